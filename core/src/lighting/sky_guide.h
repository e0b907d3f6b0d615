// SPDX-License-Identifier: MIT
//
// Where the environment is open: rays from places in a grid over the world find through which blocks of directions it
// is seen, as through the window of a room. Shadow rays from surfaces near there are drawn towards these.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <tbb/concurrent_unordered_map.h>

#include "base/shading_frame.h"
#include "environment/sky_blocks.h"
#include "shlight/environment.h"
#include "shlight/scene_rays.h"

namespace shlight {

/// How densely rays from a surface are drawn.
struct GuidedDensity {
    std::array<float, kBlocks> factor;   ///< in each block, of the density by which the environment draws directions
    std::array<float, kBlocks> up_to;    ///< the share of rays of the blocks of a row up to each one, it included
    std::array<float, kBlockRows> rows;  ///< likewise, of all rows
};

/// Any number of threads may use it: what it finds depends on the surface alone.
class SkyGuide {
  public:
    /// A direction of the world.
    struct Sample {
        Vec3d direction;
        float factor;  ///< see GuidedDensity
    };

    /// spacing: of the grid, at a distance from its middle. All must outlive this.
    SkyGuide(const Environment& environment, const SceneRays& rays, std::uint32_t transparent_bounces,
             const Vec3d& middle, std::function<double(double)> spacing);

    /// False where much of the environment is open, or nothing of it is known to be. origin: off the surface.
    bool find(const ShadingFrame& frame, const Vec3d& origin, GuidedDensity& density) const;
    Sample sample(const GuidedDensity& density, float u, float v) const;
    /// direction: of the world.
    float factor(const GuidedDensity& density, const Vec3d& direction) const {
        return density.factor[blocks_.block_of(direction)];
    }
    /// The grid's spacing at a surface: a power of two.
    double spacing(const Vec3d& position) const;

  private:
    struct Place {
        std::int32_t x, y, z;  // steps from the middle
        std::int32_t level;    // of two's power
        bool operator==(const Place&) const = default;
    };
    struct PlaceHash {
        std::size_t operator()(const Place& place) const;
    };
    /// Sets of directions, of which neighbouring places mostly have different ones: to draw them anew for each place
    /// takes longer than to trace them.
    static constexpr std::size_t kWays = 16;
    /// by block
    using Shares = std::array<float, kBlocks>;

    Vec3d position_of(const Place& place) const;
    const Shares& openness(const Place& place) const;
    /// Adds up the openness of the places around that can be seen, by their nearness. Returns the sum of the weights.
    float add_near(const Vec3d& origin, Shares& sum) const;
    static Shares widened(const Shares& open);

    SkyBlocks blocks_;
    const SceneRays* rays_;
    std::uint32_t transparent_bounces_;
    Vec3d middle_;
    std::function<double(double)> spacing_;
    std::array<Shares, 3> middles_{};             // of blocks: directions, along each axis of the world
    std::array<std::vector<Vec3f>, kWays> ways_;  // directions of rays into blocks
    mutable tbb::concurrent_unordered_map<Place, Shares, PlaceHash> open_;
};

}  // namespace shlight
