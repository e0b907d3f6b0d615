// SPDX-License-Identifier: MIT
#include "shlight/mesh.h"

#include <algorithm>
#include <string>

#include "base/scene_range.h"
#include "base/transforms.h"

namespace shlight {
namespace {

void check_all_finite(const char* name, const std::vector<Vec3f>& vectors) {
    for (const Vec3f& v : vectors) {
        check_finite(name, v);
    }
}

void check_per_material(const char* name, std::size_t size, std::size_t material_count) {
    if (size != 1 && size != material_count) {
        reject(std::string(name) + " must have one entry, or one per material (" + std::to_string(material_count) +
               "), got " + std::to_string(size));
    }
}

void check_round(const MeshShape& shape) {
    check_size("radii", shape.radii.size(), shape.form == SurfaceForm::triangles ? 0 : shape.vertices.size());
    for (const float radius : shape.radii) {
        if (!(radius >= 0 && double{radius} <= kFarthest)) {
            reject("radii must be in 0 … 1e10");
        }
    }
    for (std::size_t curve = 0; curve < shape.first.size(); ++curve) {
        const std::uint32_t begin = shape.first[curve];
        if ((curve == 0 && begin > 0) || begin + std::size_t{2} > shape.curve_end(curve)) {
            reject("first must begin with 0 and leave two points or more to each curve; curve " +
                   std::to_string(curve) + " begins with point " + std::to_string(begin));
        }
    }
    if (shape.is_curved() && shape.first.empty() && !shape.vertices.empty()) {
        reject("first must name the first point of a curve");
    }
}

void check_attributes(const MeshShape& shape) {
    for (const MeshAttribute& attribute : shape.attributes) {
        if (attribute.components < 1 || attribute.components > 4) {
            reject("attributes must have 1 … 4 components");
        }
        const std::size_t count = attribute.values.size() / attribute.components;
        if (count * attribute.components != attribute.values.size() ||
            (count != shape.vertices.size() && count != shape.part_count() && count != 3 * shape.triangles.size())) {
            reject("attributes must have one entry per vertex, part or triangle's corner");
        }
    }
}

void check_shaders(const MeshShape& shape, const MeshUse& use) {
    if (use.shaders.empty()) {
        return;
    }
    check_size("shaders", use.shaders.size(), use.material_count());
    for (const MeshShader& own : use.shaders) {
        for (const std::uint32_t index : own.attributes) {
            if (index != MeshShader::kNoAttribute && index >= shape.attributes.size()) {
                reject("shaders: attribute " + std::to_string(index) + " does not exist");
            }
        }
    }
}

void check_materials(const MeshShape& shape, const MeshUse& use) {
    const std::size_t count = use.material_count();
    check_per_material("bsdf", use.bsdfs.size(), count);
    check_per_material("emission", use.emission.size(), count);
    for (const Emission& own : use.emission) {
        check_strength("emission", own.front);
        check_strength("emission", own.back);
    }
    for (const std::uint32_t index : shape.material_indices) {
        if (index >= count) {
            reject("material_indices: " + std::to_string(index) + " is out of range for " + std::to_string(count) +
                   " materials");
        }
    }
}

void check_share(const char* name, double value) {
    if (!(value >= 0 && value <= 1)) {
        reject(std::string(name) + " must be in 0 … 1");
    }
}

/// Rays go through instances' frames, in float.
void check_scale(const glm::dmat4& transform) {
    const glm::dmat3 linear(transform);
    if (!(inf_norm(linear) <= kLargestScale && inf_norm(glm::inverse(linear)) <= kLargestScale)) {
        reject("transforms: an instance must be scaled by 1e-7 … 1e7");
    }
}

}  // namespace

Box bounds(const MeshShape& shape, const MeshUse& use) {
    Box local;
    for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
        const double radius = shape.radii.empty() ? 0.0 : double{shape.radii[i]};
        local.add(Vec3d(shape.vertices[i]) - radius);
        local.add(Vec3d(shape.vertices[i]) + radius);
    }
    Box world;
    for (const glm::dmat4& transform : use.transforms) {
        for (int corner = 0; corner < 8 && !shape.vertices.empty(); ++corner) {
            world.add(transform_point(
                transform, {corner & 1 ? local.least.x : local.largest.x, corner & 2 ? local.least.y : local.largest.y,
                            corner & 4 ? local.least.z : local.largest.z}));
        }
    }
    return world;
}

void check_shape(const MeshShape& shape) {
    for (const Vec3f& v : shape.vertices) {
        check_position(shape.form == SurfaceForm::triangles ? "vertices" : "points", Vec3d(v));
    }
    for (const Triangle& triangle : shape.triangles) {
        const std::uint32_t largest = std::max({triangle.x, triangle.y, triangle.z});
        if (largest >= shape.vertices.size()) {
            reject("triangles: vertex " + std::to_string(largest) + " is out of range for " +
                   std::to_string(shape.vertices.size()) + " vertices");
        }
    }
    if (!shape.vertex_normals.empty()) {
        check_size("normals", shape.vertex_normals.size(), shape.vertices.size());
        check_all_finite("normals", shape.vertex_normals);
    }
    if (!shape.corner_normals.empty()) {
        check_size("normals", shape.corner_normals.size(), 3 * shape.triangles.size());
        check_all_finite("normals", shape.corner_normals);
    }
    if (!shape.material_indices.empty()) {
        check_size("material_indices", shape.material_indices.size(), shape.part_count());
    }
    if (shape.uv != MeshShader::kNoAttribute && shape.uv >= shape.attributes.size()) {
        reject("uv: there is no such attribute");
    }
    check_round(shape);
    check_attributes(shape);
}

void check_place(const char* name, const glm::dmat4& to_world) {
    check_transform(name, to_world);
}

void check_use(const MeshShape& shape, const MeshUse& use) {
    check_share("terminator_geometry_offset", use.terminator.geometry);
    check_share("terminator_shading_offset", use.terminator.shading);
    check_materials(shape, use);
    check_shaders(shape, use);
    if (!use.object_values.empty()) {
        check_size("object_values", use.object_values.size(), use.transforms.size());
    }
    if (!use.object_labels.empty()) {
        check_size("object_labels", use.object_labels.size(), use.transforms.size());
    }
    if (!use.material_labels.empty()) {
        check_size("material_labels", use.material_labels.size(), use.material_count());
    }
    for (const glm::dmat4& transform : use.transforms) {
        check_transform("transforms", transform);
        if (use.transforms.size() > 1) {
            check_scale(transform);
        }
    }
    check_reach("transforms", bounds(shape, use).reach());
}

}  // namespace shlight
