// SPDX-License-Identifier: MIT
//
// Values of lobes in lanes, and their integral along the outline of a light.
#include "lobes/boundary_integral.h"
#include "regions/boundary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "lighting/cubature_kernel.h"
#include "lobe_truth.h"
#include "random_input.h"

namespace shlight {
namespace {

using testing::lobe_over_cap;
using testing::RandomInput;
using testing::view_direction;

TEST(LobeKernels, ValuesInLanesAreTheLobes) {
    // The rule of one point over a tiny cap is f·cos at its middle times the cap's area.
    RandomInput random(41);
    const std::uint32_t only = 0;
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
        const auto width = static_cast<float>(shape.alpha);
        integrate_caps(shape, &width, {&axis.x, &axis.y, &axis.z, &cosine, &sine}, {&only, 1}, {&view.x, &view.z, true},
                       {&only, 1}, 1, {&value, 1});
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

Arc<double> circle_about(const Vec3d& axis, double half_angle) {
    return whole_circle(cap_about_axis(axis, half_angle));
}

Vec3d near_mirror(RandomInput& random, double cos_theta_o, double spread) {
    const Vec3d v = view_direction(cos_theta_o);
    return glm::normalize(Vec3d(-v.x, 0, v.z) + spread * random.uniform(0, 1) * random.direction());
}

TEST(ContourIntegral, WholeCapsMatchDenseCubature) {
    RandomInput random(11);
    int compared = 0;
    for (int i = 0; i < 120; ++i) {
        const double alpha = random.log_uniform(0.003, 1);
        const double cosine = random.uniform(0.05, 1);
        const GgxShape shape{alpha, i % 2 == 0 ? Fresnel::one : Fresnel::schlick};
        const double half = random.log_uniform(0.01, 1.4);
        const Vec3d axis = near_mirror(random, cosine, half + 2 * alpha);
        if (axis.z < std::sin(half)) {
            continue;
        }
        ++compared;
        const Arc<double> arc = circle_about(axis, half);
        const double truth = lobe_over_cap(shape, cosine, axis, half, 40);
        const BoundaryIntegral fine = boundary_integral(shape, cosine, {&arc, 1}, 1e-8);
        EXPECT_LE(std::abs(fine.value - truth), 1e-5) << "alpha " << alpha << " cos " << cosine << " half " << half;
        for (const double tolerance : {1e-2, 1e-3}) {
            const BoundaryIntegral integral = boundary_integral(shape, cosine, {&arc, 1}, tolerance);
            // The radial rule, which has no estimate of its own, may add as much again.
            EXPECT_LE(std::abs(integral.value - truth), 2 * tolerance + 1e-5);
            EXPECT_LT(integral.points, 9000);
        }
        // Floats and fewer points along a radius do where the tolerance is a small share of the albedo.
        const double close = 2e-6;
        EXPECT_LE(std::abs(boundary_integral(shape, cosine, {&arc, 1}, close).value - fine.value), close);
    }
    EXPECT_GT(compared, 30);
}

TEST(ContourIntegral, AVeryNarrowLobeIsAMirror) {
    for (const double cosine : {0.1, 0.6, 0.99}) {
        const Vec3d v = view_direction(cosine);
        const Vec3d mirror(-v.x, 0, v.z);
        const double half = std::min(0.3, std::asin(mirror.z) / 2);
        const Arc<double> around = circle_about(mirror, half);
        // Tails of the lobe: (α / ½ half cosθ_o)² and less.
        EXPECT_NEAR(boundary_integral(GgxShape{1e-6}, cosine, {&around, 1}, 1e-6).value, 1, 1e-5);
        const Arc<double> beside = circle_about(glm::normalize(mirror + Vec3d(0, 2.5 * half, 0)), half);
        EXPECT_NEAR(boundary_integral(GgxShape{1e-6}, cosine, {&beside, 1}, 1e-6).value, 0, 1e-5);
    }
}

TEST(ContourIntegral, ALobeWithoutAPeakIsAFactorOfTheEvenBell) {
    // A cap above the horizon gets sin²σ cosθ from Lambert's surface, whatever the view.
    for (const double tilt : {0.0, 0.5, 0.9}) {
        for (const double half : {0.05, 0.6}) {
            const Arc<double> around = circle_about({std::sin(tilt), 0, std::cos(tilt)}, half);
            const double truth = std::pow(std::sin(half), 2) * std::cos(tilt);
            for (const double cosine : {0.1, 0.6, 1.0}) {
                const double value = boundary_integral(LambertShape{}, cosine, {&around, 1}, 1e-7).value;
                EXPECT_LE(std::abs(value - truth), 1e-6) << tilt << " " << half << " " << cosine;
            }
        }
    }
}

}  // namespace
}  // namespace shlight
