// SPDX-License-Identifier: MIT
//
// What the batch kernels make of lobes and views, against the functions of one lobe and one view.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lobe_truth.h"
#include "lobes/material_views.h"
#include "lobes/view_kernel.h"
#include "random_input.h"
#include "shading/cubature_kernel.h"
#include "shlight/warped_fit.h"

namespace shlight {
namespace {

using testing::RandomInput;
using testing::view_direction;

constexpr std::uint32_t kOnly = 0;

TEST(LobeKernels, ValuesInLanesAreTheLobes) {
    // The rule of one point over a tiny cap is f·cos at its middle times the cap's area.
    RandomInput random(41);
    double largest = 0;
    for (int i = 0; i < 3000; ++i) {
        const GgxShape shape{random.log_uniform(1e-4, 1), static_cast<Fresnel>(i % 3), random.uniform(1.1, 2.5)};
        const Vec3d view = view_direction(random.uniform(0.05, 1));
        const Vec3d noise = random.direction();
        const double spread = random.chance(0.5) ? 4 * shape.alpha : 1.0;
        Vec3d axis = glm::normalize(Vec3d(-view.x, 0, view.z) + spread * noise);
        axis.z = std::abs(axis.z);
        if (axis.z < 1e-3) {
            continue;
        }
        const double sine = 1e-6 * shape.alpha;
        const double cosine = std::sqrt(1 - sine * sine);
        float value = 0;
        integrate_caps(shape, {&axis.x, &axis.y, &axis.z, &cosine, &sine}, {&kOnly, 1}, {&view.x, &view.z, true},
                       {&kOnly, 1}, 1, {&value, 1});
        const double area = 2 * std::numbers::pi * sine * sine / (1 + cosine);
        const double expected = lobe_value(shape, axis, view);
        // Fresnel's rise is a fifth power, or as good as one, of a difference that floats know to 1e-7.
        const double edge = 1 - glm::length(axis + view) / 2;
        const double rounding = shape.fresnel == Fresnel::one ? 2e-6 : 2e-6 + 2e-6 / edge;
        const double error = std::abs(static_cast<double>(value) / area - expected) / expected;
        largest = std::max(largest, error / rounding);
    }
    EXPECT_LE(largest, 1);
}

}  // namespace
}  // namespace shlight
