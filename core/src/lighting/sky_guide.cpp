// SPDX-License-Identifier: MIT
#include "lighting/sky_guide.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Share of the rays that are drawn as without a guide: so none that sees light counts much more than others do.
constexpr float kUnguided = 0.1F;
/// Visible share of what could light a surface from which on it needs no guide.
constexpr float kOpen = 1.0F / 3;
/// Rays from a place into each block; after the first only where it, or one beside it, was found open.
constexpr std::uint32_t kRaysOfBlock = 2;
/// A block beside an open one is taken to be as open as this: it may be, from another place nearby.
constexpr float kBeside = 0.3F;
/// Cosine to the horizon at which a block may still reach above it.
constexpr float kHorizon = 0.1F;
/// A place as far as the grid's spacing along some axis counts so much beside one that is at the surface.
constexpr double kLeastWeight = 0.01;
/// Steps from the grid's middle.
constexpr double kFarthest = 1e9;

}  // namespace

std::size_t SkyGuide::PlaceHash::operator()(const Place& place) const {
    const auto bits = [](std::int32_t i) { return static_cast<std::uint32_t>(i); };
    return hash(hash(bits(place.x), bits(place.y)), hash(bits(place.z), bits(place.level)));
}

SkyGuide::SkyGuide(const Environment& environment, const SceneRays& rays, std::uint32_t transparent_bounces,
                   const Vec3d& middle, std::function<double(double)> spacing)
    : blocks_(environment),
      rays_(&rays),
      transparent_bounces_(transparent_bounces),
      middle_(middle),
      spacing_(std::move(spacing)) {
    for (std::size_t block = 0; block < kBlocks; ++block) {
        const Vec3f way(blocks_.light(block) > 0 ? blocks_.sample(block, 0.5, 0.5) : Vec3d(0));
        middles_[0][block] = way.x;
        middles_[1][block] = way.y;
        middles_[2][block] = way.z;
    }
    for (std::uint32_t i = 0; i < kWays; ++i) {
        const SobolSequence points(i);
        for (std::uint32_t ray = 0; ray < kBlocks * kRaysOfBlock; ++ray) {
            const std::size_t block = ray / kRaysOfBlock;
            const glm::dvec2 point = points.point(ray);
            ways_[i].emplace_back(blocks_.light(block) > 0 ? blocks_.sample(block, point.x, point.y) : Vec3d(0));
        }
    }
}

double SkyGuide::spacing(const Vec3d& position) const {
    return std::exp2(std::floor(std::log2(spacing_(glm::distance(position, middle_)))));
}

Vec3d SkyGuide::position_of(const Place& place) const {
    return middle_ + Vec3d(place.x, place.y, place.z) * std::ldexp(1.0, place.level);
}

const SkyGuide::Shares& SkyGuide::openness(const Place& place) const {
    if (const auto known = open_.find(place); known != open_.end()) {
        return known->second;
    }
    const Vec3f origin(position_of(place));
    const std::vector<Vec3f>& ways = ways_[PlaceHash()(place) % kWays];
    Shares open{};
    Shares wide{};
    for (std::size_t round = 0; round < kRaysOfBlock; ++round) {
        std::vector<Ray> rays;
        std::vector<std::size_t> blocks;
        for (std::size_t block = 0; block < kBlocks; ++block) {
            if (blocks_.light(block) > 0 && (round == 0 || wide[block] > 0)) {
                rays.push_back({origin, 0, ways[block * kRaysOfBlock + round]});
                blocks.push_back(block);
            }
        }
        std::vector<Rgb> visible(rays.size());
        rays_->visibility(rays, transparent_bounces_, visible);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            open[blocks[i]] += glm::dot(visible[i], Rgb(1.0F / (3 * kRaysOfBlock)));
        }
        wide = widened(open);
    }
    return open_.emplace(place, wide).first->second;
}

SkyGuide::Shares SkyGuide::widened(const Shares& open) {
    Shares wide = open;
    for (std::size_t block = 0; block < kBlocks; ++block) {
        const std::size_t row = block / kBlockColumns;
        for (std::size_t r = row - std::min<std::size_t>(row, 1); r <= std::min(row + 1, kBlockRows - 1); ++r) {
            for (const std::size_t beside : {kBlockColumns - 1, std::size_t{0}, std::size_t{1}}) {
                const std::size_t column = (block + beside) % kBlockColumns;
                wide[block] = std::max(wide[block], kBeside * open[r * kBlockColumns + column]);
            }
        }
    }
    return wide;
}

float SkyGuide::add_near(const Vec3d& origin, Shares& sum) const {
    const double step = spacing(origin);
    const Vec3d low = glm::floor((origin - middle_) / step);
    if (!(glm::length(low) < kFarthest)) {
        return 0;
    }
    std::array<Place, 8> places{};
    std::array<Ray, 8> ways;
    std::array<Rgb, 8> seen;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Vec3d place = low + Vec3d(i & 1U, i >> 1U & 1U, i >> 2U);
        places[i] = {static_cast<std::int32_t>(place.x), static_cast<std::int32_t>(place.y),
                     static_cast<std::int32_t>(place.z), std::ilogb(step)};
        ways[i] = {Vec3f(origin), 0, Vec3f(position_of(places[i]) - origin), 1};
    }
    rays_->visibility(ways, 0, seen);
    float weights = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (seen[i] != Rgb(0)) {
            const Shares& open = openness(places[i]);
            const Vec3d near = 1.0 - glm::abs(position_of(places[i]) - origin) / step;
            const auto weight = static_cast<float>(std::max(near.x * near.y * near.z, kLeastWeight));
            for (std::size_t block = 0; block < kBlocks; ++block) {
                sum[block] += weight * open[block];
            }
            weights += weight;
        }
    }
    return weights;
}

bool SkyGuide::find(const ShadingFrame& frame, const Vec3d& origin, GuidedDensity& density) const {
    density.factor.fill(0);
    const float weights = add_near(origin, density.factor);
    const Vec3f normal(frame.z);
    float all = 0;
    float open = 0;
    for (std::size_t block = 0; block < kBlocks; ++block) {
        const float cosine =
            middles_[0][block] * normal.x + middles_[1][block] * normal.y + middles_[2][block] * normal.z;
        const float above = std::max(cosine + kHorizon, 0.0F);
        density.factor[block] *= above;
        all += blocks_.light(block) * above;
        open += blocks_.light(block) * density.factor[block];
    }
    if (!(open > 0 && open < kOpen * weights * all)) {
        return false;
    }
    float rows = 0;
    for (std::size_t row = 0; row < kBlockRows; ++row) {
        float sum = 0;
        for (std::size_t block = row * kBlockColumns; block < (row + 1) * kBlockColumns; ++block) {
            density.factor[block] = (1 - kUnguided) / open * density.factor[block] + kUnguided;
            sum += blocks_.light(block) * density.factor[block];
            density.up_to[block] = sum;
        }
        rows += sum;
        density.rows[row] = rows;
    }
    return true;
}

SkyGuide::Sample SkyGuide::sample(const GuidedDensity& density, float u, float v) const {
    // Returns the part of a line in which a place in 0 … 1 lies, and makes the place that within it.
    const auto part = [](std::span<const float> up_to, float& place) {
        // The last parts may be empty.
        const float at = std::min(place * up_to.back(), std::nextafter(up_to.back(), 0.0F));
        const auto found = std::upper_bound(up_to.begin(), up_to.end(), at);
        const float before = found == up_to.begin() ? 0.0F : *(found - 1);
        place = std::clamp((at - before) / (*found - before), 0.0F, 1.0F);
        return static_cast<std::size_t>(found - up_to.begin());
    };
    const std::size_t first = part(density.rows, v) * kBlockColumns;
    const std::size_t block = first + part(std::span(density.up_to).subspan(first, kBlockColumns), u);
    return {blocks_.sample(block, u, v), density.factor[block]};
}

}  // namespace shlight
