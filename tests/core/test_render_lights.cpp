// SPDX-License-Identifier: MIT
//
// Making lights: polygons of any simple shape, emissive faces, and what is turned down.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "random_input.h"
#include "shlight/light.h"
#include "shlight/mesh_light.h"

namespace shlight {
namespace {

using testing::RandomInput;

double triangulated_area(const PolygonLight& light) {
    double area = 0;
    for (const Triangle& t : light.triangles) {
        area += 0.5 * glm::dot(light.normal, glm::cross(light.vertices[t.y] - light.vertices[t.x],
                                                        light.vertices[t.z] - light.vertices[t.x]));
    }
    return area;
}

TEST(RenderLights, ConcavePolygonsAreTriangulatedOnce) {
    RandomInput random(3);
    for (int spikes = 3; spikes < 12; ++spikes) {
        // A star in a random plane: its area has a closed form, Σ ½ r_i r_{i+1} sin Δφ.
        const Vec3d x = random.direction();
        const Vec3d y = glm::normalize(glm::cross(x, random.direction()));
        std::vector<Vec3d> vertices;
        const int count = 2 * spikes;
        for (int i = 0; i < count; ++i) {
            const double angle = 2 * std::numbers::pi * i / count;
            vertices.push_back(Vec3d(5, 6, 7) + (i % 2 == 0 ? 1.0 : 0.3) * (std::cos(angle) * x + std::sin(angle) * y));
        }
        const double expected = count * 0.5 * 0.3 * std::sin(2 * std::numbers::pi / count);
        const PolygonLight light = make_polygon_light(vertices, Rgb(1), false);
        EXPECT_LE(std::abs(triangulated_area(light) - expected), 1e-12) << spikes;
        for (const Triangle& t : light.triangles) {
            EXPECT_GE(glm::dot(light.normal, glm::cross(light.vertices[t.y] - light.vertices[t.x],
                                                        light.vertices[t.z] - light.vertices[t.x])),
                      0);
        }
    }
}

TEST(RenderLights, RepeatedAndCollinearVerticesDoNoHarm) {
    const PolygonLight light = make_polygon_light(
        {{0, 0, 1}, {0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}, {0, 0, 1}}, Rgb(1), false);
    EXPECT_EQ(light.vertices.size(), 5U);
    EXPECT_LE(std::abs(triangulated_area(light) - 4), 1e-12);
}

TEST(RenderLights, TrianglesOfAQuadrilateralAreJoined) {
    const std::vector<Vec3d> vertices = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
    // Both diagonals, and each corner of the second triangle first.
    for (const std::vector<Triangle>& triangles :
         {std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}, std::vector<Triangle>{{0, 1, 2}, {2, 3, 0}},
          std::vector<Triangle>{{1, 2, 3}, {3, 0, 1}}, std::vector<Triangle>{{3, 0, 1}, {2, 3, 1}}}) {
        const std::vector<FaceOutline> outlines = merge_faces(vertices, triangles).value();
        ASSERT_EQ(outlines.size(), 1U);
        const PolygonLight light = make_polygon_light(outlines[0], Rgb(1), true);
        EXPECT_LE(std::abs(triangulated_area(light) - 2), 1e-12);
        EXPECT_LE(glm::length(light.normal - Vec3d(0, 0, 1)), 1e-12);
    }
}

TEST(RenderLights, OnlyWhatIsFlatIsJoined) {
    const auto parts = [](const std::vector<Vec3d>& vertices, const std::vector<Triangle>& triangles) {
        return merge_faces(vertices, triangles).value().size();
    };
    const std::vector<Vec3d> folded = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.01}, {0, 1, 0}};
    EXPECT_EQ(parts(folded, {{0, 1, 2}, {0, 2, 3}}), 2U);
    const std::vector<Vec3d> dart = {{0, 0, 0}, {2, 0, 0}, {0.4, 0.4, 0}, {0, 2, 0}};
    EXPECT_EQ(parts(dart, {{0, 1, 2}, {0, 2, 3}}), 1U);
    const std::vector<Vec3d> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    EXPECT_EQ(parts(square, {{0, 1, 2}, {0, 3, 2}}), 2U) << "opposite windings";
    EXPECT_EQ(parts(square, {{0, 1, 2}, {0, 2, 2}}), 1U) << "one without area";
    EXPECT_EQ(merge_faces(square, std::vector<Triangle>{{0, 1, 2}}, 2), std::nullopt) << "too many corners";
}

/// A square of n × n cells, without the cells that leave_out(row, column) names; each cell has vertices of its own.
std::pair<std::vector<Vec3d>, std::vector<Triangle>> cells(
    std::uint32_t n, const std::function<bool(std::uint32_t, std::uint32_t)>& leave_out) {
    std::pair<std::vector<Vec3d>, std::vector<Triangle>> mesh;
    for (std::uint32_t row = 0; row < n; ++row) {
        for (std::uint32_t column = 0; column < n; ++column) {
            const auto first = static_cast<std::uint32_t>(mesh.first.size());
            if (leave_out(row, column)) continue;
            for (const auto& [x, y] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
                mesh.first.emplace_back((column + x) / static_cast<double>(n), (row + y) / static_cast<double>(n), 0.1);
            }
            mesh.second.insert(mesh.second.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
        }
    }
    return mesh;
}

TEST(RenderLights, APartIsOneLightHoweverFinelyItIsDivided) {
    const auto merged = [](const auto& mesh) { return merge_faces(mesh.first, mesh.second).value(); };
    const auto square = merged(cells(40, [](std::uint32_t, std::uint32_t) { return false; }));
    ASSERT_EQ(square.size(), 1U);
    EXPECT_EQ(square[0].size(), 4U);
    const auto corner = merged(cells(8, [](std::uint32_t row, std::uint32_t column) { return row < 3 && column < 5; }));
    ASSERT_EQ(corner.size(), 1U);
    EXPECT_EQ(corner[0].size(), 6U);
    EXPECT_LE(std::abs(triangulated_area(make_polygon_light(corner[0], Rgb(1), true)) - (1 - 15 / 64.0)), 1e-12);
    const auto ring = merged(cells(3, [](std::uint32_t row, std::uint32_t column) { return row == 1 && column == 1; }));
    EXPECT_EQ(ring.size(), 16U) << "two boundaries";
    const auto touching = merged(cells(2, [](std::uint32_t row, std::uint32_t column) { return row != column; }));
    EXPECT_EQ(touching.size(), 2U) << "two squares with a corner in common";
}

}  // namespace
}  // namespace shlight
