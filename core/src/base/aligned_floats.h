// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace shlight {

/// Floats in whole cache lines.
class AlignedFloats {
  public:
    static constexpr std::size_t kLine = 16;
    /// The next multiple of kLine.
    static constexpr std::size_t padded(std::size_t count) { return (count + kLine - 1) / kLine * kLine; }

    /// Grows to at least this many floats; added ones are 0.
    void grow(std::size_t count) {
        if (count > lines_.size() * kLine) {
            lines_.resize((count + kLine - 1) / kLine);
        }
    }
    float* data() { return lines_.empty() ? nullptr : lines_[0].values.data(); }
    const float* data() const { return lines_.empty() ? nullptr : lines_[0].values.data(); }

  private:
    struct alignas(64) Line {
        std::array<float, kLine> values;
    };
    std::vector<Line> lines_;
};

}  // namespace shlight
