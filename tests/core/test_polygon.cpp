// SPDX-License-Identifier: MIT
//
// Polygons against the 113-bit reference, without area, and bad input. Errors are the largest over all coefficients of
// a light, relative to its L_00.
#include "shlight/polygon.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "error_message.h"
#include "light_errors.h"
#include "quad_truth.h"
#include "random_polygon.h"

namespace shlight {
namespace {

using testing::as_float;
using testing::BothErrors;
using testing::describe;
using testing::errors_by_order;
using testing::Plane;
using testing::PolygonClass;
using testing::RandomInput;
using testing::relative_error;
using testing::Vertices;

template <class T>
std::vector<T> coefficients(const Vertices& vertices, int order, bool clip) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const std::vector<Vec3<T>> rounded(vertices.begin(), vertices.end());
    polygon_coefficients<T>(rounded, static_cast<int>(vertices.size()), order, clip, std::span<T>(result));
    return result;
}

Vertices rounded_to_float(Vertices vertices) {
    for (Vec3d& v : vertices) {
        v = as_float(v);
    }
    return vertices;
}

Vertices scaled(Vertices vertices, double scale) {
    std::for_each(vertices.begin(), vertices.end(), [&](Vec3d& v) { v *= scale; });
    return vertices;
}

constexpr auto kClasses = std::to_array<PolygonClass>({
    {"plain", testing::plain},
    {"concave", testing::concave},
    {"small", testing::small},
    {"tiny", testing::tiny},
    {"large", testing::large},
    {"near contact", testing::near_contact},
    {"thin", testing::thin},
    {"nearly edge-on", testing::nearly_edge_on},
    {"edge on the horizon", testing::on_horizon},
    {"deep", testing::deep},
    {"contact at an edge", testing::contact_at_an_edge},
});

/// One in four is not clipped; half are wound the other way; some are as large or small as floats allow.
void compare_class(const PolygonClass& kind, std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
    RandomInput random(seed);
    std::vector<Vertices> polygons64(count);
    std::vector<Vertices> polygons32(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double scale = i % 5 == 0 ? 0x1p-30 : i % 5 == 1 ? 0x1p+30 : 1;
        polygons64[i] = scaled(kind.draw(random), scale);
        polygons32[i] = scaled(rounded_to_float(kind.draw(random)), scale);
        if (random.chance(0.5)) {
            std::reverse(polygons64[i].begin(), polygons64[i].end());
            std::reverse(polygons32[i].begin(), polygons32[i].end());
        }
    }
    const auto clipped = [](std::size_t i) { return i % 4 != 0; };
    const std::vector<BothErrors> errors = errors_by_order(kind.name, count, orders, [&](std::size_t i) {
        const bool clip = clipped(i);
        return [&polygon64 = polygons64[i], &polygon32 = polygons32[i], clip,
                reference64 = truth::polygon(polygons64[i], orders.back(), clip),
                reference32 = truth::polygon(polygons32[i], orders.back(), clip)](int order) {
            return std::array{relative_error(reference64, order, coefficients<double>(polygon64, order, clip)),
                              relative_error(reference32, order, coefficients<float>(polygon32, order, clip))};
        };
    });
    for (const auto& [float64, float32] : errors) {
        const std::size_t worst64 = float64.worst();
        const std::size_t worst32 = float32.worst();
        EXPECT_LE(float64.largest(), 2e-11) << kind.name << ": " << describe(polygons64[worst64], clipped(worst64));
        EXPECT_LE(float32.largest(), 2e-5) << kind.name << ": " << describe(polygons32[worst32], clipped(worst32));
        EXPECT_LE(float32.median(), 1e-5) << kind.name;
    }
}

void compare(std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
    for (const PolygonClass& kind : kClasses) {
        compare_class(kind, count, orders, seed++);
    }
}

const std::size_t kMore = testing::all_tests() ? 16 : 1;

TEST(Polygon, AgreesWithReferenceUpToOrder16) {
    compare(25 * kMore, {1, 2, 3, 4, 8, 16}, 400);
}
TEST(Polygon, AgreesWithReferenceAtOrder33) {
    compare(4 * kMore, {33}, 500);
}
TEST(Polygon, AgreesWithReferenceAtOrder64) {
    compare(2 * kMore, {64}, 600);
}

template <class T>
void expect_nothing_seen() {
    const std::vector<T> zeros(64, T(0));
    for (const Vertices& vertices : {
             Vertices{{1, 0, 1}, {1, 0, 1}, {1, 0, 1}},         // a point
             {{1, 0, 1}, {2, 0, 1}, {3, 0, 1}},                 // a line
             {{1, 0, 1}, {2, 0, 2}, {3, 0, 1}},                 // edge-on
             {{-1, -1, 1}, {1, 1, 1}, {2, 2, 3}, {-2, -2, 3}},  // edge-on, above
             {{1, -1, 0}, {3, -1, 0}, {2, 2, 0}},               // in the horizon's plane
             {{2, -1, -1}, {2, 1, -1}, {2, 1, 0}, {2, -1, 0}},  // up to the horizon
             {{1, 0, 0}, {2, 1, -1}, {2, -1, -1}},              // touches from below
         }) {
        EXPECT_EQ(coefficients<T>(vertices, 8, true), zeros) << describe(vertices, true);
    }
}
TEST(Polygon, WithoutAreaItGivesZeros) {
    expect_nothing_seen<double>();
    expect_nothing_seen<float>();
}

template <class T>
void expect_finite_unless_refused(const Vertices& vertices, bool clip) {
    try {
        const std::vector<T> values = coefficients<T>(vertices, 16, clip);
        EXPECT_TRUE(std::ranges::all_of(values, [](T value) { return std::isfinite(value); }))
            << describe(vertices, clip);
    } catch (const std::invalid_argument& error) {
        EXPECT_STREQ(error.what(), "vertices: the shading point lies inside a polygon");
    }
}

/// Whatever their coordinates that are zero make of them.
TEST(Polygon, EverythingIsFinite) {
    RandomInput random(44);
    for (std::size_t i = 0; i < 2000; ++i) {
        Vertices vertices = kClasses.at(i % kClasses.size()).draw(random);
        for (Vec3d& vertex : vertices) {
            for (int k = 0; k < 3; ++k) {
                vertex[k] = vertices.size() == 3 && random.chance(0.1) ? 0 : vertex[k];
            }
        }
        expect_finite_unless_refused<double>(vertices, i % 3 != 0);
        expect_finite_unless_refused<float>(vertices, i % 3 != 0);
    }
}

/// In a plane through the shading point: refused where it is on the polygon, without light where it is aside, but for
/// what the rounding of the vertices, a size from it or half of that, lets be seen.
template <class T>
void expect_one_rule_in_plane(const Vertices& vertices, bool on_it, bool clip) {
    const std::string message = testing::error_message([&] {
        const T seen = coefficients<T>(vertices, 4, clip)[0];
        EXPECT_LE(std::abs(seen), 20 * std::numeric_limits<T>::epsilon()) << describe(vertices, clip);
    });
    EXPECT_EQ(message, on_it ? "vertices: the shading point lies inside a polygon" : "") << describe(vertices, clip);
}

/// A ring's sector of 200 … 340 degrees; the shading point in its middle is outside.
Vertices horseshoe(RandomInput& random, const Plane& plane) {
    const double opened = random.uniform(200, 340) * std::numbers::pi / 180;
    Vertices vertices;
    for (int i = 0; i < 14; ++i) {
        const double angle = opened * (i < 7 ? i : 13 - i) / 6;
        vertices.push_back((i < 7 ? 1.0 : 0.5) * (std::cos(angle) * plane.u + std::sin(angle) * plane.v));
    }
    return vertices;
}

/// Moved so that the shading point is inside, a vertex, on an edge, or aside.
Vertices moved_in_plane(RandomInput& random, const Plane& plane, int place) {
    Vertices vertices = testing::star(random, Vec3d(0), plane, random.integer(4, 7), 0.6, 1, 1);
    const std::array<Vec3d, 4> points = {0.1 * plane.u, vertices[1],
                                         glm::mix(vertices[0], vertices[1], random.uniform(0.1, 0.9)),
                                         1.5 * (random.chance(0.5) ? plane.u : plane.v)};
    for (Vec3d& vertex : vertices) {
        vertex -= points.at(static_cast<std::size_t>(place));
    }
    return vertices;
}

/// In planes that the numbers, turned, scaled and rounded, hold to a rounding or two.
TEST(Polygon, HasNoLightInThePlaneOfTheShadingPointAndIsRefusedOnIt) {
    RandomInput random(45);
    for (int i = 0; i < 4000; ++i) {
        const int place = i % 5;
        const Plane plane(random, random.direction());
        const Vertices vertices = scaled(place == 4 ? horseshoe(random, plane) : moved_in_plane(random, plane, place),
                                         random.log_uniform(1e-9, 1e9));
        expect_one_rule_in_plane<double>(vertices, place < 3, random.chance(0.5));
        expect_one_rule_in_plane<float>(vertices, place < 3, random.chance(0.5));
    }
}

/// Granted to be off the plane of the others, which is not seen edge-on.
TEST(Polygon, WithAVertexAtTheShadingPointIsRefused) {
    for (const double off : {0x1p-22, 0x1p-14}) {
        const Vertices vertices = {{2, 0, 2}, {2, 2, 2}, {off, 0, 0}, {0, 0, 0}};
        expect_one_rule_in_plane<double>(vertices, true, true);
        expect_one_rule_in_plane<float>(vertices, true, false);
    }
}

/// The corners are rounded to either side of the shading point, which would be in a region and out of it.
TEST(Polygon, ASliverAroundTheShadingPointCoversNoMoreThanHalf) {
    const Vertices sliver = {{-2.83561228e-08, 8.87846012e-16, 3.83362249e-08},
                             {-6.86540072e-13, 1.39320803e-12, -5.07812488e-13},
                             {2.83561281e-08, -4.22506848e-19, -3.8336232e-08},
                             {6.86538988e-13, -1.3932089e-12, 5.07811675e-13}};
    for (const bool clip : {false, true}) {
        const double half = std::sqrt(std::numbers::pi);  // L_00 of half the sphere
        EXPECT_LE(coefficients<float>(sliver, 3, clip)[0], half * (1 + 1e-6));
        EXPECT_GE(coefficients<float>(sliver, 3, clip)[0], 0);
    }
}

TEST(Polygon, HasItsLightInTheLeastUnitToo) {
    // A slit some vertices of which are equal, so that few of three tell on which side of their plane the point is.
    const Vertices slit = {{0.000423293008, -0.418381125, 0.908272803},  {0.000423293008, -0.166536734, 0.363686353},
                           {0.000423333753, 0.0853076503, -0.180900112}, {0.000423333753, 0.0853076503, -0.180900112},
                           {0.000423252233, 0.0853076726, -0.180900097}, {0.000423252233, 0.0853076726, -0.180900097}};
    Vertices tiny = slit;
    for (Vec3d& v : tiny) {
        v *= 0x1p-100;
    }
    EXPECT_GT(coefficients<float>(slit, 3, false)[0], 0);
    EXPECT_EQ(coefficients<float>(tiny, 3, false), coefficients<float>(slit, 3, false));
}

/// Triangles with coordinates of the least double.
TEST(Polygon, SubnormalCoordinatesKeepTheirSigns) {
    RandomInput random(46);
    for (int i = 0; i < 500; ++i) {
        Vertices least;
        for (int j = 0; j < 3; ++j) {
            Vec3d v = {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
            // Different ones, since a triangle in a plane of two axes is edge-on.
            const int axis = j < 2 ? 2 - j : random.integer(0, 2);
            const double sign = random.chance(0.5) ? 1 : -1;
            v[axis] = sign * std::numeric_limits<double>::denorm_min();
            least.push_back(v);
        }
        const bool clip = random.chance(0.5);
        const std::vector<double> alone = coefficients<double>(least, 4, clip);
        const auto reference = truth::polygon(least, 4, clip);
        EXPECT_LE(truth::largest_error(reference, 4, alone.data()), 1e-13 * reference.high[0] + 1e-16);
    }
}

TEST(Polygon, IsTheSameBesideOneOfAnotherUnit) {
    const double least = std::numeric_limits<double>::denorm_min();
    const Vertices alone = {{0.8941097554765467, 2.1653737927460583, -least},
                            {least, -least, 1.5095218971884485},
                            {1.147024050377036, -1.5055298397694976, 0.9857128550531784}};
    Vertices both = alone;
    both.insert(both.end(), {{1e-9, 0, 1e-9}, {0, 1e-9, 1e-9}, {-1e-9, 0, 1e-9}});
    std::vector<double> light(18);
    polygon_coefficients<double>(both, 3, 3, false, light);
    light.resize(9);
    EXPECT_EQ(light, coefficients<double>(alone, 3, false));
}

/// A room's floor, however little below a point on it.
TEST(Polygon, JustBelowTheHorizonIsUnseen) {
    for (const double below : {1e-12, 1e-9, 1e-6}) {
        const Vertices floor = {{-1, -1, -below}, {1, -1, -below}, {1, 1, -below}, {-1, 1, -below}};
        EXPECT_EQ(coefficients<double>(floor, 4, true), std::vector<double>(16, 0));
        EXPECT_EQ(coefficients<float>(floor, 4, true), std::vector<float>(16, 0));
    }
}

}  // namespace
}  // namespace shlight
