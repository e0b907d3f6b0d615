// SPDX-License-Identifier: MIT
//
// Camera rays where they are needed: exact areas of edges and wires, what neighbours see, the cost, and the same bits
// however the picture is cut.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render_scenes.h"

namespace shlight {
namespace {

using namespace testing;

RenderSettings unshadowed_settings(bool adaptive) {
    RenderSettings settings;
    settings.shadow_rays = 0;
    settings.sampling = adaptive ? PixelSampling::refined(16) : PixelSampling::fixed(16);
    return settings;
}

/// A glowing rectangle in the plane z = 0: half sizes, turned about z, then moved.
Mesh glowing(double half_x, double half_y, double angle, const Vec3d& place, float radiance = 1) {
    Mesh mesh = floor_mesh(1);
    mesh.emission = {Rgb(radiance)};
    mesh.bsdfs = {Bsdf()};
    mesh.transforms = {frame_matrix({half_x * std::cos(angle), half_x * std::sin(angle), 0},
                                    {-half_y * std::sin(angle), half_y * std::cos(angle), 0}, {0, 0, 1}, place)};
    return mesh;
}

/// The area of a convex polygon inside x0 … x0 + 1, y0 … y0 + 1, by Sutherland and Hodgman's clipping.
double area_in_square(std::vector<glm::dvec2> polygon, double x0, double y0) {
    for (int side = 0; side < 4; ++side) {
        const int axis = side % 2;
        const double sign = side < 2 ? 1 : -1;
        const double limit = (axis == 0 ? x0 : y0) + (side < 2 ? 0 : 1);
        std::vector<glm::dvec2> kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const glm::dvec2& a = polygon[i];
            const glm::dvec2& b = polygon[(i + 1) % polygon.size()];
            const double da = sign * (a[axis] - limit);
            const double db = sign * (b[axis] - limit);
            if (da >= 0) kept.push_back(a);
            if ((da >= 0) != (db >= 0)) kept.push_back(a + da / (da - db) * (b - a));
        }
        polygon = kept;
    }
    double twice = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2& a = polygon[i];
        const glm::dvec2& b = polygon[(i + 1) % polygon.size()];
        twice += a.x * b.y - a.y * b.x;
    }
    return std::abs(twice) / 2;
}

/// Corners in pixels of `glowing` in a picture of camera_above(half_size) with rows upside down.
std::vector<glm::dvec2> corners(double half_x, double half_y, double angle, const Vec3d& place, int size,
                                double half_size) {
    const double scale = size / (2 * half_size);
    std::vector<glm::dvec2> result;
    for (const glm::dvec2 sign : {glm::dvec2(-1, -1), glm::dvec2(1, -1), glm::dvec2(1, 1), glm::dvec2(-1, 1)}) {
        const double u = sign.x * half_x;
        const double v = sign.y * half_y;
        const double x = place.x + u * std::cos(angle) - v * std::sin(angle);
        const double y = place.y + u * std::sin(angle) + v * std::cos(angle);
        result.emplace_back((x + half_size) * scale, (half_size - y) * scale);
    }
    return result;
}

TEST(RenderAdaptive, AThinWireHasItsArea) {
    // 1/8 pixel wide and across 64 pixels at a slant: 16 rays meet it twice a pixel or so.
    constexpr int kSize = 64;
    const double half = kSize / 2.0;  // pixels of unit size
    const double angle = 0.3;
    Scene scene;
    scene.add_mesh(glowing(25, 1.0 / 16, angle, {0.2, 0.3, 0}));
    const auto wire = corners(25, 1.0 / 16, angle, {0.2, 0.3, 0}, kSize, half);
    const auto mean_square = [&](const Image& image, double tolerance) {
        double squares = 0;
        double sum = 0;
        for (int row = 0; row < kSize; ++row) {
            for (int column = 0; column < kSize; ++column) {
                squares += std::pow(image.red(column, row) - area_in_square(wire, column, row), 2);
                sum += image.red(column, row);
            }
        }
        EXPECT_LE(std::abs(sum - 50.0 / 8), tolerance * 50 / 8);
        return squares / 60;  // some pixels that it crosses
    };
    const auto picture = [&](bool adaptive) {
        return render_image(scene, camera_above(half), kSize, kSize, unshadowed_settings(adaptive));
    };
    const double fine = mean_square(picture(true), 0.02);
    const double plain = mean_square(picture(false), 0.05);
    EXPECT_LE(std::sqrt(fine), 0.008);
    EXPECT_LE(fine, plain / 10);
}

TEST(RenderAdaptive, WhatRaysMissIsFoundThroughNeighbours) {
    // A bright wire of 1/64 pixel: 16 rays see it in one pixel of four. In each of the others it is found by following
    // it from there, but for a few that 256 rays miss too.
    constexpr int kSize = 32;
    const double half = kSize / 2.0;
    Scene scene;
    scene.add_mesh(glowing(12, 1.0 / 128, 0.2, {0.1, 0.2, 0}, 100));
    const auto wire = corners(12, 1.0 / 128, 0.2, {0.1, 0.2, 0}, kSize, half);
    const auto missed = [&](bool adaptive) {
        const Image image = render_image(scene, camera_above(half), kSize, kSize, unshadowed_settings(adaptive));
        int count = 0;
        for (int row = 0; row < kSize; ++row) {
            for (int column = 0; column < kSize; ++column) {
                count += area_in_square(wire, column, row) > 0.9 / 64 && image.red(column, row) == 0 ? 1 : 0;
            }
        }
        return count;
    };
    EXPECT_GE(missed(false), 10);
    EXPECT_LE(missed(true), 4);
}

TEST(RenderAdaptive, RaysGoWhereTheyAreNeededOnly) {
    constexpr int kSize = 64;
    Scene flat;
    flat.add_mesh(floor_mesh(40, 0, Bsdf::lambert(Rgb(0.5F))));
    flat.add_sphere_light({0, 0, 30}, 5, Rgb(3));
    const Image even = render_image(flat, camera_above(16), kSize, kSize, unshadowed_settings(true));
    EXPECT_EQ(even.report.hits, 16U * kSize * kSize) << "a smooth gradient";
    Scene edge = flat;
    edge.add_mesh(glowing(40, 40, 0, {-40.1, 0, 1}));  // one column of pixels has its edge
    const Image half = render_image(edge, camera_above(16), kSize, kSize, unshadowed_settings(true));
    EXPECT_GT(half.report.hits, 16U * kSize * kSize);
    EXPECT_LE(half.report.hits, 16U * kSize * (kSize + 15 + 2 * 3)) << "16 times in one column, 4 times beside it";
    RenderSettings one = unshadowed_settings(true);
    one.sampling = PixelSampling::fixed(1);
    const Image aliased = render_image(edge, camera_above(16), kSize, kSize, one);
    EXPECT_EQ(aliased.report.hits, 1U * kSize * kSize);
    EXPECT_EQ(aliased.values, render_image(edge, camera_above(16), kSize, kSize, one).values);
    RenderSettings odd = unshadowed_settings(true);
    odd.sampling = PixelSampling::refined(5);
    EXPECT_EQ(render_image(flat, camera_above(16), kSize, kSize, odd).report.hits, 8U * kSize * kSize);
}

TEST(RenderAdaptive, APenumbraIsNotRefinedWithoutEnd) {
    Scene scene;
    scene.add_mesh(floor_mesh(10));
    scene.add_mesh(glowing(0.5, 0.5, 0.3, {0, 0, 1}, 0));
    scene.add_polygon_light({{-1, -1, 2}, {-1, 1, 2}, {1, 1, 2}, {1, -1, 2}}, Rgb(2));
    RenderSettings settings;
    const Image image = render_image(scene, camera_above(2, 0.9), 48, 48, settings);  // from below the blocker
    EXPECT_LE(image.report.hits, 256U * 48 * 48 * 2 / 3);  // 256 are the most, and most pixels see a part of the light
}

/// Edges, a thin wire and a lit ball about the origin, on black, so that a shift keeps the picture's mean.
Scene spread_scene() {
    Scene scene;
    scene.add_mesh(sphere_mesh({0, 0, 0.3}, 0.3, 12, true));
    scene.add_mesh(glowing(0.45, 0.003, 0.5, {0, 0, 1}, 20));
    scene.add_sphere_light({1, -1, 2}, 0.5, Rgb(3));
    return scene;
}

TEST(RenderAdaptive, AShiftOfTheWindowShiftsThePicture) {
    // Other tiles, other batches of pixels that are refined, other neighbours at hand. Powers of two keep the rays.
    const glm::dmat4 above = frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 10});
    const auto picture = [&](int right, int up) {
        const double x = right / 32.0;
        const double y = up / 32.0;
        return render_image(spread_scene(), Camera(above, Window{x - 1, x + 1, y - 1, y + 1}, Projection::orthographic),
                            64, 64, unshadowed_settings(true));
    };
    const Image middle = picture(0, 0);
    const Image shifted = picture(5, 11);
    EXPECT_GT(middle.report.hits, 0U);
    EXPECT_EQ(shifted.report.hits, middle.report.hits);
    for (int row = 11; row < 64; ++row) {
        for (int column = 0; column < 64 - 5; ++column) {
            ASSERT_EQ(shifted.color(column, row), middle.color(column + 5, row - 11)) << column << ", " << row;
            ASSERT_EQ(shifted.alpha(column, row), middle.alpha(column + 5, row - 11));
        }
    }
}

TEST(RenderAdaptive, ManyRaysOfAPixelGoInSlices) {
    // The wire needs more rays than a batch holds; its brightness must match its area.
    Scene scene;
    scene.add_mesh(glowing(50, 0.005, 0.3, {0.1, 0.06, 0}));
    RenderSettings settings = unshadowed_settings(true);
    settings.sampling = PixelSampling::refined(1024);
    const Image image = render_image(scene, camera_above(0.5), 1, 1, settings);
    const double truth = area_in_square(corners(50, 0.005, 0.3, {0.1, 0.06, 0}, 1, 0.5), 0, 0);
    EXPECT_EQ(std::round(image.alpha(0, 0) * 16384), image.alpha(0, 0) * 16384) << "so many rays";
    EXPECT_NE(std::round(image.alpha(0, 0) * 4096), image.alpha(0, 0) * 4096) << "and no fewer";
    EXPECT_LE(std::abs(image.alpha(0, 0) - truth), 3e-4);
}

TEST(RenderPasses, ATimeLimitLeavesPassesOut) {
    RenderSettings settings;
    settings.sampling.time_limit = 1e-9;
    EXPECT_EQ(render_image(spread_scene(), camera_above(1), 64, 64, settings).report.passes, 1U);
    settings.sampling.time_limit = 1e9;
    const Image all = render_image(spread_scene(), camera_above(1), 64, 64, settings);
    settings.sampling.time_limit = 0;
    EXPECT_EQ(render_image(spread_scene(), camera_above(1), 64, 64, settings).values, all.values);
}

/// A floor that fills the picture, under so many lamps.
Scene lamps_over_floor(int count) {
    Scene scene;
    scene.add_mesh(floor_mesh(10));
    for (int i = 0; i < count; ++i) {
        scene.add_sphere_light({0.3 * (i % 5) - 0.6, 0.3 * (i / 5) - 0.6, 1.0 + 0.01 * i}, 0.1, Rgb(3));
    }
    return scene;
}

TEST(RenderPasses, APictureThatTheTimeEndsIsComplete) {
    const auto compiled = lamps_over_floor(40).compile();
    RenderSettings settings;
    settings.sampling.time_limit = 1e-9;
    settings.passes.passes = {{Pass::normal}, {Pass::diffuse_color}};
    constexpr std::size_t kPixels = 130 * 70;
    std::vector<float> image(4 * kPixels, -1);
    std::vector<float> passes(PassLayout(settings.passes).stride() * kPixels, -1);
    const RenderReport report = render(*compiled, camera_above(1), 130, 70, settings, image, {}, passes);
    EXPECT_LE(report.hits, kPixels / 4 + 130 + 70) << "of a grid";
    for (std::size_t i = 0; i < kPixels; ++i) {
        ASSERT_EQ(image[4 * i + 3], 1) << i;
        ASSERT_GT(image[4 * i], 0) << i;
        ASSERT_EQ(passes[6 * i + 2], 1) << i << ", the normal's z";
        ASSERT_GT(passes[6 * i + 3], 0) << i << ", the colour";
    }
}

TEST(RenderPasses, EveryPictureThatIsShownIsCompleteAndCounted) {
    std::uint64_t hits = 0;
    int updates = 0;
    const auto update = [&](std::span<const float> picture, const RenderReport& report) {
        for (std::size_t i = 3; i < picture.size(); i += 4) {
            EXPECT_EQ(picture[i], 1) << updates;
        }
        EXPECT_GE(report.hits, std::max<std::uint64_t>(hits, 1));
        hits = report.hits;
        ++updates;
        return true;
    };
    const Image image = render_image(lamps_over_floor(20), camera_above(1), 200, 150, RenderSettings(), {}, update);
    EXPECT_GE(updates, 2);
    EXPECT_GE(image.report.hits, hits);
}

}  // namespace
}  // namespace shlight
