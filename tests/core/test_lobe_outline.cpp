// SPDX-License-Identifier: MIT
#include "lobes/contour_integral.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lobe_truth.h"
#include "random_input.h"

namespace shlight {
namespace {

using testing::lobe_over_cap;
using testing::RandomInput;
using testing::view_direction;

OutlineArc whole_circle(const Vec3d& axis, double half_angle) {
    const Vec3d side = glm::normalize(glm::cross(axis, Vec3d(0.3, 0.5, 0.8)));
    const Vec3d from = std::cos(half_angle) * axis + std::sin(half_angle) * side;
    return {{axis, std::cos(half_angle), std::sin(half_angle)}, from, from, true};
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
        const OutlineArc arc = whole_circle(axis, half);
        const double truth = lobe_over_cap(shape, cosine, axis, half, 40);
        const OutlineIntegral fine = outline_integral(shape, cosine, {&arc, 1}, 1e-8);
        EXPECT_LE(std::abs(fine.value - truth), 1e-5) << "alpha " << alpha << " cos " << cosine << " half " << half;
        for (const double tolerance : {1e-2, 1e-3}) {
            const OutlineIntegral integral = outline_integral(shape, cosine, {&arc, 1}, tolerance);
            // The radial rule, which has no estimate of its own, may add as much again.
            EXPECT_LE(std::abs(integral.value - truth), 2 * tolerance + 1e-5);
            EXPECT_LT(integral.points, 9000);
        }
    }
    EXPECT_GT(compared, 30);
}

TEST(ContourIntegral, TheWholeHorizonGivesTheAlbedo) {
    const OutlineArc horizon{{{0, 0, 1}, 0, 1}, {1, 0, 0}, {1, 0, 0}, true};
    for (const double alpha : {0.01, 0.2, 1.0}) {
        for (const double cosine : {0.02, 0.3, 1.0}) {
            const double truth = lobe_over_cap({alpha}, cosine, {0, 0, 1}, std::numbers::pi / 2);
            EXPECT_NEAR(outline_integral(GgxShape{alpha}, cosine, {&horizon, 1}, 1e-7).value, truth, 1e-5)
                << alpha << " " << cosine;
        }
    }
}

TEST(ContourIntegral, AVeryNarrowLobeIsAMirror) {
    for (const double cosine : {0.1, 0.6, 0.99}) {
        const Vec3d v = view_direction(cosine);
        const Vec3d mirror(-v.x, 0, v.z);
        const double half = std::min(0.3, std::asin(mirror.z) / 2);
        const OutlineArc around = whole_circle(mirror, half);
        // Tails of the bell: (α / ½ half cosθ_o)² and less.
        EXPECT_NEAR(outline_integral(GgxShape{1e-6}, cosine, {&around, 1}, 1e-6).value, 1, 1e-5);
        const OutlineArc beside = whole_circle(glm::normalize(mirror + Vec3d(0, 2.5 * half, 0)), half);
        EXPECT_NEAR(outline_integral(GgxShape{1e-6}, cosine, {&beside, 1}, 1e-6).value, 0, 1e-5);
    }
}

TEST(ContourIntegral, ALobeWithoutAPeakIsAFactorOfTheEvenBell) {
    // A cap above the horizon gets sin²σ cosθ from Lambert's surface, whatever the view.
    for (const double tilt : {0.0, 0.5, 0.9}) {
        for (const double half : {0.05, 0.6}) {
            const OutlineArc around = whole_circle({std::sin(tilt), 0, std::cos(tilt)}, half);
            const double truth = std::pow(std::sin(half), 2) * std::cos(tilt);
            for (const double cosine : {0.1, 0.6, 1.0}) {
                const double value = outline_integral(LambertShape{}, cosine, {&around, 1}, 1e-7).value;
                EXPECT_LE(std::abs(value - truth), 1e-6) << tilt << " " << half << " " << cosine;
            }
        }
    }
}

}  // namespace
}  // namespace shlight
