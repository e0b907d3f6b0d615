// SPDX-License-Identifier: MIT
//
// Points in the unit square that fill it evenly, and the same on every run, machine and number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

namespace shlight {

/// Mixes two numbers into one that looks random.
std::uint32_t hash(std::uint32_t a, std::uint32_t b);

/// Point `index` of the two-dimensional Sobol sequence, Owen-scrambled by `seed` (Burley 2020, "Practical hash-based
/// Owen scrambling"): each block of 2^k points, aligned at a multiple of 2^k, has one point in each elementary interval
/// of area 2^-k. Coordinates lie strictly between 0 and 1.
glm::dvec2 sobol(std::uint32_t index, std::uint32_t seed);

/// The third and fourth coordinate of the Sobol sequence (Joe & Kuo 2008), Owen-scrambled likewise: they go on where
/// nested_points() and hammersley() end, so that all four fill their cube evenly.
glm::dvec2 sobol_beyond(std::uint32_t index, std::uint32_t seed);

/// The points of sobol() with another index in place of each, another order for each seed: aligned blocks of 2^k
/// indices stay together. Sequences of different seeds are unrelated even where both are taken in the order of their
/// indices.
class SobolSequence {
  public:
    explicit SobolSequence(std::uint32_t seed);
    glm::dvec2 point(std::uint32_t index) const;
    /// What lanes need to draw points themselves.
    std::uint32_t x_seed() const { return x_; }
    std::uint32_t y_seed() const { return y_; }
    std::uint32_t order_seed() const { return order_; }

  private:
    std::uint32_t x_, y_, order_;
};

/// Point i < count of a lattice of rank 1, which fills the unit square evenly for any count, moved around by `seed`.
glm::dvec2 lattice_point(std::size_t i, std::size_t count, std::uint32_t seed);

/// Points that can be continued: the first of a longer set are those of a shorter one. The first 2^k, and each aligned
/// block of 2^k, have one point in each elementary interval of area 2^-k; each odd point is its even predecessor
/// reflected at the centre, so that any even number of them is centred. The same for every pixel: edges get even steps
/// and no noise.
///
/// Linearly scrambled Sobol points, which keeps their intervals: where the first bit of a coordinate is set, all the
/// bits below are flipped. Indices that differ in bit 0 differ in both first bits only, and so in all bits now.
std::vector<glm::dvec2> nested_points(std::uint32_t count);

/// A Hammersley set, its coordinates spread evenly over 0 … 1 for any count: each of the `count` equal strips of either
/// axis has one point at its middle. The same for every pixel: edges get even steps and no noise.
std::vector<glm::dvec2> hammersley(std::uint32_t count);

}  // namespace shlight
