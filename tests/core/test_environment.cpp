// SPDX-License-Identifier: MIT
//
// Light from all around, of one radiance.
#include <cmath>

#include <gtest/gtest.h>

#include "quadrature.h"
#include "render_scenes.h"
#include "shlight/environment.h"

namespace shlight::testing {
namespace {

const Rgb kSky(0.5F, 1.0F, 2.0F);

Scene floor_under_sky(const Bsdf& bsdf, const Environment& environment = Environment(kSky)) {
    Scene scene;
    scene.add_mesh(floor_mesh(4, 0, bsdf));
    scene.set_environment(environment);
    return scene;
}

/// A view of the floor's origin from this height over it, one pixel.
Camera camera_at(double cos_theta_o) {
    const double sine = std::sqrt(1 - cos_theta_o * cos_theta_o);
    return {look_at({10 * sine, 0, 10 * cos_theta_o}, {0, 0, 0}), 1e-3};
}

TEST(Environment, GlossyReflectsItsAlbedo) {
    for (const float roughness : {0.2F, 0.5F, 1.0F}) {
        for (const double cosine : {0.2, 0.6, 0.95}) {
            const double alpha = double{roughness} * roughness;
            const Vec3d wo(std::sqrt(1 - cosine * cosine), 0, cosine);
            const double expected = integral(mirrored_hemisphere(160, 160),
                                             [&](const Vec3d& wi) { return lobe_value(GgxShape{alpha}, wi, wo); });
            const Image image =
                render_image(floor_under_sky(Bsdf::ggx(roughness, Rgb(1))), camera_at(cosine), 1, 1, {});
            EXPECT_NEAR(image.red(0, 0), expected * kSky.x, 2e-3 * kSky.x) << roughness << " " << cosine;
        }
    }
}

TEST(Environment, MirrorShowsIt) {
    const Image image = render_image(floor_under_sky(Bsdf::ggx(0, Rgb(0.25F, 0.5F, 1))), camera_at(0.6), 1, 1, {});
    const float edge = std::pow(1 - 0.6F, 5.0F);
    EXPECT_NEAR(image.red(0, 0), (0.25F + 0.75F * edge) * kSky.x, 1e-6);
    EXPECT_NEAR(image.color(0, 0).z, kSky.z, 1e-6);
}

TEST(Environment, ABlackOneIsOnlyOpaque) {
    const Image image =
        render_image(floor_under_sky(Bsdf::lambert(Rgb(0.5F)), Environment(Rgb(0))), camera_above(8), 4, 4, {});
    EXPECT_EQ(image.color(0, 0), Rgb(0));
    EXPECT_EQ(image.color(2, 2), Rgb(0));
    EXPECT_EQ(image.alpha(0, 0), 1);
    EXPECT_EQ(image.report.shadow_rays, 0);
}

/// Only objects in the direction of a narrow lobe hide the environment that it reflects.
TEST(Environment, GlossyLobesSeeOnlyTheirOwnObstacles) {
    const Camera camera(look_at({0, -10, 10}, {0, 0, 0}), 1e-3);
    const auto shaded = [&](double y) {
        Scene scene = floor_under_sky(Bsdf::ggx(0.2F, Rgb(1)));
        scene.add_mesh(sphere_mesh({0, y, 10}, 4, 16, false));
        RenderSettings settings;
        settings.shadow_rays = 256;
        return render_image(scene, camera, 1, 1, settings).red(0, 0);
    };
    const float open = render_image(floor_under_sky(Bsdf::ggx(0.2F, Rgb(1))), camera, 1, 1, {}).red(0, 0);
    EXPECT_LT(shaded(10), 0.1F * open);
    EXPECT_GT(shaded(-30), 0.98F * open);
}

TEST(Environment, NoNoiseWhereNothingIsInTheWay) {
    const Scene scene = floor_under_sky(Bsdf::lambert(Rgb(0.5F)) + Bsdf::ggx(0.3F, Rgb(0.2F)));
    RenderSettings settings;
    settings.shadow_rays = 1;
    const Image few = render_image(scene, camera_above(2), 4, 4, settings);
    settings.shadow_rays = 0;
    const Image none = render_image(scene, camera_above(2), 4, 4, settings);
    EXPECT_EQ(few.values, none.values);
}

}  // namespace
}  // namespace shlight::testing
