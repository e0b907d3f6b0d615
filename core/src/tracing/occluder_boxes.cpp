// SPDX-License-Identifier: MIT
#include "tracing/occluder_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/ray_rounding.h"

namespace shlight {
namespace {

constexpr std::size_t kLeastTriangles = 16;  // of a cluster
constexpr std::size_t kDeepestTree = 64;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Keeps the t of low … high for which slope · t ≤ room.
void clip(double slope, double room, double& low, double& high) {
    if (slope > 0) {
        high = std::min(high, room / slope);
    } else if (slope < 0) {
        low = std::max(low, room / slope);
    } else if (room < 0) {
        high = -1;
    }
}

/// Minimum of n · v over a box.
double least_along(const Vec3d& n, const Box& box) {
    return glm::dot(n, box.low + box.high) / 2 - glm::dot(glm::abs(n), box.high - box.low) / 2;
}

OccluderCluster cluster_of(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
    OccluderCluster cluster = {Box(), Vec3d(0), kInfinity, -kInfinity};
    const auto corner = [&](const Triangle& triangle, int i) { return Vec3d(vertices[triangle[i]]); };
    for (const Triangle& triangle : triangles) {
        const Vec3d first = corner(triangle, 0);
        cluster.normal += glm::cross(corner(triangle, 1) - first, corner(triangle, 2) - first);
    }
    for (const Triangle& triangle : triangles) {
        for (int i = 0; i < 3; ++i) {
            cluster.box.include(corner(triangle, i));
            const double along = glm::dot(cluster.normal, corner(triangle, i));
            cluster.least = std::min(cluster.least, along);
            cluster.most = std::max(cluster.most, along);
        }
    }
    return cluster;
}

}  // namespace

/// All lines from some points to a light. Their points at the fraction t of the length are in the box `start` + t ·
/// `growth`.
struct OccluderBoxes::Shaft {
    Shaft(std::span<const Vec3f> from, const LightBounds& light) : points(from), target(light) {
        for (const Vec3f& point : points) {
            start.include(Vec3d(point));
        }
        const Vec3d farthest = glm::max(glm::max(glm::abs(start.low), glm::abs(start.high)),
                                        glm::max(glm::abs(light.box.low), glm::abs(light.box.high)));
        const double astray = kRayRounding * (light.is_far ? 1 : largest_component(farthest));
        target.box = {light.box.low - astray, light.box.high + astray};
        growth = light.is_far ? target.box : Box{target.box.low - start.low, target.box.high - start.high};
    }

    std::span<const Vec3f> points;
    LightBounds target;
    Box start;
    Box growth;
};

std::vector<OccluderCluster> occluder_clusters(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
    const std::size_t size =
        std::max(kLeastTriangles, static_cast<std::size_t>(std::sqrt(static_cast<double>(triangles.size()))));
    std::vector<OccluderCluster> clusters;
    for (std::size_t first = 0; first < triangles.size(); first += size) {
        clusters.push_back(cluster_of(vertices, triangles.subspan(first, std::min(size, triangles.size() - first))));
    }
    return clusters;
}

OccluderCluster placed_cluster(const OccluderCluster& cluster, const glm::dmat4& to_world) {
    const glm::dmat3 turn(to_world);
    const Vec3d shift(to_world[3]);
    const Vec3d half = (cluster.box.high - cluster.box.low) / 2.0;
    const glm::dmat3 sizes(glm::abs(turn[0]), glm::abs(turn[1]), glm::abs(turn[2]));
    const Vec3d normal = cluster.normal * glm::inverse(turn);
    const double offset = glm::dot(normal, shift);
    return {Box::around(turn * (cluster.box.low + half) + shift, sizes * half), normal, cluster.least + offset,
            cluster.most + offset};
}

OccluderBoxes::OccluderBoxes(std::vector<OccluderCluster> clusters) : clusters_(std::move(clusters)) {
    if (!clusters_.empty()) {
        build(0, static_cast<std::uint32_t>(clusters_.size()));
    }
}

void OccluderBoxes::build(std::uint32_t begin, std::uint32_t end) {
    const std::size_t node = nodes_.size();
    nodes_.push_back({Box(), 0, begin});
    Box box = Box();
    for (std::uint32_t i = begin; i < end; ++i) {
        box.include(clusters_[i].box.low);
        box.include(clusters_[i].box.high);
    }
    nodes_[node].box = box;
    if (end - begin == 1) {
        return;
    }
    const Vec3d size = box.high - box.low;
    const int axis = size.x >= std::max(size.y, size.z) ? 0 : (size.y >= size.z ? 1 : 2);
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(clusters_.begin() + begin, clusters_.begin() + middle, clusters_.begin() + end,
                     [axis](const OccluderCluster& a, const OccluderCluster& b) {
                         return a.box.low[axis] + a.box.high[axis] < b.box.low[axis] + b.box.high[axis];
                     });
    build(begin, middle);
    nodes_[node].second_child = static_cast<std::uint32_t>(nodes_.size());
    build(middle, end);
}

bool OccluderBoxes::meets(const Shaft& shaft, const Box& box) {
    double low = 0;
    double high = shaft.target.is_far ? kInfinity : 1;
    for (int axis = 0; axis < 3; ++axis) {
        clip(shaft.growth.low[axis], box.high[axis] - shaft.start.low[axis], low, high);
        clip(-shaft.growth.high[axis], shaft.start.high[axis] - box.low[axis], low, high);
    }
    return low <= high;
}

bool OccluderBoxes::lies_beside(const Shaft& shaft, const OccluderCluster& cluster) {
    const auto is_below = [&](const Vec3d& normal, double most) {
        return least_along(normal, shaft.target.box) > (shaft.target.is_far ? 0 : most) &&
               std::all_of(shaft.points.begin(), shaft.points.end(),
                           [&](const Vec3f& point) { return glm::dot(normal, Vec3d(point)) > most; });
    };
    return is_below(cluster.normal, cluster.most) || is_below(-cluster.normal, -cluster.least);
}

bool OccluderBoxes::may_block(std::span<const Vec3f> points, const LightBounds& light) const {
    const Shaft shaft(points, light);
    std::array<std::uint32_t, kDeepestTree> waiting{};
    std::size_t count = nodes_.empty() ? 0 : 1;
    while (count > 0) {
        const std::uint32_t index = waiting[--count];
        const Node& node = nodes_[index];
        if (!meets(shaft, node.box)) {
            continue;
        }
        if (node.second_child != 0) {
            waiting[count++] = node.second_child;
            waiting[count++] = index + 1;
        } else if (!lies_beside(shaft, clusters_[node.cluster])) {
            return true;
        }
    }
    return false;
}

}  // namespace shlight
