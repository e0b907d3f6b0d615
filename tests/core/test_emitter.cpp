// SPDX-License-Identifier: MIT
//
// Outlines of emissive meshes against the sum over their faces, those with fewer vertices against what they were made
// from, and levels of detail against the sphere.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "base/perpendicular.h"
#include "emitters/emitter_levels.h"
#include "emitters/flat_outline.h"
#include "emitters/silhouette.h"
#include "lights/mesh_sampling.h"
#include "random_input.h"
#include "shlight/cap.h"
#include "shlight/polygon.h"
#include "solids.h"

namespace shlight {
namespace {

using testing::icosphere;
using testing::RandomInput;
using testing::Solid;

constexpr int kOrder = 6;
using Row = std::array<double, kOrder * kOrder>;

double largest_difference(const Row& a, const Row& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        largest = std::max(largest, std::abs(a[i] - b[i]));
    }
    return largest;
}

/// Sum over all faces that show `point` their outer side.
Row sum_of_faces(const EmitterLevel& level, const Vec3d& point, bool clip) {
    Row sum{};
    for (std::size_t i = 0; i < level.faces.size(); ++i) {
        if (!(glm::dot(level.planes[i].normal, point) > level.planes[i].height)) {
            continue;
        }
        std::vector<Vec3d> corners;
        for (int k = 0; k < 3; ++k) {
            corners.push_back(level.vertices[level.faces[i][k]] - point);
        }
        Row row{};
        polygon_coefficients<double>(corners, static_cast<int>(corners.size()), kOrder, clip, row);
        for (std::size_t j = 0; j < row.size(); ++j) {
            sum[j] += row[j];
        }
    }
    return sum;
}

Row of_outline(const EmitterLevel& level, const Vec3d& point, bool clip) {
    Row row{};
    Silhouette silhouette;
    FlatOutline flat;
    EXPECT_TRUE(silhouette.find(level, point));
    EXPECT_TRUE(flat.draw(silhouette.directions(), silhouette.ends()));
    flat.join();
    std::vector<Vec3d> outline;
    for (const FlatOutline::Vertex& v : flat.line(0)) {
        outline.push_back(flat.direction(v.at));
    }
    polygon_coefficients<double>(outline, static_cast<int>(outline.size()), kOrder, clip, row);
    return row;
}

void expect_outline_is_sum_of_faces(const EmitterLevels& emitter, const Vec3d& point, bool clip) {
    const EmitterLevel& level = emitter.levels.front();
    const Row faces = sum_of_faces(level, point, clip);
    // Faces and outline each lose a few digits of the solid angle's.
    EXPECT_LE(largest_difference(of_outline(level, point, clip), faces), 1e-11 * (1 + faces[0]));
}

TEST(Silhouette, OfAClosedSurfaceHoldsTheFacesThatAreSeen) {
    RandomInput random(1);
    for (const int subdivisions : {0, 1, 2}) {
        const Solid solid = icosphere(subdivisions);
        const EmitterLevels emitter = make_emitter_levels(solid.vertices, solid.triangles, 1000);
        ASSERT_TRUE(emitter.closed);
        for (int i = 0; i < 20; ++i) {
            const Vec3d point = random.uniform(1.05, 5) * random.direction();
            expect_outline_is_sum_of_faces(emitter, point, i % 2 == 0);
        }
    }
}

using Lines = std::vector<std::vector<Vec3d>>;

constexpr double kMost = 4e-3;
constexpr double kOneSided = 0.15;

FlatOutline drawn(const Lines& lines) {
    std::vector<Vec3d> directions;
    std::vector<std::size_t> ends;
    for (const std::vector<Vec3d>& line : lines) {
        directions.insert(directions.end(), line.begin(), line.end());
        ends.push_back(directions.size());
    }
    FlatOutline outline;
    EXPECT_TRUE(outline.draw(directions, ends));
    return outline;
}

std::vector<Vec3d> joined(FlatOutline outline) {
    outline.join();
    std::vector<Vec3d> line;
    for (const FlatOutline::Vertex& v : outline.line(0)) {
        line.push_back(outline.direction(v.at));
    }
    return line;
}

/// Around a point of the plane z = 1, a little out of round, with a jitter.
std::vector<Vec3d> ring(const Vec3d& middle, double radius, int count, RandomInput& random) {
    std::vector<Vec3d> line;
    for (int i = 0; i < count; ++i) {
        const double azimuth = -2 * std::numbers::pi * i / count;  // counter-clockwise as seen from the origin
        const double r = radius * (1 + 0.15 * std::cos(3 * azimuth)) * random.uniform(0.995, 1.005);
        line.push_back(middle + r * Vec3d(std::cos(azimuth), std::sin(azimuth), 0));
    }
    return line;
}

/// How often a line in the plane z = 1 winds about a point of it.
int winding(const std::vector<Vec3d>& line, const Vec3d& point) {
    double angle = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const Vec3d a = line[i] / line[i].z - point;
        const Vec3d b = line[(i + 1) % line.size()] / line[(i + 1) % line.size()].z - point;
        angle += std::atan2(glm::cross(a, b).z, glm::dot(a, b));
    }
    return static_cast<int>(std::lround(angle / (2 * std::numbers::pi)));
}

/// Area of the plane z = 1 in which the winding numbers of two outlines differ.
double moved_area(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    constexpr int kGrid = 160;
    constexpr double kHalf = 0.8;
    int moved = 0;
    for (int i = 0; i < kGrid * kGrid; ++i) {
        const Vec3d point(kHalf * (2 * (i % kGrid + 0.5) / kGrid - 1), kHalf * (2 * (i / kGrid + 0.5) / kGrid - 1), 1);
        moved += std::abs(winding(a, point) - winding(b, point));
    }
    return moved * (2 * kHalf / kGrid) * (2 * kHalf / kGrid);
}

TEST(FlatOutline, EachLineIsThinnedOutByItself) {
    RandomInput random(10);
    const FlatOutline outline = drawn({ring({-0.3, 0, 1}, 0.2, 60, random), ring({0.3, 0.1, 1}, 0.15, 60, random),
                                       ring({0.2, -0.4, 1}, 0.1, 60, random)});
    FlatOutline thin = outline;
    thin.thin_out(kMost, kOneSided);
    ASSERT_EQ(thin.line_count(), 3U);
    EXPECT_LE(joined(thin).size(), joined(outline).size() / 2);
    EXPECT_LE(std::abs(thin.area() - outline.area()), 1e-14);
    EXPECT_LE(moved_area(joined(thin), joined(outline)), kMost);
}

TEST(FlatOutline, LinesAboutNextToNothingGo) {
    RandomInput random(11);
    const std::vector<Vec3d> large = ring({0, 0, 1}, 0.3, 30, random);
    const std::vector<Vec3d> fold = ring({0.31, 0, 1}, 0.004, 5, random);
    const std::vector<Vec3d> other = ring({-0.5, 0, 1}, 0.03, 12, random);
    FlatOutline outline = drawn({fold, large, other});
    outline.thin_out(kMost, kOneSided);
    EXPECT_EQ(outline.line_count(), 2U);
    // What is all there is stays, as small as it may be.
    FlatOutline far = drawn({fold});
    const double area = far.area();
    far.thin_out(kMost, kOneSided);
    EXPECT_EQ(far.line_count(), 1U);
    EXPECT_LE(std::abs(far.area() - area), 1e-14);
}

TEST(FlatOutline, MoreThanHalfOfSpaceIsNotDrawn) {
    FlatOutline outline;
    const std::vector<std::size_t> ends = {3};
    EXPECT_FALSE(outline.draw(std::vector<Vec3d>{{1, 0, -0.1}, {-1, 1, -0.1}, {-1, -1, -0.1}, {0, 0, 5}}, ends));
    EXPECT_FALSE(outline.draw(std::vector<Vec3d>{{1, 0, 0}, {0, 0, 0}, {0, 1, 0}}, ends));
}

TEST(EmitterLevels, AreWoundOutwardsWhateverTheMeshWas) {
    Solid solid = icosphere(1);
    for (Triangle& t : solid.triangles) {
        std::swap(t.x, t.y);
    }
    const EmitterLevels emitter = make_emitter_levels(solid.vertices, solid.triangles, 1000);
    for (const EmitterPlane& plane : emitter.levels.front().planes) {
        EXPECT_GT(plane.height, 0);
    }
}

TEST(EmitterLevels, JoinEqualVerticesAndDropFacesWithoutArea) {
    const Solid solid = icosphere(1);
    std::vector<Vec3d> apart;
    std::vector<Triangle> triangles;
    for (const Triangle& t : solid.triangles) {
        const auto first = static_cast<std::uint32_t>(apart.size());
        triangles.emplace_back(first, first + 1, first + 2);
        triangles.emplace_back(first, first + 1, first + 1);
        for (int k = 0; k < 3; ++k) {
            apart.push_back(solid.vertices[t[k]]);
        }
    }
    const EmitterLevels emitter = make_emitter_levels(apart, triangles, 1000);
    EXPECT_TRUE(emitter.closed);
    EXPECT_EQ(emitter.levels.front().vertices.size(), solid.vertices.size());
    EXPECT_EQ(emitter.levels.front().faces.size(), solid.triangles.size());
    EXPECT_EQ(make_emitter_levels(apart, std::vector<Triangle>{{0, 0, 1}}, 10).area, 0);
}

TEST(EmitterLevels, OfASphereShowTheSphere) {
    const Solid solid = icosphere(6);
    const EmitterLevels emitter = make_emitter_levels(solid.vertices, solid.triangles, 64);
    ASSERT_TRUE(emitter.closed);
    ASSERT_EQ(emitter.levels.size(), 4U);
    RandomInput random(2);
    for (const EmitterLevel& level : emitter.levels) {
        // The sagitta of an even mesh is about 3.6 ÷ faces, that of an uneven one some times as large.
        EXPECT_LE(level.error, 15.0 / static_cast<double>(level.faces.size()));
        for (int i = 0; i < 10; ++i) {
            const Vec3d point = 2.0 * random.direction();
            Row cap{};
            const std::array centers = {-point};
            const std::array radii = {1.0};
            sphere_coefficients<double>(centers, radii, kOrder, false, std::span<double>(cap));
            // Twice the error if it all lay on one side; the scale takes out its mean.
            EXPECT_LE(largest_difference(of_outline(level, point, false), cap), 0.7 * level.error * cap[0])
                << level.faces.size();
        }
    }
}

MeshLight light_of(const Solid& solid, std::size_t faces) {
    return {std::make_shared<const EmitterLevels>(make_emitter_levels(solid.vertices, solid.triangles, faces)),
            Rgb(1),
            nullptr,
            {}};
}

/// Near and far: a wide rectangle about the outline is drawn by solid angle, a small one by area.
TEST(MeshSampler, WeightsAddUpToTheSolidAngle) {
    const MeshLight light = light_of(icosphere(3), 64);
    MeshSampler sampler;
    for (const double distance : {1.5, 4.0, 60.0}) {
        const ShadingFrame frame{{0, 0, -distance}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        sampler.reset(light, frame);
        constexpr int kPoints = 200;
        double sum = 0;
        for (int i = 0; i < kPoints * kPoints; ++i) {
            sum += sampler.sample({(i / kPoints + 0.5) / kPoints, (i % kPoints + 0.5) / kPoints}).weight;
        }
        const double cap = 2 * std::numbers::pi * (1 - std::sqrt(1 - 1 / (distance * distance)));
        // The outline that rays are drawn in is up to a tenth smaller, and 320 faces show 2 % less than the sphere.
        EXPECT_NEAR(sum / (kPoints * kPoints) / cap, 0.9, 0.1) << distance;
    }
}

/// Near the last hit the outline is kept, elsewhere it is found anew.
TEST(MeshSampler, MovedItSeesWhatItWouldSeeFromThere) {
    const MeshLight light = light_of(icosphere(4), 64);
    RandomInput random(13);
    for (int i = 0; i < 40; ++i) {
        const Vec3d last = random.uniform(1.5, 6) * random.direction();
        const Vec3d way = i % 2 == 0 ? 0.05 * random.direction() : 2.0 * perpendicular(glm::normalize(last));
        const Vec3d here = last + (glm::length(last) - 1) * way;
        const auto frame_at = [](const Vec3d& point) {
            const Vec3d z = -glm::normalize(point);
            const Vec3d x = perpendicular(z);
            return ShadingFrame{point, x, glm::cross(z, x), z};
        };
        MeshSampler moved;
        moved.reset(light, frame_at(last));
        moved.move(light, frame_at(here));
        // The centre is along z. A coarse outline differs by some hundredths, and shrinks by up to a tenth.
        const double angle = std::asin(1 / glm::length(here));
        for (int k = 0; k < 48; ++k) {
            const double azimuth = 2 * std::numbers::pi * k / 48;
            const auto at = [&](double part) {
                const double sine = std::sin(part * angle);
                return Vec3d(sine * std::cos(azimuth), sine * std::sin(azimuth), std::cos(part * angle));
            };
            EXPECT_TRUE(moved.meets(at(0.86))) << i << ", azimuth " << azimuth;
            EXPECT_FALSE(moved.meets(at(1.06))) << i << ", azimuth " << azimuth;
        }
    }
}

}  // namespace
}  // namespace shlight
