// SPDX-License-Identifier: MIT
//
// Coefficients by quadrature against the 113-bit reference.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "error_record.h"
#include "light_errors.h"
#include "method_calls.h"
#include "quad_truth.h"
#include "random_input.h"
#include "random_polygon.h"

namespace shlight {
namespace {

using testing::across_horizon;
using testing::ErrorRecord;
using testing::of_cap;
using testing::of_polygon;
using testing::of_sphere;
using testing::on_two_threads;
using testing::PolygonClass;
using testing::RandomInput;
using testing::relative_error;
using testing::Vertices;
using Kind = truth::CapInput::Kind;

constexpr double kPi = std::numbers::pi;

/// Attainable relative error of sums of basis values. A light's preparation in double loses digits if the gap between
/// rim and horizon is 1e-7.
template <class T>
constexpr double kHeld = std::is_same_v<T, float> ? 1e-5 : 1e-12;
constexpr double kHeldNearTangency = 1e-8;

/// An input that a method sees in T, as the reference has to see it.
template <class T, class Value>
Value rounded(const Value& value) {
    if constexpr (std::is_same_v<T, float>) {
        return testing::as_float(value);
    } else {
        return value;
    }
}
template <class T>
const char* const kTypeName = std::is_same_v<T, float> ? "float" : "double";

struct SphereKind {
    const char* name;
    Vec3d (*axis)(RandomInput&, double half_angle);
    double smallest, largest;  // half angle
};

Vec3d anywhere(RandomInput& random, double) {
    return random.direction();
}
Vec3d near_tangency(RandomInput& random, double half_angle) {
    const double side = random.chance(0.5) ? 1 : -1;
    return random.at_tilt(kPi / 2 + side * half_angle * (1 - random.log_uniform(1e-7, 1e-2)));
}
Vec3d axis_near_horizon(RandomInput& random, double) {
    return random.at_tilt(kPi / 2 + random.uniform(-1, 1) * random.log_uniform(1e-9, 1e-2));
}

template <class T>
void check_caps(const SphereKind& kind) {
    constexpr std::size_t kCount = 16;
    ErrorRecord record(kCount);
    on_two_threads(kCount, [&](std::size_t i) {
        RandomInput random(i);
        const int order = i % 4 == 0 ? 16 : random.integer(1, 9);
        const auto half = rounded<T>(random.log_uniform(kind.smallest, kind.largest));
        const Vec3d axis = rounded<T>(kind.axis(random, half));
        const bool clip = i % 3 != 0;
        record[i] = relative_error(truth::cap({axis, Kind::angle, half}, order, clip), order,
                                   of_cap<T>("quadrature", axis, half, order, clip));
    });
    record.publish(std::string(kind.name) + " " + kTypeName<T>);
    EXPECT_LE(record.largest(), std::max(kHeld<T>, kind.axis == &near_tangency ? kHeldNearTangency : 0.0))
        << kind.name << " " << record.worst();
}

TEST(NumericalMethods, QuadratureOfCapsMatchesReference) {
    for (const SphereKind& kind : {SphereKind{"anywhere", &anywhere, 0.05, 1.5},
                                   {"across the horizon", &across_horizon, 0.05, 1.5},
                                   {"near tangency", &near_tangency, 0.05, 1.4},
                                   {"axis near the horizon", &axis_near_horizon, 0.05, 1.5},
                                   {"small", &across_horizon, 1e-5, 0.05},
                                   {"beyond a hemisphere", &anywhere, 1.6, 3.1}}) {
        check_caps<float>(kind);
        check_caps<double>(kind);
    }
}

TEST(NumericalMethods, QuadratureOfSpheresInContactMatchesReference) {
    for (const double gap : {0.0, 1e-9, 1e-3}) {
        const Vec3d center(0.36, 0.48, 0.8);  // of length 1
        const truth::Coefficients reference = truth::cap({center, Kind::sphere, 1 - gap}, 8, true);
        EXPECT_LE(relative_error(reference, 8, of_sphere<double>("quadrature", center, 1 - gap, 8, true)), 1e-12);
    }
    const std::vector<double> all = of_cap<double>("quadrature", {0, 0, 1}, kPi, 8, false);
    EXPECT_NEAR(all[0], 4 * kPi * 0.5 * std::numbers::inv_sqrtpi, 1e-13);
    EXPECT_LE(std::abs(*std::max_element(all.begin() + 1, all.end())), 1e-13);
}

template <class T>
void check_polygons(const PolygonClass& kind) {
    constexpr std::size_t kCount = 12;
    ErrorRecord record(kCount);
    on_two_threads(kCount, [&](std::size_t i) {
        RandomInput random(i);
        const int order = i % 4 == 0 ? 16 : random.integer(1, 9);
        Vertices vertices = kind.draw(random);
        for (Vec3d& v : vertices) {
            v = rounded<T>(v);
        }
        const bool clip = i % 3 != 0;
        record[i] = relative_error(truth::polygon(vertices, order, clip), order,
                                   of_polygon<T>("quadrature", vertices, order, clip));
    });
    record.publish(std::string(kind.name) + " polygons " + kTypeName<T>);
    EXPECT_LE(record.largest(), kHeld<T>) << kind.name << " " << record.worst();
}

TEST(NumericalMethods, QuadratureOfPolygonsMatchesReference) {
    for (const PolygonClass& kind : {PolygonClass{"plain", &testing::plain},
                                     {"concave", &testing::concave},
                                     {"small", &testing::small},
                                     {"large", &testing::large},
                                     {"near contact", &testing::near_contact},
                                     {"on the horizon", &testing::on_horizon}}) {
        check_polygons<float>(kind);
        check_polygons<double>(kind);
    }
}

TEST(NumericalMethods, QuadratureKeepsItsTolerance) {
    for (const double tolerance : {1e-2, 1e-4, 1e-8}) {
        ErrorRecord record(40);
        for (std::size_t i = 0; i < 40; ++i) {
            RandomInput random(i);
            const int order = random.integer(2, 12);
            const double half = random.uniform(0.05, 1.4);
            const Vec3d axis = across_horizon(random, half);
            const Vertices vertices = testing::plain(random);
            const bool polygon = i % 2 == 1;
            record[i] = relative_error(
                polygon ? truth::polygon(vertices, order, true) : truth::cap({axis, Kind::angle, half}, order, true),
                order,
                polygon ? of_polygon<double>("quadrature", vertices, order, true, {.tolerance = tolerance})
                        : of_cap<double>("quadrature", axis, half, order, true, {.tolerance = tolerance}));
        }
        record.publish("tolerance " + std::to_string(tolerance));
        EXPECT_LE(record.largest(), tolerance);
    }
}

}  // namespace
}  // namespace shlight
