// SPDX-License-Identifier: MIT
//
// Shading by quadrature against brute force, and by Monte Carlo and cubature against quadrature.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "error_record.h"
#include "lobe_truth.h"
#include "mean.h"
#include "method.h"
#include "quadrature.h"
#include "random_input.h"
#include "random_polygon.h"

namespace shlight {
namespace {

using methods::find_shading_method;
using methods::Sampling;
using testing::across_horizon;
using testing::all_tests;
using testing::ErrorRecord;
using testing::Mean;
using testing::on_two_threads;
using testing::RandomInput;
using testing::Vertices;
using testing::view_direction;

constexpr double kPi = std::numbers::pi;

struct Glossy {
    GgxShape shape;
    double cosine;
};

Glossy random_glossy(RandomInput& random) {
    const double roughness = random.uniform(0.05, 1);
    const Fresnel fresnel = random.chance(0.5)   ? Fresnel::one
                            : random.chance(0.5) ? Fresnel::schlick
                                                 : Fresnel::dielectric;
    return {{roughness * roughness, fresnel}, random.uniform(0.1, 1)};
}

Vec3d lit_axis(RandomInput& random, const Glossy& lobe, double half_angle) {
    const Vec3d view = view_direction(lobe.cosine);
    const Vec3d mirror(-view.x, 0, view.z);
    return glm::normalize(mirror + (half_angle + 2 * lobe.shape.alpha) * random.uniform(0, 1) * random.direction());
}

double albedo(const Glossy& lobe) {
    return testing::lobe_over_cap(lobe.shape, lobe.cosine, {0, 0, 1}, kPi / 2);
}

TEST(NumericalMethods, ShadingQuadratureOfCapsMatchesBruteForce) {
    const std::size_t count = all_tests() ? 400 : 60;
    ErrorRecord record(count);
    ErrorRecord grazing(count);  // where brute force itself knows no more than this
    on_two_threads(count, [&](std::size_t i) {
        RandomInput random(i);
        Glossy lobe = random_glossy(random);
        const double half = random.log_uniform(0.01, 1.5);
        const bool cut = i % 3 == 0;
        // Rings about the axis have no care for narrow lobes; those about the lobe none for the horizon.
        lobe.shape.alpha = std::max(lobe.shape.alpha, cut ? 0.1 : 0.0);
        const Vec3d axis = cut ? across_horizon(random, half) : lit_axis(random, lobe, half);
        if (!cut && axis.z < std::sin(half)) {
            return;
        }
        const Vec3d view = view_direction(lobe.cosine);
        const auto value = [&](const Vec3d& direction) { return lobe_value(lobe.shape, direction, view); };
        const double truth = cut ? testing::integral(testing::clipped_cap_samples(axis, half, 200), value)
                                 : testing::lobe_over_cap(lobe.shape, lobe.cosine, axis, half, 48);
        const auto method = find_shading_method("quadrature").make(lobe.shape, lobe.cosine, {});
        (lobe.cosine < 0.2 ? grazing : record)[i] =
            std::abs(method->radiance(cap_about_axis(axis, half), 0).value - truth) / albedo(lobe);
    });
    record.publish("shading quadrature of caps");
    EXPECT_LE(record.largest(), 1e-8) << record.worst();
    EXPECT_LE(grazing.largest(), 1e-6) << grazing.worst();
}

TEST(NumericalMethods, ShadingQuadratureOfPolygonsMatchesBruteForce) {
    constexpr std::size_t kCount = 16;
    ErrorRecord record(kCount);
    on_two_threads(kCount, [&](std::size_t i) {
        RandomInput random(i);
        Glossy lobe = random_glossy(random);
        lobe.shape.alpha = std::max(lobe.shape.alpha, 0.05);
        const Vertices vertices = testing::plain(random);
        const auto method = find_shading_method("quadrature").make(lobe.shape, lobe.cosine, {});
        const double truth = testing::PolygonTruth(lobe.shape, lobe.cosine).integral(vertices);
        record[i] = std::abs(method->radiance(methods::SeenPolygon(vertices), 0).value - truth);
    });
    record.publish("shading quadrature of polygons");
    EXPECT_LE(record.largest(), 1e-8) << record.worst();
}

/// Standard error of one light, relative to its value.
double noise(const LobeShape& shape, double half_angle, Sampling sampling) {
    const auto method = find_shading_method("monte_carlo").make(shape, 0.6, {.samples = 64, .sampling = sampling});
    Mean mean;
    for (std::uint32_t seed = 0; seed < 500; ++seed) {
        mean.add(method->radiance(cap_about_axis({-0.8, 0, 0.6}, half_angle), seed).value);
    }
    return mean.error() / mean.mean();
}

TEST(NumericalMethods, BothKindsOfSamplesTogetherAreGoodWhereEitherIs) {
    // A narrow lobe under a wide light is for the lobe's directions, a wide lobe under a small light for the light's.
    EXPECT_LE(10 * noise(GgxShape{0.01}, 0.7, Sampling::mis), noise(GgxShape{0.01}, 0.7, Sampling::solid_angle));
    EXPECT_LE(3 * noise(GgxShape{0.8}, 0.03, Sampling::mis), noise(GgxShape{0.8}, 0.03, Sampling::bsdf));
}

TEST(NumericalMethods, CubatureConvergesAndTakesNoMorePointsThanAllowed) {
    RandomInput random(21);
    for (int i = 0; i < 60; ++i) {
        const double roughness = random.uniform(0.5, 1);
        const LobeShape shape = i % 5 == 0 ? LobeShape(LambertShape{}) : LobeShape(GgxShape{roughness * roughness});
        const double cosine = random.uniform(0.4, 1);
        const double half = random.uniform(0.05, 0.5);
        const SphericalCap cap = cap_about_axis(across_horizon(random, half), half);
        const SphericalCap above = cap_about_axis({random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 1}, half);
        const Vertices vertices = testing::facing(random, 4, 0.6, half);
        const methods::SeenPolygon polygon(vertices);
        const auto truth = find_shading_method("quadrature").make(shape, cosine, {});
        for (const int points : {1, 3, 4, 7, 24, 40, 128, 600}) {
            const auto method = find_shading_method("cubature").make(shape, cosine, {.samples = points});
            const double largest = points >= 600 ? 2e-6 : points >= 128 ? 5e-4 : points >= 24 ? 5e-3 : 0.1;
            const auto check = [&](const char* name, const auto& region) {
                const methods::Reflected r = method->radiance(region, 0);
                EXPECT_LE(r.points, points) << name;
                EXPECT_GE(r.points, points == 1 ? 1 : points / 4) << name;
                EXPECT_LE(std::abs(r.value - truth->radiance(region, 0).value), largest) << name << " " << points;
            };
            check("cap above", above);
            check("cap cut", cap);
            if (!polygon.kept.empty()) {
                check("polygon", polygon);
            }
        }
    }
}

}  // namespace
}  // namespace shlight
