// SPDX-License-Identifier: MIT
//
// Outlines with fewer vertices against those they were made from.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "emitters/flat_outline.h"
#include "random_input.h"

namespace shlight {
namespace {

using testing::RandomInput;
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

/// Of what two outlines in the plane z = 1 wind about differently often.
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

}  // namespace
}  // namespace shlight
