// SPDX-License-Identifier: MIT
//
// Rays against triangles, curves and spheres: what the renderer needs of Embree, without its headers.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "shlight/parallel.h"
#include "shlight/types.h"

namespace shlight {

using Triangle = glm::vec<3, std::uint32_t, glm::defaultp>;

/// Kinds of rays by what has sent them, as bits; a ray may be of several. Shadow rays are those that ask what lies
/// between a point and a light: each shadow set of surfaces has a bit for those that it blocks.
enum RayKind : std::uint32_t {
    kCameraRay = 1,
    kDiffuseRay = 2,
    kGlossyRay = 4,
    kTransmissionRay = 8,
    kShadowRay = ~std::uint32_t{15},
    kAllRays = ~std::uint32_t{0}
};

/// Shadow sets have numbers below this.
inline constexpr std::uint32_t kShadowSets = 28;
/// The shadow rays that surfaces of a set block.
constexpr std::uint32_t shadow_rays_of(std::uint32_t set) {
    return std::uint32_t{16} << set;
}

/// The points origin + t · direction with t_min ≤ t ≤ t_max.
struct Ray {
    Vec3f origin{0};
    float t_min = 0;
    Vec3f direction{0};
    float t_max = std::numeric_limits<float>::infinity();
    std::uint32_t kinds = kShadowRay;  ///< it meets what is seen by any of them

    bool empty() const { return t_max < t_min; }
};

/// A surface's parts. Curves are Catmull-Rom splines of points and radii.
enum class SurfaceForm : std::uint8_t {
    triangles,
    ribbons,  ///< flat curves, turned to each ray
    tubes,    ///< curves of round cross-section
    spheres,
};

/// A ray's first hit. On a triangle the point is (1 - u - v) · corner 0 + u · corner 1 + v · corner 2; on a curve u
/// runs from 0 to 1 between two of its points, and across a ribbon v from -1 to 1.
struct RayHit {
    static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

    std::uint32_t instance = kNone;  ///< index of the TracedInstance, kNone for a miss
    std::uint32_t triangle = 0;      ///< or the vertex where a curve's segment begins, or at the middle of a sphere
    float u = 0, v = 0;
    float distance = 0;  ///< t of the ray
    Vec3f normal{0};     ///< of a tube or a sphere, in the instance's frame, outwards, of any length

    bool missed() const { return instance == kNone; }
};

/// Curves or spheres; they are met from outside alone, as in Cycles.
struct RoundParts {
    SurfaceForm form;
    std::vector<glm::vec4> points;        ///< with radii. Each curve has its first and its last point twice.
    std::vector<std::uint32_t> segments;  ///< of curves: for each the point before the one where it begins
    std::vector<std::uint32_t> numbers;   ///< RayHit::triangle of each segment or sphere
    std::uint32_t subdivisions;           ///< pieces of a ribbon's segment, 1 … 16
};

/// Triangles, curves or spheres in one frame and Embree's tree over them. Immutable; any number of tracers may share
/// it.
class SurfaceTree {
  public:
    /// Copies what it needs. Builds with the threads of the tbb::task_arena that it is called in.
    /// numbers: RayHit::triangle of each triangle, or none: its index.
    /// Throws std::runtime_error when Embree fails, std::bad_alloc when memory runs out, RenderCancelled once it is to
    /// end.
    SurfaceTree(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                std::vector<std::uint32_t> numbers = {}, const Stopped& stopped = {});
    /// The same of other parts.
    explicit SurfaceTree(RoundParts parts, const Stopped& stopped = {});
    ~SurfaceTree();
    SurfaceTree(const SurfaceTree&) = delete;
    SurfaceTree& operator=(const SurfaceTree&) = delete;

  private:
    friend class RayTracer;
    class Impl;
    std::unique_ptr<const Impl> impl_;
};

/// Surfaces placed in the world.
struct TracedInstance {
    std::shared_ptr<const SurfaceTree> tree;  ///< null: nothing
    glm::dmat4 to_world;                      ///< affine
    std::uint32_t seen_by = kAllRays;         ///< the RayKind of rays that meet it
};

/// Immutable; any number of threads may trace at a time.
class RayTracer {
  public:
    /// Builds a tree over the instances. Throws what SurfaceTree throws.
    explicit RayTracer(std::vector<TracedInstance> instances, const Stopped& stopped = {});
    ~RayTracer();
    RayTracer(const RayTracer&) = delete;
    RayTracer& operator=(const RayTracer&) = delete;

    /// The first hit of each ray; spans of the same length.
    void intersect(std::span<const Ray> rays, std::span<RayHit> hits) const;
    /// Whether anything lies on each ray (1) or not (0); spans of the same length.
    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const;
    /// Adds the parts that shadow rays may meet and whose boxes are within a radius of a point: their instances and
    /// triangles alone.
    void near(const Vec3f& point, float radius, std::vector<RayHit>& found) const;

  private:
    class Impl;
    std::unique_ptr<const Impl> impl_;
};

}  // namespace shlight
