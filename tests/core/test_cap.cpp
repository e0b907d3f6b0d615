// SPDX-License-Identifier: MIT
//
// Caps against the 113-bit reference, at random and in the corners. Errors are the largest over all coefficients of a
// light, relative to L_00: the light's own, or the whole cap's where only a sliver is kept.
#include "shlight/cap.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "light_errors.h"
#include "quad_truth.h"
#include "random_input.h"

namespace shlight {
namespace {

using testing::as_float;
using testing::BothErrors;
using testing::errors_by_order;
using testing::RandomInput;
using truth::CapInput;
using Kind = truth::CapInput::Kind;

constexpr double kHalfPi = std::numbers::pi / 2;
constexpr double kNextToOne = 1 - std::numeric_limits<float>::epsilon();

enum class Relative { to_own, to_whole };

struct Light {
    CapInput input;
    bool clip = true;
};

/// One of the three ways to say which cap is meant; half < π/2 for the first two.
CapInput described(RandomInput& random, double tilt, double half) {
    const double distance = random.log_uniform(1e-3, 1e3);
    const Vec3d axis = distance * random.at_tilt(tilt);
    const int way = random.integer(0, 9);
    if (half >= kHalfPi || way == 0) {
        return {axis, Kind::angle, half};
    }
    if (way == 1) {
        return {axis, Kind::facing_disk, distance * std::tan(half)};
    }
    return {axis, Kind::sphere, distance * std::sin(half)};
}

/// The centre `below` half angles under the horizon.
Light at_horizon(RandomInput& random, double below_low, double below_high) {
    const double half = random.log_uniform(1e-6, 1.56);
    return {described(random, kHalfPi + half * random.uniform(below_low, below_high), half)};
}

Light clipped(RandomInput& random) {
    return at_horizon(random, -0.8, 0.8);
}
Light barely_clipped(RandomInput& random) {
    return at_horizon(random, -1, -0.8);
}
Light sliver(RandomInput& random) {
    return at_horizon(random, 0.8, 0.999);
}
Light vanishing(RandomInput& random) {
    return at_horizon(random, 0.999, 1.0001);
}

Light centered_on_horizon(RandomInput& random) {
    Light light{described(random, kHalfPi, random.log_uniform(1e-6, 1.56))};
    light.input.axis.z = 0;
    return light;
}

/// Spheres that touch the horizon's plane, from above or from below, exactly or but for a few roundings.
Light tangent(RandomInput& random) {
    const double radius = as_float(random.log_uniform(1e-6, 1));
    const double offset = random.chance(0.5) ? 0 : random.integer(-8, 8) * 0x1p-24;
    const double z = as_float((random.chance(0.5) ? radius : -radius) * (1 + offset));
    const Vec3d across = random.log_uniform(0.1, 10) * random.at_tilt(kHalfPi);
    return {{{across.x, across.y, z}, Kind::sphere, radius}};
}

Light whole(RandomInput& random) {
    const double half = random.log_uniform(1e-6, 1.56);
    return {described(random, random.uniform(0, kHalfPi - half), half)};
}

Light near_overhead(RandomInput& random) {
    const double half = random.log_uniform(1e-6, 1.56);
    Light light{described(random, random.log_uniform(1e-12, 0.01), half)};
    if (random.chance(0.3)) {
        light.input.axis.x = light.input.axis.y = 0;
    }
    return light;
}

/// The sphere's surface passes through the shading point, or all but; the directions have rational lengths.
/// Straight below, such a sphere is hidden: see test_cap_limits.cpp.
Light contact(RandomInput& random) {
    constexpr auto kTriples = std::to_array<std::array<double, 4>>(
        {{2, 3, 6, 7}, {1, 4, 8, 9}, {4, 4, 7, 9}, {0, 3, 4, 5}, {0, 0, 1, 1}, {2, 6, 9, 11}});
    const std::array<double, 4>& triple = kTriples[static_cast<std::size_t>(random.integer(0, 5))];
    const int shift = random.integer(0, 2);
    Vec3d center;
    for (int i = 0; i < 3; ++i) {
        center[i] = std::copysign(triple[static_cast<std::size_t>((i + shift) % 3)], random.uniform(-1, 1));
    }
    const double near = random.chance(0.5) ? 1 : 1 - random.log_uniform(1e-7, 1e-2);
    if (center.x == 0 && center.y == 0) {
        center.z = std::abs(center.z);
    }
    return {{center, Kind::sphere, triple[3] * near}};
}

Light wide(RandomInput& random) {
    const double half = random.uniform(kHalfPi, 3.13);
    const double highest = std::min(std::numbers::pi, kHalfPi + 0.8 * half);
    return {described(random, random.chance(0.1) ? 0.0 : random.uniform(0, highest), half)};
}

Light unclipped(RandomInput& random) {
    Light light = random.chance(0.2) ? wide(random) : whole(random);
    light.input.axis = glm::length(light.input.axis) * random.direction();
    light.clip = false;
    return light;
}

CapInput rounded_to_float(const CapInput& input) {
    CapInput rounded{as_float(input.axis), input.kind, as_float(input.size)};
    if (input.kind == Kind::sphere && rounded.size > glm::length(rounded.axis)) {
        rounded.size = as_float(glm::length(rounded.axis) * kNextToOne);
    }
    return rounded;
}

template <class T>
std::vector<T> coefficients(const CapInput& input, int order, bool clip) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const Vec3<T> axis(input.axis);
    const auto size = static_cast<T>(input.size);
    if (input.kind == Kind::sphere) {
        sphere_coefficients<T>(std::span(&axis, 1), std::span(&size, 1), order, clip, result);
    } else if (input.kind == Kind::angle) {
        cap_coefficients<T>(std::span(&axis, 1), std::span(&size, 1), order, clip, result);
    } else {
        const SphericalCap circle = cap_of_facing_disk(input.axis, input.size);
        cap_coefficients<T>({&circle, 1}, order, clip, result);
    }
    return result;
}

/// One class of lights with what is asked of it.
struct Class {
    const char* name;
    Light (*draw)(RandomInput&);
    Relative relative64, relative32;
    double bound64;
    bool sliver;  ///< float32 answers for 1e-4 of the whole cap at every order
    int share;    ///< of the sample, in hundredths
};

constexpr auto kClasses = std::to_array<Class>({
    {"clipped", clipped, Relative::to_own, Relative::to_own, 1e-12, false, 30},
    {"barely clipped", barely_clipped, Relative::to_own, Relative::to_own, 1e-12, false, 8},
    {"sliver", sliver, Relative::to_own, Relative::to_whole, 2e-11, true, 12},
    {"vanishing", vanishing, Relative::to_whole, Relative::to_whole, 1e-12, true, 4},
    {"centred on the horizon", centered_on_horizon, Relative::to_own, Relative::to_own, 1e-12, false, 8},
    {"tangent", tangent, Relative::to_whole, Relative::to_whole, 1e-12, false, 6},
    {"whole", whole, Relative::to_own, Relative::to_own, 1e-12, false, 8},
    {"near overhead", near_overhead, Relative::to_own, Relative::to_own, 1e-12, false, 6},
    {"contact", contact, Relative::to_own, Relative::to_own, 1e-12, false, 6},
    {"wider than a hemisphere", wide, Relative::to_own, Relative::to_own, 1e-12, false, 6},
    {"unclipped", unclipped, Relative::to_own, Relative::to_own, 1e-12, false, 6},
});

double bound32(int order, bool sliver) {
    if (sliver || order <= 16) {
        return 1e-4;
    }
    return order <= 33 ? 5e-4 : 2e-3;
}

template <class T>
double relative_error(const Light& light, const truth::Coefficients& reference, int order, Relative relative) {
    const double largest =
        truth::largest_error(reference, order, coefficients<T>(light.input, order, light.clip).data());
    const double scale = relative == Relative::to_own ? reference.high[0] : truth::cap(light.input, 1, false).high[0];
    return largest == 0 ? 0 : largest / scale;  // hidden lights have no coefficients at all
}

std::string describe(const Light& light) {
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(), "axis %.17g %.17g %.17g, size %.17g, kind %d, clip %d", light.input.axis.x,
                  light.input.axis.y, light.input.axis.z, light.input.size, static_cast<int>(light.input.kind),
                  static_cast<int>(light.clip));
    return text.data();
}

/// `count` lights of one class at every order of `orders`, the last of which is the highest.
void compare_class(const Class& kind, std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
    RandomInput random(seed);
    std::vector<Light> lights64(count);
    std::vector<Light> lights32(count);
    for (std::size_t i = 0; i < count; ++i) {
        lights64[i] = kind.draw(random);
        lights32[i] = kind.draw(random);
        lights32[i].input = rounded_to_float(lights32[i].input);
    }
    const std::vector<BothErrors> errors = errors_by_order(kind.name, count, orders, [&](std::size_t i) {
        return [&kind, &light64 = lights64[i], &light32 = lights32[i],
                reference64 = truth::cap(lights64[i].input, orders.back(), lights64[i].clip),
                reference32 = truth::cap(lights32[i].input, orders.back(), lights32[i].clip)](int order) {
            return std::array{relative_error<double>(light64, reference64, order, kind.relative64),
                              relative_error<float>(light32, reference32, order, kind.relative32)};
        };
    });
    for (std::size_t k = 0; k < orders.size(); ++k) {
        const auto& [float64, float32] = errors[k];
        EXPECT_LE(float64.largest(), kind.bound64) << kind.name << ": " << describe(lights64[float64.worst()]);
        EXPECT_LE(float32.largest(), bound32(orders[k], kind.sliver))
            << kind.name << ": " << describe(lights32[float32.worst()]);
    }
}

void compare(std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
    for (const Class& kind : kClasses) {
        compare_class(kind, count * static_cast<std::size_t>(kind.share) / 100, orders, seed++);
    }
}

const std::size_t kMore = testing::all_tests() ? 20 : 1;

TEST(Cap, AgreesWithReferenceUpToOrder16) {
    compare(800 * kMore, {1, 2, 8, 16}, 100);
}
TEST(Cap, AgreesWithReferenceAtOrder33) {
    compare(160 * kMore, {33}, 200);
}
TEST(Cap, AgreesWithReferenceAtOrder64) {
    compare(60 * kMore, {64}, 300);
}

}  // namespace
}  // namespace shlight
