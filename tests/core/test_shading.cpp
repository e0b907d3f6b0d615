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
#include "shlight/polygon.h"

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

TEST(Shading, CosineTermsMeetTheirCoefficients) {
    RandomInput random(81);
    std::vector<double> light(coefficient_count(9));
    std::vector<double> terms(cosine_count(6));
    for (double& value : light) {
        value = random.uniform(-1, 1);
    }
    double expected = 0;
    for (int l = 0; l < 6; ++l) {
        for (int m = 0; m <= l; ++m) {
            terms[cosine_index(l, m)] = random.uniform(-1, 1);
            expected += terms[cosine_index(l, m)] * light[coefficient_index(l, m)];
        }
    }
    EXPECT_NEAR(shade_cosine(light.data(), terms.data(), 6), expected, 1e-13);
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
        const Circle circle = circle_about_axis(axis, half);
        circle_coefficients<float>({&circle, 1}, 16, true, coefficients);
    }

    double solid_angle() const {
        return testing::integral(samples, [](const Vec3d&) { return 1.0; });
    }
};

TEST(Shading, LambertUnderClippedCapsIsExact) {
    RandomInput random(82);
    const auto lambert = plain_fit(LambertShape{});
    for (int i = 0; i < 200; ++i) {
        const Light light(random);
        const double expected =
            testing::integral(light.samples, [](const Vec3d& wi) { return wi.z / std::numbers::pi; });
        for (const int order : {2, 8, 16}) {
            std::vector<float> terms(cosine_count(order));
            lambert->coefficients(0.5, order, terms.data());
            EXPECT_NEAR(shade_cosine(light.coefficients.data(), terms.data(), order), expected, 2e-6)
                << "half angle " << light.half << ", z of the axis " << light.axis.z << ", order " << order;
        }
    }
}

/// By Cauchy and Schwarz the error is at most the fit's L2 error times √Ω.
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

/// Irradiance of a polygon by Lambert's formula, ½ Σ_edges angle · (unit normal)_z, known since 1760.
TEST(Shading, LambertUnderPolygonsIsLambertsFormula) {
    RandomInput random(84);
    const auto lambert = plain_fit(LambertShape{});
    for (int i = 0; i < 200; ++i) {
        const Vec3d center = random.log_uniform(0.1, 10) * random.at_tilt(random.uniform(0, 1));
        std::vector<Vec3f> vertices;
        for (int k = 0; k < 3; ++k) {
            Vec3d vertex = center + 0.7 * glm::length(center) * random.direction();
            vertex.z = std::abs(vertex.z);
            vertices.emplace_back(vertex);
        }
        double expected = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d a = glm::normalize(Vec3d(vertices[k]));
            const Vec3d b = glm::normalize(Vec3d(vertices[(k + 1) % 3]));
            const Vec3d normal = glm::cross(a, b);
            const double angle = std::atan2(glm::length(normal), glm::dot(a, b));
            expected += angle * normal.z / glm::length(normal) / (2 * std::numbers::pi);
        }
        std::vector<float> coefficients(coefficient_count(4));
        polygon_coefficients<float>(vertices, 4, true, coefficients.data());
        std::vector<float> terms(cosine_count(2));
        lambert->coefficients(0.5, 2, terms.data());
        EXPECT_NEAR(shade_cosine(coefficients.data(), terms.data(), 2), std::abs(expected), 2e-6);
    }
}

}  // namespace
}  // namespace shlight
