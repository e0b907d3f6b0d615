// SPDX-License-Identifier: MIT
#include "shlight/mesh_light.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "emitters/indexed_mesh.h"

namespace shlight {
namespace {

/// Height over a plane ÷ the distance within it.
constexpr double kCoplanar = 1e-5;
/// Sine of the angle between normals in a plane: tiny triangles are turned by the rounding of their corners.
constexpr double kAlikeNormals = 1e-3;

double longest_edge(const IndexedMesh& mesh, const Triangle& t) {
    const auto length = [&](std::uint32_t a, std::uint32_t b) {
        return glm::length(mesh.vertices[b] - mesh.vertices[a]);
    };
    return std::max({length(t.x, t.y), length(t.y, t.z), length(t.z, t.x)});
}

bool has_area(const IndexedMesh& mesh, const Triangle& t) {
    const double longest = longest_edge(mesh, t);
    return glm::length(scaled_normal(mesh, t)) > 1e-8 * longest * longest;
}

class FaceMerger {
  public:
    explicit FaceMerger(IndexedMesh mesh) : mesh_(std::move(mesh)), used_(mesh_.faces.size()) {
        for (std::size_t i = 0; i < mesh_.faces.size(); ++i) {
            used_[i] = !has_area(mesh_, mesh_.faces[i]);
            for (int corner = 0; corner < 3 && !used_[i]; ++corner) {
                triangle_at_.emplace(edge(mesh_.faces[i], corner), i);
            }
        }
    }

    std::optional<std::vector<FaceOutline>> run(std::size_t most_corners) {
        std::size_t corners = 0;
        for (std::size_t i = 0; i < mesh_.faces.size(); ++i) {
            if (used_[i]) {
                continue;
            }
            const std::size_t before = outlines_.size();
            add_part(i);
            for (std::size_t k = before; k < outlines_.size(); ++k) {
                corners += outlines_[k].size();
            }
            if (corners > most_corners) {
                return std::nullopt;
            }
        }
        return std::move(outlines_);
    }

  private:
    static std::uint64_t directed(std::uint32_t from, std::uint32_t to) { return std::uint64_t{from} << 32U | to; }
    static std::uint64_t edge(const Triangle& t, int corner) { return directed(t[corner], t[(corner + 1) % 3]); }

    /// Adds the outlines of all that lies in one plane with a triangle and is connected to it.
    void add_part(std::size_t seed) {
        find_part(seed);
        FaceOutline outline = boundary();
        if (outline.size() >= 3) {
            outlines_.push_back(std::move(outline));
            return;
        }
        for (const std::size_t i : part_) {
            const Triangle& t = mesh_.faces[i];
            outlines_.push_back({mesh_.vertices[t.x], mesh_.vertices[t.y], mesh_.vertices[t.z]});
        }
    }

    void find_part(std::size_t seed) {
        const Vec3d& origin = mesh_.vertices[mesh_.faces[seed].x];
        const double size = longest_edge(mesh_, mesh_.faces[seed]);
        normal_ = glm::normalize(scaled_normal(mesh_, mesh_.faces[seed]));
        const auto in_plane = [&](const Triangle& t) {
            const Vec3d own = glm::normalize(scaled_normal(mesh_, t));
            bool flat = glm::dot(own, normal_) > 0 && glm::length(glm::cross(own, normal_)) <= kAlikeNormals;
            for (int corner = 0; corner < 3; ++corner) {
                const Vec3d way = mesh_.vertices[t[corner]] - origin;
                flat = flat && std::abs(glm::dot(way, normal_)) <= kCoplanar * std::max(size, glm::length(way));
            }
            return flat;
        };
        part_ = {seed};
        used_[seed] = true;
        for (std::size_t k = 0; k < part_.size(); ++k) {
            for (int corner = 0; corner < 3; ++corner) {
                // A neighbour with the same winding passes the shared edge in the other direction.
                const Triangle& t = mesh_.faces[part_[k]];
                const auto [begin, end] = triangle_at_.equal_range(directed(t[(corner + 1) % 3], t[corner]));
                for (auto it = begin; it != end; ++it) {
                    if (!used_[it->second] && in_plane(mesh_.faces[it->second])) {
                        used_[it->second] = true;
                        part_.push_back(it->second);
                    }
                }
            }
        }
    }

    /// The corners of the part's boundary; none unless that is one line that passes each of its vertices once.
    FaceOutline boundary() const {
        std::unordered_map<std::uint64_t, int> edges;
        for (const std::size_t i : part_) {
            for (int corner = 0; corner < 3; ++corner) {
                ++edges[edge(mesh_.faces[i], corner)];
            }
        }
        std::unordered_map<std::uint32_t, std::uint32_t> next;
        std::uint32_t start = 0;
        for (const std::size_t i : part_) {
            for (int corner = 0; corner < 3; ++corner) {
                const std::uint32_t from = mesh_.faces[i][corner];
                const std::uint32_t to = mesh_.faces[i][(corner + 1) % 3];
                if (edges[directed(from, to)] > 1) {
                    return {};
                }
                if (!edges.contains(directed(to, from)) && !next.emplace(from, to).second) {
                    return {};
                }
                start = next.contains(from) ? from : start;
            }
        }
        std::vector<std::uint32_t> line;
        for (std::uint32_t at = start; line.empty() || at != start; at = next.at(at)) {
            line.push_back(at);
        }
        return line.size() == next.size() ? corners_of(line) : FaceOutline();
    }

    /// The vertices of a line but for those on a straight part of it.
    FaceOutline corners_of(std::span<const std::uint32_t> line) const {
        FaceOutline corners;
        for (std::size_t i = 0; i < line.size(); ++i) {
            const Vec3d& here = mesh_.vertices[line[i]];
            const Vec3d& before = corners.empty() ? mesh_.vertices[line.back()] : corners.back();
            const Vec3d in = glm::normalize(here - before);
            const Vec3d out = glm::normalize(mesh_.vertices[line[(i + 1) % line.size()]] - here);
            if (!(glm::dot(in, out) > 0) || std::abs(glm::dot(glm::cross(in, out), normal_)) > kCoplanar) {
                corners.push_back(here);
            }
        }
        return corners;
    }

    IndexedMesh mesh_;
    std::vector<bool> used_;                                           // or without area
    std::unordered_multimap<std::uint64_t, std::size_t> triangle_at_;  // by directed edge
    std::vector<std::size_t> part_;
    Vec3d normal_{0};  // of the part
    std::vector<FaceOutline> outlines_;
};

}  // namespace

std::optional<std::vector<FaceOutline>> merge_faces(std::span<const Vec3d> vertices,
                                                    std::span<const Triangle> triangles, std::size_t most_corners) {
    return FaceMerger(welded(vertices, triangles, 0)).run(most_corners);
}

}  // namespace shlight
