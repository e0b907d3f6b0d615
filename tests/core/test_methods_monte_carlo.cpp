// SPDX-License-Identifier: MIT
//
// Coefficients by Monte Carlo against the 113-bit reference, within their own standard error.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mean.h"
#include "method_calls.h"
#include "quad_truth.h"
#include "random_polygon.h"

namespace shlight {
namespace {

using methods::Options;
using methods::Sampling;
using testing::kFewSigma;
using testing::Mean;
using testing::of_cap;
using testing::of_polygon;
using testing::of_sphere;
using testing::Vertices;
using Kind = truth::CapInput::Kind;

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
    const double half = 0.7;
    const double radius = std::sin(half) * glm::length(axis);
    const Vertices quad = {{-0.2, 0.5, -0.3}, {0.9, 0.5, -0.2}, {0.9, 0.6, 0.9}, {-0.2, 0.6, 0.8}};
    const Vertices concave = {{-0.5, 0.5, 1}, {0, 0.1, 1}, {0.5, 0.5, 1}, {0, -0.5, 1}};
    for (const bool clip : {true, false}) {
        for (const Sampling sampling : {Sampling::solid_angle, Sampling::area}) {
            const Options options = {.sampling = sampling};
            const std::string name = (clip ? "clipped " : "whole ") + std::to_string(static_cast<int>(sampling));
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
            for (const Vertices& vertices : {quad, concave}) {
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
