// SPDX-License-Identifier: MIT
//
// What a compiled scene builds of one mesh: its vertices in the world, the trees for its rays, and its emissive faces
// as lights. Scenes that are compiled later share what a change of the mesh leaves as it is.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "shlight/light.h"
#include "shlight/mesh.h"
#include "shlight/parallel.h"
#include "shlight/ray_tracer.h"

namespace shlight {

/// Lights of meshes in a scene, at most, that are looked at one by one.
inline constexpr std::size_t kMostMeshLights = 128;

struct CompiledMesh {
    std::shared_ptr<const SceneMesh> given;                    ///< as the scene has it
    std::shared_ptr<const SceneMesh> mesh;                     ///< the same, in the scene's frame
    Vec3d origin;                                              ///< of that frame
    std::shared_ptr<const std::vector<Vec3f>> world_vertices;  ///< null: rays meet the mesh in its own frame
    double radius_scale = 1;                                   ///< of curves and spheres there
    std::shared_ptr<const SurfaceTree> opaque, transparent;    ///< null: there are no such surfaces
    std::vector<Light> lights;  ///< EmissiveMesh::instance counts the instances of this mesh; none of a crowd
    bool is_crowd = false;      ///< it shines and has more instances than a scene looks at one by one

    bool is_baked() const { return world_vertices != nullptr; }
    /// In the frame in which rays meet the mesh.
    std::span<const Vec3f> vertices() const { return is_baked() ? *world_vertices : mesh->shape->vertices; }
};

/// origin: see CompiledScene::origin(); before: the mesh of the same shape in the scene before, or null.
/// Throws what SurfaceTree throws.
std::shared_ptr<const CompiledMesh> compile_mesh(const std::shared_ptr<const SceneMesh>& given, const Vec3d& origin,
                                                 const std::shared_ptr<const CompiledMesh>& before,
                                                 const Stopped& stopped);

}  // namespace shlight
