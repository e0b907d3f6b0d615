// SPDX-License-Identifier: MIT
//
// The clipped cap in scalars, from which the kernels are made, against the kernels, which have the reference's values.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "clipped_cap.h"
#include "random_input.h"
#include "shlight/cap.h"

namespace shlight {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(CapTranscription, KernelsAreTheTranscription) {
    // Hidden, whole and clipped caps, slivers among them. The transcription's ∫ sin²φ dφ cancels to ε φ_a, which is
    // some ε / σ of the whole cap's L_00.
    testing::RandomInput random(21);
    const int order = 32;
    std::vector<double> coefficients(coefficient_count(order));
    for (int i = 0; i < 3000; ++i) {
        const double half = random.log_uniform(0.01, 1.5);
        const double reach = i % 3 == 0 ? kPi / 2 : half;
        const SphericalCap cap = cap_about_axis(random.at_tilt(kPi / 2 + reach * random.uniform(-1, 1)), half);
        cap_coefficients<double>({&cap, 1}, order, true, coefficients);
        const std::vector<double> transcribed = clipped_cap_coefficients(cap, order);
        double largest = 0;
        for (std::size_t k = 0; k < transcribed.size(); ++k) {
            const double error = std::abs(coefficients[k] - transcribed[k]);
            largest = std::isnan(error) ? 1e300 : std::max(largest, error);
        }
        EXPECT_LE(largest, 1e-12 * std::sqrt(kPi) * (1 - cap.cosine))
            << "half angle " << half << ", tilt " << std::acos(cap.axis.z);
    }
}

}  // namespace
}  // namespace shlight
