// SPDX-License-Identifier: MIT
#include "surfaces/compiled_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/ray_rounding.h"
#include "base/scene_range.h"
#include "base/transforms.h"
#include "surfaces/mesh_emission.h"

namespace shlight {
namespace {

/// Triangles whose tree is built anew when their mesh moves: this many take some ten milliseconds of a core.
constexpr std::size_t kMostMovedTriangles = 1 << 15;
/// Growth of rays' rounding in a mesh's own frame, which costs shadow rays more distance from the surface: a rotation
/// has up to 3.
constexpr double kLargestCondition = 4;

/// Deviation of a square of a scale from that of others, as a share, below which they are alike.
constexpr double kEvenScale = 1e-5;

bool scales_evenly(const glm::dmat3& linear) {
    const glm::dmat3 squares = glm::transpose(linear) * linear;
    const double mean = (squares[0][0] + squares[1][1] + squares[2][2]) / 3;
    return inf_norm(squares - mean * glm::dmat3(1)) <= kEvenScale * mean;
}

/// A mesh placed once has its vertices moved to the world, where rays are rounded least, unless it is so large that it
/// had better keep its tree when it moves. Curves and spheres that are scaled unevenly have no radius there: they are
/// round, or turn to the ray, in their own frame, as in Cycles.
bool is_baked(const SceneMesh& mesh) {
    if (mesh.transforms.size() != 1) {
        return false;
    }
    if (mesh.shape->form != SurfaceForm::triangles) {
        return scales_evenly(glm::dmat3(mesh.transforms.front()));
    }
    if (mesh.shape->triangles.size() <= kMostMovedTriangles) {
        return true;
    }
    const glm::dmat4& to_world = mesh.transforms.front();
    const glm::dmat3 linear(to_world);
    const double scale = inf_norm(linear);
    const double inverse_scale = inf_norm(glm::inverse(linear));
    const double origin = largest_component(Vec3d(to_world[3]));
    const Box box = bounds(*mesh.shape, mesh);
    return !(scale * inverse_scale <= kLargestCondition && scale <= kLargestScale && inverse_scale <= kLargestScale &&
             origin <= 2 * box.reach());
}

std::vector<Vec3f> moved(const std::vector<Vec3f>& vertices, const glm::dmat4& to_world) {
    std::vector<Vec3f> result;
    result.reserve(vertices.size());
    for (const Vec3f& v : vertices) {
        result.emplace_back(transform_point(to_world, Vec3d(v)));
    }
    return result;
}

/// The mesh in a frame with this origin.
std::shared_ptr<const SceneMesh> moved(const std::shared_ptr<const SceneMesh>& mesh, const Vec3d& origin) {
    if (origin == Vec3d(0)) {
        return mesh;
    }
    auto result = std::make_shared<SceneMesh>(*mesh);
    for (glm::dmat4& to_world : result->transforms) {
        to_world[3] -= glm::dvec4(origin, 0);
    }
    return result;
}

/// Whether each material lets light through.
std::vector<bool> transparent_materials(const SceneMesh& mesh) {
    std::vector<bool> transparent;
    for (const MeshShader& own : mesh.shaders) {
        transparent.push_back(own.shader != nullptr && own.shader->transparency);
    }
    // None, if no material does: the number of materials may change.
    return std::ranges::find(transparent, true) == transparent.end() ? std::vector<bool>() : transparent;
}

/// Whether a triangle of the mesh gives light.
bool shines(const SceneMesh& mesh) {
    for (std::size_t i = 0; i < mesh.shape->triangles.size(); ++i) {
        if (mesh.emitted(mesh.shape->material_index(i)) != Emission()) {
            return true;
        }
    }
    return false;
}

/// The curves or spheres for which wanted(part).
template <class Wanted>
RoundParts round_parts(const CompiledMesh& compiled, const Wanted& wanted) {
    const MeshShape& shape = *compiled.mesh->shape;
    RoundParts parts = {shape.form, {}, {}, {}, shape.subdivisions};
    const auto add = [&](std::size_t vertex) {
        parts.points.emplace_back(compiled.vertices()[vertex], compiled.radius_scale * shape.radii[vertex]);
    };
    for (std::size_t part = 0; part < shape.part_count(); ++part) {
        if (!wanted(part)) {
            continue;
        }
        const std::size_t first = shape.is_curved() ? shape.first[part] : part;
        const std::size_t last = shape.is_curved() ? shape.curve_end(part) - 1 : part;
        if (shape.is_curved()) add(first);
        for (std::size_t vertex = first; vertex <= last; ++vertex) {
            if (vertex < last) parts.segments.push_back(static_cast<std::uint32_t>(parts.points.size()) - 1);
            if (vertex < last || !shape.is_curved()) parts.numbers.push_back(static_cast<std::uint32_t>(vertex));
            add(vertex);
        }
        if (shape.is_curved()) add(last);
    }
    return parts;
}

/// The mesh's surfaces, or those of them that let light through; null: there are none.
std::shared_ptr<const SurfaceTree> tree_of(const CompiledMesh& compiled, const std::vector<bool>& transparent,
                                           bool wanted, const Stopped& stopped) {
    const MeshShape& shape = *compiled.mesh->shape;
    const auto is_wanted = [&](std::size_t part) {
        return (!transparent.empty() && transparent[shape.material_index(part)]) == wanted;
    };
    if (shape.form != SurfaceForm::triangles) {
        RoundParts parts = round_parts(compiled, is_wanted);
        return parts.points.empty() ? nullptr : std::make_shared<const SurfaceTree>(std::move(parts), stopped);
    }
    if (transparent.empty()) {
        return wanted ? nullptr
                      : std::make_shared<const SurfaceTree>(compiled.vertices(), shape.triangles,
                                                            std::vector<std::uint32_t>(), stopped);
    }
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < shape.triangles.size(); ++i) {
        if (is_wanted(i)) {
            triangles.push_back(shape.triangles[i]);
            numbers.push_back(i);
        }
    }
    return triangles.empty()
               ? nullptr
               : std::make_shared<const SurfaceTree>(compiled.vertices(), triangles, std::move(numbers), stopped);
}

}  // namespace

std::shared_ptr<const CompiledMesh> compile_mesh(const std::shared_ptr<const SceneMesh>& given, const Vec3d& origin,
                                                 const std::shared_ptr<const CompiledMesh>& before,
                                                 const Stopped& stopped) {
    if (before != nullptr && before->given == given && before->origin == origin) {
        return before;
    }
    end_if(stopped);
    auto compiled = std::make_shared<CompiledMesh>();
    const std::shared_ptr<const SceneMesh> mesh = moved(given, origin);
    compiled->given = given;
    compiled->mesh = mesh;
    compiled->origin = origin;
    const MeshShape& shape = *mesh->shape;
    const bool baked = is_baked(*mesh);
    const bool is_in_place =
        before != nullptr && before->is_baked() == baked && (!baked || before->mesh->transforms == mesh->transforms);
    if (is_in_place) {
        compiled->world_vertices = before->world_vertices;
    } else if (baked) {
        compiled->world_vertices =
            std::make_shared<const std::vector<Vec3f>>(moved(shape.vertices, mesh->transforms.front()));
    }
    compiled->radius_scale = baked ? std::cbrt(std::abs(glm::determinant(glm::dmat3(mesh->transforms.front())))) : 1.0;
    const std::vector<bool> transparent = transparent_materials(*mesh);
    if (is_in_place && transparent_materials(*before->mesh) == transparent) {
        compiled->opaque = before->opaque;
        compiled->transparent = before->transparent;
    } else {
        compiled->opaque = tree_of(*compiled, transparent, false, stopped);
        compiled->transparent = tree_of(*compiled, transparent, true, stopped);
    }
    compiled->is_crowd = mesh->transforms.size() > kMostMeshLights && shines(*mesh);
    if (!compiled->is_crowd) {
        visit_emissive_faces(*compiled, 0,
                             [&](const EmissiveFaces& faces) { add_lights(faces, stopped, compiled->lights); });
    }
    return compiled;
}

}  // namespace shlight
