// SPDX-License-Identifier: MIT
#include "lights/whole_rectangle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "random_input.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

using testing::RandomInput;

constexpr std::size_t kPoints = 4096;

/// Solid angle of a rectangle perpendicular to z with its middle above the origin, by one arctangent.
double solid_angle_above(double width, double depth, double height) {
    return 4 * std::atan(width * depth / (2 * height * std::sqrt(width * width + depth * depth + 4 * height * height)));
}

/// Such a rectangle, shining down; everything is turned and moved by the frame.
PolygonLight lamp_above(const ShadingFrame& frame, double width, double depth, double height) {
    std::vector<Vec3d> corners;
    for (const auto& [x, y] : {std::pair(-1, -1), std::pair(-1, 1), std::pair(1, 1), std::pair(1, -1)}) {
        corners.push_back(frame.origin + frame.to_world({x * width / 2, y * depth / 2, height}));
    }
    return make_polygon_light(corners, Rgb(1), false);
}

ShadingFrame random_frame(RandomInput& random, double scale) {
    return shading_frame(scale * random.direction(), random.direction(), random.direction());
}

/// A point of that rectangle, in the frame, and area · cos / distance² there.
struct Place {
    Vec3d at;
    double weight;
};

Place place_of(double width, double depth, double height, const glm::dvec2& point) {
    const Vec3d at((point.y - 0.5) * width, (point.x - 0.5) * depth, height);
    const double distance = glm::length(at);
    return {at, width * depth * height / (distance * distance * distance)};
}

struct Points {
    std::vector<float> u, v, x, y, z, weight;
};

Points points_of(const WholeRectangle& rectangle, const SobolSequence& sequence, std::uint32_t first) {
    const std::vector<float> empty(kPoints + kLightPointLanes);
    Points points = {empty, empty, empty, empty, empty, empty};
    draw_square_points(sequence, first, kPoints, points.u.data(), points.v.data());
    place_points(rectangle, points.u.data(), points.v.data(), kPoints,
                 {points.x.data(), points.y.data(), points.z.data(), points.weight.data()});
    return points;
}

TEST(WholeRectangle, PointsAreThoseOfTheSequenceAndWeighTheSolidAngle) {
    RandomInput random(3);
    for (const double scale : {1e-6, 1.0, 1e9}) {
        for (int i = 0; i < 20; ++i) {
            const double width = scale * random.uniform(0.1, 1);
            const double depth = scale * random.uniform(0.1, 1);
            const double height = scale * random.uniform(1, 3);
            const ShadingFrame frame = random_frame(random, scale);
            const std::optional<WholeRectangle> seen =
                WholeRectangle::see(Light(lamp_above(frame, width, depth, height)), frame, 0);
            ASSERT_TRUE(seen);
            const SobolSequence sequence(static_cast<std::uint32_t>(i));
            const Points points = points_of(*seen, sequence, 64);
            double sum = 0;
            for (std::uint32_t p = 0; p < kPoints; ++p) {
                const glm::dvec2 expected = sequence.point(64 + p);
                ASSERT_LE(std::abs(points.u[p] - expected.x), 0x1p-22);
                ASSERT_LE(std::abs(points.v[p] - expected.y), 0x1p-22);
                const Vec3d place = frame.to_local({points.x[p], points.y[p], points.z[p]});
                ASSERT_LE(std::abs(place.z - height), 1e-5 * height);
                ASSERT_LE(std::abs(place.x), width / 2 + 1e-5 * height);
                ASSERT_LE(std::abs(place.y), depth / 2 + 1e-5 * height);
                const Place one = place_of(width, depth, height, {points.u[p], points.v[p]});
                ASSERT_LE(glm::length(one.at - place), 1e-5 * height);
                ASSERT_LE(std::abs(one.weight - points.weight[p]), 1e-5 * one.weight);
                sum += points.weight[p];
            }
            // So many points of a smooth function; far less than by chance.
            const double truth = solid_angle_above(width, depth, height);
            EXPECT_LE(std::abs(sum / kPoints - truth), 1e-4 * truth);
        }
    }
}

/// Directions lead to points of its plane, within its edges and beyond, at any length, and backwards.
TEST(WholeRectangle, IsMetWhereItIs) {
    RandomInput random(4);
    for (const double scale : {1e-6, 1.0, 1e9}) {
        const ShadingFrame frame = random_frame(random, scale);
        const std::optional<WholeRectangle> seen =
            WholeRectangle::see(Light(lamp_above(frame, 0.8 * scale, 0.4 * scale, 2 * scale)), frame, 0);
        ASSERT_TRUE(seen);
        const std::vector<float> empty(kPoints + kLightPointLanes);
        Points points = {{}, {}, empty, empty, empty, empty};
        std::vector<glm::dvec2> targets;
        for (std::size_t i = 0; i < kPoints; ++i) {
            targets.emplace_back(random.uniform(-0.3, 1.3), random.uniform(-0.3, 1.3));
            const Place towards = place_of(0.8 * scale, 0.4 * scale, 2 * scale, targets[i]);
            const Vec3d direction = (i % 8 == 0 ? -1.0 : 1.0) * glm::normalize(towards.at);
            points.x[i] = static_cast<float>(direction.x);
            points.y[i] = static_cast<float>(direction.y);
            points.z[i] = static_cast<float>(direction.z);
        }
        meet_rectangle(*seen, frame, kPoints,
                       {points.x.data(), points.y.data(), points.z.data(), points.weight.data()});
        for (std::size_t i = 0; i < kPoints; ++i) {
            const auto [least, most] = std::minmax(targets[i].x, targets[i].y);
            if (std::min(std::abs(least), std::abs(most - 1)) < 1e-5) {
                continue;  // too near an edge for floats
            }
            const bool met = i % 8 != 0 && least > 0 && most < 1;
            const Place there = place_of(0.8 * scale, 0.4 * scale, 2 * scale, targets[i]);
            ASSERT_LE(std::abs(points.weight[i] - (met ? there.weight : 0)), 1e-5 * there.weight);
            const Vec3d way = frame.to_local({points.x[i], points.y[i], points.z[i]});
            ASSERT_TRUE(!met || glm::length(way - there.at) <= 1e-5 * glm::length(there.at));
        }
    }
}

TEST(WholeRectangle, OthersAreNotSeenAsSuch) {
    const ShadingFrame frame = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const auto sees = [&](const Light& light) { return WholeRectangle::see(light, frame, 0).has_value(); };
    const std::vector<Vec3d> corners = {{-1, -1, 3}, {-1, 1, 3}, {1, 1, 3}, {1, -1, 3}};
    EXPECT_TRUE(sees(make_polygon_light(corners, Rgb(1), false)));
    EXPECT_FALSE(sees(make_polygon_light({corners[3], corners[2], corners[1], corners[0]}, Rgb(1), false)))
        << "its dark side";
    EXPECT_TRUE(sees(make_polygon_light({corners[3], corners[2], corners[1], corners[0]}, Rgb(1), true)));
    EXPECT_FALSE(sees(make_polygon_light({corners[0], corners[1], corners[2]}, Rgb(1), false))) << "a triangle";
    LightTraits spread;
    spread.profile = make_spread_profile({0, 0, -1}, 1.0);
    EXPECT_FALSE(sees(make_polygon_light(corners, Rgb(1), false, spread))) << "not even";
    EXPECT_FALSE(sees(lamp_above(frame, 2, 2, 0.5))) << "much nearer in the middle";
    EXPECT_FALSE(sees(make_polygon_light({{4, -1, -0.1}, {4, -1, 1}, {4, 1, 1}, {4, 1, -0.1}}, Rgb(1), true)))
        << "partly below the horizon";
}

}  // namespace
}  // namespace shlight
