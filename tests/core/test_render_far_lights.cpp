// SPDX-License-Identifier: MIT
//
// Lights that are summed up: as all of them one by one, in groups too small for sums.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "random_input.h"
#include "render_scenes.h"

namespace shlight::testing {
namespace {

constexpr int kSize = 8;
constexpr int kLights = 1000;
constexpr int kGroup = 200;

/// Adds lights of all kinds that can be summed up, around a small still life, some below its horizon.
void add_lights(Scene& scene, int first, int last, const LightTraits& traits) {
    RandomInput random(7);
    for (int i = 0; i < last; ++i) {
        Vec3d direction = random.direction();
        direction.z = std::abs(direction.z + 0.3) - 0.3;
        const Vec3d place = random.uniform(8, 16) * glm::normalize(direction);
        const Vec3d u = random.direction();
        const Vec3d v = glm::cross(u, random.direction());
        const double size = random.uniform(0.01, 0.04);
        const Rgb color(static_cast<float>(random.uniform(0.2, 1)), 0.5F, static_cast<float>(random.uniform(0.2, 1)));
        if (i < first) {
            continue;
        }
        const Rgb radiance = color / static_cast<float>(size * size);
        switch (i % 4) {
            case 0:
                scene.add_point_light(place, color, traits);
                break;
            case 1:
                scene.add_sphere_light(place, size, radiance, i % 8 == 1, traits);
                break;
            case 2:
                scene.add_polygon_light({place, place + size * u, place + size * (u + v), place + size * v}, radiance,
                                        std::numbers::pi, traits);
                break;
            default:
                scene.add_disk_light(place, size * u, size * v, radiance, std::numbers::pi, traits);
        }
    }
}

Scene scene_of(int first, int last, const Bsdf& bsdf, const LightTraits& traits = {}) {
    Scene scene;
    scene.add_mesh(floor_mesh(1, 0, bsdf));
    Mesh ball = sphere_mesh({0.02, 0.01, 0.05}, 0.05, 24, true);
    ball.bsdfs = {bsdf};
    scene.add_mesh(ball);
    add_lights(scene, first, last, traits);
    return scene;
}

RenderSettings plain_settings(int shadow_rays) {
    RenderSettings settings;
    settings.tolerance = 7e-4;
    settings.sampling = PixelSampling::fixed(16);
    settings.shadow_rays = shadow_rays;
    return settings;
}

Image rendered(const Scene& scene, const RenderSettings& settings) {
    return render_image(scene, {look_at({0.3, -1, 0.8}, {0, 0, 0.03}), 0.12}, kSize, kSize, settings);
}

Image sum_of_groups(const Bsdf& bsdf, const RenderSettings& settings) {
    Image sum = rendered(scene_of(0, kGroup, bsdf), settings);
    for (int first = kGroup; first < kLights; first += kGroup) {
        const Image part = rendered(scene_of(first, first + kGroup, bsdf), settings);
        EXPECT_EQ(part.report.summed_count, 0U);
        for (std::size_t i = 0; i < sum.values.size(); ++i) {
            sum.values[i] += i % 4 == 3 ? 0 : part.values[i];
        }
    }
    return sum;
}

Image all_of_them(const Bsdf& bsdf, const RenderSettings& settings, const LightTraits& traits = {}) {
    return rendered(scene_of(0, kLights, bsdf, traits), settings);
}

struct Difference {
    double relative_mse = 0, largest = 0, mean = 0;
};

/// Relative to the picture's values and a tenth of their mean.
Difference difference_between(const Image& image, const Image& truth) {
    double mean = 0;
    double image_mean = 0;
    const double count = 3 * kSize * kSize;
    for (std::size_t i = 0; i < truth.values.size(); ++i) {
        mean += i % 4 == 3 ? 0 : truth.values[i] / count;
        image_mean += i % 4 == 3 ? 0 : image.values[i] / count;
    }
    Difference difference;
    for (std::size_t i = 0; i < truth.values.size(); ++i) {
        if (i % 4 == 3) continue;  // alpha
        const double error = (image.values[i] - truth.values[i]) / std::hypot(truth.values[i], 0.1 * mean);
        difference.relative_mse += error * error / count;
        difference.largest = std::max(difference.largest, std::abs(error));
    }
    difference.mean = image_mean / mean - 1;
    return difference;
}

/// The tolerance of a sum is ten times that of a light, as root mean square over all turns of the sum; a pixel in its
/// unluckiest turn may err by some times that.
TEST(RenderFarLights, KeepWithinTheTolerance) {
    RenderSettings settings = plain_settings(0);
    for (const Bsdf& bsdf : {Bsdf::lambert(Rgb(0.5F, 0.6F, 0.7F)), Bsdf::ggx(0.8F, Rgb(0.9F)),
                             Bsdf::lambert(Rgb(0.4F)) + Bsdf::ggx(0.8F, Rgb(0.04F), 1.45F)}) {
        std::uint64_t before = std::uint64_t{kLights} * kSize * kSize * 32;
        for (const double tolerance : {7e-4, 3e-5}) {
            settings.tolerance = tolerance;
            const Image image = all_of_them(bsdf, settings);
            EXPECT_LT(image.report.summed_count, before) << "sums end where the tolerance does";
            EXPECT_TRUE(tolerance < 7e-4 || image.report.summed_count >= image.report.hits * kLights / 4);
            before = image.report.summed_count;
            const Difference difference = difference_between(image, sum_of_groups(bsdf, settings));
            const double rounding = tolerance < 7e-4 ? 2e-6 : 0;
            EXPECT_LE(std::sqrt(difference.relative_mse), tolerance + rounding);
            EXPECT_LE(difference.largest, 4 * (tolerance + rounding));
        }
    }
}

TEST(RenderFarLights, HaveTheirShadows) {
    const RenderSettings settings = plain_settings(16);
    for (const Bsdf& bsdf : {Bsdf::lambert(Rgb(0.5F, 0.6F, 0.7F)), Bsdf::ggx(0.8F, Rgb(0.9F))}) {
        const Image image = all_of_them(bsdf, settings);
        EXPECT_GE(image.report.summed_count, image.report.hits * kLights / 4);
        const Image truth = sum_of_groups(bsdf, settings);
        EXPECT_LE(image.report.shadow_rays, truth.report.shadow_rays * 5 / 2);
        const Difference difference = difference_between(image, truth);
        // A few hundred lights are drawn of which a part is hidden.
        EXPECT_LE(difference.relative_mse, 2e-4);
        EXPECT_LE(std::abs(difference.mean), 2e-3);
        const Image open = all_of_them(bsdf, plain_settings(0));
        EXPECT_GE(difference_between(open, truth).relative_mse, 1e-3);
    }
}

/// Near enough for their light to change over a group of pixels, and from one side.
TEST(RenderFarLights, ChangeWithThePlace) {
    const auto floor_under = [](int first, int last) {
        Scene scene;
        scene.add_mesh(floor_mesh(1));
        RandomInput random(8);
        for (int i = 0; i < last; ++i) {
            const Vec3d position(random.uniform(1, 2.5), random.uniform(-1, 1), random.uniform(1.5, 2.5));
            if (i >= first) {
                scene.add_point_light(position, Rgb(1));
            }
        }
        return render_image(scene, camera_above(0.1), kSize, kSize, plain_settings(0));
    };
    const Image all = floor_under(0, 2 * kGroup);
    EXPECT_GE(all.report.summed_count, all.report.hits * kGroup / 2);
    Image sum = floor_under(0, kGroup);
    const Image other = floor_under(kGroup, 2 * kGroup);
    std::transform(sum.values.begin(), sum.values.end(), other.values.begin(), sum.values.begin(), std::plus<>());
    EXPECT_LE(std::sqrt(difference_between(all, sum).relative_mse), 1e-3);
}

/// A wall hides the brighter half.
TEST(RenderFarLights, CountInShadowsAsBrightAsTheyAre) {
    const auto half_hidden = [](float hidden) {
        Scene scene;
        scene.add_mesh(floor_mesh(1));
        Mesh wall = floor_mesh(40);
        wall.transforms = {frame_matrix({0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {0.5, 0, 0})};
        scene.add_mesh(wall);
        RandomInput random(9);
        for (int i = 0; i < kLights; ++i) {
            const Vec3d position(random.uniform(4, 8), random.uniform(-4, 4), random.uniform(2, 8));
            scene.add_point_light({i % 2 == 0 ? position.x : -position.x, position.y, position.z},
                                  Rgb(i % 2 == 0 ? hidden : 1.0F));
        }
        RenderSettings settings = plain_settings(hidden > 0 ? 16 : 0);
        settings.tolerance = 7e-4;
        const Image image = render_image(scene, camera_above(0.02), kSize, kSize, settings);
        EXPECT_GE(image.report.summed_count, image.report.hits * kLights / 4);
        return image;
    };
    const Difference difference = difference_between(half_hidden(10), half_hidden(0));
    EXPECT_LE(std::abs(difference.mean), 0.02);
    EXPECT_LE(std::sqrt(difference.relative_mse), 0.2);  // a tenth of the light, by some hundred rays
}

TEST(RenderFarLights, LightsWithoutShadowsHaveNone) {
    LightTraits traits;
    traits.casts_shadows = false;
    const Bsdf bsdf = Bsdf::lambert(Rgb(0.5F));
    const Image image = all_of_them(bsdf, plain_settings(16), traits);
    EXPECT_GE(image.report.summed_count, image.report.hits * kLights / 4);
    EXPECT_EQ(image.report.shadow_rays, 0U);
    EXPECT_EQ(image.values, all_of_them(bsdf, plain_settings(0)).values);
}

TEST(RenderFarLights, NarrowLobesAndGivenOrdersHaveEachLight) {
    EXPECT_EQ(all_of_them(Bsdf::ggx(0.2F, Rgb(0.9F)), plain_settings(0)).report.summed_count, 0U);
    EXPECT_EQ(all_of_them(Bsdf::ggx(0, Rgb(0.9F)), plain_settings(0)).report.summed_count, 0U);
    RenderSettings settings = plain_settings(0);
    settings.order = 4;
    EXPECT_EQ(all_of_them(Bsdf::lambert(Rgb(0.5F)), settings).report.summed_count, 0U);
}

}  // namespace
}  // namespace shlight::testing
