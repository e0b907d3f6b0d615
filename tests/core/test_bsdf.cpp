// SPDX-License-Identifier: MIT
//
// Lobe shapes against the formulas as their papers print them (Walter et al. 2007, Heitz 2014, Fresnel by Snell's law),
// and materials made of them.
#include "shlight/bsdf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "quadrature.h"
#include "random_input.h"
#include "shlight/lobe_shape.h"

namespace shlight {
namespace {

using testing::RandomInput;

double distribution(double alpha, double theta) {
    const double tan2 = std::pow(std::tan(theta), 2);
    return alpha * alpha / (std::numbers::pi * std::pow(std::cos(theta), 4) * std::pow(alpha * alpha + tan2, 2));
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
        f = std::max(0.0, (fresnel(shape.ior, cos_d) - head_on) / (1 - head_on));
    }
    return f * d * g2 / (4 * wi.z * wo.z) * wi.z;
}

Vec3d upper(RandomInput& random) {
    return random.at_tilt(random.uniform(0.02, 1.5));
}

TEST(LobeShape, GgxIsTheTextbooks) {
    RandomInput random(50);
    for (int i = 0; i < 3000; ++i) {
        const GgxShape shape{std::array{0.01, 0.1, 0.3, 0.6, 1.0}.at(static_cast<std::size_t>(i % 5)),
                             static_cast<Fresnel>(i % 3), random.log_uniform(1.05, 50)};
        const Vec3d wi = random.at_tilt(random.uniform(0.01, 1.55));
        const Vec3d wo = random.at_tilt(random.uniform(0.01, 1.55));
        const double expected = textbook(shape, wi, wo);
        EXPECT_NEAR(lobe_value(shape, wi, wo), expected, 1e-9 * expected + 1e-13)
            << "alpha " << shape.alpha << ", fresnel " << static_cast<int>(shape.fresnel);
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

void expect_near(const Rgb& computed, const Vec3d& expected, double tolerance) {
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(computed[i], expected[i], tolerance * std::max(1.0, expected[i])) << "channel " << i;
    }
}

TEST(Bsdf, LambertIsAlbedoOverPi) {
    RandomInput random(70);
    const Bsdf bsdf = Bsdf::lambert({0.2F, 0.5F, 0.9F});
    for (int i = 0; i < 20; ++i) {
        const Vec3d wi = upper(random);
        expect_near(bsdf.evaluate(wi, upper(random)), Vec3d(0.2, 0.5, 0.9) * wi.z / std::numbers::pi, 1e-6);
    }
    expect_near(bsdf.albedo(0.4), {0.2, 0.5, 0.9}, 1e-6);
}

TEST(Bsdf, DefaultIsBlack) {
    EXPECT_EQ(Bsdf().evaluate({0, 0, 1}, {0, 0, 1}), Rgb(0));
    EXPECT_EQ(Bsdf().albedo(1), Rgb(0));
}

/// F = f0 + (1 - f0) s multiplies what GGX without Fresnel reflects.
TEST(Bsdf, GgxMixesFresnelByColor) {
    RandomInput random(71);
    const Vec3d f0(0.04, 0.5, 1);
    for (const float ior : {0.0F, 1.5F}) {
        const Bsdf bsdf = Bsdf::ggx(0.6F, Rgb(f0), ior);
        const double alpha = static_cast<double>(0.6F) * static_cast<double>(0.6F);
        const GgxShape edge{alpha, ior > 0 ? Fresnel::dielectric : Fresnel::schlick, 1.5};
        for (int i = 0; i < 100; ++i) {
            const Vec3d wi = upper(random);
            const Vec3d wo = upper(random);
            const double plain = lobe_value(GgxShape{alpha}, wi, wo);
            const double grazing = lobe_value(edge, wi, wo);
            expect_near(bsdf.evaluate(wi, wo), f0 * plain + (Vec3d(1) - f0) * grazing, 1e-6);
        }
    }
}

/// Light reflected by the top does not reach the base, which may itself be layered.
TEST(Bsdf, LayersShareTheLight) {
    RandomInput random(73);
    const Bsdf top = Bsdf::ggx(0.4F, {0.04F, 0.05F, 0.03F}, 1.5F);
    const Bsdf matte = Bsdf::lambert({0.8F, 0.4F, 0.2F});
    for (const Bsdf& base : {matte, Bsdf::layer(Bsdf::ggx(0.7F, Rgb(0.2F)), matte)}) {
        const Bsdf layered = Bsdf::layer(top, base);
        for (int i = 0; i < 100; ++i) {
            const Vec3d wi = upper(random);
            const Vec3d wo = random.at_tilt(random.uniform(0, 1.45));
            const Rgb reflected = top.albedo(wo.z);
            const double passed = 1 - std::max({reflected.x, reflected.y, reflected.z});
            const Vec3d expected = Vec3d(top.evaluate(wi, wo)) + passed * Vec3d(base.evaluate(wi, wo));
            expect_near(layered.evaluate(wi, wo), expected, 2e-4);
        }
    }
    for (const double cos_theta_o : {0.05, 0.3, 0.9}) {  // no layer makes light
        const Rgb albedo = Bsdf::layer(top, Bsdf::lambert(Rgb(1))).albedo(cos_theta_o);
        EXPECT_LE(std::max({albedo.x, albedo.y, albedo.z}), 1 + 1e-4);
    }
}

TEST(Bsdf, AlbedoIsTheIntegralOfEvaluate) {
    const auto samples = testing::mirrored_hemisphere(120, 120);
    const Bsdf bsdf = Bsdf::layer(Bsdf::ggx(0.6F, Rgb(0.04F), 1.5F), Bsdf::lambert({0.8F, 0.4F, 0.2F}));
    for (const double cos_theta_o : {0.3, 0.8, 1.0}) {
        const Vec3d wo(std::sqrt(1 - cos_theta_o * cos_theta_o), 0, cos_theta_o);
        for (int channel = 0; channel < 3; ++channel) {
            const double expected = testing::integral(
                samples, [&](const Vec3d& wi) { return static_cast<double>(bsdf.evaluate(wi, wo)[channel]); });
            EXPECT_NEAR(bsdf.albedo(cos_theta_o)[channel], expected, 1e-4);
        }
    }
}

}  // namespace
}  // namespace shlight
