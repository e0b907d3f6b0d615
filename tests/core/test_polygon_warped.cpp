// SPDX-License-Identifier: MIT
//
// Polygons under a warp against the 113-bit reference, which maps points and knows no circles.
#include <gtest/gtest.h>

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "error_record.h"
#include "polygons/polygon_shading.h"
#include "quad_polygon.h"
#include "random_polygon.h"
#include "shlight/polygon.h"
#include "shlight/shading.h"

namespace shlight {
namespace {

using testing::ErrorRecord;
using testing::PolygonClass;
using testing::RandomInput;
using testing::Vertices;
using truth::WarpInput;

constexpr double kSphere = 4 * std::numbers::pi;

template <class T>
std::vector<T> warped_coefficients(const Vertices& vertices, const WarpInput& warp, int order) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const std::vector<Vec3<T>> rounded(vertices.begin(), vertices.end());
    warped_polygon_coefficients<T>(rounded, Warp(warp.tilt, warp.narrowness), order, result.data());
    return result;
}

struct Input {
    Vertices vertices;
    WarpInput warp;
};

std::string describe(const Input& input) {
    std::array<char, 100> text{};
    std::snprintf(text.data(), text.size(), "tilt %.17g, narrowness %.17g", input.warp.tilt, input.warp.narrowness);
    std::string result = text.data();
    for (const Vec3d& v : input.vertices) {
        std::snprintf(text.data(), text.size(), " {%.17g, %.17g, %.17g}", v.x, v.y, v.z);
        result += text.data();
    }
    return result;
}

/// Of a warp that a lobe may have, or of one with its axis at the polygon.
WarpInput random_warp(RandomInput& random, const Vertices& vertices) {
    WarpInput warp{random.uniform(-1.5, 1.5), random.chance(0.1) ? 1 : random.log_uniform(1e-3, 1)};
    if (random.chance(0.3)) {
        Vec3d middle(0);
        for (const Vec3d& v : vertices) {
            middle += v;
        }
        warp.tilt = std::clamp(std::atan2(-middle.x, std::abs(middle.z)), -1.5, 1.5);
    }
    return warp;
}

/// Vertices that float holds exactly, so that one reference serves both precisions.
Input random_input(RandomInput& random, Vertices (*draw)(RandomInput&)) {
    Input input{draw(random), {}};
    std::transform(input.vertices.begin(), input.vertices.end(), input.vertices.begin(),
                   [](const Vec3d& v) { return testing::as_float(v); });
    if (random.chance(0.5)) {
        std::reverse(input.vertices.begin(), input.vertices.end());
    }
    input.warp = random_warp(random, input.vertices);
    return input;
}

/// The plane y = 0 cuts it, so that the axis of a warp can lie inside.
Vertices around_the_mirror_plane(RandomInput& random) {
    const Vec3d center = random.log_uniform(0.3, 3) * testing::seen_direction(random) * Vec3d(1, 0.05, 1);
    const double half = random.log_uniform(0.03, 3);
    return testing::star(random, center, testing::Plane(random, center + 0.3 * random.direction()),
                         random.integer(3, 6), 0.6, half, half);
}

constexpr auto kClasses = std::to_array<PolygonClass>({
    {"plain", testing::plain},
    {"around the mirror plane", around_the_mirror_plane},
    {"concave", testing::concave},
    {"small", testing::small},
    {"large", testing::large},
    {"near contact", testing::near_contact},
    {"thin", testing::thin},
    {"nearly edge-on", testing::nearly_edge_on},
    {"edge on the horizon", testing::on_horizon},
    {"deep", testing::deep},
    {"contact at an edge", testing::contact_at_an_edge},
});

template <class T>
double error_of(const Input& input, int order, const truth::Coefficients& reference) {
    const double scale = std::max(reference.high[0], 1e-3 * kSphere);
    return truth::largest_error(reference, order, warped_coefficients<T>(input.vertices, input.warp, order).data()) /
           scale;
}

void compare(std::size_t count, int order, std::uint64_t seed) {
    for (const PolygonClass& kind : kClasses) {
        RandomInput random(seed++);
        std::vector<Input> inputs(count);
        std::generate(inputs.begin(), inputs.end(), [&] { return random_input(random, kind.draw); });
        ErrorRecord errors64(count);
        ErrorRecord errors32(count);
        testing::on_two_threads(count, [&](std::size_t i) {
            const truth::Coefficients reference = truth::warped_polygon(inputs[i].vertices, inputs[i].warp, order);
            errors64[i] = error_of<double>(inputs[i], order, reference);
            errors32[i] = error_of<float>(inputs[i], order, reference);
        });
        const std::string name = std::string(kind.name) + ", n = " + std::to_string(order);
        errors64.publish(name + ", float64");
        errors32.publish(name + ", float32");
        // A direction's rounding is stretched up to 2000 times by the warp, and long double's up to 10⁷ times by
        // contact; both count up to 300 times where the image is small.
        EXPECT_LE(errors64.largest(), 1e-10) << name << ": " << describe(inputs[errors64.worst()]);
        // Only the result is rounded to float, except where there is no warp and the polygon is wide.
        EXPECT_LE(errors32.largest(), 5e-6) << name << ": " << describe(inputs[errors32.worst()]);
    }
}

const std::size_t kMore = testing::all_tests() ? 40 : 1;

TEST(PolygonWarped, AgreesWithReferenceAtOrder1) {
    compare(30 * kMore, 1, 700);
}
TEST(PolygonWarped, AgreesWithReferenceAtOrder16) {
    compare(30 * kMore, 16, 720);
}
TEST(PolygonWarped, AgreesWithReferenceAtOrder32) {
    compare(8 * kMore, 32, 740);
}

/// The reference against product cubature over the polygon itself, and against more nodes.
TEST(PolygonWarped, ReferenceIsRight) {
    RandomInput random(760);
    ErrorRecord methods(20);
    ErrorRecord resolutions(20);
    for (std::size_t i = 0; i < 20; ++i) {
        const Vec3d center = testing::seen_direction(random);
        const testing::Plane plane(random, center + 0.3 * random.direction());
        const Vertices vertices = testing::star(random, center, plane, random.integer(3, 5), 0.6, 0.2, 0.2);
        const WarpInput warp{random.uniform(-1.5, 1.5), random.uniform(0.3, 1)};
        const truth::Coefficients reference = truth::warped_polygon(vertices, warp, 10);
        const auto difference = [&](const truth::Coefficients& other) {
            double largest = 0;
            for (std::size_t k = 0; k < 100; ++k) {
                const double d = (other.high[k] - reference.high[k]) + (other.low[k] - reference.low[k]);
                largest = std::abs(d) <= largest ? largest : std::abs(d);
            }
            return largest;
        };
        methods[i] = difference(truth::warped_polygon_by_cubature(vertices, warp, 10, 40));
        resolutions[i] = difference(truth::warped_polygon(vertices, warp, 10, 8));
    }
    methods.publish("two methods");
    resolutions.publish("two resolutions");
    EXPECT_LE(methods.largest(), 1e-14);
    EXPECT_LE(resolutions.largest(), 1e-20);
}

template <class T>
class PolygonWarpedLimits : public ::testing::Test {
  protected:
    const double tolerance_ = sizeof(T) == 8 ? 1e-11 : 2e-5;
};
using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(PolygonWarpedLimits, Precisions);

/// shade_polygon is the dot product of what the other function gives, for one lobe after the other.
TYPED_TEST(PolygonWarpedLimits, ShadingIsTheDotProduct) {
    using T = TypeParam;
    RandomInput random(761);
    for (int i = 0; i < 100; ++i) {
        const Input input = random_input(random, kClasses.at(static_cast<std::size_t>(i) % kClasses.size()).draw);
        const Warp warp(input.warp.tilt, input.warp.narrowness);
        const int order = random.integer(1, 20);
        std::vector<T> lobe(cosine_count(order));
        std::generate(lobe.begin(), lobe.end(), [&] { return static_cast<T>(random.uniform(-1, 1)); });
        const std::vector<T> light = warped_coefficients<T>(input.vertices, input.warp, order);
        const double expected = shade_cosine(light.data(), lobe.data(), order);
        const std::vector<Vec3<T>> vertices(input.vertices.begin(), input.vertices.end());
        EXPECT_NEAR(shade_polygon<T>(vertices, warp, lobe.data(), order), expected, this->tolerance_)
            << describe(input);
        const std::vector<Vec3<Wider<T>>> exact(vertices.begin(), vertices.end());
        const SphericalPolygon<Wider<T>> prepared(exact, true);
        EXPECT_NEAR(shade_polygon<T>(prepared, warp, lobe.data(), order), expected, this->tolerance_);
        EXPECT_NEAR(static_cast<double>(PolygonRegion<Wider<T>>(prepared, warp).solid_angle()),
                    static_cast<double>(light[0]) * std::sqrt(kSphere), this->tolerance_);
    }
}

/// No warp, and a warp so weak that it hardly moves anything, must meet.
TYPED_TEST(PolygonWarpedLimits, NoWarpIsTheLimit) {
    using T = TypeParam;
    RandomInput random(762);
    for (int i = 0; i < 50; ++i) {
        const Input input = random_input(random, i % 2 == 0 ? testing::plain : testing::concave);
        const std::vector<Vec3<T>> vertices(input.vertices.begin(), input.vertices.end());
        std::vector<T> expected(144);
        polygon_coefficients<T>(vertices, 12, true, expected.data());
        const std::vector<T> none = warped_coefficients<T>(input.vertices, {0.7, 1}, 12);
        const std::vector<T> weak = warped_coefficients<T>(input.vertices, {0.7, 1 - 1e-13}, 12);
        EXPECT_EQ(none, expected);
        for (std::size_t k = 0; k < expected.size(); ++k) {
            EXPECT_NEAR(weak[k], expected[k], this->tolerance_);
        }
    }
}

/// A ceiling that fills the hemisphere becomes the cap inside the warped horizon, nearly everything if the warp is
/// strong: L_00, the vector irradiance, and nothing that is not symmetric about z.
TYPED_TEST(PolygonWarpedLimits, HugeCeilingIsTheHorizonsCap) {
    using T = TypeParam;
    const double far = 1e9;
    for (const double narrowness : {0.9, 0.1, 1e-3}) {
        const Warp warp(0.3, narrowness);
        const std::vector<T> c = warped_coefficients<T>(
            {{-far, -far, 1}, {far, -far, 1}, {far, far, 1}, {-far, far, 1}}, {0.3, narrowness}, 6);
        const double z = warp.horizon_height();
        const double pi = std::numbers::pi;
        EXPECT_NEAR(c[0], std::sqrt(pi) * (1 - z), 2e-6);
        EXPECT_NEAR(c[2], std::sqrt(3 * pi) / 2 * (1 - z * z), 2e-6);
        EXPECT_NEAR(c[6], std::sqrt(5 * pi) / 2 * z * (1 - z * z), 2e-6);
        EXPECT_NEAR(c[3], 0, 2e-6);
        EXPECT_NEAR(c[coefficient_index(5, 3)], 0, 2e-6);
    }
}

TYPED_TEST(PolygonWarpedLimits, NoAreaGivesZeros) {
    using T = TypeParam;
    const std::vector<T> zeros(64, T(0));
    const WarpInput warp{0.5, 0.1};
    EXPECT_EQ(warped_coefficients<T>({{1, 0, 1}, {1, 0, 1}, {1, 0, 1}}, warp, 8), zeros);
    EXPECT_EQ(warped_coefficients<T>({{1, 0, 1}, {2, 0, 2}, {3, 0, 1}}, warp, 8), zeros);
    EXPECT_EQ(warped_coefficients<T>({{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}, warp, 8), zeros);
    EXPECT_EQ(warped_coefficients<T>({{-1, -1, -1}, {1, -1, -1}, {0, 2, -1}}, warp, 8), zeros);
}

/// Vertices that coincide, exactly or by rounding, and a vertex or an edge at the warp's axis.
TYPED_TEST(PolygonWarpedLimits, CoincidingVerticesDoNotMatter) {
    using T = TypeParam;
    RandomInput random(763);
    for (int i = 0; i < 200; ++i) {
        const WarpInput warp{random.uniform(-1.2, 1.2), random.log_uniform(1e-3, 1)};
        const Vec3d axis(-std::sin(warp.tilt), 0, std::cos(warp.tilt));
        const Vec3d center = axis + random.log_uniform(1e-3, 1) * random.direction();
        const testing::Plane plane(random, center);
        Vertices vertices = testing::star(random, center, plane, 4, 0.6, 0.5, 0.5);
        if (i % 3 == 0) {
            vertices = {axis, axis + 0.4 * plane.u, axis + 0.4 * plane.v};
        } else if (i % 3 == 1) {
            vertices = {axis - 0.5 * plane.u, axis + 0.5 * plane.u, axis + 0.4 * plane.v};
        }
        for (Vec3d& v : vertices) {
            v = testing::as_float(v);
        }
        const std::vector<T> expected = warped_coefficients<T>(vertices, warp, 12);
        const double step = i % 2 == 0 ? 0 : std::numeric_limits<T>::epsilon();
        vertices.insert(vertices.begin() + 1, vertices[1] + step * (vertices[0] - vertices[1]));
        const std::vector<T> doubled = warped_coefficients<T>(vertices, warp, 12);
        for (std::size_t k = 0; k < expected.size(); ++k) {
            EXPECT_NEAR(doubled[k], expected[k], 10 * this->tolerance_) << describe({vertices, warp});
        }
    }
}

/// A shading point closer and closer to an edge: the edge becomes half a turn, of which the ends say nothing about the
/// middle.
TYPED_TEST(PolygonWarpedLimits, TouchedEdgeIsHalfATurn) {
    using T = TypeParam;
    RandomInput random(765);
    for (int i = 0; i < 40; ++i) {
        // Few digits, so that the edge's ends are opposite to the last bit, until their lengths are divided out.
        const Vec3d along = glm::round(random.at_tilt(std::numbers::pi / 2) * 1024.0) / 1024.0 * Vec3d(1, 1, 0);
        const Vec3d across(-along.y, along.x, random.uniform(0.3, 3));
        const WarpInput warp{random.uniform(-1, 1), random.log_uniform(0.1, 1)};
        const auto touching = [&](double height) {
            const Vec3d above(0, 0, height);
            return warped_coefficients<T>({above - 0.8125 * along, above + along, above + along + across}, warp, 8);
        };
        const std::vector<T> near = touching(1e-8);
        const std::vector<T> nearer = touching(1e-12);
        for (std::size_t k = 0; k < near.size(); ++k) {
            // The edge moves by 1e-8, its image twenty times that.
            EXPECT_NEAR(near[k], nearer[k], 2e-6);
        }
    }
}

TYPED_TEST(PolygonWarpedLimits, EverythingIsFinite) {
    using T = TypeParam;
    RandomInput random(764);
    for (int i = 0; i < 2000; ++i) {
        Input input = random_input(
            random, i % 12 == 0 ? testing::tiny : kClasses.at(static_cast<std::size_t>(i) % kClasses.size()).draw);
        for (Vec3d& vertex : input.vertices) {
            for (int k = 0; k < 3; ++k) {
                vertex[k] = input.vertices.size() == 3 && random.chance(0.1) ? 0 : vertex[k];
            }
        }
        const std::vector<T> result = warped_coefficients<T>(input.vertices, input.warp, 16);
        EXPECT_TRUE(std::all_of(result.begin(), result.end(), [](T value) { return std::isfinite(value); }))
            << describe(input);
    }
}

}  // namespace
}  // namespace shlight
