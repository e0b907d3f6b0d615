// SPDX-License-Identifier: MIT
//
// The random numbers of Monte Carlo methods.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "random_numbers.h"

namespace shlight {
namespace {

using methods::RandomNumbers;

TEST(NumericalMethods, RandomNumbersAreUniformAndIndependent) {
    constexpr int kCount = 200000;
    const double bound = 5 / std::sqrt(static_cast<double>(kCount));
    for (const std::uint32_t seed : {0U, 1U, 0xFFFFFFFFU}) {
        RandomNumbers random(seed);
        RandomNumbers neighbour(seed + 1);
        double before = random.next() - 0.5;
        double mean = 0;
        double square = 0;
        double serial = 0;
        double cross = 0;
        for (int i = 0; i < kCount; ++i) {
            const double x = random.next() - 0.5;
            mean += x / kCount;
            square += 12 * x * x / kCount;
            serial += 12 * x * before / kCount;
            cross += 12 * x * (neighbour.next() - 0.5) / kCount;
            before = x;
            ASSERT_TRUE(x > -0.5 && x < 0.5);
        }
        EXPECT_LE(std::abs(mean) * std::sqrt(12.0), bound) << seed;
        EXPECT_LE(std::abs(square - 1), 0.9 * bound) << seed;
        EXPECT_LE(std::abs(serial), bound) << seed;
        EXPECT_LE(std::abs(cross), bound) << seed;
    }
}

}  // namespace
}  // namespace shlight
