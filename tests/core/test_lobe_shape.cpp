// SPDX-License-Identifier: MIT
//
// Lobe shapes against the formulas as their papers print them: Walter et al. 2007, Heitz 2014, Fresnel by Snell's law.
#include "shlight/lobe_shape.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "quadrature.h"
#include "random_input.h"

namespace shlight {
namespace {

using testing::RandomInput;

constexpr double kPi = std::numbers::pi;
constexpr std::array kAlphas = {0.01, 0.1, 0.3, 0.6, 1.0};

double distribution(double alpha, double theta) {
    const double tan2 = std::pow(std::tan(theta), 2);
    return alpha * alpha / (kPi * std::pow(std::cos(theta), 4) * std::pow(alpha * alpha + tan2, 2));
}

double smith_lambda(double alpha, const Vec3d& v) {
    const double tan_theta = std::tan(std::acos(v.z));
    return (-1 + std::sqrt(1 + alpha * alpha * tan_theta * tan_theta)) / 2;
}

double fresnel(double ior, double cos_i) {
    const double cos_t = std::sqrt(1 - (1 - cos_i * cos_i) / (ior * ior));
    const double s = (cos_i - ior * cos_t) / (cos_i + ior * cos_t);
    const double p = (ior * cos_i - cos_t) / (ior * cos_i + cos_t);
    return (s * s + p * p) / 2;
}

double textbook(const GgxShape& shape, const Vec3d& wi, const Vec3d& wo) {
    const Vec3d h = glm::normalize(wi + wo);
    const double d = distribution(shape.alpha, std::acos(std::min(h.z, 1.0)));
    const double g2 = 1 / (1 + smith_lambda(shape.alpha, wi) + smith_lambda(shape.alpha, wo));
    const double cos_d = glm::dot(wi, h);
    double f = 1;
    if (shape.fresnel == Fresnel::schlick) {
        f = std::pow(1 - cos_d, 5);
    } else if (shape.fresnel == Fresnel::dielectric) {
        const double head_on = std::pow((shape.ior - 1) / (shape.ior + 1), 2);
        f = (fresnel(shape.ior, cos_d) - head_on) / (1 - head_on);
    }
    return f * d * g2 / (4 * wi.z * wo.z) * wi.z;
}

Vec3d upper(RandomInput& random) {
    return random.at_tilt(random.uniform(0.01, 1.55));
}

TEST(LobeShape, GgxIsTheTextbooks) {
    RandomInput random(50);
    for (int i = 0; i < 3000; ++i) {
        const GgxShape shape{kAlphas[static_cast<std::size_t>(i % 5)], static_cast<Fresnel>(i % 3),
                             random.uniform(1.05, 2.5)};
        const Vec3d wi = upper(random);
        const Vec3d wo = upper(random);
        const double expected = textbook(shape, wi, wo);
        EXPECT_NEAR(lobe_value(shape, wi, wo), expected, 1e-9 * expected + 1e-13)
            << "alpha " << shape.alpha << ", fresnel " << static_cast<int>(shape.fresnel);
    }
}

/// f(wi, wo) = f(wo, wi); what is computed is f·cos.
TEST(LobeShape, GgxIsReciprocal) {
    RandomInput random(51);
    for (int i = 0; i < 1000; ++i) {
        const GgxShape shape{kAlphas[static_cast<std::size_t>(i % 5)], static_cast<Fresnel>(i % 3), 1.5};
        const Vec3d wi = upper(random);
        const Vec3d wo = upper(random);
        const double forward = lobe_value(shape, wi, wo) / wi.z;
        EXPECT_NEAR(lobe_value(shape, wo, wi) / wo.z, forward, 1e-12 * forward + 1e-14);
    }
}

/// ∫ D cosθ_h dω_h = 1, with D taken back out of f·cos at ω_i = ω_o = h, in t = tanθ_h.
TEST(LobeShape, DistributionIsNormalized) {
    for (const double alpha : kAlphas) {
        double sum = 0;
        for (const testing::Node& s : testing::gauss_nodes(200, 0, 1)) {
            const double tangent = alpha * s.x / (1 - s.x);
            const double theta = std::atan(tangent);
            const Vec3d h(std::sin(theta), 0, std::cos(theta));
            const double d = lobe_value(GgxShape{alpha}, h, h) * 4 * h.z * (1 + 2 * smith_lambda(alpha, h));
            const double jacobian = alpha / std::pow(1 - s.x, 2) / (1 + tangent * tangent);
            sum += s.weight * 2 * kPi * d * h.z * std::sin(theta) * jacobian;
        }
        EXPECT_NEAR(sum, 1, 1e-10) << "alpha " << alpha;
    }
}

TEST(LobeShape, FresnelFactorsRunFromZeroToOne) {
    const Vec3d up(0, 0, 1);
    const double angle = kPi / 2 - 1e-7;
    const Vec3d left(std::sin(angle), 0, std::cos(angle));
    const Vec3d right(-left.x, 0, left.z);
    for (const Fresnel kind : {Fresnel::schlick, Fresnel::dielectric}) {
        EXPECT_NEAR(lobe_value(GgxShape{0.5, kind}, up, up), 0, 1e-15);
        const double share = lobe_value(GgxShape{0.5, kind}, left, right) / lobe_value(GgxShape{0.5}, left, right);
        EXPECT_NEAR(share, 1, 1e-5);
    }
}

TEST(LobeShape, NothingIsReflectedBelowTheHorizon) {
    const Vec3d above(0.6, 0, 0.8);
    const Vec3d below(0.6, 0, -0.8);
    const Vec3d along(1, 0, 0);
    for (const LobeShape& shape : {LobeShape(LambertShape{}), LobeShape(GgxShape{0.3})}) {
        EXPECT_EQ(lobe_value(shape, below, above), 0);
        EXPECT_EQ(lobe_value(shape, above, below), 0);
        EXPECT_EQ(lobe_value(shape, below, below), 0);
        EXPECT_EQ(lobe_value(shape, along, above), 0);
    }
}

TEST(LobeShape, NoneReflectsMoreThanItGets) {
    const auto samples = testing::mirrored_hemisphere(160, 160);
    for (const double alpha : {0.1, 0.3, 0.6, 1.0}) {
        for (const double cos_theta_o : {0.05, 0.3, 0.7, 1.0}) {
            const Vec3d wo(std::sqrt(1 - cos_theta_o * cos_theta_o), 0, cos_theta_o);
            const double albedo =
                testing::integral(samples, [&](const Vec3d& wi) { return lobe_value(GgxShape{alpha}, wi, wo); });
            EXPECT_LE(albedo, 1 + 1e-4);
            EXPECT_GE(albedo, 0.3);
        }
    }
    const double lambert =
        testing::integral(samples, [](const Vec3d& wi) { return lobe_value(LambertShape{}, wi, Vec3d(0, 0, 1)); });
    EXPECT_NEAR(lambert, 1, 1e-12);
}

}  // namespace
}  // namespace shlight
