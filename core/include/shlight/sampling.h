// SPDX-License-Identifier: MIT
//
// Evenly distributed points in the unit square, the same on every run, on every machine and for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

namespace shlight {

/// A pseudo-random hash of two numbers.
std::uint32_t hash(std::uint32_t a, std::uint32_t b);

/// The third and fourth coordinate of the Sobol sequence (Joe & Kuo 2008), Owen-scrambled by `seed`: they go on where
/// nested_points() and hammersley() end, so that all four fill their cube evenly.
glm::dvec2 sobol_beyond(std::uint32_t index, std::uint32_t seed);

/// The two-dimensional Sobol sequence, Owen-scrambled by `seed` (Burley 2020, "Practical hash-based Owen scrambling")
/// and in another order for each seed: each block of 2^k points, aligned at a multiple of 2^k, has one point in each
/// elementary interval of area 2^-k. Coordinates lie strictly between 0 and 1. Sequences of different seeds are
/// unrelated even where both are taken in the order of their indices.
class SobolSequence {
  public:
    explicit SobolSequence(std::uint32_t seed);
    glm::dvec2 point(std::uint32_t index) const;
    /// Seeds for kernels that compute the points in lanes.
    std::uint32_t x_seed() const { return x_; }
    std::uint32_t y_seed() const { return y_; }
    std::uint32_t order_seed() const { return order_; }

  private:
    std::uint32_t x_, y_, order_;
};

/// Point i < count of a rank-1 lattice, which fills the unit square evenly for any count, shifted by `seed`.
glm::dvec2 lattice_point(std::size_t i, std::size_t count, std::uint32_t seed);

/// Nested sets of points: a shorter set is the beginning of a longer one. The first 2^k points, and each aligned block
/// of 2^k, have one point in each elementary interval of area 2^-k. Each odd point is its even predecessor reflected at
/// the centre, so that any even number of points is centred. All pixels use the same points: edges get even steps and
/// no noise.
///
/// They are linearly scrambled Sobol points, which keeps their intervals: where the first bit of a coordinate is set,
/// all lower bits are flipped. Indices that differ in bit 0 only give coordinates that differ in all bits.
std::vector<glm::dvec2> nested_points(std::uint32_t count);

/// A Hammersley set whose coordinates are evenly spaced for any count: each of `count` equal strips along either axis
/// has one point at its middle. All pixels use the same points: edges get even steps and no noise.
std::vector<glm::dvec2> hammersley(std::uint32_t count);

}  // namespace shlight
