// SPDX-License-Identifier: MIT
//
// What the camera sees where: axes, windows, clipping, shares of a pixel; and arguments that are turned down.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "error_message.h"
#include "render_scenes.h"

namespace shlight {
namespace {

using namespace testing;

TEST(RenderCamera, CameraLooksAlongMinusZWithYUp) {
    // Four squares of different emission in the plane z = -2 of a turned camera.
    const glm::dmat4 to_world = look_at({3, -4, 2}, {0, 1, 0.5});
    Scene scene;
    for (int i = 0; i < 4; ++i) {
        Mesh mesh = floor_mesh(0.4F);
        mesh.emission = {Rgb(static_cast<float>(i + 1))};
        const Vec3d offset(i % 2 == 0 ? -0.5 : 0.5, i < 2 ? 0.5 : -0.5, -2);
        mesh.transforms = {to_world * frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, offset)};
        scene.add_mesh(mesh);
    }
    const auto corners = [&](const Camera& camera) {
        const Image image = render_image(scene, camera, 4, 4, analytic_settings());
        return std::array{image.red(1, 1), image.red(2, 1), image.red(1, 2), image.red(2, 2)};
    };
    const std::array<float, 4> expected = {1, 2, 3, 4};
    EXPECT_EQ(corners(Camera(to_world, 2 * std::atan(0.5))), expected);
    EXPECT_EQ(corners(Camera(to_world, Window{-0.5, 0.5, -0.5, 0.5}, Projection::perspective)), expected);
    EXPECT_EQ(corners(Camera(to_world, Window{-1, 1, -1, 1}, Projection::orthographic)), expected);
    // A shifted window shows only the upper right square.
    const Image shifted = render_image(scene, Camera(to_world, Window{0.1, 0.4, 0.1, 0.4}, Projection::perspective), 2,
                                       2, analytic_settings());
    EXPECT_EQ(shifted.red(0, 0), 2);
    EXPECT_EQ(shifted.red(1, 1), 2);
}

TEST(RenderCamera, ClippingIsByDepthAlongTheAxis) {
    Mesh wall = floor_mesh(100, -2);
    wall.emission = {Rgb(1)};
    Scene scene;
    scene.add_mesh(wall);
    const Window wide = {-3, 3, -3, 3};  // at the corner the ray is four times as long as the depth
    const auto alpha = [&](const ClipRange& clip, Projection projection) {
        const Image image =
            render_image(scene, Camera(glm::dmat4(1), wide, projection, clip), 8, 8, analytic_settings());
        float sum = 0;
        for (int i = 0; i < 64; ++i) {
            sum += image.alpha(i % 8, i / 8);
        }
        return sum / 64;
    };
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        EXPECT_EQ(alpha({0, 2.001}, projection), 1);
        EXPECT_EQ(alpha({0, 1.999}, projection), 0);
        EXPECT_EQ(alpha({1.999, 100}, projection), 1);
        EXPECT_EQ(alpha({2.001, 100}, projection), 0);
    }
}

/// An axis whose square underflows has no direction.
TEST(RenderCamera, AxesWithoutLengthAreRefused) {
    glm::dmat4 to_world(1);
    to_world[0] *= 1e-160;
    EXPECT_EQ(error_message([&] { Camera(to_world, 1.0); }).find("to_world"), 0U);
    to_world[0] = glm::dvec4(0, -std::numeric_limits<double>::min(), 0, 0);
    to_world[1] = glm::dvec4(1, 0, 0, 0);
    EXPECT_EQ(error_message([&] { Camera(to_world, 1.0); }).find("to_world"), 0U);
}

TEST(RenderCamera, CoverageIsTheShareOfThePixel) {
    // The floor covers the left 37.5 % of the only pixel: 6 of 16 columns of stratified samples.
    Mesh mesh = floor_mesh(1);
    mesh.transforms = {frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1.25, 0, 0})};
    mesh.emission = {Rgb(1)};
    Scene scene;
    scene.add_mesh(mesh);
    RenderSettings settings = analytic_settings();
    settings.sampling = PixelSampling::refined(16);
    const Image image = render_image(scene, camera_above(1), 1, 1, settings);
    EXPECT_EQ(image.alpha(0, 0), 6.0F / 16);
    EXPECT_EQ(image.red(0, 0), 6.0F / 16);
}

}  // namespace
}  // namespace shlight
