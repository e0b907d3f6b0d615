// SPDX-License-Identifier: MIT
#include "surfaces/world_lattice.h"

#include <cmath>
#include <span>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "surfaces/placed_meshes.h"

namespace shlight {
namespace {

/// The lattice's corner ÷ the edge of a cell: surfaces that lie at a round number would lie between cells.
constexpr double kShift = 0.381966;
/// Edges of a cell by which a surface may be away from its middle: a side of the world's turns by 55° at most.
constexpr double kDeep = 2;
/// Surfaces along a cell's column that are looked at.
constexpr int kMostLayers = 4;
/// Edges of a cell above two surfaces at which they see each other.
constexpr double kAbove = 0.1;

/// Bits of a number with two zeros between each and the next.
std::uint64_t spread_bits(std::int64_t number) {
    std::uint64_t bits = static_cast<std::uint64_t>(number) & 0x7FFFF;
    bits = (bits | bits << 32) & 0x1F00000000FFFF;
    bits = (bits | bits << 16) & 0x1F0000FF0000FF;
    bits = (bits | bits << 8) & 0x100F00F00F00F00F;
    bits = (bits | bits << 4) & 0x10C30C30C30C30C3;
    return (bits | bits << 2) & 0x1249249249249249;
}

/// An axis of the world, and the end of it that a direction is close to.
struct Side {
    int axis;
    bool is_back;

    explicit Side(const Vec3d& direction) {
        const Vec3d size = glm::abs(direction);
        axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        is_back = direction[axis] < 0;
    }
    std::uint32_t number() const { return static_cast<std::uint32_t>(2 * axis + (is_back ? 1 : 0)); }
};

}  // namespace

std::size_t WorldCellHash::operator()(const WorldCell& cell) const {
    // The finalizer of SplitMix64.
    std::uint64_t x = cell.place + cell.kind * 0x9E3779B97F4A7C15U;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
    return x ^ (x >> 31);
}

int WorldLattice::level(double size) {
    return std::ilogb(size);
}

glm::i64vec3 WorldLattice::corner(const SurfacePoint& point, int level) const {
    return glm::i64vec3(glm::floor((point.position + scene_->origin()) * std::ldexp(1.0, -level) + kShift));
}

WorldCell WorldLattice::cell(const SurfacePoint& point, int level, std::uint32_t view) const {
    const glm::i64vec3 own = corner(point, level);
    const std::uint64_t place = static_cast<std::uint64_t>(level) << 57 | spread_bits(own.x) | spread_bits(own.y) << 1 |
                                spread_bits(own.z) << 2;
    return {place, (Side(point.geometric_normal).number() << 4 | view) << 24 | (point.material & 0xFFFFFF)};
}

Vec3d WorldLattice::middle(const SurfacePoint& point, int level) const {
    return (Vec3d(corner(point, level)) + (0.5 - kShift)) * std::ldexp(1.0, level) - scene_->origin();
}

std::optional<SurfacePoint> WorldLattice::surface(const SurfacePoint& point, int level, const glm::dvec2& place) const {
    const double edge = std::ldexp(1.0, level);
    const Side side(point.geometric_normal);
    Vec3d start = middle(point, level);
    start[(side.axis + 1) % 3] += (place.x - 0.5) * edge;
    start[(side.axis + 2) % 3] += (place.y - 0.5) * edge;
    start[side.axis] += (side.is_back ? -kDeep : kDeep) * edge;
    Ray ray = {Vec3f(start), 0, Vec3f(0), static_cast<float>(2 * kDeep * edge), kAllRays};
    ray.direction[side.axis] = side.is_back ? 1.0F : -1.0F;
    std::optional<SurfacePoint> found;
    RayHit hit;
    for (int layer = 0; layer < kMostLayers; ++layer, ray = behind(ray, hit)) {
        scene_->rays().intersect({&ray, 1}, {&hit, 1});
        if (hit.missed()) {
            break;
        }
        const SurfacePoint met = scene_->placed().surface(hit, ray.direction);
        const bool is_alike = cell(met, level).kind == cell(point, level).kind;
        if (is_alike &&
            (!found || glm::distance(met.position, point.position) < glm::distance(found->position, point.position))) {
            found = met;
        }
    }
    if (found) {
        const Vec3d from = point.off_surface() + kAbove * edge * point.geometric_normal;
        const Vec3d to = found->off_surface() + kAbove * edge * found->geometric_normal;
        const Ray between = {Vec3f(from), 0, Vec3f(to - from), 1, kAllRays};
        scene_->rays().intersect({&between, 1}, {&hit, 1});
    }
    return found && hit.missed() ? found : std::nullopt;
}

}  // namespace shlight
