// SPDX-License-Identifier: MIT
//
// Lobes of tables, one direction at a time.
#include <cmath>

#include "shlight/lobe_shape.h"
#include "shlight/lobe_table.h"

namespace shlight {

bool TableShape::is_glossy() const {
    return table->is_glossy();
}

double TableShape::width() const {
    return table->width();
}

double TableShape::value(const Vec3d& wi, const Vec3d& wo) const {
    return table->reflected(wi, wo, azimuth, channel);
}

double TableShape::albedo(double cos_theta_o) const {
    return table->albedo(cos_theta_o, azimuth, channel);
}

SampledShape TableShape::sampled() const {
    if (!is_glossy()) {
        return LambertShape{};
    }
    // Between the width of the peak and 1: f·cos ÷ density is bounded by about 1 ÷ width at the peak, and beside it.
    return GgxShape{std::sqrt(width())};
}

}  // namespace shlight
