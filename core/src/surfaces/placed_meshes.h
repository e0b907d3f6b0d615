// SPDX-License-Identifier: MIT
//
// Meshes, curves and spheres where they stand in a scene: what a ray meets there, as shading wants it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include "base/shading_frame.h"
#include "shlight/mesh.h"
#include "shlight/ray_tracer.h"
#include "shlight/shader_program.h"
#include "shlight/surface_point.h"
#include "shlight/types.h"
#include "surfaces/compiled_mesh.h"
#include "tracing/terminator.h"

namespace shlight {

/// A place on a surface where a shader program runs.
struct SurfacePlace {
    RayHit hit;
    Vec3d position;
    Vec3d towards_viewer;  ///< unit
};

/// Other places of a surface (see shader_program.h): to the right of a hit, below it, and two near by.
using PlacesBeside = std::array<SurfacePlace, 4>;

/// A place, and what only hits have.
struct ShadedPlace {
    ShadedPlace(const SurfacePoint& point, const RayHit& hit, const Vec3d& towards_viewer, double length,
                std::uint32_t depth)
        : at{hit, point.position, towards_viewer},
          shading_normal(point.shading_normal),
          geometric_normal(point.geometric_normal),
          ray_length(length),
          transparent_depth(depth) {}

    SurfacePlace at;
    Vec3d shading_normal, geometric_normal;
    double ray_length;
    std::uint32_t transparent_depth;
};

/// Sorts numbers by their keys, and calls f with each run of those whose keys are the same, in the order in which they
/// were.
template <class Function>
void for_each_run(std::span<std::uint32_t> numbers, std::span<const std::uint32_t> keys, const Function& f) {
    const auto key = [&](std::uint32_t i) { return keys[i]; };
    std::ranges::stable_sort(numbers, {}, key);
    for (auto begin = numbers.begin(); begin != numbers.end();) {
        const auto end = std::ranges::upper_bound(begin, numbers.end(), key(*begin), {}, key);
        f(std::span<const std::uint32_t>(begin, end));
        begin = end;
    }
}

struct Placement {
    std::uint32_t mesh, number;    // number: of the mesh's instances
    std::uint32_t first_material;  // number of the mesh's first material in the scene
    bool baked;                    // the mesh's vertices are in the world frame
    // It is baked, and a transform that stretches one axis more would weigh its normals otherwise: they are
    // interpolated in the world, as those of Cycles' meshes without instances.
    bool stretched;
    bool mirrored;  // it shows its front where its corners, in the world, run clockwise
    glm::dmat4 to_world;
    glm::dmat4 to_object;
    double condition;  // how much a ray's rounding grows on its way through the instance's frame
    double origin;     // largest component of the translation
};

class PlacedMeshes {
  public:
    /// The origin of the frame in which everything stands, for programs, which read the world's.
    void set_origin(const Vec3d& origin) { origin_ = origin; }
    const Vec3d& origin() const { return origin_; }
    /// first_material: number of the mesh's first material in the scene.
    void add(std::shared_ptr<const CompiledMesh> mesh, std::uint32_t first_material);

    std::span<const std::shared_ptr<const CompiledMesh>> meshes() const { return meshes_; }
    std::span<const Placement> placements() const { return placements_; }

    /// Precondition: not hit.missed(); direction is the ray's.
    SurfacePoint surface(const RayHit& hit, const Vec3f& direction) const;
    /// point: surface() there.
    Terminator terminator(const RayHit& hit, const SurfacePoint& point) const;
    /// The value of Pass::uv, whose last component is 1; 0 on meshes without texture coordinates.
    Vec3d uv(const RayHit& hit) const;
    /// The azimuth of a frame's x, 0 … 2π, from the direction on in which anisotropic materials are laid out: in which
    /// the texture coordinate u grows, or, on meshes without texture coordinates, around the mesh's own z-axis.
    double azimuth(const RayHit& hit, const ShadingFrame& frame) const;
    const Label& label(const RayHit& hit) const;
    /// MeshUse::seen_by of what was hit.
    std::uint32_t seen_by(const RayHit& hit) const { return mesh_of(placements_[hit.instance]).seen_by; }
    /// MeshUse::is_holdout of what was hit.
    bool is_holdout(const RayHit& hit) const { return mesh_of(placements_[hit.instance]).is_holdout; }
    /// Whether triangles were hit, and no curve or sphere.
    bool is_triangle(const RayHit& hit) const {
        return mesh_of(placements_[hit.instance]).shape->form == SurfaceForm::triangles;
    }
    /// Corners of the hit triangle, in the frame in which everything stands.
    std::array<Vec3d, 3> corners(const RayHit& hit) const;
    /// Whether the viewer sees the mesh's back.
    bool is_back(const RayHit& hit, const Vec3d& towards_viewer) const;
    /// The radiance that the material emits to the side of the viewer.
    const Rgb& emission(const Material& material, const RayHit& hit, const Vec3d& towards_viewer) const;
    /// The place where another ray meets the plane of a surface, which may lie outside its triangle. The ray is taken
    /// to be at most twice as long as the hit's. Precondition: as of surface().
    SurfacePlace neighbour(const SurfacePlace& place, const Vec3d& normal, double length, const Ray& ray) const;
    /// The place at the end of a step in the plane of a surface, which may lie outside its triangle.
    SurfacePlace beside(const SurfacePlace& place, const Vec3d& step) const;
    /// Evaluates a material's program, see ShaderProgram::evaluate(). beside: of each place; none: nothing differs.
    void run(const ShaderProgram& program, const Material& material, std::span<const ShadedPlace> places,
             std::span<const PlacesBeside> beside, ShaderProgram::Registers& registers, std::span<float> results) const;

  private:
    class PlaceReader;

    /// place: see ShaderReader; that of the hits, or one of `beside`.
    void read(const ShaderInput& input, const Material& material, std::size_t place, std::span<const ShadedPlace> hits,
              std::span<const PlacesBeside> beside, std::span<float> out) const;
    /// The mesh's own at the corners of the hit triangle, in its frame, of no particular length; none: it is flat.
    std::optional<std::array<Vec3d, 3>> corner_normals(const RayHit& hit) const;
    /// surface() of curves and spheres.
    SurfacePoint round_surface(const RayHit& hit, const Vec3f& direction) const;
    /// How far a corner of the hit triangle is from the edge opposite to it, in the world.
    double height(const RayHit& hit, std::size_t corner) const;
    /// ∂P/∂u up to its length, of curves the way along them; 0 where u and v do not say.
    Vec3d growth_of_u(const RayHit& hit) const;
    Vec3d around_axis(const RayHit& hit, const Vec3d& position) const;
    Vec3d normal_at(const ShadedPlace& shaded, const SurfacePlace& at, bool smooth) const;
    /// See ShaderSource::mesh_normal. normal: that in the world.
    Vec3d mesh_normal(const RayHit& hit, const Vec3d& normal) const;
    float object_value(const Placement& placement, std::uint32_t index) const;
    /// A number of the matrix from the mesh's frame to the world, and of its inverse, row by row.
    double to_world_number(const Placement& placement, std::uint32_t component) const;
    double to_object_number(const Placement& placement, std::uint32_t component) const;
    float attribute(const MeshAttribute& attribute, std::uint32_t component, const RayHit& hit) const;

    const SceneMesh& mesh_of(const Placement& placement) const { return *meshes_[placement.mesh]->mesh; }

    Vec3d origin_{0};
    std::vector<std::shared_ptr<const CompiledMesh>> meshes_;
    std::vector<Placement> placements_;
};

}  // namespace shlight
