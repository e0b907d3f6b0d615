// SPDX-License-Identifier: MIT
//
// Gauss points on the edges, the road that polygons take by default, against the 113-bit reference and against the
// recurrences along the same edges.
#include "polygons/polygon_edge_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "light_errors.h"
#include "polygons/polygon_boundary.h"
#include "polygons/polygon_low_bands.h"
#include "quad_truth.h"
#include "random_polygon.h"
#include "shlight/polygon.h"
#include "shlight/shading.h"

namespace shlight {
namespace {

using testing::BothErrors;
using testing::ErrorRecord;
using testing::errors_by_order;
using testing::PolygonClass;
using testing::RandomInput;
using testing::Vertices;

constexpr double kSphere = 4 * std::numbers::pi;

constexpr auto kClasses = std::to_array<PolygonClass>({
    {"plain", testing::plain},
    {"concave", testing::concave},
    {"small", testing::small},
    {"tiny", testing::tiny},
    {"large", testing::large},
    {"near contact", testing::near_contact},
    {"thin", testing::thin},
    {"edge on the horizon", testing::on_horizon},
    {"deep", testing::deep},
    {"contact at an edge", testing::contact_at_an_edge},
});

/// Vertices that float holds exactly, so that one reference serves both precisions.
Vertices draw(const PolygonClass& kind, RandomInput& random) {
    Vertices vertices = kind.draw(random);
    std::transform(vertices.begin(), vertices.end(), vertices.begin(),
                   [](const Vec3d& v) { return testing::as_float(v); });
    return vertices;
}

template <class T>
SphericalPolygon<Wider<T>> clipped(const Vertices& vertices) {
    const std::vector<Vec3<Wider<T>>> exact(vertices.begin(), vertices.end());
    return {exact, true};
}

/// Solid angle ÷ length of the outline.
template <class Real>
double width(const SphericalPolygon<Real>& polygon) {
    const PolygonRegion<Real> region(polygon, Warp());
    double outline = 0;
    for (const auto& arc : region.arcs()) {
        outline += static_cast<double>(arc.angle);
    }
    return static_cast<double>(polygon.solid_angle()) / outline;
}

/// Relative to L_00, in double times the width; 0 for lights that are not seen at all.
template <class T>
double width_error(const Vertices& vertices, int order, const truth::Coefficients& reference) {
    const SphericalPolygon<Wider<T>> polygon = clipped<T>(vertices);
    if (polygon.empty()) {
        return reference.high[0];
    }
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    edge_point_coefficients<T>(PolygonRegion<Wider<T>>(polygon, Warp()), order, result.data());
    const double largest = truth::largest_error(reference, order, result.data()) / reference.high[0];
    // The edges of a narrow polygon cancel.
    return sizeof(T) == 8 ? largest * std::min(1.0, width(polygon)) : largest;
}

void compare(std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
    for (const PolygonClass& kind : kClasses) {
        RandomInput random(seed++);
        std::vector<Vertices> polygons(count);
        std::generate(polygons.begin(), polygons.end(), [&] { return draw(kind, random); });
        const std::vector<BothErrors> errors = errors_by_order(kind.name, count, orders, [&](std::size_t i) {
            return [&vertices = polygons[i], reference = truth::polygon(polygons[i], orders.back(), true)](int order) {
                return std::array{width_error<double>(vertices, order, reference),
                                  width_error<float>(vertices, order, reference)};
            };
        });
        for (const auto& [float64, float32] : errors) {
            EXPECT_LE(float64.largest(), 1e-14) << kind.name;
            EXPECT_LE(float32.largest(), 5e-6) << kind.name;
        }
    }
}

const std::size_t kMore = testing::all_tests() ? 40 : 1;

TEST(PolygonEdgePoints, AgreeWithReferenceUpToOrder16) {
    compare(20 * kMore, {1, 2, 3, 4, 8, 16}, 800);
}
TEST(PolygonEdgePoints, AgreeWithReferenceAtOrder64) {
    compare(2 * kMore, {64}, 820);
}

template <class T>
class PolygonEdgePointsTyped : public ::testing::Test {};
using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(PolygonEdgePointsTyped, Precisions);

/// Largest difference between two roads ÷ L_00 or that of a thousandth of the sphere.
template <class T>
double difference(const PolygonRegion<Wider<T>>& region, int order) {
    std::vector<T> points(coefficient_count(order));
    std::vector<T> recurrences(coefficient_count(order));
    edge_point_coefficients<T>(region, order, points.data());
    boundary_coefficients<T>(region, order, recurrences.data());
    double largest = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const double error = std::abs(static_cast<double>(points[k]) - static_cast<double>(recurrences[k]));
        largest = error <= largest ? largest : error;
    }
    return largest / std::max(static_cast<double>(points[0]), 1e-3 * std::sqrt(kSphere));
}

/// Arcs of small circles, of lengths up to a whole circle.
TYPED_TEST(PolygonEdgePointsTyped, AgreeWithRecurrencesUnderWarps) {
    using T = TypeParam;
    RandomInput random(830);
    constexpr std::size_t kCount = 400;
    for (const int order : {5, 16, 40}) {
        ErrorRecord errors(kCount);
        for (std::size_t i = 0; i < kCount; ++i) {
            const Vertices vertices = draw(kClasses.at(i % kClasses.size()), random);
            const Warp warp(random.uniform(-1.5, 1.5), random.log_uniform(1e-3, 1));
            errors[i] = difference<T>(PolygonRegion<Wider<T>>(clipped<T>(vertices), warp), order);
        }
        errors.publish("warped, n = " + std::to_string(order) + (sizeof(T) == 8 ? ", float64" : ", float32"));
        EXPECT_LE(errors.largest(), sizeof(T) == 8 ? 1e-11 : 5e-7);
    }
}

/// A triangle whose outline is nearly all two arcs, or one, of more points than one rule has.
TYPED_TEST(PolygonEdgePointsTyped, LongArcsAreDivided) {
    using T = TypeParam;
    constexpr double kFar = 1e6;
    const Vertices ceiling = {{kFar, 0, 1}, {-kFar, kFar / 64, 1}, {-kFar, -kFar / 64, 1}};
    for (const double narrowness : {1.0, 0.8, 0.6, 0.4}) {
        for (const double tilt : {-0.7, 0.7}) {
            const PolygonRegion<Wider<T>> region(clipped<T>(ceiling), Warp(tilt, narrowness));
            EXPECT_GT(edge_points<T>(region, 64), 100) << narrowness;
            EXPECT_LE(difference<T>(region, 64), sizeof(T) == 8 ? 1e-13 : 2e-7) << narrowness << " " << tilt;
        }
    }
}

/// More points for more bands, longer edges and more digits.
TEST(PolygonEdgePoints, NumberOfPointsFollowsTheWaves) {
    const auto square = [](double half) {
        return Vertices{{-half, -half, 1}, {half, -half, 1}, {half, half, 1}, {-half, half, 1}};
    };
    const auto points = [&](double half, int order) {
        return edge_points<float>(PolygonRegion<double>(clipped<float>(square(half)), Warp()), order);
    };
    EXPECT_LE(points(0.01, 3), 4 * 3);
    EXPECT_LT(points(0.01, 16), points(0.5, 16));
    EXPECT_LT(points(0.5, 8), points(0.5, 16));
    // Two points a wavelength and a few more.
    EXPECT_GE(points(1, 64), 4 * 64 * 1.23 / std::numbers::pi);
    EXPECT_LE(points(1, 64), 4 * (64 * 1.23 / std::numbers::pi + 16));
    const PolygonRegion<long double> region(clipped<double>(square(0.5)), Warp());
    EXPECT_LT(points(0.5, 16), edge_points<double>(region, 16));
}

/// The sum of a lobe's products on either road.
TYPED_TEST(PolygonEdgePointsTyped, ShadingIsTheDotProduct) {
    using T = TypeParam;
    RandomInput random(840);
    for (int i = 0; i < 200; ++i) {
        const Vertices vertices = draw(kClasses.at(static_cast<std::size_t>(i) % 3), random);
        const Warp warp = i % 4 == 0 ? Warp() : Warp(random.uniform(-1.2, 1.2), random.log_uniform(0.05, 1));
        const PolygonRegion<Wider<T>> region(clipped<T>(vertices), warp);
        const int order = random.integer(1, 20);
        std::vector<T> lobe(static_cast<std::size_t>(cosine_count(order)));
        std::generate(lobe.begin(), lobe.end(), [&] { return static_cast<T>(random.uniform(-1, 1)); });
        std::vector<T> light(coefficient_count(order));
        boundary_coefficients<T>(region, order, light.data());
        const auto expected = static_cast<double>(shade_cosine(light.data(), lobe.data(), order));
        const double scale = std::max(static_cast<double>(light[0]), 1e-3 * std::sqrt(kSphere));
        const double tolerance = scale * (sizeof(T) == 8 ? 1e-10 : 2e-5);
        EXPECT_NEAR(shade_by_edge_points<T>(region, lobe.data(), order), expected, tolerance) << order;
        EXPECT_NEAR(shade_by_boundary<T>(region, lobe.data(), order), expected, tolerance) << order;
    }
}

/// Great circles around a wide region go through float, and lose little.
TEST(PolygonEdgePoints, FloatIsForWideRegions) {
    const auto in_float = [](double half, const Warp& warp) {
        const Vertices square = {{-half, -half, 1}, {half, -half, 1}, {half, half, 1}, {-half, half, 1}};
        return edge_points_in_float<float>(PolygonRegion<double>(clipped<float>(square), warp));
    };
    EXPECT_TRUE(in_float(0.5, Warp()));
    EXPECT_FALSE(in_float(0.05, Warp()));
    EXPECT_FALSE(in_float(0.5, Warp(0.3, 0.5)));
}

/// Orders up to 4 need neither points nor recurrences.
TYPED_TEST(PolygonEdgePointsTyped, LowBandsHaveClosedForms) {
    using T = TypeParam;
    RandomInput random(850);
    constexpr std::size_t kCount = 200;
    ErrorRecord errors(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
        const Vertices vertices = draw(kClasses.at(i % kClasses.size()), random);
        const SphericalPolygon<Wider<T>> polygon = clipped<T>(vertices);
        if (polygon.solid_angle() < 1e-8 || width(polygon) < (sizeof(T) == 8 ? 2e-3 : 1e-6)) {
            continue;
        }
        const truth::Coefficients reference = truth::polygon(vertices, kLowOrder, true);
        const PolygonRegion<Wider<T>> region(polygon, Warp());
        for (int order = 1; order <= kLowOrder; ++order) {
            std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
            low_band_coefficients<T>(region, order, result.data());
            const double error = truth::largest_error(reference, order, result.data()) / reference.high[0];
            errors[i] = error <= errors[i] ? errors[i] : error;
        }
    }
    errors.publish(std::string("closed forms, ") + (sizeof(T) == 8 ? "float64" : "float32"));
    EXPECT_LE(errors.largest(), sizeof(T) == 8 ? 1e-13 : 3e-7);
}

TYPED_TEST(PolygonEdgePointsTyped, NothingIsZero) {
    using T = TypeParam;
    const PolygonRegion<Wider<T>> nothing(clipped<T>({{1, 0, 0}, {2, 1, -1}, {2, -1, -1}}), Warp());
    std::vector<T> result(64, std::numeric_limits<T>::quiet_NaN());
    edge_point_coefficients<T>(nothing, 8, result.data());
    EXPECT_EQ(result, std::vector<T>(64, T(0)));
    const std::vector<T> lobe(36, T(1));
    EXPECT_EQ(shade_by_edge_points<T>(nothing, lobe.data(), 8), T(0));
    EXPECT_EQ(edge_points<T>(nothing, 8), 0);
}

}  // namespace
}  // namespace shlight
