// SPDX-License-Identifier: MIT
//
// Polygons: symmetries that cost nothing to know, no area, and bad input.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "random_polygon.h"
#include "shlight/polygon.h"

namespace shlight {
namespace {

using testing::RandomInput;
using testing::Vertices;

template <class T>
std::vector<T> coefficients(const Vertices& vertices, int order, bool clip = true) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const std::vector<Vec3<T>> rounded(vertices.begin(), vertices.end());
    polygon_coefficients<T>(rounded, static_cast<int>(vertices.size()), order, clip, std::span<T>(result));
    return result;
}

/// Largest difference; NaN if there is one.
template <class T>
double difference(const std::vector<T>& a, const std::vector<T>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double error = std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
        largest = error <= largest ? largest : error;
    }
    return largest;
}

template <class T>
class PolygonLimits : public ::testing::Test {
  protected:
    const double tolerance_ = sizeof(T) == 8 ? 1e-11 : 2e-5;
};
using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(PolygonLimits, Precisions);

TYPED_TEST(PolygonLimits, WindingAndFirstVertexDoNotMatter) {
    using T = TypeParam;
    RandomInput random(41);
    for (int i = 0; i < 100; ++i) {
        Vertices vertices = i % 2 == 0 ? testing::plain(random) : testing::concave(random);
        const std::vector<T> expected = coefficients<T>(vertices, 10);
        EXPECT_GE(expected[0], 0);
        std::rotate(vertices.begin(), vertices.begin() + 1, vertices.end());
        EXPECT_LE(difference(expected, coefficients<T>(vertices, 10)), this->tolerance_);
        std::reverse(vertices.begin(), vertices.end());
        EXPECT_LE(difference(expected, coefficients<T>(vertices, 10)), this->tolerance_);
    }
}

/// Cutting a polygon in two must add up.
TYPED_TEST(PolygonLimits, PartsSumToTheWhole) {
    using T = TypeParam;
    RandomInput random(42);
    for (int i = 0; i < 100; ++i) {
        const Vec3d center = testing::seen_direction(random);
        const testing::Plane plane(random, center + 0.5 * random.direction());
        const double size = random.log_uniform(0.01, 3);
        const Vec3d u = size * plane.u;
        const Vec3d v = size * plane.v;
        const double cut = random.uniform(-0.9, 0.9);
        const std::vector<T> whole =
            coefficients<T>({center - u - v, center + u - v, center + u + v, center - u + v}, 12);
        std::vector<T> sum =
            coefficients<T>({center - u - v, center + cut * u - v, center - cut * u + v, center - u + v}, 12);
        const std::vector<T> rest =
            coefficients<T>({center + cut * u - v, center + u - v, center + u + v, center - cut * u + v}, 12);
        std::transform(sum.begin(), sum.end(), rest.begin(), sum.begin(), std::plus<>());
        EXPECT_LE(difference(whole, sum), this->tolerance_);
    }
}

TYPED_TEST(PolygonLimits, ScaleDoesNotMatter) {
    using T = TypeParam;
    RandomInput random(43);
    for (int i = 0; i < 40; ++i) {
        Vertices vertices = testing::plain(random);
        const std::vector<T> expected = coefficients<T>(vertices, 8);
        const double scale = i % 2 == 0 ? 0x1p-30 : 0x1p+30;
        for (Vec3d& vertex : vertices) {
            vertex *= scale;
        }
        EXPECT_EQ(expected, coefficients<T>(vertices, 8));
    }
}

/// Clipped by the horizon or by hand: the same light.
TYPED_TEST(PolygonLimits, ClippingKeepsWhatIsAbove) {
    using T = TypeParam;
    const Vertices door = {{2, -1, -1}, {2, 1, -1}, {2, 1, 1}, {2, -1, 1}};
    const Vertices upper_half = {{2, -1, 0}, {2, 1, 0}, {2, 1, 1}, {2, -1, 1}};
    EXPECT_LE(difference(coefficients<T>(door, 16), coefficients<T>(upper_half, 16, false)), this->tolerance_);
    const Vertices below = {{2, -1, -1}, {2, 1, -1}, {2, 1, 0}, {2, -1, 0}};
    EXPECT_EQ(coefficients<T>(below, 16), std::vector<T>(256, T(0)));
}

/// The octant x, y, z > 0: an eighth of the sphere, and z's mean over it is 1/2.
TYPED_TEST(PolygonLimits, OctantIsKnown) {
    using T = TypeParam;
    const double pi = std::numbers::pi;
    const std::vector<T> octant = coefficients<T>({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 3);
    const double first_band = std::sqrt(3 / (4 * pi)) * pi / 4;
    EXPECT_NEAR(octant[0], pi / 2 / std::sqrt(4 * pi), this->tolerance_);
    EXPECT_NEAR(octant[1], first_band, this->tolerance_);
    EXPECT_NEAR(octant[2], first_band, this->tolerance_);
    EXPECT_NEAR(octant[3], first_band, this->tolerance_);
    EXPECT_NEAR(octant[4], std::sqrt(15 / (4 * pi)) / 3, this->tolerance_);
    EXPECT_NEAR(octant[6], 0, this->tolerance_);
    EXPECT_NEAR(octant[8], 0, this->tolerance_);
}

TYPED_TEST(PolygonLimits, NoAreaGivesZeros) {
    using T = TypeParam;
    const std::vector<T> zeros(64, T(0));
    EXPECT_EQ(coefficients<T>({{1, 0, 1}, {1, 0, 1}, {1, 0, 1}}, 8), zeros);                 // a point
    EXPECT_EQ(coefficients<T>({{1, 0, 1}, {2, 0, 1}, {3, 0, 1}}, 8), zeros);                 // a line
    EXPECT_EQ(coefficients<T>({{1, 0, 1}, {2, 0, 2}, {3, 0, 1}}, 8), zeros);                 // edge-on
    EXPECT_EQ(coefficients<T>({{-1, -1, 1}, {1, 1, 1}, {2, 2, 3}, {-2, -2, 3}}, 8), zeros);  // edge-on, above
    EXPECT_EQ(coefficients<T>({{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}, 8), zeros);              // in the horizon's plane
    EXPECT_EQ(coefficients<T>({{1, 0, 0}, {2, 1, -1}, {2, -1, -1}}, 8), zeros);              // touches from below
}

/// A plane that fills the upper half of the sphere.
TYPED_TEST(PolygonLimits, HugeCeilingIsTheHemisphere) {
    using T = TypeParam;
    const double far = 1e7;
    const std::vector<T> ceiling = coefficients<T>({{-far, -far, 1}, {far, -far, 1}, {far, far, 1}, {-far, far, 1}}, 8);
    const double pi = std::numbers::pi;
    EXPECT_NEAR(ceiling[0], std::sqrt(pi), 1e-5);
    EXPECT_NEAR(ceiling[2], std::sqrt(3 * pi) / 2, 1e-5);
    EXPECT_NEAR(ceiling[6], 0, 1e-5);
    EXPECT_NEAR(ceiling[12], -std::sqrt(7 * pi) / 8, 1e-5);
}

TYPED_TEST(PolygonLimits, EverythingIsFinite) {
    using T = TypeParam;
    RandomInput random(44);
    using Draw = Vertices (*)(RandomInput&);
    const std::array<Draw, 8> kinds = {testing::plain,        testing::concave, testing::tiny,
                                       testing::near_contact, testing::thin,    testing::nearly_edge_on,
                                       testing::on_horizon,   testing::deep};
    for (int i = 0; i < 2000; ++i) {
        Vertices vertices = kinds[static_cast<std::size_t>(i % 8)](random);
        for (Vec3d& vertex : vertices) {
            for (int k = 0; k < 3; ++k) {
                vertex[k] = vertices.size() == 3 && random.chance(0.1) ? 0 : vertex[k];
            }
        }
        const std::vector<T> result = coefficients<T>(vertices, 16, i % 3 != 0);
        EXPECT_TRUE(std::all_of(result.begin(), result.end(), [](T value) { return std::isfinite(value); }));
    }
}

TYPED_TEST(PolygonLimits, RejectsBadInput) {
    using T = TypeParam;
    const auto names = [](const std::string& argument, const std::function<void()>& call) {
        std::string message = "accepted";
        try {
            call();
        } catch (const std::invalid_argument& error) {
            message = error.what();
        }
        EXPECT_NE(message.find(argument), std::string::npos) << argument << ": " << message;
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    const Vertices triangle = {{1, 0, 1}, {0, 1, 1}, {0, 0, 2}};
    names("vertices", [&] { coefficients<T>({{1, 0, 1}, {0, 1, 1}}, 4); });
    names("vertices", [&] { coefficients<T>({{1, 0, nan}, {0, 1, 1}, {0, 0, 1}}, 4); });
    names("vertices", [&] { coefficients<T>({{1, 0, 1}, {-inf, 1, 1}, {0, 0, 1}}, 4); });
    names("planar", [&] { coefficients<T>({{1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}, {1, -1, 1.5}}, 4); });
    for (const int order : {-1, 0, 65}) {
        names("order", [&] {
            const std::vector<Vec3<T>> vertices(triangle.begin(), triangle.end());
            std::vector<T> values(65 * 65);
            polygon_coefficients<T>(vertices, 3, order, true, std::span<T>(values));
        });
    }
    names("coefficients", [&] {
        const std::vector<Vec3<T>> vertices(triangle.begin(), triangle.end());
        std::vector<T> values(15);
        polygon_coefficients<T>(vertices, 3, 4, true, std::span<T>(values));
    });
}

}  // namespace
}  // namespace shlight
