// SPDX-License-Identifier: MIT
//
// Caps against horizons of any height, and through warps, compared with the 113-bit reference: all ways in which two
// circles can lie, and all ways in which they can touch. Errors are the largest over all coefficients of a light,
// relative to its L_00 or, for what is small, to that of a thousandth of the sphere.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "error_record.h"
#include "quad_truth.h"
#include "quadrature.h"
#include "random_input.h"
#include "shlight/basis.h"
#include "shlight/cap.h"

namespace shlight {
namespace {

using testing::ErrorRecord;
using testing::on_two_threads;
using testing::RandomInput;
using truth::CapInput;

constexpr double kPi = std::numbers::pi;
constexpr int kOrder = 32;
/// L_00 of a thousandth of the sphere, 4π/1000 ÷ √4π.
const double kSmall = 1e-3 * std::sqrt(4 * kPi);

/// The three sides of the triangle of the poles and a crossing; any angles in 0 … π.
struct Sides {
    double tilt, half, horizon;
};

double any_angle(RandomInput& random) {
    switch (random.integer(0, 3)) {
        case 0:
            return random.log_uniform(1e-3, kPi / 2);
        case 1:
            return kPi - random.log_uniform(1e-3, kPi / 2);
        default:
            return random.uniform(0.01, kPi - 0.01);
    }
}

Sides anywhere(RandomInput& random) {
    return {random.uniform(0, kPi), any_angle(random), any_angle(random)};
}

/// The tilts between which circles of these half angles cross.
double first_contact(const Sides& s) {
    return std::abs(s.half - s.horizon);
}
double last_contact(const Sides& s) {
    return std::min(s.half + s.horizon, 2 * kPi - s.half - s.horizon);
}

Sides crossing(RandomInput& random) {
    Sides s{0, any_angle(random), any_angle(random)};
    s.tilt = random.uniform(first_contact(s), last_contact(s));
    return s;
}

/// Touching, or off by any number of digits, on either side.
Sides tangent(RandomInput& random) {
    Sides s{0, any_angle(random), any_angle(random)};
    const double off = random.chance(0.1) ? 0 : random.log_uniform(1e-17, 1e-2);
    const double contact = random.chance(0.5) ? first_contact(s) : last_contact(s);
    s.tilt = std::clamp(contact + (random.chance(0.5) ? off : -off), 0.0, kPi);
    return s;
}

/// Circles that are all but the same, or all but opposite.
Sides coincident(RandomInput& random) {
    Sides s{random.log_uniform(1e-17, 1e-2), any_angle(random), 0};
    s.horizon = std::clamp(s.half + random.uniform(-2, 2) * s.tilt, 1e-3, kPi - 1e-3);
    if (random.chance(0.2)) {
        s.horizon = s.half;
        s.tilt = random.chance(0.5) ? 0 : s.tilt;
    }
    return random.chance(0.5) ? s : Sides{kPi - s.tilt, kPi - s.half, s.horizon};
}

Sides tiny(RandomInput& random) {
    Sides s{0, random.log_uniform(1e-7, 1e-2), any_angle(random)};
    s.tilt = std::clamp(s.horizon + s.half * random.uniform(-1.2, 1.2), 0.0, kPi);
    return s;
}

Sides huge(RandomInput& random) {
    Sides s = tiny(random);
    s.half = kPi - s.half;
    s.tilt = kPi - s.tilt;
    return s;
}

Sides overhead(RandomInput& random) {
    Sides s = anywhere(random);
    s.tilt = random.chance(0.2) ? 0 : random.log_uniform(1e-12, 0.01);
    s.tilt = random.chance(0.5) ? s.tilt : kPi - s.tilt;
    return s;
}

struct Case {
    double height, sine;
    CapInput light;
};

Case described(RandomInput& random, const Sides& s) {
    return {std::cos(s.horizon), std::sin(s.horizon), {random.at_tilt(s.tilt), CapInput::Kind::angle, s.half}};
}

/// Terms of the azimuth 0 to all order² coefficients, to be compared with a reference at any azimuth.
template <class T>
std::vector<T> coefficients(const Cap<T>& cap, int order) {
    std::vector<T> terms(cosine_count(order), std::numeric_limits<T>::quiet_NaN());
    clipped_cap_terms(cap, order, terms.data());
    std::vector<T> result(coefficient_count(order));
    const double azimuth = std::atan2(static_cast<double>(cap.sin_azimuth), static_cast<double>(cap.cos_azimuth));
    for (int l = 0; l < order; ++l) {
        for (int m = 0; m <= l; ++m) {
            const auto term = static_cast<double>(terms[cosine_index(l, m)]);
            result[coefficient_index(l, -m)] = static_cast<T>(term * std::sin(m * azimuth));
            result[coefficient_index(l, m)] = static_cast<T>(term * std::cos(m * azimuth));
        }
    }
    return result;
}

double scale_of(const truth::Coefficients& reference) {
    return std::max(reference.high[0], kSmall);
}

template <class T>
double error_of(const Case& c, const truth::Coefficients& reference) {
    const auto cap = Cap<T>::against(c.height, c.sine, c.light.axis, c.light.size);
    const std::vector<T> computed = coefficients(cap, kOrder);
    return truth::largest_error(reference, kOrder, computed.data()) / scale_of(reference);
}

std::string describe(const Case& c) {
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(), "axis %.17g %.17g %.17g, half angle %.17g, horizon %.17g", c.light.axis.x,
                  c.light.axis.y, c.light.axis.z, c.light.size, c.height);
    return text.data();
}

struct Class {
    const char* name;
    Sides (*draw)(RandomInput&);
    std::size_t count;
};

constexpr auto kClasses = std::to_array<Class>({{"anywhere", anywhere, 75},
                                                {"crossing", crossing, 125},
                                                {"tangent", tangent, 125},
                                                {"coincident", coincident, 75},
                                                {"tiny", tiny, 50},
                                                {"huge", huge, 50},
                                                {"overhead or below", overhead, 50}});

const std::size_t kMore = testing::all_tests() ? 40 : 1;

TEST(CapHorizon, AgreesWithReference) {
    std::uint64_t seed = 400;
    for (const Class& kind : kClasses) {
        RandomInput random(seed++);
        std::vector<Case> cases(kind.count * kMore);
        for (Case& c : cases) {
            c = described(random, kind.draw(random));
        }
        ErrorRecord errors64(cases.size());
        ErrorRecord errors32(cases.size());
        on_two_threads(cases.size(), [&](std::size_t i) {
            const Case& c = cases[i];
            const truth::Coefficients reference = truth::cap_above(c.light, c.height, c.sine, kOrder);
            errors64[i] = error_of<double>(c, reference);
            errors32[i] = error_of<float>(c, reference);
        });
        errors64.publish(std::string(kind.name) + ", float64");
        errors32.publish(std::string(kind.name) + ", float32");
        EXPECT_LE(errors64.largest(), 1e-11) << kind.name << ": " << describe(cases[errors64.worst()]);
        EXPECT_LE(errors32.largest(), 2e-4) << kind.name << ": " << describe(cases[errors32.worst()]);
    }
}

/// A warp, and a light before it.
struct WarpedCase {
    double tilt, narrowness;
    CapInput light;
};

/// Half angle and tilt of a light whose circle is all but the horizon, above it or below.
Sides against_the_plane(RandomInput& random) {
    const double tilt = random.log_uniform(1e-14, 1e-2);
    const Sides s{tilt, kPi / 2 + tilt * random.uniform(-1.5, 1.5), kPi / 2};
    return random.chance(0.7) ? s : Sides{kPi - s.tilt, s.half, s.horizon};
}

/// A third of the lights is clipped; the others may be anywhere, many of them where the lobe is.
WarpedCase warped_case(RandomInput& random, double least_narrowness) {
    WarpedCase c{random.uniform(-1.5, 1.5), random.log_uniform(least_narrowness, 1), {}};
    if (random.chance(0.1)) {
        const Sides s = against_the_plane(random);
        c.light = {random.at_tilt(s.tilt), CapInput::Kind::angle, s.half};
        if (random.chance(0.5)) {
            c.light.kind = CapInput::Kind::sphere;
            c.light.size = glm::length(c.light.axis) * (1 - random.log_uniform(1e-15, 1e-4));
        }
        return c;
    }
    const double half = random.log_uniform(0.01, 1.4);
    Vec3d axis = random.direction();
    if (random.chance(1.0 / 3)) {
        axis = random.at_tilt(kPi / 2 + half * random.uniform(-1, 1));
    } else if (random.chance(0.5)) {
        const Vec3d lobe(-std::sin(c.tilt), 0, std::cos(c.tilt));
        axis = glm::normalize(lobe + (half + c.narrowness) * random.uniform(0, 1.5) * random.direction());
    }
    c.light = {axis, CapInput::Kind::angle, half};
    if (random.chance(0.5)) {
        const double distance = random.log_uniform(1e-3, 1e3);
        c.light = {distance * axis, CapInput::Kind::sphere, distance * std::sin(half)};
    }
    return c;
}

template <class T>
Cap<T> cap_of(const CapInput& light, const Warp& warp) {
    return light.kind == CapInput::Kind::sphere ? Cap<T>::of_sphere(light.axis, light.size, warp)
                                                : Cap<T>::about_axis(light.axis, light.size, warp);
}

TEST(CapHorizon, WarpedLightsAgreeWithReference) {
    RandomInput random(420);
    std::vector<WarpedCase> cases(200 * kMore);
    for (WarpedCase& c : cases) {
        c = warped_case(random, 1e-3);
    }
    ErrorRecord errors64(cases.size());
    ErrorRecord errors32(cases.size());
    on_two_threads(cases.size(), [&](std::size_t i) {
        const WarpedCase& c = cases[i];
        const Warp warp(c.tilt, c.narrowness);
        const truth::Coefficients reference = truth::warped_cap(c.light, {c.tilt, c.narrowness}, kOrder);
        const auto error = [&]<class T>(T /*precision*/) {
            const std::vector<T> computed = coefficients(cap_of<T>(c.light, warp), kOrder);
            return truth::largest_error(reference, kOrder, computed.data()) / scale_of(reference);
        };
        errors64[i] = error(0.0);
        errors32[i] = error(0.0F);
    });
    errors64.publish("warped, float64");
    errors32.publish("warped, float32");
    const auto text = [&](std::size_t i) {
        const WarpedCase& c = cases[i];
        return describe({0, 1, c.light}) + ", tilt " + std::to_string(c.tilt) + ", narrowness " +
               std::to_string(c.narrowness);
    };
    EXPECT_LE(errors64.largest(), 1e-11) << text(errors64.worst());
    EXPECT_LE(errors32.largest(), 2e-4) << text(errors32.worst());
}

/// The whole road: ∫ g(u(ω)) du/dω dω over the light as it is, by cubature, against Σ g_lm S_lm.
TEST(CapHorizon, IntegralsThroughAWarpAreThoseOverTheTrueLight) {
    RandomInput random(430);
    const int order = 6;
    for (int i = 0; i < 60; ++i) {
        const WarpedCase c = warped_case(random, 0.3);
        const Warp warp(c.tilt, c.narrowness);
        std::vector<double> lobe(cosine_count(order));
        for (double& term : lobe) {
            term = random.uniform(-1, 1);
        }
        const auto half =
            c.light.kind == CapInput::Kind::sphere ? std::asin(c.light.size / glm::length(c.light.axis)) : c.light.size;
        const double expected =
            testing::integral(testing::clipped_cap_samples(c.light.axis, half, 120), [&](const Vec3d& direction) {
                const Vec3d u = warp.warped(direction);
                std::array<double, 36> basis;
                sh_basis<double>(u, order, basis.data());
                double sum = 0;
                for (int l = 0; l < order; ++l) {
                    for (int m = 0; m <= l; ++m) {
                        sum += lobe[cosine_index(l, m)] * basis[coefficient_index(l, m)];
                    }
                }
                return sum / warp.density(u);
            });
        const double computed = shade_cap(cap_of<double>(c.light, warp), lobe.data(), order);
        EXPECT_NEAR(computed, expected, 1e-8)
            << describe({0, 1, c.light}) << ", tilt " << c.tilt << ", narrowness " << c.narrowness;
    }
}

template <class T>
class CapHorizonLimits : public ::testing::Test {};
using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(CapHorizonLimits, Precisions);

/// The fused sum is the sum of what the other two functions give.
TYPED_TEST(CapHorizonLimits, ShadingIsTheSumOverTheTerms) {
    using T = TypeParam;
    RandomInput random(440);
    for (int i = 0; i < 200; ++i) {
        const int order = random.integer(1, 20);
        const Case c = described(random, i % 2 == 0 ? crossing(random) : anywhere(random));
        const auto cap = Cap<T>::against(c.height, c.sine, c.light.axis, c.light.size);
        const std::vector<T> light = coefficients(cap, order);
        std::vector<T> lobe(cosine_count(order));
        double expected = 0;
        double size = 0;
        for (int l = 0; l < order; ++l) {
            for (int m = 0; m <= l; ++m) {
                lobe[cosine_index(l, m)] = static_cast<T>(random.uniform(-1, 1));
                const double product =
                    static_cast<double>(lobe[cosine_index(l, m)]) * static_cast<double>(light[coefficient_index(l, m)]);
                expected += product;
                size += std::abs(product);
            }
        }
        const T computed = shade_cap(cap, lobe.data(), order);
        EXPECT_NEAR(computed, expected, 100 * std::numeric_limits<T>::epsilon() * size);
    }
}

/// No warp is the plane z = 0, bit for bit.
TYPED_TEST(CapHorizonLimits, NoWarpIsThePlane) {
    using T = TypeParam;
    RandomInput random(450);
    const int order = 12;
    for (int i = 0; i < 50; ++i) {
        const double half = random.uniform(0.01, 3.1);
        const Vec3d axis = random.direction();
        const auto plain = Cap<T>::about_axis(axis, half);
        const auto against = Cap<T>::against(0, 1, axis, half);
        EXPECT_NEAR(plain.solid_angle, against.solid_angle, 10 * std::numeric_limits<T>::epsilon());
        std::vector<T> terms(cosine_count(order));
        std::vector<T> whole(coefficient_count(order));
        clipped_cap_terms(plain, order, terms.data());
        cap_coefficients(plain, order, true, whole.data());
        EXPECT_EQ(terms[0], whole[0]);
    }
}

/// Nothing overflows or divides by zero, wherever the circles lie.
TYPED_TEST(CapHorizonLimits, EverythingIsFinite) {
    using T = TypeParam;
    RandomInput random(460);
    const std::vector<T> lobe(cosine_count(kMaxOrder), T(1));
    const auto angle = [&] {
        const double small = random.chance(0.1) ? 0 : random.log_uniform(1e-30, kPi);
        return random.chance(0.5) ? small : kPi - small;
    };
    for (int i = 0; i < 20000; ++i) {
        const double eta = std::clamp(angle(), 1e-12, kPi - 1e-12);
        const Vec3d axis = random.at_tilt(angle());
        const double half = std::max(angle(), 1e-30);
        const int order = i % 50 == 0 ? kMaxOrder : random.integer(1, 8);
        const auto cap = Cap<T>::against(std::cos(eta), std::sin(eta), axis, half);
        EXPECT_TRUE(std::isfinite(shade_cap(cap, lobe.data(), order)))
            << "horizon " << eta << ", half angle " << half << ", axis " << axis.x << ' ' << axis.y << ' ' << axis.z;
        EXPECT_GE(cap.solid_angle, 0);
        const Warp warp(random.uniform(-1.57, 1.57), random.log_uniform(1e-6, 1));
        const double distance = random.log_uniform(1e-150, 1e150);
        const Vec3d center = distance * (random.chance(0.1) ? Vec3d(0, 0, random.chance(0.5) ? 1 : -1) : axis);
        const double radius = random.chance(0.1) ? glm::length(center) : distance * random.log_uniform(1e-200, 0.999);
        if (radius > 0) {
            const auto sphere = Cap<T>::of_sphere(center, radius, warp);
            EXPECT_TRUE(std::isfinite(shade_cap(sphere, lobe.data(), order)))
                << "center " << center.x << ' ' << center.y << ' ' << center.z << ", radius " << radius;
        }
    }
}

}  // namespace
}  // namespace shlight
