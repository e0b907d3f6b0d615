// SPDX-License-Identifier: MIT
//
// Systematic sampling: a given number of evenly spaced places on a line that consists of parts.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace shlight {

/// Steps along the line, evenly spaced from a random start within the first step, so that there is at least one.
class EvenSteps {
  public:
    /// length: total length of all parts; count: number of steps; random: any number.
    EvenSteps(float length, std::size_t count, std::uint32_t random)
        : step_(length / static_cast<float>(count)), next_(step_ * (static_cast<float>(random >> 9U) * 0x1p-23F)) {}

    /// Advances over the next part, cut into `pieces` equal pieces: visit(piece) for each step in it.
    template <class Visit>
    void within(float length, std::size_t pieces, const Visit& visit) {
        for (; next_ < before_ + length; next_ += step_) {
            const float place = (next_ - before_) / length;
            visit(std::min(static_cast<std::size_t>(place * static_cast<float>(pieces)), pieces - 1));
        }
        before_ += length;
    }

  private:
    float step_;
    float next_;
    float before_ = 0;
};

}  // namespace shlight
