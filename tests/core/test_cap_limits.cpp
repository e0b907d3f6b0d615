// SPDX-License-Identifier: MIT
//
// Caps where formulas break: nothing kept, everything kept, contact from below, and absurd sizes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "random_input.h"
#include "shlight/cap.h"

namespace shlight {
namespace {

using testing::RandomInput;

constexpr double kPi = std::numbers::pi;

template <class T>
std::vector<T> sphere(const Vec3<T>& center, T radius, int order, bool clip = true) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    sphere_coefficients<T>(std::span(&center, 1), std::span(&radius, 1), order, clip, result);
    return result;
}

template <class T>
std::vector<T> cap(const Vec3<T>& axis, T half_angle, int order, bool clip = true) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    cap_coefficients<T>(std::span(&axis, 1), std::span(&half_angle, 1), order, clip, result);
    return result;
}

template <class T>
bool all_finite(const std::vector<T>& values) {
    return std::all_of(values.begin(), values.end(), [](T value) { return std::isfinite(value); });
}

template <class T>
T largest(const std::vector<T>& values) {
    T result = 0;
    for (const T value : values) {
        result = std::max(result, std::abs(value));
    }
    return result;
}

template <class T>
class CapLimits : public ::testing::Test {};
using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(CapLimits, Precisions);

TYPED_TEST(CapLimits, HiddenLightsGiveZeros) {
    using T = TypeParam;
    EXPECT_EQ(largest(sphere<T>({1, 0, -2}, 1, 64)), 0);
    EXPECT_EQ(largest(sphere<T>({0, 0, -1}, T(0.5), 64)), 0);
    EXPECT_EQ(largest(sphere<T>({0, 0, -1}, 1, 64)), 0);  // contact from straight below
    EXPECT_EQ(largest(sphere<T>({3, 4, -1}, 1, 64)), 0);  // tangent from below
    EXPECT_EQ(largest(cap<T>({0, 0, -1}, T(1.5), 64)), 0);
}

TYPED_TEST(CapLimits, HalfAnglePiIsEverything) {
    using T = TypeParam;
    const double tolerance = 40 * static_cast<double>(std::numeric_limits<T>::epsilon());
    const T pi = std::numbers::pi_v<T>;
    const std::vector<T> all = cap<T>({T(0.3), T(-0.2), T(0.1)}, pi, 16, false);
    EXPECT_NEAR(all[0], std::sqrt(4 * kPi), tolerance);
    EXPECT_LE(largest(std::vector<T>(all.begin() + 1, all.end())), tolerance);
    const std::vector<T> upper = cap<T>({T(0.3), T(-0.2), T(0.1)}, pi, 16, true);
    const std::vector<T> contact = sphere<T>({0, 0, 1}, 1, 16);
    for (std::size_t i = 0; i < upper.size(); ++i) {
        EXPECT_NEAR(upper[i], contact[i], tolerance);
    }
}

/// Nothing may overflow, underflow to NaN or divide by zero, whatever the sizes and however the light grazes.
TYPED_TEST(CapLimits, EverythingIsFinite) {
    using T = TypeParam;
    RandomInput random(30);
    const double huge = sizeof(T) == 8 ? 1e150 : 1e18;
    for (int i = 0; i < 4000; ++i) {
        const double distance = random.log_uniform(1 / huge, huge);
        Vec3d direction = random.direction();
        for (int k = 0; k < 3; ++k) {
            if (random.chance(0.2)) {
                direction[k] = random.chance(0.5) ? 0 : random.uniform(-1, 1) * std::pow(10, random.uniform(-30, 0));
            }
        }
        if (direction == Vec3d(0)) {
            continue;
        }
        const Vec3<T> center(distance * direction);
        const auto length = static_cast<T>(glm::length(Vec3d(center)));
        const double share = i % 4 == 0 ? std::abs(direction.z) / glm::length(direction) : random.log_uniform(1e-30, 1);
        const T radius = std::min(static_cast<T>(share) * length, std::nextafter(length, T(0)));
        if (radius > 0) {
            EXPECT_TRUE(all_finite(sphere<T>(center, radius, 33, i % 5 != 0)))
                << center.x << ' ' << center.y << ' ' << center.z << " radius " << radius;
        }
        const auto half_angle = static_cast<T>(random.log_uniform(1e-30, kPi));
        EXPECT_TRUE(all_finite(cap<T>(center, half_angle, 33, i % 5 != 0)))
            << center.x << ' ' << center.y << ' ' << center.z << " half angle " << half_angle;
    }
}

TYPED_TEST(CapLimits, ManyLightsGiveTheSameAsEachAlone) {
    using T = TypeParam;
    RandomInput random(31);
    std::vector<Vec3<T>> centers;
    std::vector<T> radii;
    for (int i = 0; i < 37; ++i) {
        centers.push_back(Vec3<T>(random.direction()));
        radii.push_back(static_cast<T>(random.log_uniform(1e-4, 0.99)));
    }
    for (const int order : {1, 2, 3, 8, 13}) {
        const auto count = static_cast<std::size_t>(coefficient_count(order));
        std::vector<T> together(centers.size() * count);
        sphere_coefficients<T>(centers, radii, order, true, together);
        for (std::size_t i = 0; i < centers.size(); ++i) {
            const std::vector<T> alone = sphere<T>(centers[i], radii[i], order);
            EXPECT_TRUE(
                std::equal(alone.begin(), alone.end(), together.begin() + static_cast<std::ptrdiff_t>(i * count)));
        }
    }
}

TYPED_TEST(CapLimits, SizesOfArraysAgree) {
    using T = TypeParam;
    const std::vector<Vec3<T>> centers(2, Vec3<T>(0, 0, 1));
    const std::vector<T> radii(2, T(0.5));
    std::vector<T> values(2 * 16);
    EXPECT_THROW(sphere_coefficients<T>(centers, std::span(radii).first(1), 4, true, std::span(values)),
                 std::invalid_argument);
    EXPECT_THROW(sphere_coefficients<T>(centers, radii, 4, true, std::span(values).first(31)), std::invalid_argument);
}

}  // namespace
}  // namespace shlight
