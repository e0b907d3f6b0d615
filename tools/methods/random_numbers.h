// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include <glm/vec2.hpp>

#include "shlight/sampling.h"

namespace shlight::methods {

/// Independent uniform random numbers for plain Monte Carlo, neither stratified nor of low discrepancy. Number i of a
/// seed is a hash of both (shlight::hash, twice); a seed has 2^32 numbers.
class RandomNumbers {
  public:
    explicit RandomNumbers(std::uint32_t seed) : first_(seed), second_(hash(seed, 0x5EEDU)) {}

    /// Strictly between 0 and 1, in steps of 2^-32.
    double next() { return (hash(second_, hash(first_, count_++)) + 0.5) * 0x1p-32; }
    glm::dvec2 point() {
        const double x = next();
        return {x, next()};
    }

  private:
    std::uint32_t first_, second_;
    std::uint32_t count_ = 0;
};

}  // namespace shlight::methods
