// SPDX-License-Identifier: MIT
//
// The views of the lights of a batch.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "base/checks.h"

namespace shlight {

/// The views of some lights.
struct LightViews {
    std::span<const double> cos_theta_o, azimuth;

    bool shared() const { return cos_theta_o.size() == 1 && azimuth.size() <= 1; }
    double cosine_of(std::size_t light) const { return cos_theta_o[cos_theta_o.size() == 1 ? 0 : light]; }
    double azimuth_of(std::size_t light) const {
        return azimuth.empty() ? 0.0 : azimuth[azimuth.size() == 1 ? 0 : light];
    }
};

/// Throws std::invalid_argument naming the argument.
inline void check_views(const LightViews& views, std::size_t count) {
    const auto [cos_theta_o, azimuth] = views;
    if (azimuth.size() > 1) {
        check_size("azimuth", azimuth.size(), count);
    }
    if (!std::all_of(azimuth.begin(), azimuth.end(), [](double angle) { return std::isfinite(angle); })) {
        reject("azimuth must be finite");
    }
    if (cos_theta_o.size() != 1) {
        check_size("cos_theta_o", cos_theta_o.size(), count);
    }
    // A number instead of a bool lets the loop run in lanes.
    int invalid = 0;
    for (const double c : cos_theta_o) {
        invalid |= c >= 0 && c <= 1 ? 0 : 1;
    }
    if (invalid != 0) {
        reject("cos_theta_o must lie in [0, 1]");
    }
}

}  // namespace shlight
