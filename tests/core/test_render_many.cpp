// SPDX-License-Identifier: MIT
//
// Many lights: each asked for at a few of a pixel's hits, and all together as if each had been asked for everywhere.
#include <gtest/gtest.h>

#include "random_input.h"
#include "render_scenes.h"

namespace shlight {
namespace {

using testing::Image;

constexpr int kSize = 24;
constexpr int kLights = 320;
constexpr int kGroup = 20;  // of which each adds more than the share that is asked for less

Scene scene_of(int first, int last, const Bsdf& floor) {
    Scene scene;
    scene.add_mesh(testing::floor_mesh(3, 0, floor));
    scene.add_mesh(testing::sphere_mesh({0.3, 0.2, 0.5}, 0.4, 16, true));
    testing::RandomInput random(5);
    for (int i = 0; i < last; ++i) {
        const Vec3d position(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(1.2, 2.5));
        const Rgb intensity(static_cast<float>(random.uniform(0.5, 1.5)), 1, 0.3F);
        if (i >= first) {
            scene.add_point_light(position, intensity);
        }
    }
    return scene;
}

TEST(RenderMany, LightsTogetherAreTheSumOfTheirParts) {
    RenderSettings settings;
    settings.adaptive = false;
    const Camera camera = testing::camera_above(2);
    for (const Bsdf& floor : {Bsdf::lambert(Rgb(0.5F)), Bsdf::ggx(0.4F, Rgb(0.9F))}) {
        const Image all = testing::render_image(scene_of(0, kLights, floor), camera, kSize, kSize, settings);
        std::vector<double> sum(all.values.size(), 0.0);
        std::uint64_t rays = 0;
        for (int first = 0; first < kLights; first += kGroup) {
            const Image part =
                testing::render_image(scene_of(first, first + kGroup, floor), camera, kSize, kSize, settings);
            rays += part.report.shadow_rays;
            for (std::size_t i = 0; i < sum.size(); ++i) {
                sum[i] += double{part.values[i]};
            }
        }
        double squares = 0;
        double difference = 0;
        double whole = 0;
        for (std::size_t i = 0; i < sum.size(); ++i) {
            if (i % 4 == 3) continue;  // alpha
            const double error = double{all.values[i]} - sum[i];
            squares += sum[i] > 0 ? error * error / (sum[i] * sum[i]) : 0;
            difference += error;
            whole += sum[i];
        }
        // 320 lights, of which a fifth has its shadow's edge in a pixel, and each of these errs by half its share.
        EXPECT_LE(squares / (3 * kSize * kSize), 1e-4);
        EXPECT_LE(std::abs(difference), 1e-3 * whole);
        EXPECT_LE(all.report.shadow_rays, rays / 2);
    }
}

}  // namespace
}  // namespace shlight
