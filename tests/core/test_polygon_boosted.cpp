// SPDX-License-Identifier: MIT
//
// Polygons under a boost, as they are shaded, against the 113-bit reference, which maps points and knows no circles.
#include <gtest/gtest.h>

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "boosted_terms.h"
#include "error_record.h"
#include "quad_polygon.h"
#include "random_polygon.h"
#include "regions/polygon_kernels.h"
#include "shlight/boost.h"

namespace shlight {
namespace {

using testing::ErrorRecord;
using testing::PolygonClass;
using testing::RandomInput;
using testing::Vertices;
using truth::BoostInput;

constexpr double kSphere = 4 * std::numbers::pi;

auto shading_of(const Vertices& vertices) {
    return [&vertices](std::span<const std::uint32_t> lights, const LobeArrays& lobe,
                       std::span<const std::uint32_t> views, std::span<float> values) {
        shade_polygons(vertices, static_cast<int>(vertices.size()), lights, lobe, views, values);
    };
}

std::vector<float> boosted_terms(const Vertices& vertices, const BoostInput& boost, int order) {
    return testing::boosted_terms(boost, order, shading_of(vertices));
}

struct Input {
    Vertices vertices;
    BoostInput boost;
};

std::string describe(const Input& input) {
    std::array<char, 100> text{};
    std::snprintf(text.data(), text.size(), "tilt %.17g, narrowness %.17g", input.boost.tilt, input.boost.narrowness);
    std::string result = text.data();
    for (const Vec3d& v : input.vertices) {
        std::snprintf(text.data(), text.size(), " {%.17g, %.17g, %.17g}", v.x, v.y, v.z);
        result += text.data();
    }
    return result;
}

/// A boost that a lobe may have, or one with its axis in the polygon, on an edge, or at a vertex in the mirror plane.
BoostInput random_boost(RandomInput& random, const Vertices& vertices) {
    BoostInput boost{random.uniform(-1.5, 1.5), random.log_uniform(1e-3, 1)};
    if (random.chance(0.2)) {
        boost.narrowness = random.chance(0.5) ? 1 : 1 - 1e-13;
    }
    if (random.chance(0.3)) {
        Vec3d at = vertices[0] + (vertices[0].y == 0 ? Vec3d(0) : vertices[1]);
        if (at.y != 0) {
            at = std::accumulate(vertices.begin(), vertices.end(), Vec3d(0));
        }
        boost.tilt = std::clamp(std::atan2(-at.x, std::abs(at.z)), -1.5, 1.5);
    }
    return boost;
}

/// Vertices that float holds exactly, so that one reference serves both precisions.
Input random_input(RandomInput& random, Vertices (*draw)(RandomInput&)) {
    Input input{draw(random), {}};
    std::transform(input.vertices.begin(), input.vertices.end(), input.vertices.begin(),
                   [](const Vec3d& v) { return testing::as_float(v); });
    if (random.chance(0.5)) {
        std::reverse(input.vertices.begin(), input.vertices.end());
    }
    input.boost = random_boost(random, input.vertices);
    if (random.chance(0.1)) {  // coinciding vertices, exactly or by rounding
        const Vec3d& at = input.vertices[1];
        const double step = random.chance(0.5) ? 0 : std::numeric_limits<float>::epsilon();
        input.vertices.insert(input.vertices.begin() + 1, testing::as_float(at + step * (input.vertices[0] - at)));
    }
    return input;
}

/// The plane y = 0 cuts it, so that the axis of a boost can lie inside.
Vertices around_the_mirror_plane(RandomInput& random) {
    const Vec3d center = random.log_uniform(0.3, 3) * testing::seen_direction(random) * Vec3d(1, 0.05, 1);
    const double half = random.log_uniform(0.03, 3);
    return testing::star(random, center, testing::Plane(random, center + 0.3 * random.direction()),
                         random.integer(3, 6), 0.6, half, half);
}

/// A triangle with a vertex or an edge's middle in the plane y = 0.
Vertices at_the_mirror_plane(RandomInput& random) {
    Vertices vertices(3, testing::seen_direction(random));
    vertices[1] += 0.7 * random.direction();
    vertices[2] += 0.7 * random.direction();
    vertices[0].y = random.chance(0.5) ? 0 : -vertices[1].y;
    return vertices;
}

constexpr auto kClasses = std::to_array<PolygonClass>({
    {"plain", testing::plain},
    {"around the mirror plane", around_the_mirror_plane},
    {"at the mirror plane", at_the_mirror_plane},
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

double error_of(const Input& input, int order, const truth::Coefficients& reference) {
    return testing::largest_error(reference, order, boosted_terms(input.vertices, input.boost, order)) /
           std::max(reference.high[0], 1e-3 * kSphere);
}

void compare(std::size_t count, int order, std::uint64_t seed) {
    for (const PolygonClass& kind : kClasses) {
        RandomInput random(seed++);
        std::vector<Input> inputs(count);
        std::generate(inputs.begin(), inputs.end(), [&] { return random_input(random, kind.draw); });
        ErrorRecord errors(count);
        testing::on_two_threads(count, [&](std::size_t i) {
            errors[i] = error_of(inputs[i], order, truth::boosted_polygon(inputs[i].vertices, inputs[i].boost, order));
        });
        const std::string name = std::string(kind.name) + ", n = " + std::to_string(order);
        errors.publish(name);
        EXPECT_LE(errors.largest(), 1e-5) << name << ": " << describe(inputs[errors.worst()]);
    }
}

const std::size_t kMore = testing::all_tests() ? 16 : 1;

TEST(PolygonBoosted, AgreesWithReferenceAtOrder1) {
    compare(15 * kMore, 1, 700);
}
TEST(PolygonBoosted, AgreesWithReferenceAtOrder16) {
    compare(15 * kMore, 16, 720);
}
TEST(PolygonBoosted, AgreesWithReferenceAtOrder32) {
    compare(4 * kMore, 32, 740);
}

/// The reference against product cubature over the polygon itself, and against more nodes.
TEST(PolygonBoosted, ReferenceIsRight) {
    RandomInput random(760);
    ErrorRecord methods(20);
    ErrorRecord resolutions(20);
    for (std::size_t i = 0; i < 20; ++i) {
        const Vec3d center = testing::seen_direction(random);
        const testing::Plane plane(random, center + 0.3 * random.direction());
        const Vertices vertices = testing::star(random, center, plane, random.integer(3, 5), 0.6, 0.2, 0.2);
        const BoostInput boost{random.uniform(-1.5, 1.5), random.uniform(0.3, 1)};
        const truth::Coefficients reference = truth::boosted_polygon(vertices, boost, 10);
        const auto difference = [&](const truth::Coefficients& other) {
            double largest = 0;
            for (std::size_t k = 0; k < 100; ++k) {
                const double d = (other.high[k] - reference.high[k]) + (other.low[k] - reference.low[k]);
                largest = std::abs(d) <= largest ? largest : std::abs(d);
            }
            return largest;
        };
        methods[i] = difference(truth::boosted_polygon_by_cubature(vertices, boost, 10, 40));
        resolutions[i] = difference(truth::boosted_polygon(vertices, boost, 10, 8));
    }
    methods.publish("two methods");
    resolutions.publish("two resolutions");
    EXPECT_LE(methods.largest(), 1e-14);
    EXPECT_LE(resolutions.largest(), 1e-20);
}

constexpr double kTolerance = 2e-5;

/// One lobe of many terms, or many of one.
TEST(PolygonBoostedLimits, ShadingIsTheDotProduct) {
    RandomInput random(761);
    for (int i = 0; i < 100; ++i) {
        const Input input = random_input(random, kClasses.at(static_cast<std::size_t>(i) % kClasses.size()).draw);
        const int order = random.integer(1, 20);
        std::vector<float> lobe(static_cast<std::size_t>(cosine_count(order)));
        std::generate(lobe.begin(), lobe.end(), [&] { return static_cast<float>(random.uniform(-1, 1)); });
        const std::vector<float> light = boosted_terms(input.vertices, input.boost, order);
        const double expected = std::inner_product(light.begin(), light.end(), lobe.begin(), 0.0);
        EXPECT_NEAR(testing::shaded(input.boost, lobe, order, shading_of(input.vertices))[0], expected, kTolerance)
            << describe(input);
    }
}

TEST(PolygonBoostedLimits, EverythingIsFinite) {
    RandomInput random(764);
    for (int i = 0; i < 2000; ++i) {
        Input input = random_input(
            random, i % 12 == 0 ? testing::tiny : kClasses.at(static_cast<std::size_t>(i) % kClasses.size()).draw);
        for (Vec3d& vertex : input.vertices) {
            for (int k = 0; k < 3; ++k) {
                vertex[k] = input.vertices.size() == 3 && random.chance(0.1) ? 0 : vertex[k];
            }
        }
        const std::vector<float> result = boosted_terms(input.vertices, input.boost, 16);
        EXPECT_TRUE(std::all_of(result.begin(), result.end(), [](float value) { return std::isfinite(value); }))
            << describe(input);
    }
}

}  // namespace
}  // namespace shlight
