// SPDX-License-Identifier: MIT
//
// Meshes where they stand in a scene: what a ray meets there, as shading wants it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include "render/compiled_mesh.h"
#include "shlight/mesh.h"
#include "shlight/ray_tracer.h"
#include "shlight/scene.h"
#include "shlight/surface_point.h"
#include "shlight/types.h"

namespace shlight {

struct Placement {
    std::uint32_t mesh, number;    // number: of the mesh's instances
    std::uint32_t first_material;  // number of the mesh's first material in the scene
    bool baked;                    // the mesh's vertices are in the world frame
    glm::dmat4 to_world;
    glm::dmat4 to_object;
    double condition;  // how much a ray's rounding grows on its way through the instance's frame
    double origin;     // largest component of the translation
};

class PlacedMeshes {
  public:
    /// The origin of the frame in which everything stands, for programs, which read the world's.
    void set_origin(const Vec3d& origin) { origin_ = origin; }
    /// first_material: number of the mesh's first material in the scene.
    void add(std::shared_ptr<const CompiledMesh> mesh, std::uint32_t first_material);

    std::span<const std::shared_ptr<const CompiledMesh>> meshes() const { return meshes_; }
    std::span<const Placement> placements() const { return placements_; }

    /// These do what CompiledScene's functions of the same names do.
    SurfacePoint surface(const RayHit& hit, const Vec3f& direction) const;
    Vec3d uv(const RayHit& hit) const;
    const Label& label(const RayHit& hit) const;
    SurfacePlace neighbour(const SurfacePlace& place, const Vec3d& normal, double length, const Ray& ray) const;
    void read(const ShaderInput& input, const std::vector<std::uint32_t>& attributes, int place,
              std::span<const ShadedPlace> places, std::span<float> out) const;

  private:
    /// The mesh's own, of no particular length; false: it is flat there.
    bool smooth_normal(const RayHit& hit, Vec3d& normal) const;
    /// Corners of the hit triangle in the world.
    std::array<Vec3d, 3> corners(const RayHit& hit) const;
    /// place: see ShaderReader.
    Vec3d normal_at(const ShadedPlace& shaded, int place, bool smooth) const;
    float object_value(const Placement& placement, std::uint32_t index) const;
    bool is_back(const RayHit& hit, const Vec3d& towards_viewer) const;
    float attribute(const MeshAttribute& attribute, std::uint32_t component, const RayHit& hit) const;

    const SceneMesh& mesh_of(const Placement& placement) const { return *meshes_[placement.mesh]->mesh; }

    Vec3d origin_{0};
    std::vector<std::shared_ptr<const CompiledMesh>> meshes_;
    std::vector<Placement> placements_;
};

}  // namespace shlight
