// SPDX-License-Identifier: MIT
//
// Systematic sampling: so many places on a line of parts, drawn in proportion to the parts' lengths.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace shlight {

/// Evenly spaced steps along the line, from a random start that is less than a step: so there is one at least.
class EvenSteps {
  public:
    /// length: of all parts together; random: any number.
    EvenSteps(float length, std::size_t count, std::uint32_t random)
        : step_(length / static_cast<float>(count)), next_(step_ * (static_cast<float>(random >> 9U) * 0x1p-23F)) {}

    /// The next part of the line: visit(piece) for each step in it, of so many equal pieces 0 … pieces - 1.
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
