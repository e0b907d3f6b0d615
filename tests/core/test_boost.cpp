// SPDX-License-Identifier: MIT
#include "shlight/boost.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "random_input.h"

namespace shlight {
namespace {

using testing::RandomInput;

Boost random_boost(RandomInput& random) {
    return {random.uniform(-1.5, 1.5), random.log_uniform(1e-3, 1)};
}

TEST(Boost, WithoutOneDirectionsStay) {
    const Boost none;
    EXPECT_EQ(none.horizon_height(), 0);
    const Vec3d d = glm::normalize(Vec3d(0.3, -0.2, 0.5));
    EXPECT_LE(glm::length(none.boosted(d) - d), 1e-15);
    EXPECT_EQ(none.density(d), 1);
}

TEST(Boost, UndoesItself) {
    RandomInput random(1);
    for (int i = 0; i < 10000; ++i) {
        const Boost boost = random_boost(random);
        const Vec3d d = random.direction();
        const Vec3d u = boost.boosted(d);
        EXPECT_LE(std::abs(glm::length(u) - 1), 1e-14);
        // Rounding u by ε moves ω by ε √density, and at the boost's far side that is up to 2/narrowness · ε.
        EXPECT_LE(glm::length(boost.direction(u) - d), 1e-15 * (8 + 4 * std::sqrt(boost.density(u))));
    }
}

TEST(Boost, EnlargesWhatLiesAlongItsAxis) {
    for (const double tilt : {-0.8, 0.0, 1.2}) {
        for (const double narrowness : {0.01, 0.3}) {
            const Boost boost(tilt, narrowness);
            const Vec3d axis(-std::sin(tilt), 0, std::cos(tilt));
            const double scale = narrowness / (2 - narrowness);  // (1 - r) / (1 + r)
            EXPECT_NEAR(boost.density(boost.boosted(axis)) / (scale * scale), 1, 1e-12);
        }
    }
}

TEST(Boost, TakesTheHorizonToItsHeight) {
    RandomInput random(3);
    for (int i = 0; i < 2000; ++i) {
        const Boost boost = random_boost(random);
        const double azimuth = random.uniform(0, 6.28);
        const Vec3d on(std::cos(azimuth), std::sin(azimuth), 0);
        EXPECT_LE(std::abs(boost.boosted(on).z - boost.horizon_height()), 1e-14);
        EXPECT_GT(boost.boosted({0, 0, 1}).z, boost.horizon_height());
        EXPECT_LE(std::abs(boost.boosted({std::sqrt(0.5), 0, std::sqrt(0.5)}).y), 1e-15);
        EXPECT_LE(std::abs(std::hypot(boost.horizon_height(), boost.horizon_sine()) - 1), 1e-14);
    }
}

TEST(Boost, DensityIsADerivative) {
    RandomInput random(4);
    for (int i = 0; i < 2000; ++i) {
        const Boost boost(random.uniform(-1.5, 1.5), random.log_uniform(0.02, 1));
        const Vec3d u = random.direction();
        const Vec3d a = glm::normalize(glm::cross(u, random.direction()));
        const Vec3d b = glm::cross(u, a);
        const double h = 1e-6;
        const auto moved = [&](const Vec3d& step) {
            return (boost.direction(glm::normalize(u + h * step)) - boost.direction(glm::normalize(u - h * step))) /
                   (2 * h);
        };
        // Central differences: h² times a third derivative of at most about density^(3/2) / narrowness, and rounding.
        EXPECT_LE(std::abs(glm::length(glm::cross(moved(a), moved(b))) / boost.density(u) - 1), 1e-6);
    }
}

}  // namespace
}  // namespace shlight
