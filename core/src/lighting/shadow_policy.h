// SPDX-License-Identifier: MIT
//
// How many shadow rays a light gets, of whatever kind it is.
//
// Lights get rays in proportion to what they add to a pixel, and those that would get less than one share some. How
// many rays go is settled before any is drawn, and all of them count: a decision by the rays themselves would bias the
// picture.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace shlight {

/// A source without extent that adds less than this to a pixel is sampled at fewer of its hits: what its visibility
/// is then off by is no more than that of a light of this share, and of many such lights the errors go both ways. The
/// variance of their sum, over its square, is below this share / (4 · hits), however many they are: each adds its own
/// share times this share / hits, times p (1 - p) ≤ 1/4 if it is seen from p of the pixel.
inline constexpr float kDimShare = 0.01F;

/// Hits at which to sample a source: 1 … hits. own: brightness of the light over the pixel; all: that of all lights.
inline std::size_t hits_to_sample(float own, float all, std::size_t hits) {
    const float least = kDimShare * all;
    return own < least ? static_cast<std::size_t>(std::ceil(own / least * static_cast<float>(hits))) : hits;
}

/// Which of its camera rays each pixel of a group takes: those numbered first … first + count - 1.
struct SampleRange {
    std::uint32_t first, count;
    std::uint32_t shadow_rays;  ///< per camera ray and light, at most
    std::uint32_t first_point;  ///< on the light; count · shadow_rays of them are theirs
    bool shares_rays = true;    ///< false: every light has one of its own, at least
};

/// If a pixel's light came from n equal lights, each would get this many times the n-th part of the shadow rays.
inline constexpr float kRaysByShare = 4;

/// The lit hits begin … end - 1 of a pixel.
struct LitRange {
    std::size_t begin, end;
    std::size_t size() const { return end - begin; }
};

/// Hits whose rays are traced together: so few that all about them stays in the cache.
inline constexpr std::size_t kHitsAtOnce = 128;

}  // namespace shlight
