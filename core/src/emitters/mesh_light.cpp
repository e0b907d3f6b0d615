// SPDX-License-Identifier: MIT
#include "shlight/mesh_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

namespace shlight {
namespace {

constexpr double kCoplanar = 1e-5;  // height over the plane ÷ extent, and sine at a convex corner

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Vec3d scaled_normal(std::span<const Vec3d> vertices, const Triangle& t) {
    return glm::cross(vertices[t.y] - vertices[t.x], vertices[t.z] - vertices[t.x]);
}

double longest_edge(std::span<const Vec3d> vertices, const Triangle& t) {
    return std::max({glm::length(vertices[t.y] - vertices[t.x]), glm::length(vertices[t.z] - vertices[t.y]),
                     glm::length(vertices[t.x] - vertices[t.z])});
}

bool has_area(std::span<const Vec3d> vertices, const Triangle& t) {
    const double longest = longest_edge(vertices, t);
    return glm::length(scaled_normal(vertices, t)) > 1e-8 * longest * longest;
}

/// The quadrilateral of two triangles, if it is planar and convex. They share the edge of `first` that starts at corner
/// `edge`; `apex` is the corner of the other triangle off this edge.
std::optional<FaceOutline> quadrilateral(std::span<const Vec3d> vertices, const Triangle& first, int edge,
                                         std::uint32_t apex) {
    const Vec3d& from = vertices[first[edge]];
    const Vec3d& to = vertices[first[(edge + 1) % 3]];
    const Vec3d& opposite = vertices[first[(edge + 2) % 3]];
    const Vec3d normal = glm::normalize(scaled_normal(vertices, first));
    const Vec3d& tip = vertices[apex];
    if (std::abs(glm::dot(tip - from, normal)) > kCoplanar * longest_edge(vertices, first)) {
        return std::nullopt;
    }
    FaceOutline outline = {from, tip, to, opposite};
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3d in = glm::normalize(outline[(i + 1) % 4] - outline[i]);
        const Vec3d out = glm::normalize(outline[(i + 2) % 4] - outline[(i + 1) % 4]);
        if (!(glm::dot(glm::cross(in, out), normal) > kCoplanar)) {
            return std::nullopt;
        }
    }
    return outline;
}

/// Joins triangles to pairs, each at most once.
class FaceMerger {
  public:
    FaceMerger(std::span<const Vec3d> vertices, std::span<const Triangle> triangles)
        : vertices_(vertices), triangles_(triangles), used_(triangles.size()) {
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            used_[i] = !has_area(vertices, triangles[i]);
            for (int corner = 0; corner < 3; ++corner) {
                triangle_at_.emplace(Edge{triangles[i][corner], triangles[i][(corner + 1) % 3]}, i);
            }
        }
    }

    std::vector<FaceOutline> run() {
        std::vector<FaceOutline> outlines;
        for (std::size_t i = 0; i < triangles_.size(); ++i) {
            if (!used_[i]) {
                used_[i] = true;
                outlines.push_back(face_from(triangles_[i]));
            }
        }
        return outlines;
    }

  private:
    /// The triangle with its first partner, or alone.
    FaceOutline face_from(const Triangle& triangle) {
        std::size_t partner = triangles_.size();
        FaceOutline outline = {vertices_[triangle.x], vertices_[triangle.y], vertices_[triangle.z]};
        for (int edge = 0; edge < 3; ++edge) {
            const std::uint32_t from = triangle[edge];
            const std::uint32_t to = triangle[(edge + 1) % 3];
            // A neighbour with the same winding passes the shared edge in the other direction.
            const auto [begin, end] = triangle_at_.equal_range({to, from});
            for (auto it = begin; it != end; ++it) {
                if (used_[it->second] || it->second >= partner) continue;
                const Triangle& other = triangles_[it->second];
                const std::uint32_t apex = other.x ^ other.y ^ other.z ^ from ^ to;
                if (auto joined = quadrilateral(vertices_, triangle, edge, apex)) {
                    outline = std::move(*joined);
                    partner = it->second;
                }
            }
        }
        if (partner < triangles_.size()) {
            used_[partner] = true;
        }
        return outline;
    }

    std::span<const Vec3d> vertices_;
    std::span<const Triangle> triangles_;
    std::multimap<Edge, std::size_t> triangle_at_;  // by directed edge
    std::vector<bool> used_;                        // or without area
};

}  // namespace

std::vector<FaceOutline> merge_faces(std::span<const Vec3d> vertices, std::span<const Triangle> triangles) {
    return FaceMerger(vertices, triangles).run();
}

}  // namespace shlight
