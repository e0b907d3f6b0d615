// SPDX-License-Identifier: MIT
//
// Polygons against the 113-bit reference. Errors are the largest over all coefficients of a light, relative to its
// L_00.
#include "shlight/polygon.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "light_errors.h"
#include "quad_truth.h"
#include "random_polygon.h"

namespace shlight {
namespace {

using testing::as_float;
using testing::BothErrors;
using testing::describe;
using testing::errors_by_order;
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

/// One in four is not clipped; half are wound the other way.
void compare_class(const PolygonClass& kind, std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
    RandomInput random(seed);
    std::vector<Vertices> polygons64(count);
    std::vector<Vertices> polygons32(count);
    for (std::size_t i = 0; i < count; ++i) {
        polygons64[i] = kind.draw(random);
        polygons32[i] = rounded_to_float(kind.draw(random));
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

const std::size_t kMore = testing::all_tests() ? 40 : 1;

TEST(Polygon, AgreesWithReferenceUpToOrder16) {
    compare(50 * kMore, {1, 2, 3, 4, 8, 16}, 400);
}
TEST(Polygon, AgreesWithReferenceAtOrder33) {
    compare(8 * kMore, {33}, 500);
}
TEST(Polygon, AgreesWithReferenceAtOrder64) {
    compare(3 * kMore, {64}, 600);
}

}  // namespace
}  // namespace shlight
