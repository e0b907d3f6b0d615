// SPDX-License-Identifier: MIT
#include "shlight/mesh.h"

#include <algorithm>
#include <string>

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

void check_materials(const Mesh& mesh) {
    check_per_material("bsdf", mesh.bsdfs.size(), mesh.material_count());
    check_per_material("emission", mesh.emission.size(), mesh.material_count());
    check_all_finite("emission", mesh.emission);
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

}  // namespace

void check_mesh(const Mesh& mesh) {
    check_all_finite("vertices", mesh.vertices);
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
    for (const glm::dmat4& transform : mesh.transforms) {
        check_transform("transforms", transform);
    }
}

}  // namespace shlight
