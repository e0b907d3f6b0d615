// SPDX-License-Identifier: MIT
//
// Caps through boosts, as they are shaded, compared with the 113-bit reference: all ways in which a light's circle and
// the horizon can lie, and all ways in which they can touch. Errors are the largest over all terms of a light, relative
// to its L_00 or, for what is small, to that of a thousandth of the sphere.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "boosted_terms.h"
#include "error_record.h"
#include "quad_truth.h"
#include "quadrature.h"
#include "random_input.h"
#include "regions/cap_kernels.h"
#include "shlight/basis.h"
#include "shlight/boost.h"
#include "shlight/cap.h"

namespace shlight {
namespace {

using testing::boosted_terms;
using testing::ErrorRecord;
using testing::on_two_threads;
using testing::RandomInput;
using truth::BoostInput;
using truth::CapInput;

constexpr double kPi = std::numbers::pi;
constexpr double kHalfPi = kPi / 2;
constexpr int kOrder = 32;
/// L_00 of a thousandth of the sphere, 4π/1000 ÷ √4π.
const double kSmall = 1e-3 * std::sqrt(4 * kPi);

/// A light by the angle between its axis and the zenith, and its half angle.
struct Angles {
    double tilt, half;
};

double any_angle(RandomInput& random) {
    switch (random.integer(0, 3)) {
        case 0:
            return random.log_uniform(1e-3, kHalfPi);
        case 1:
            return kPi - random.log_uniform(1e-3, kHalfPi);
        default:
            return random.uniform(0.01, kPi - 0.01);
    }
}

Angles anywhere(RandomInput& random) {
    return {random.uniform(0, kPi), any_angle(random)};
}

/// The tilts between which a circle of this half angle crosses the horizon lie as far from it on either side.
double contact(double half) {
    return std::min(half, kPi - half);
}

Angles crossing(RandomInput& random) {
    const double half = any_angle(random);
    return {kHalfPi + contact(half) * random.uniform(-1, 1), half};
}

/// Touching, or off by any number of digits, on either side.
Angles tangent(RandomInput& random) {
    const double half = any_angle(random);
    const double off = random.chance(0.1) ? 0 : random.log_uniform(1e-17, 1e-2);
    const double side = random.chance(0.5) ? 1 : -1;
    return {std::clamp(kHalfPi + side * contact(half) + (random.chance(0.5) ? off : -off), 0.0, kPi), half};
}

/// A circle that is all but the horizon, above it or below.
Angles coincident(RandomInput& random) {
    const double tilt = random.log_uniform(1e-17, 1e-2);
    const Angles a = {random.chance(0.1) ? 0 : tilt, kHalfPi + tilt * random.uniform(-2, 2)};
    return random.chance(0.5) ? a : Angles{kPi - a.tilt, kPi - a.half};
}

Angles tiny(RandomInput& random) {
    const double half = random.log_uniform(1e-7, 1e-2);
    return {kHalfPi + half * random.uniform(-1.2, 1.2), half};
}

Angles huge(RandomInput& random) {
    const Angles a = tiny(random);
    return {kPi - a.tilt, kPi - a.half};
}

Angles overhead(RandomInput& random) {
    Angles a = anywhere(random);
    a.tilt = random.chance(0.2) ? 0 : random.log_uniform(1e-12, 0.01);
    a.tilt = random.chance(0.5) ? a.tilt : kPi - a.tilt;
    return a;
}

struct Case {
    BoostInput boost;
    CapInput light;
};

BoostInput random_boost(RandomInput& random) {
    return {random.uniform(-1.5, 1.5), random.chance(0.1) ? 1 : random.log_uniform(1e-3, 1)};
}

CapInput about(const Vec3d& axis, double half) {
    return {axis, CapInput::Kind::angle, half};
}

template <Angles (*kDraw)(RandomInput&)>
Case at_horizon(RandomInput& random) {
    const BoostInput boost = random_boost(random);
    const Angles a = kDraw(random);
    return {boost, about(random.at_tilt(a.tilt), a.half)};
}

/// Inside the boost's lobe, at its rim, or near it.
Case in_lobe(RandomInput& random) {
    const BoostInput boost = random_boost(random);
    const double half = random.log_uniform(0.01, 1.4);
    const Vec3d lobe(-std::sin(boost.tilt), 0, std::cos(boost.tilt));
    const Vec3d offset = (half + boost.narrowness) * random.uniform(0, 1.5) * random.direction();
    return {boost, about(glm::normalize(lobe + offset), half)};
}

/// Spheres, at any distance or all but in contact.
Case sphere(RandomInput& random) {
    const BoostInput boost = random_boost(random);
    const double share = random.chance(0.3) ? 1 - random.log_uniform(1e-15, 1e-4) : std::sin(random.uniform(0.01, 1.4));
    const Vec3d center = random.log_uniform(1e-3, 1e3) * random.direction();
    return {boost, {center, CapInput::Kind::sphere, share * glm::length(center)}};
}

SphericalCap circle_of(const CapInput& light) {
    return light.kind == CapInput::Kind::sphere ? cap_of_sphere(light.axis, light.size)
                                                : cap_about_axis(light.axis, light.size);
}

/// The function that `shaded` and `boosted_terms` call.
auto shading_of(const CapInput& light) {
    CapBatch circles;
    circles.resize(1);
    if (light.kind == CapInput::Kind::sphere) {
        circles.set_spheres(std::span(&light.axis, 1), &light.size);
    } else {
        circles.set(0, circle_of(light));
    }
    return
        [circles](std::span<const std::uint32_t> lights, const LobeArrays& lobe, std::span<const std::uint32_t> views,
                  std::span<float> values) { shade_caps(circles.arrays(), lights, lobe, views, values); };
}

std::string describe(const Case& c) {
    std::array<char, 250> text{};
    std::snprintf(text.data(), text.size(), "axis %.17g %.17g %.17g, size %.17g, kind %d, tilt %.17g, narrowness %.17g",
                  c.light.axis.x, c.light.axis.y, c.light.axis.z, c.light.size, static_cast<int>(c.light.kind),
                  c.boost.tilt, c.boost.narrowness);
    return text.data();
}

struct Class {
    const char* name;
    Case (*draw)(RandomInput&);
    std::size_t count;
};

constexpr auto kClasses = std::to_array<Class>({{"anywhere", at_horizon<anywhere>, 30},
                                                {"crossing", at_horizon<crossing>, 50},
                                                {"tangent", at_horizon<tangent>, 50},
                                                {"coincident", at_horizon<coincident>, 30},
                                                {"tiny", at_horizon<tiny>, 20},
                                                {"huge", at_horizon<huge>, 20},
                                                {"overhead or below", at_horizon<overhead>, 20},
                                                {"in the lobe", in_lobe, 40},
                                                {"spheres", sphere, 40}});

const std::size_t kMore = testing::all_tests() ? 20 : 1;
// Error relative to the sliver's solid angle; more cases, and kernels without fused products, find a worse one.
const double kBound = testing::all_tests() ? 3e-4 : 2e-4;

TEST(CapHorizon, BoostedLightsAgreeWithReference) {
    std::uint64_t seed = 400;
    for (const Class& kind : kClasses) {
        RandomInput random(seed++);
        std::vector<Case> cases(kind.count * kMore);
        std::generate(cases.begin(), cases.end(), [&] { return kind.draw(random); });
        ErrorRecord errors(cases.size());
        on_two_threads(cases.size(), [&](std::size_t i) {
            const Case& c = cases[i];
            const truth::Coefficients reference = truth::boosted_cap(c.light, c.boost, kOrder);
            errors[i] = testing::largest_error(reference, kOrder, boosted_terms(c.boost, kOrder, shading_of(c.light))) /
                        std::max(reference.high[0], kSmall);
        });
        errors.publish(kind.name);
        EXPECT_LE(errors.largest(), kBound) << kind.name << ": " << describe(cases[errors.worst()]);
    }
}

/// The reference: ∫ g(u(ω)) du/dω dω over the light as it is, by cubature, against Σ g_lm S_lm.
TEST(CapHorizon, IntegralsThroughABoostAreThoseOverTheTrueLight) {
    RandomInput random(430);
    const int order = 6;
    for (int i = 0; i < 60; ++i) {
        const double half = random.log_uniform(0.01, 1.4);
        const Vec3d axis = i % 3 == 0 ? random.at_tilt(kHalfPi + half * random.uniform(-1, 1)) : random.direction();
        const Case c{{random.uniform(-1.5, 1.5), random.log_uniform(0.3, 1)}, about(axis, half)};
        const Boost boost(c.boost.tilt, c.boost.narrowness);
        std::vector<double> lobe(cosine_count(order));
        std::generate(lobe.begin(), lobe.end(), [&] { return random.uniform(-1, 1); });
        const auto dot = [&](const double* coefficients) {
            double sum = 0;
            for (int l = 0; l < order; ++l) {
                for (int m = 0; m <= l; ++m) {
                    sum += lobe[cosine_index(l, m)] * coefficients[coefficient_index(l, m)];
                }
            }
            return sum;
        };
        const double expected =
            testing::integral(testing::clipped_cap_samples(axis, half, 120), [&](const Vec3d& direction) {
                const Vec3d u = boost.boosted(direction);
                std::array<double, 36> basis;
                sh_basis<double>(u, order, basis.data());
                return dot(basis.data()) / boost.density(u);
            });
        EXPECT_NEAR(dot(truth::boosted_cap(c.light, c.boost, order).high.data()), expected, 1e-8) << describe(c);
    }
}

/// One lobe of many terms, or many of one.
TEST(CapHorizonLimits, ShadingIsTheSumOverTheTerms) {
    RandomInput random(440);
    for (int i = 0; i < 200; ++i) {
        const int order = random.integer(1, 20);
        const Case c = i % 2 == 0 ? at_horizon<crossing>(random) : at_horizon<anywhere>(random);
        const auto shading = shading_of(c.light);
        std::vector<float> lobe(cosine_count(order));
        std::generate(lobe.begin(), lobe.end(), [&] { return static_cast<float>(random.uniform(-1, 1)); });
        const std::vector<float> light = boosted_terms(c.boost, order, shading);
        const double expected = std::inner_product(light.begin(), light.end(), lobe.begin(), 0.0);
        const double size = std::inner_product(light.begin(), light.end(), lobe.begin(), 0.0, std::plus<>(),
                                               [](float a, float b) { return std::abs(a * b); });
        EXPECT_NEAR(testing::shaded(c.boost, lobe, order, shading)[0], expected,
                    100 * std::numeric_limits<float>::epsilon() * size)
            << describe(c);
    }
}

/// No boost is the plane z = 0, whether the kernel knows it or not.
TEST(CapHorizonLimits, NoBoostIsThePlane) {
    RandomInput random(450);
    const int order = 12;
    for (int i = 0; i < 100; ++i) {
        const CapInput light = about(random.direction(), random.uniform(0.01, 3.1));
        const SphericalCap circle = circle_of(light);
        std::vector<float> expected(coefficient_count(order));
        cap_coefficients<float>({&circle, 1}, order, true, expected);
        const auto shading = shading_of(light);
        const auto unboosted = [&](const auto& lights, LobeArrays lobe, const auto& views, auto& values) {
            lobe.boosted = false;
            shading(lights, lobe, views, values);
        };
        const std::vector<float> plane = boosted_terms({0, 1}, order, unboosted);
        const std::vector<float> boosted = boosted_terms({0, 1}, order, shading);
        for (int l = 0; l < order; ++l) {
            for (int m = 0; m <= l; ++m) {
                EXPECT_NEAR(plane[cosine_index(l, m)], expected[coefficient_index(l, m)], 1e-6);
                EXPECT_NEAR(boosted[cosine_index(l, m)], expected[coefficient_index(l, m)], 1e-5);
            }
        }
    }
}

/// Nothing overflows or divides by zero, wherever the circles lie.
TEST(CapHorizonLimits, EverythingIsFinite) {
    RandomInput random(460);
    const std::vector<float> ones(cosine_count(kMaxOrder), 1);
    const auto angle = [&] {
        const double small = random.chance(0.1) ? 0 : random.log_uniform(1e-30, kPi);
        return random.chance(0.5) ? small : kPi - small;
    };
    for (int i = 0; i < 20000; ++i) {
        const int order = i % 50 == 0 ? kMaxOrder : random.integer(1, 8);
        const std::vector<float> lobe(ones.begin(), ones.begin() + cosine_count(order));
        const Vec3d axis = random.chance(0.1) ? Vec3d(0, 0, random.chance(0.5) ? 1 : -1) : random.at_tilt(angle());
        const double distance = random.log_uniform(1e-150, 1e150);
        const double radius = random.chance(0.1) ? distance : distance * random.log_uniform(1e-200, 0.999);
        Case c{{random.uniform(-1.57, 1.57), random.log_uniform(1e-6, 1)}, about(axis, std::max(angle(), 1e-30))};
        EXPECT_TRUE(std::isfinite(testing::shaded(c.boost, lobe, order, shading_of(c.light))[0])) << describe(c);
        c.light = {distance * axis, CapInput::Kind::sphere, radius};
        if (radius > 0) {
            EXPECT_TRUE(std::isfinite(testing::shaded(c.boost, lobe, order, shading_of(c.light))[0])) << describe(c);
        }
    }
}

}  // namespace
}  // namespace shlight
