// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "caps/cap_shading.h"
#include "shlight/warp.h"

namespace shlight {

/// Circles as the kernels read them. Keeps its memory.
class CircleBatch {
  public:
    void resize(std::size_t count) {
        for (std::vector<double>& member : members_) {
            member.resize(count);
        }
    }
    void set(std::size_t i, const Circle& circle) {
        members_[0][i] = circle.axis.x;
        members_[1][i] = circle.axis.y;
        members_[2][i] = circle.axis.z;
        members_[3][i] = circle.cosine;
        members_[4][i] = circle.sine;
    }
    CircleOutput output() {
        return {members_[0].data(), members_[1].data(), members_[2].data(), members_[3].data(), members_[4].data()};
    }
    CircleArrays arrays() const {
        return {members_[0].data(), members_[1].data(), members_[2].data(), members_[3].data(), members_[4].data()};
    }

  private:
    std::array<std::vector<double>, 5> members_;
};

}  // namespace shlight
