// SPDX-License-Identifier: MIT
//
// Values of lobes in lanes, and their integral along the outline of a light.
#include "lobes/boundary_integral.h"
#include "regions/boundary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "lighting/cubature_kernel.h"
#include "lobe_truth.h"
#include "quadrature.h"
#include "random_input.h"

namespace shlight {
namespace {

using testing::lobe_over_cap;
using testing::RandomInput;
using testing::view_direction;

TEST(LobeKernels, ValuesInLanesAreTheLobes) {
    // The rule of one point over a tiny cap is f·cos at its middle times the cap's area.
    RandomInput random(41);
    const std::uint32_t only = 0;
    double largest = 0;
    for (int i = 0; i < 3000; ++i) {
        const GgxShape shape{random.log_uniform(1e-4, 1), static_cast<Fresnel>(i % 3), random.uniform(1.1, 2.5)};
        const Vec3d view = view_direction(random.uniform(0.05, 1));
        const Vec3d noise = random.direction();
        const double spread = random.chance(0.5) ? 4 * shape.alpha : 1.0;
        Vec3d axis = glm::normalize(Vec3d(-view.x, 0, view.z) + spread * noise);
        axis.z = std::abs(axis.z);
        if (axis.z < 1e-3) {
            continue;
        }
        const double sine = 1e-6 * shape.alpha;
        const double cosine = std::sqrt(1 - sine * sine);
        float value = 0;
        const auto width = static_cast<float>(shape.alpha);
        integrate_caps(shape, &width, {&axis.x, &axis.y, &axis.z, &cosine, &sine}, {&only, 1}, {&view.x, &view.z, true},
                       {&only, 1}, 1, {&value, 1});
        const double area = 2 * std::numbers::pi * sine * sine / (1 + cosine);
        const double expected = lobe_value(shape, axis, view);
        // Fresnel's rise is a fifth power, or as good as one, of a difference that floats know to 1e-7.
        const double edge = 1 - glm::length(axis + view) / 2;
        const double rounding = shape.fresnel == Fresnel::one ? 2e-6 : 2e-6 + 2e-6 / edge;
        const double error = std::abs(static_cast<double>(value) / area - expected) / expected;
        largest = std::max(largest, error / rounding);
    }
    EXPECT_LE(largest, 1);
}

Arc<double> circle_about(const Vec3d& axis, double half_angle) {
    return whole_circle(cap_about_axis(axis, half_angle));
}

Vec3d near_mirror(RandomInput& random, double cos_theta_o, double spread) {
    const Vec3d v = view_direction(cos_theta_o);
    return glm::normalize(Vec3d(-v.x, 0, v.z) + spread * random.uniform(0, 1) * random.direction());
}

TEST(ContourIntegral, WholeCapsMatchDenseCubature) {
    RandomInput random(11);
    int compared = 0;
    for (int i = 0; i < 120; ++i) {
        const double alpha = random.log_uniform(0.003, 1);
        const double cosine = random.uniform(0.05, 1);
        const GgxShape shape{alpha, i % 2 == 0 ? Fresnel::one : Fresnel::schlick};
        const double half = random.log_uniform(0.01, 1.4);
        const Vec3d axis = near_mirror(random, cosine, half + 2 * alpha);
        if (axis.z < std::sin(half)) {
            continue;
        }
        ++compared;
        const Arc<double> arc = circle_about(axis, half);
        const double truth = lobe_over_cap(shape, cosine, axis, half, 40);
        const BoundaryIntegral fine = boundary_integral(shape, cosine, {&arc, 1}, 1e-8);
        EXPECT_LE(std::abs(fine.value - truth), 1e-5) << "alpha " << alpha << " cos " << cosine << " half " << half;
        for (const double tolerance : {1e-2, 1e-3}) {
            const BoundaryIntegral integral = boundary_integral(shape, cosine, {&arc, 1}, tolerance);
            // The radial rule, which has no estimate of its own, may add as much again.
            EXPECT_LE(std::abs(integral.value - truth), 2 * tolerance + 1e-5);
            EXPECT_LT(integral.points, 9000);
        }
        // Floats and fewer points along a radius do where the tolerance is a small share of the albedo.
        const double close = 2e-6;
        EXPECT_LE(std::abs(boundary_integral(shape, cosine, {&arc, 1}, close).value - fine.value), close);
    }
    EXPECT_GT(compared, 30);
}

TEST(RoughDiffuse, AlbedosAreTheIntegralOverTheHemisphere) {
    const std::vector<testing::Sample> samples = testing::mirrored_hemisphere(400, 400);
    for (const LobeShape& shape : testing::rough_diffuse_shapes()) {
        for (const double cosine : {0.05, 0.1, 0.25, 0.43, 0.6, 0.9, 0.999, 1.0}) {
            const Vec3d view = view_direction(cosine);
            const double truth =
                testing::integral(samples, [&](const Vec3d& direction) { return lobe_value(shape, direction, view); });
            // Kinks of the lobes cost the sum of 400² points 1e-5.
            EXPECT_LE(std::abs(lobe_albedo(shape, cosine) - truth), 2e-5) << shape.index() << " " << cosine;
        }
    }
}

TEST(ContourIntegral, AVeryNarrowLobeIsAMirror) {
    for (const double cosine : {0.1, 0.6, 0.99}) {
        const Vec3d v = view_direction(cosine);
        const Vec3d mirror(-v.x, 0, v.z);
        const double half = std::min(0.3, std::asin(mirror.z) / 2);
        const Arc<double> around = circle_about(mirror, half);
        // Tails of the lobe: (α / ½ half cosθ_o)² and less.
        EXPECT_NEAR(boundary_integral(GgxShape{1e-6}, cosine, {&around, 1}, 1e-6).value, 1, 1e-5);
        const Arc<double> beside = circle_about(glm::normalize(mirror + Vec3d(0, 2.5 * half, 0)), half);
        EXPECT_NEAR(boundary_integral(GgxShape{1e-6}, cosine, {&beside, 1}, 1e-6).value, 0, 1e-5);
    }
}

TEST(ContourIntegral, ALobeWithoutAPeakIsAFactorOfTheEvenBell) {
    // A cap above the horizon gets sin²σ cosθ from Lambert's surface, whatever the view.
    for (const double tilt : {0.0, 0.5, 0.9}) {
        for (const double half : {0.05, 0.6}) {
            const Arc<double> around = circle_about({std::sin(tilt), 0, std::cos(tilt)}, half);
            const double truth = std::pow(std::sin(half), 2) * std::cos(tilt);
            for (const double cosine : {0.1, 0.6, 1.0}) {
                const double value = boundary_integral(LambertShape{}, cosine, {&around, 1}, 1e-7).value;
                EXPECT_LE(std::abs(value - truth), 1e-6) << tilt << " " << half << " " << cosine;
            }
        }
    }
}

/// f·cos of microfacets with two widths as Heitz 2014 has it, "Understanding the Masking-Shadowing Function in
/// Microfacet-Based BRDFs".
double heitz(const GgxShape& shape, const Vec3d& wi, const Vec3d& wo) {
    const Vec3d x(std::cos(shape.azimuth), -std::sin(shape.azimuth), 0);
    const Vec3d y(std::sin(shape.azimuth), std::cos(shape.azimuth), 0);
    const Vec3d h = glm::normalize(wi + wo);
    const double slope_x = glm::dot(h, x) / (shape.alpha * h.z);
    const double slope_y = glm::dot(h, y) / (shape.across * h.z);
    const double slope2 = slope_x * slope_x + slope_y * slope_y;
    const bool is_ggx = shape.distribution == Microfacets::ggx;
    const double spread = is_ggx ? 1 / ((1 + slope2) * (1 + slope2)) : std::exp(-slope2);
    const double ndf = spread / (std::numbers::pi * shape.alpha * shape.across * std::pow(h.z, 4));
    const auto lambda = [&](const Vec3d& v) {
        const double a = v.z / std::hypot(shape.alpha * glm::dot(v, x), shape.across * glm::dot(v, y));
        return is_ggx    ? (std::sqrt(1 + 1 / (a * a)) - 1) / 2
               : a < 1.6 ? (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a)
                         : 0;
    };
    const double fresnel = shape.fresnel == Fresnel::one ? 1 : std::pow(1 - glm::dot(wi, h), 5);
    return fresnel * ndf / (1 + lambda(wi) + lambda(wo)) / (4 * wo.z);
}

/// Over a cap above the horizon, in equal steps of its azimuth and by Gauss's rule in its polar angle.
double heitz_over_cap(const GgxShape& shape, const Vec3d& wo, const Vec3d& axis, double half_angle) {
    constexpr int kSpokes = 600;
    const Vec3d u = glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.5 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0)));
    const Vec3d v = glm::cross(axis, u);
    double sum = 0;
    for (const testing::Node& ring : testing::gauss_nodes(200, 0, half_angle)) {
        for (int i = 0; i < kSpokes; ++i) {
            const double phi = 2 * std::numbers::pi * i / kSpokes;
            const Vec3d outwards = std::cos(phi) * u + std::sin(phi) * v;
            const Vec3d wi = std::cos(ring.x) * axis + std::sin(ring.x) * outwards;
            sum += ring.weight * std::sin(ring.x) * heitz(shape, wi, wo);
        }
    }
    return sum * 2 * std::numbers::pi / kSpokes;
}

TEST(ContourIntegral, StretchedMicrofacetsOverCapsMatchDenseCubature) {
    RandomInput random(17);
    int compared = 0;
    for (int i = 0; i < 60; ++i) {
        const double alpha = random.log_uniform(0.02, 0.5);
        const GgxShape shape{alpha,
                             i % 2 == 0 ? Fresnel::one : Fresnel::schlick,
                             1.5,
                             i % 3 == 0 ? Microfacets::beckmann : Microfacets::ggx,
                             std::min(1.0, alpha * random.uniform(1, 10)),
                             random.uniform(0, 2 * std::numbers::pi)};
        const double cosine = random.uniform(0.1, 1);
        const Vec3d view = view_direction(cosine);
        const double half = random.log_uniform(0.05, 1.2);
        const Vec3d axis = near_mirror(random, cosine, half + 2 * shape.across);
        if (axis.z < std::sin(half) + 1e-3) {
            continue;
        }
        ++compared;
        EXPECT_NEAR(lobe_value(shape, axis, view), heitz(shape, axis, view), 1e-10 * heitz(shape, axis, view) + 1e-12);
        const Arc<double> arc = circle_about(axis, half);
        const double truth = heitz_over_cap(shape, view, axis, half);
        EXPECT_NEAR(boundary_integral(shape, cosine, {&arc, 1}, 1e-8).value, truth, 2e-5) << i << " " << alpha;
        EXPECT_NEAR(boundary_integral(shape, cosine, {&arc, 1}, 1e-3).value, truth, 2e-3) << i << " " << alpha;
    }
    EXPECT_GT(compared, 15);
}

TEST(ContourIntegral, StretchedMicrofacetsReflectNoMoreThanTheyGet) {
    for (const double cosine : {0.05, 0.5, 0.98}) {
        for (const double azimuth : {0.0, 0.7, 1.5}) {
            const GgxShape shape{0.1, Fresnel::one, 1.5, Microfacets::ggx, 1, azimuth};
            const double truth = heitz_over_cap(shape, view_direction(cosine), {0, 0, 1}, std::numbers::pi / 2);
            EXPECT_NEAR(lobe_albedo(shape, cosine), truth, 1e-4);
            EXPECT_LE(lobe_albedo(shape, cosine), 1);
        }
    }
}

}  // namespace
}  // namespace shlight
