// SPDX-License-Identifier: MIT
//
// Rays against triangles: what the renderer needs of Embree, without its headers.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "shlight/parallel.h"
#include "shlight/types.h"

namespace shlight {

using Triangle = glm::vec<3, std::uint32_t, glm::defaultp>;

/// The points origin + t · direction with t_min ≤ t ≤ t_max.
struct Ray {
    Vec3f origin{0};
    float t_min = 0;
    Vec3f direction{0};
    float t_max = std::numeric_limits<float>::infinity();

    bool empty() const { return t_max < t_min; }
};

/// A ray's first hit. The point is (1 - u - v) · corner 0 + u · corner 1 + v · corner 2.
struct RayHit {
    static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

    std::uint32_t instance = kNone;  ///< index of the TracedInstance, kNone for a miss
    std::uint32_t triangle = 0;
    float u = 0, v = 0;
    float distance = 0;  ///< t of the ray

    bool missed() const { return instance == kNone; }
};

/// Triangles in one frame and Embree's tree over them. Immutable; any number of tracers may share it.
class TriangleTree {
  public:
    /// Copies what it needs. Builds with the threads of the tbb::task_arena that it is called in.
    /// numbers: RayHit::triangle of each triangle, or none: its index.
    /// Throws std::runtime_error when Embree fails, std::bad_alloc when memory runs out, RenderCancelled once it is to
    /// end.
    TriangleTree(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                 std::vector<std::uint32_t> numbers = {}, const Stopped& stopped = {});
    ~TriangleTree();
    TriangleTree(const TriangleTree&) = delete;
    TriangleTree& operator=(const TriangleTree&) = delete;

  private:
    friend class RayTracer;
    class Impl;
    std::unique_ptr<const Impl> impl_;
};

/// Triangles placed in the world.
struct TracedInstance {
    std::shared_ptr<const TriangleTree> tree;  ///< null: nothing
    glm::dmat4 to_world;                       ///< affine
};

/// Immutable; any number of threads may trace at a time.
class RayTracer {
  public:
    /// Builds a tree over the instances. Throws what TriangleTree throws.
    explicit RayTracer(std::vector<TracedInstance> instances, const Stopped& stopped = {});
    ~RayTracer();
    RayTracer(const RayTracer&) = delete;
    RayTracer& operator=(const RayTracer&) = delete;

    /// The first hit of each ray; spans of the same length.
    void intersect(std::span<const Ray> rays, std::span<RayHit> hits) const;
    /// Whether anything lies on each ray (1) or not (0); spans of the same length.
    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const;

  private:
    class Impl;
    std::unique_ptr<const Impl> impl_;
};

}  // namespace shlight
