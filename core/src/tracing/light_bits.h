// SPDX-License-Identifier: MIT
//
// What shadow rays have met on their way to lights: one bit for all lights whose numbers are alike modulo 32.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shlight/types.h"

namespace shlight {

struct LightBits {
    std::uint32_t seen = 0;    ///< lights that some ray sees
    std::uint32_t hidden = 0;  ///< lights of which something takes light from some ray

    static constexpr std::uint32_t kAll = ~std::uint32_t{0};
    static std::uint32_t bit(std::size_t light) { return std::uint32_t{1} << (light % 32); }

    /// visible: what a ray to the light sees of it.
    void add(std::size_t light, const Rgb& visible) {
        seen |= visible != Rgb(0) ? bit(light) : 0;
        hidden |= visible != Rgb(1) ? bit(light) : 0;
    }
    LightBits& operator|=(const LightBits& other) {
        seen |= other.seen;
        hidden |= other.hidden;
        return *this;
    }
    /// Lights that some rays see and others do not.
    std::uint32_t partly_hidden() const { return seen & hidden; }
};

}  // namespace shlight
