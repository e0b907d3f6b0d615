// SPDX-License-Identifier: MIT
#include "emitters/indexed_mesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>

namespace shlight {

Vec3d scaled_normal(const IndexedMesh& mesh, const Triangle& face) {
    const Vec3d& a = mesh.vertices[face.x];
    return glm::cross(mesh.vertices[face.y] - a, mesh.vertices[face.z] - a);
}

IndexedMesh welded(std::span<const Vec3d> vertices, std::span<const Triangle> triangles, double nearness) {
    std::vector<std::uint32_t> order;
    double extent = 0;
    for (const Triangle& t : triangles) {
        for (int corner = 0; corner < 3; ++corner) {
            const Vec3d v = glm::abs(vertices[t[corner]] - vertices[triangles.front().x]);
            extent = std::max({extent, v.x, v.y, v.z});
        }
    }
    std::vector<Vec3d> rounded(vertices.size());
    for (std::size_t i = 0; i < vertices.size() && extent > 0; ++i) {
        const Vec3d way = vertices[i] - vertices[triangles.front().x];
        rounded[i] = nearness > 0 ? glm::round(way / (nearness * extent)) : way;
    }
    for (const Triangle& t : triangles) {
        order.insert(order.end(), {t.x, t.y, t.z});
    }
    const auto key = [&](std::uint32_t i) { return std::tie(rounded[i].x, rounded[i].y, rounded[i].z); };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    IndexedMesh mesh;
    std::vector<std::uint32_t> position(vertices.size());
    const Vec3d* before = nullptr;
    for (const std::uint32_t i : order) {
        if (before == nullptr || *before != rounded[i]) {
            mesh.vertices.push_back(vertices[i]);
            before = &rounded[i];
        }
        position[i] = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    }
    for (const Triangle& t : triangles) {
        const Triangle face(position[t.x], position[t.y], position[t.z]);
        if (face.x != face.y && face.y != face.z && face.z != face.x && scaled_normal(mesh, face) != Vec3d(0)) {
            mesh.faces.push_back(face);
        }
    }
    return mesh;
}

}  // namespace shlight
