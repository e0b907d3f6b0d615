// SPDX-License-Identifier: MIT
//
// What records keep of light that has bounced.
#include <cmath>

#include <gtest/gtest.h>

#include "surfaces/light_records.h"

namespace shlight {
namespace {

// Light of one colour leaves the other channels rounding alone, of either sign; the square of such a gradient is 0.
TEST(LightRecords, ALimitedRadiusKeepsRoundedDarknessFinite) {
    for (const float gradient : {0.0F, 1e-37F}) {
        LightRecord record;
        record.reflected.assign(1, {-1e-37F, 0.0F, 1.0F});
        record.gradient.assign(1, {Rgb(gradient), Rgb(gradient), Rgb(gradient)});
        record.limit_radius(2.0, 1.0, 8.0);
        for (const Rgb& axis : record.gradient[0]) {
            for (int channel = 0; channel < 3; ++channel) {
                EXPECT_LE(std::abs(axis[channel]), gradient);
            }
        }
    }
}

}  // namespace
}  // namespace shlight
