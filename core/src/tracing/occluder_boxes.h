// SPDX-License-Identifier: MIT
//
// Boxes around the surfaces of a scene. They prove that nothing is between many points and a light, which saves all
// their shadow rays. The tree is separate from Embree's, which is not accessible.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "shlight/scene_rays.h"
#include "shlight/types.h"

namespace shlight {

/// At first empty.
struct Box {
    static Box around(const Vec3d& center, const Vec3d& half) { return {center - half, center + half}; }
    void include(const Vec3d& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }

    Vec3d low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

/// Bounds of a light's places or directions.
struct LightBounds {
    Box box;
    bool is_far;  ///< infinitely: the box holds unit vectors towards it
};

/// Consecutive triangles of a mesh.
struct OccluderCluster {
    Box box;
    Vec3d normal;        ///< mean of theirs, of any length
    double least, most;  ///< of its dot product with any place on them
};

/// All triangles of a mesh, in clusters of about as many triangles as there are clusters.
std::vector<OccluderCluster> occluder_clusters(std::span<const Vec3f> vertices, std::span<const Triangle> triangles);
/// to_world: affine.
OccluderCluster placed_cluster(const OccluderCluster& cluster, const glm::dmat4& to_world);

/// Immutable; any number of threads may read it.
class OccluderBoxes {
  public:
    /// clusters: in the world.
    explicit OccluderBoxes(std::vector<OccluderCluster> clusters);

    /// Returns false if no surface is between any of the points, at least one, and any point of the light.
    bool may_block(std::span<const Vec3f> points, const LightBounds& light) const;

  private:
    /// Its first child is the next node.
    struct Node {
        Box box;
        std::uint32_t second_child;  // 0: there are none, but a cluster
        std::uint32_t cluster;
    };
    struct Shaft;

    void build(std::uint32_t begin, std::uint32_t end);
    static bool meets(const Shaft& shaft, const Box& box);
    /// Whether the cluster's plane separates it from all lines to the light.
    static bool lies_beside(const Shaft& shaft, const OccluderCluster& cluster);

    std::vector<OccluderCluster> clusters_;
    std::vector<Node> nodes_;
};

}  // namespace shlight
