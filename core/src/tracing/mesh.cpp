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

void check_attributes(const Mesh& mesh) {
    for (const MeshAttribute& attribute : mesh.attributes) {
        if (attribute.components < 1 || attribute.components > 4) {
            reject("attributes must have 1 … 4 components");
        }
        const std::size_t count = attribute.values.size() / attribute.components;
        if (count * attribute.components != attribute.values.size() ||
            (count != mesh.vertices.size() && count != mesh.triangles.size() && count != 3 * mesh.triangles.size())) {
            reject("attributes must have one entry per vertex, triangle or triangle's corner");
        }
    }
}

void check_shaders(const Mesh& mesh) {
    if (mesh.shaders.empty()) {
        return;
    }
    check_size("shaders", mesh.shaders.size(), mesh.material_count());
    for (const MeshShader& own : mesh.shaders) {
        for (const std::uint32_t index : own.attributes) {
            if (index != MeshShader::kNoAttribute && index >= mesh.attributes.size()) {
                reject("shaders: attribute " + std::to_string(index) + " does not exist");
            }
        }
    }
}

void check_materials(const Mesh& mesh) {
    check_per_material("bsdf", mesh.bsdfs.size(), mesh.material_count());
    check_per_material("emission", mesh.emission.size(), mesh.material_count());
    std::for_each(mesh.emission.begin(), mesh.emission.end(),
                  [](const Rgb& color) { check_strength("emission", color); });
    if (mesh.material_indices.empty()) {
        return;
    }
    check_size("material_indices", mesh.material_indices.size(), mesh.triangles.size());
    for (const std::uint32_t index : mesh.material_indices) {
        if (index >= mesh.material_count()) {
            reject("material_indices: " + std::to_string(index) + " is out of range for " +
                   std::to_string(mesh.material_count()) + " materials");
        }
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

double reach(const Mesh& mesh) {
    if (mesh.vertices.empty()) {
        return 0;
    }
    Vec3d least(mesh.vertices.front());
    Vec3d largest = least;
    for (const Vec3f& v : mesh.vertices) {
        least = glm::min(least, Vec3d(v));
        largest = glm::max(largest, Vec3d(v));
    }
    double farthest = 0;
    for (const glm::dmat4& transform : mesh.transforms) {
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3d p(corner & 1 ? least.x : largest.x, corner & 2 ? least.y : largest.y,
                          corner & 4 ? least.z : largest.z);
            farthest = std::max(farthest, largest_component(transform_point(transform, p)));
        }
    }
    return farthest;
}

void check_mesh(const Mesh& mesh) {
    for (const Vec3f& v : mesh.vertices) {
        check_position("vertices", Vec3d(v));
    }
    for (const Triangle& triangle : mesh.triangles) {
        const std::uint32_t largest = std::max({triangle.x, triangle.y, triangle.z});
        if (largest >= mesh.vertices.size()) {
            reject("triangles: vertex " + std::to_string(largest) + " is out of range for " +
                   std::to_string(mesh.vertices.size()) + " vertices");
        }
    }
    if (!mesh.vertex_normals.empty()) {
        check_size("normals", mesh.vertex_normals.size(), mesh.vertices.size());
        check_all_finite("normals", mesh.vertex_normals);
    }
    if (!mesh.corner_normals.empty()) {
        check_size("normals", mesh.corner_normals.size(), 3 * mesh.triangles.size());
        check_all_finite("normals", mesh.corner_normals);
    }
    check_materials(mesh);
    check_shaders(mesh);
    check_attributes(mesh);
    if (!mesh.object_values.empty()) {
        check_size("object_values", mesh.object_values.size(), mesh.transforms.size());
    }
    if (!mesh.object_labels.empty()) {
        check_size("object_labels", mesh.object_labels.size(), mesh.transforms.size());
    }
    if (!mesh.material_labels.empty()) {
        check_size("material_labels", mesh.material_labels.size(), mesh.material_count());
    }
    if (mesh.uv != MeshShader::kNoAttribute && mesh.uv >= mesh.attributes.size()) {
        reject("uv: there is no such attribute");
    }
    for (const glm::dmat4& transform : mesh.transforms) {
        check_transform("transforms", transform);
        if (mesh.transforms.size() > 1) {
            check_scale(transform);
        }
    }
    check_reach("transforms", reach(mesh));
}

}  // namespace shlight
