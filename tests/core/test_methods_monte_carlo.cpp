// SPDX-License-Identifier: MIT
//
// Random numbers, and coefficients by Monte Carlo against the 113-bit reference, within their own standard error.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mean.h"
#include "method_calls.h"
#include "quad_truth.h"
#include "random_numbers.h"
#include "random_polygon.h"

namespace shlight {
namespace {

using methods::Options;
using methods::RandomNumbers;
using methods::Sampling;
using testing::kFewSigma;
using testing::Mean;
using testing::of_cap;
using testing::of_polygon;
using testing::of_sphere;
using testing::Vertices;
using Kind = truth::CapInput::Kind;

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

using Coefficients = std::function<std::vector<double>(const Options&, std::size_t number)>;

/// Means over many lights of a batch, which differ in their random numbers.
void check_unbiased(const truth::Coefficients& reference, const Coefficients& compute, Options options,
                    const std::string& name) {
    std::vector<Mean> means(reference.high.size());
    options.samples = 64;
    options.seed = 3;
    for (std::size_t number = 0; number < 400; ++number) {
        const std::vector<double> c = compute(options, number);
        for (std::size_t k = 0; k < means.size(); ++k) {
            means[k].add(c[k]);
        }
    }
    for (std::size_t k = 0; k < means.size(); ++k) {
        EXPECT_LE(means[k].deviation(reference.high[k], 1e-9 * reference.high[0]), kFewSigma) << name << " " << k;
        EXPECT_LE(means[k].error(), 0.2 * reference.high[0]) << name << " " << k;
    }
}

TEST(NumericalMethods, MonteCarloCoefficientsAreUnbiased) {
    const Vec3d axis(0.5, -0.3, 0.2);
    const Vertices quad = {{-0.2, 0.5, -0.3}, {0.9, 0.5, -0.2}, {0.9, 0.6, 0.9}, {-0.2, 0.6, 0.8}};
    const Vertices tiny = {{0.5, -0.3, 2e-6}, {0.50001, -0.3, -3e-6}, {0.5, -0.29999, 7e-6}};
    const Vertices concave = {{-0.5, 0.5, 1}, {0, 0.1, 1}, {0.5, 0.5, 1}, {0, -0.5, 1}};
    for (const bool clip : {true, false}) {
        for (const Sampling sampling : {Sampling::solid_angle, Sampling::area}) {
            const Options options = {.sampling = sampling};
            const std::string name = (clip ? "clipped " : "whole ") + std::to_string(static_cast<int>(sampling));
            for (const double half : {1e-5, 0.7}) {
                const double radius = std::sin(half) * glm::length(axis);
                check_unbiased(
                    truth::cap({axis, Kind::angle, half}, 4, clip),
                    [&](const Options& o, std::size_t i) {
                        return of_cap<double>("monte_carlo", axis, half, 4, clip, o, i);
                    },
                    options, "cap " + name);
                check_unbiased(
                    truth::cap({axis, Kind::sphere, radius}, 4, clip),
                    [&](const Options& o, std::size_t i) {
                        return of_sphere<double>("monte_carlo", axis, radius, 4, clip, o, i);
                    },
                    options, "sphere " + name);
            }
            for (const Vertices& vertices : {quad, tiny, concave}) {
                check_unbiased(
                    truth::polygon(vertices, 4, clip),
                    [&](const Options& o, std::size_t i) {
                        return of_polygon<double>("monte_carlo", vertices, 4, clip, o, i);
                    },
                    options, "polygon " + name);
            }
        }
        check_unbiased(
            truth::cap({axis, Kind::angle, 2.5}, 4, clip),
            [&](const Options& o, std::size_t i) { return of_cap<double>("monte_carlo", axis, 2.5, 4, clip, o, i); },
            {}, "beyond a hemisphere");
    }
}

}  // namespace
}  // namespace shlight
