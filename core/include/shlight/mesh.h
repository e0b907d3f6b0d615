// SPDX-License-Identifier: MIT
//
// Triangle meshes with materials, placed once or many times.
#pragma once

#include <cstdint>
#include <vector>

#include "shlight/bsdf.h"
#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// Surfaces are two-sided: the normal is turned to the viewer.
struct Mesh {
    std::vector<Vec3f> vertices;
    std::vector<Triangle> triangles;  ///< vertex indices
    /// Smooth normals of any length in the mesh's frame: one per vertex, or three per triangle, or none (flat).
    std::vector<Vec3f> vertex_normals, corner_normals;
    std::vector<Bsdf> bsdfs = {Bsdf()};                    ///< one per material, or one for all
    std::vector<Rgb> emission = {Rgb(0)};                  ///< radiance of both sides: one per material, or one for all
    std::vector<std::uint32_t> material_indices;           ///< one per triangle, or none (all 0)
    std::vector<glm::dmat4> transforms = {glm::dmat4(1)};  ///< object to world, one per instance

    std::size_t material_count() const { return bsdfs.size() > emission.size() ? bsdfs.size() : emission.size(); }
    std::uint32_t material_index(std::size_t triangle) const {
        return material_indices.empty() ? 0 : material_indices[triangle];
    }
    const Bsdf& bsdf(std::size_t material) const { return bsdfs[bsdfs.size() == 1 ? 0 : material]; }
    const Rgb& emitted(std::size_t material) const { return emission[emission.size() == 1 ? 0 : material]; }
};

/// Throws std::invalid_argument naming the member that is wrong: sizes that do not fit, an index out of range,
/// a number outside docs/conventions.md's range, a transform that is not affine and invertible.
void check_mesh(const Mesh& mesh);

/// A bound of the coordinates that its instances have in the world.
double reach(const Mesh& mesh);

}  // namespace shlight
