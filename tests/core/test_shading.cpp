// SPDX-License-Identifier: MIT
//
// Eq. 5 from end to end: light coefficients times material coefficients against cubature of f·cos over the light.
#include "shlight/shading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "quadrature.h"
#include "random_input.h"
#include "shlight/cap.h"
#include "shlight/plain_fit.h"

namespace shlight {
namespace {

using testing::RandomInput;

TEST(Shading, IsADotProduct) {
    RandomInput random(80);
    const int order = 5;
    std::vector<double> light(3 * 25);
    std::vector<double> bsdf(3 * 25);
    std::vector<double> radiance(3);
    for (std::size_t i = 0; i < light.size(); ++i) {
        light[i] = random.uniform(-1, 1);
        bsdf[i] = random.uniform(-1, 1);
    }
    shade<double>(light, bsdf, order, radiance);
    for (std::size_t i = 0; i < 3; ++i) {
        double expected = 0;
        for (std::size_t k = 0; k < 25; ++k) {
            expected += light[25 * i + k] * bsdf[25 * i + k];
        }
        EXPECT_NEAR(radiance[i], expected, 1e-13);
    }
    EXPECT_THROW(shade<double>(light, bsdf, 6, radiance), std::invalid_argument);
    EXPECT_THROW(shade<double>(light, bsdf, 0, radiance), std::invalid_argument);
}

/// A light whose cubature over its kept part is known, with its float coefficients of order 16.
struct Light {
    Vec3d axis;
    double half;
    std::vector<testing::Sample> samples;
    std::vector<float> coefficients;

    explicit Light(RandomInput& random) : half(random.uniform(0.1, 1.2)) {
        axis = random.at_tilt(random.uniform(0, std::numbers::pi / 2 + 0.7 * half));
        samples = testing::clipped_cap_samples(axis, half, 48);
        coefficients.resize(coefficient_count(16));
        const SphericalCap circle = cap_about_axis(axis, half);
        cap_coefficients<float>({&circle, 1}, 16, true, coefficients);
    }

    double solid_angle() const {
        return testing::integral(samples, [](const Vec3d&) { return 1.0; });
    }
};

/// The Cauchy–Schwarz inequality bounds the error by the fit's L2 error times √Ω.
TEST(Shading, GgxUnderClippedCapsErrsLessThanItsResidual) {
    RandomInput random(83);
    for (const double alpha : {0.3, 0.6, 1.0}) {
        for (const Fresnel fresnel : {Fresnel::one, Fresnel::schlick}) {
            const LobeShape shape = GgxShape{alpha, fresnel};
            const auto fit = plain_fit(shape);
            for (int i = 0; i < 30; ++i) {
                const Light light(random);
                const double cos_theta_o = random.uniform(0.2, 1);
                const Vec3d wo(std::sqrt(1 - cos_theta_o * cos_theta_o), 0, cos_theta_o);
                const double expected =
                    testing::integral(light.samples, [&](const Vec3d& wi) { return lobe_value(shape, wi, wo); });
                for (const int order : {2, 4, 8, 16}) {
                    std::vector<float> terms(cosine_count(order));
                    fit->coefficients(cos_theta_o, order, terms.data());
                    const double bound = fit->residual(cos_theta_o, order) * fit->norm(cos_theta_o);
                    EXPECT_NEAR(shade_cosine(light.coefficients.data(), terms.data(), order), expected,
                                1.05 * bound * std::sqrt(light.solid_angle()) + 1e-5)
                        << "alpha " << alpha << ", cosθ_o " << cos_theta_o << ", order " << order;
                }
            }
        }
    }
}

}  // namespace
}  // namespace shlight
