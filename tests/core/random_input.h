// SPDX-License-Identifier: MIT
//
// Seeded random inputs: the same on every machine, as std's distributions are not.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "shlight/types.h"

namespace shlight::testing {

class RandomInput {
  public:
    explicit RandomInput(std::uint64_t seed) : engine_(seed) {}

    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
    }
    double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
    int integer(int low, int high) {  // both included
        return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
    }
    bool chance(double probability) { return uniform(0, 1) < probability; }
    Vec3d direction() {
        const double z = uniform(-1, 1);
        return at_tilt(std::acos(z));
    }
    /// A unit vector with this angle to z and a random azimuth.
    Vec3d at_tilt(double tilt) {
        const double azimuth = uniform(-std::numbers::pi, std::numbers::pi);
        return {std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)};
    }

  private:
    std::mt19937_64 engine_;
};

/// The axis of a cap that the horizon cuts.
inline Vec3d across_horizon(RandomInput& random, double half_angle) {
    return random.at_tilt(std::numbers::pi / 2 +
                          random.uniform(-0.95, 0.95) * std::min(half_angle, std::numbers::pi - half_angle));
}

/// The nearest float. Through memory, because GCC 12 takes double → float → double for nothing when it vectorizes it.
inline double as_float(double x) {
    volatile auto rounded = static_cast<float>(x);
    return rounded;
}
inline Vec3d as_float(const Vec3d& v) {
    return {as_float(v.x), as_float(v.y), as_float(v.z)};
}

}  // namespace shlight::testing
