// SPDX-License-Identifier: MIT
//
// Polygons against the 113-bit reference. Errors are the largest over all coefficients of a light, relative to its
// L_00.
#include "shlight/polygon.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "error_record.h"
#include "quad_truth.h"
#include "random_polygon.h"

namespace shlight {
namespace {

using testing::as_float;
using testing::ErrorRecord;
using testing::RandomInput;
using testing::Vertices;

template <class T>
std::vector<T> coefficients(const Vertices& vertices, int order, bool clip,
                            PolygonMethod method = PolygonMethod::automatic) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const std::vector<Vec3<T>> rounded(vertices.begin(), vertices.end());
    polygon_coefficients<T>(rounded, static_cast<int>(vertices.size()), order, clip, std::span<T>(result), method);
    return result;
}

Vertices rounded_to_float(Vertices vertices) {
    for (Vec3d& v : vertices) {
        v = as_float(v);
    }
    return vertices;
}

std::string describe(const Vertices& vertices, bool clip) {
    std::string text = clip ? "clipped" : "unclipped";
    for (const Vec3d& v : vertices) {
        std::array<char, 100> vertex{};
        std::snprintf(vertex.data(), vertex.size(), " {%.17g, %.17g, %.17g}", v.x, v.y, v.z);
        text += vertex.data();
    }
    return text;
}

/// 0 for lights that are not seen at all.
template <class T>
double relative_error(const Vertices& vertices, int order, bool clip, const truth::Coefficients& reference) {
    const double largest = truth::largest_error(reference, order, coefficients<T>(vertices, order, clip).data());
    return largest == 0 ? 0 : largest / reference.high[0];
}

struct Class {
    const char* name;
    Vertices (*draw)(RandomInput&);
};

constexpr auto kClasses = std::to_array<Class>({
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
void compare_class(const Class& kind, std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
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
    std::vector<ErrorRecord> errors64(orders.size(), ErrorRecord(count));
    std::vector<ErrorRecord> errors32(orders.size(), ErrorRecord(count));
    testing::on_two_threads(count, [&](std::size_t i) {
        const bool clip = i % 4 != 0;
        const truth::Coefficients reference64 = truth::polygon(polygons64[i], orders.back(), clip);
        const truth::Coefficients reference32 = truth::polygon(polygons32[i], orders.back(), clip);
        for (std::size_t k = 0; k < orders.size(); ++k) {
            errors64[k][i] = relative_error<double>(polygons64[i], orders[k], clip, reference64);
            errors32[k][i] = relative_error<float>(polygons32[i], orders[k], clip, reference32);
        }
    });
    for (std::size_t k = 0; k < orders.size(); ++k) {
        const std::string name = std::string(kind.name) + ", n = " + std::to_string(orders[k]);
        errors64[k].publish(name + ", float64");
        errors32[k].publish(name + ", float32");
        const std::size_t worst64 = errors64[k].worst();
        const std::size_t worst32 = errors32[k].worst();
        EXPECT_LE(errors64[k].largest(), 1e-10) << name << ": " << describe(polygons64[worst64], worst64 % 4 != 0);
        EXPECT_LE(errors32[k].largest(), 1e-3) << name << ": " << describe(polygons32[worst32], worst32 % 4 != 0);
        EXPECT_LE(errors32[k].median(), 1e-5) << name;
    }
}

void compare(std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
    for (const Class& kind : kClasses) {
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
