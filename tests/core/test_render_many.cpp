// SPDX-License-Identifier: MIT
//
// Many lights: each asked for at a few of a pixel's hits, and all together as if each had been asked for everywhere.
#include <gtest/gtest.h>

#include <numbers>

#include "random_input.h"
#include "render_scenes.h"

namespace shlight {
namespace {

using testing::Image;

constexpr int kSize = 24;
constexpr int kLights = 320;
constexpr int kGroup = 20;  // of which each adds more than the share that is asked for less

/// radius 0: a source without extent.
void add_light(Scene& scene, const Vec3d& position, double radius, const Rgb& intensity) {
    if (radius == 0) {
        scene.add_point_light(position, intensity);
    } else {
        scene.add_sphere_light(position, radius, intensity / static_cast<float>(std::numbers::pi * radius * radius));
    }
}

Scene scene_of(int first, int last, double radius, const Bsdf& floor) {
    Scene scene;
    scene.add_mesh(testing::floor_mesh(3, 0, floor));
    scene.add_mesh(testing::sphere_mesh({0.3, 0.2, 0.5}, 0.4, 16, true));
    testing::RandomInput random(5);
    for (int i = 0; i < last; ++i) {
        const Vec3d position(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(1.2, 2.5));
        const Rgb intensity(static_cast<float>(random.uniform(0.5, 1.5)), 1, 0.3F);
        if (i >= first) {
            add_light(scene, position, radius, intensity);
        }
    }
    return scene;
}

/// Sums of `kGroup` lights each.
Image sum_of_groups(double radius, const Bsdf& floor, const Camera& camera, int size, const RenderSettings& settings) {
    Image sum = testing::render_image(scene_of(0, kGroup, radius, floor), camera, size, size, settings);
    for (int first = kGroup; first < kLights; first += kGroup) {
        const Image part =
            testing::render_image(scene_of(first, first + kGroup, radius, floor), camera, size, size, settings);
        for (std::size_t i = 0; i < sum.values.size(); ++i) {
            sum.values[i] += part.values[i];
        }
        sum.report.shadow_rays += part.report.shadow_rays;
    }
    return sum;
}

/// Parameter: radius of the lights.
class RenderMany : public ::testing::TestWithParam<double> {};

TEST_P(RenderMany, LightsTogetherAreTheSumOfTheirParts) {
    RenderSettings settings;
    settings.sampling = PixelSampling::fixed(16);
    const Camera camera = testing::camera_above(2);
    for (const Bsdf& floor : {Bsdf::lambert(Rgb(0.5F)), Bsdf::ggx(0.4F, Rgb(0.9F))}) {
        const Image all =
            testing::render_image(scene_of(0, kLights, GetParam(), floor), camera, kSize, kSize, settings);
        const Image sum = sum_of_groups(GetParam(), floor, camera, kSize, settings);
        double squares = 0;
        double difference = 0;
        double whole = 0;
        for (std::size_t i = 0; i < sum.values.size(); ++i) {
            if (i % 4 == 3) continue;  // alpha
            const double expected = sum.values[i];
            const double error = double{all.values[i]} - expected;
            squares += expected > 0 ? error * error / (expected * expected) : 0;
            difference += error;
            whole += expected;
        }
        // 320 lights, of which a fifth has its shadow's edge in a pixel, and each of these errs by half its share.
        EXPECT_LE(squares / (3 * kSize * kSize), 1e-4);
        EXPECT_LE(std::abs(difference), 1e-3 * whole);
        EXPECT_LE(all.report.shadow_rays, sum.report.shadow_rays / 2);
    }
}

/// A bright half of the floor under lights that a wall hides from the dark other half.
TEST_P(RenderMany, APixelOfTwoSurfacesIsNoMixOfTheirShadows) {
    Scene scene;
    Mesh floor = testing::floor_mesh(3);
    floor.vertices = {{-3, -3, 0}, {0, -3, 0}, {0, 3, 0}, {-3, 3, 0}, {3, -3, 0},
                      {3, 3, 0},   {0, -9, 0}, {0, 9, 0}, {0, 9, 5},  {0, -9, 5}};
    floor.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}, {6, 7, 8}, {6, 8, 9}};
    floor.bsdfs = {Bsdf::lambert(Rgb(0.8F)), Bsdf::lambert(Rgb(0.2F))};
    floor.material_indices = {0, 0, 1, 1, 1, 1};
    scene.add_mesh(floor);
    double truth = 0;
    testing::RandomInput random(6);
    RenderSettings settings;
    settings.sampling = PixelSampling::fixed(16);
    for (int i = 0; i < kLights; ++i) {
        const Vec3d position(random.uniform(-2, -1), random.uniform(-1, 1), random.uniform(0.5, 1));
        add_light(scene, position, GetParam(), Rgb(1));
        const double distance = glm::length(position);
        truth += position.z / (distance * distance * distance);
    }
    // Half of the pixel is lit.
    truth *= 0.5 * 0.8 / std::acos(-1.0);
    const Image image = testing::render_image(scene, testing::camera_above(1e-3), 1, 1, settings);
    EXPECT_LE(std::abs(image.red(0, 0) - truth), 0.01 * truth);
    EXPECT_LE(image.report.shadow_rays, std::uint64_t{kLights} * 16 / 2);
}

INSTANTIATE_TEST_SUITE_P(Radii, RenderMany, ::testing::Values(0.0, 0.05),
                         [](const auto& radius) { return radius.param == 0 ? "WithoutExtent" : "WithExtent"; });

}  // namespace
}  // namespace shlight
