// SPDX-License-Identifier: MIT
//
// Suns and sources without extent against closed forms: irradiance E gives a Lambert surface the radiance albedo E / π.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "quadrature.h"
#include "render_scenes.h"
#include "shlight/light.h"
#include "shlight/lobe_shape.h"

namespace shlight {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): the scenes' own
using std::numbers::pi;

constexpr int kSize = 9;
constexpr double kHalf = 2;
constexpr float kAlbedo = 0.5F;  // of floor_mesh

Image floor_under(const std::function<void(Scene&)>& add_lights, const RenderSettings& settings = analytic_settings(),
                  const Bsdf& bsdf = Bsdf::lambert(Rgb(kAlbedo))) {
    Scene scene;
    scene.add_mesh(floor_mesh(5, 0, bsdf));
    add_lights(scene);
    return render_image(scene, camera_above(kHalf), kSize, kSize, settings);
}

/// Largest error of the floor's radiance ÷ the largest radiance.
double error_of(const Image& image, const std::function<double(const Vec3d&)>& truth) {
    const auto expected = [&](int column, int row) { return truth(floor_point(column, row, kSize, kHalf)); };
    const PictureError error = picture_error(image, expected);
    return error.largest / error.brightest;
}

TEST(RenderSources, ASettingSunIsCutByTheHorizon) {
    for (const double elevation : {-0.2, -0.05, 0.0, 0.1, 0.25}) {
        const Vec3d towards(std::cos(elevation), 0, std::sin(elevation));
        const double radiance = 2 / (pi * std::pow(std::sin(0.3), 2));
        const double truth =
            integral(clipped_cap_samples(towards, 0.3, 40), [](const Vec3d& w) { return w.z / pi; }) * radiance;
        const Image image = floor_under([&](Scene& scene) { scene.add_sun_light(-towards, 0.6, Rgb(2)); });
        EXPECT_LE(error_of(image, [&](const Vec3d& /*p*/) { return kAlbedo * truth; }), 1e-3) << elevation;
    }
    const Image night = floor_under([](Scene& scene) { scene.add_sun_light({0, -1, 0.4}, 0.6, Rgb(2)); });
    EXPECT_EQ(night.red(4, 4), 0.0F);
}

TEST(RenderSources, TangentSunIsEvenOnItsPlane) {
    const Vec3d travels(0.2, 0.4, -1);
    const Vec3d axis = -glm::normalize(travels);
    for (const double angle : {0.1, 1.2}) {
        const double radiance = 3 / (pi * std::pow(std::tan(angle / 2), 2));
        const double truth = radiance * integral(clipped_cap_samples(axis, angle / 2, 40), [&](const Vec3d& w) {
                                 return w.z / pi / std::pow(glm::dot(w, axis), 3);
                             });
        const Image image = floor_under([&](Scene& scene) { scene.add_sun_light(travels, angle, Rgb(3), true); });
        EXPECT_LE(error_of(image, [&](const Vec3d& /*p*/) { return kAlbedo * truth; }), 2e-4) << angle;
    }
}

TEST(RenderSources, GlossySurfacesReflectSourcesAsTheirBrdfSays) {
    const Vec3d position(0.4, -0.3, 1.2);
    const Vec3d travels(0.4, 0.1, -1);
    const Image image = floor_under(
        [&](Scene& scene) {
            scene.add_point_light(position, Rgb(7));
            scene.add_sun_light(travels, 0, Rgb(2));
        },
        analytic_settings(), Bsdf::ggx(0.5, Rgb(1)));
    EXPECT_LE(error_of(image,
                       [&](const Vec3d& p) {
                           const GgxShape shape{0.25};
                           const Vec3d way = position - p;
                           const double d2 = glm::dot(way, way);
                           return 7 / d2 * lobe_value(shape, way / std::sqrt(d2), {0, 0, 1}) +
                                  2 * lobe_value(shape, -glm::normalize(travels), {0, 0, 1});
                       }),
              2e-6);
}

TEST(RenderSources, MirrorsDoNotShowSources) {
    const Image image = floor_under(
        [](Scene& scene) {
            scene.add_point_light({0, 0, 2}, Rgb(7));
        },
        analytic_settings(), Bsdf::ggx(0, Rgb(1)));
    EXPECT_EQ(image.red(4, 4), 0.0F);
}

TEST(RenderSources, ShadowsAreSharpAndCanBeSwitchedOff) {
    // A square of half size 0.5 at height 1 under a source at height 2: its shadow reaches twice as far. What is above
    // the source shades nothing.
    for (const bool shadows : {true, false}) {
        LightTraits traits;
        traits.casts_shadows = shadows;
        Scene scene;
        scene.add_mesh(floor_mesh(5));
        scene.add_mesh(floor_mesh(0.5F, 1));
        scene.add_mesh(floor_mesh(5, 2.01F));
        scene.add_point_light({0, 0, 2}, Rgb(7), traits);
        RenderSettings settings;
        settings.sampling = PixelSampling::refined(1);
        const Image image = render_image(scene, camera_above(kHalf, 1.9), 64, 64, settings);
        const auto lit = [&](double x) {
            const int column = static_cast<int>((x / kHalf + 1) * 32);
            return image.red(column, 32) > 0;
        };
        EXPECT_TRUE(lit(1.1));
        EXPECT_EQ(lit(0.9), !shadows);
        EXPECT_TRUE(lit(0.3));  // the square itself
    }
}

TEST(RenderSources, SunsShadowReachesAnyDistance) {
    Scene scene;
    scene.add_mesh(floor_mesh(5));
    scene.add_mesh(floor_mesh(500, 3e5F));
    scene.add_sun_light({0, 0, -1}, 0.001, Rgb(2));
    scene.add_sun_light({0, 0, -1}, 0, Rgb(2));
    const Image image = render_image(scene, camera_above(kHalf), kSize, kSize, RenderSettings{});
    EXPECT_EQ(image.red(4, 4), 0.0F);
    EXPECT_EQ(image.alpha(4, 4), 1.0F);
}

TEST(RenderSources, LightsMayLeaveOutDiffuseOrGlossyReflection) {
    const auto add = [](bool diffuse, bool glossy) {
        return [=](Scene& scene) {
            LightTraits traits;
            traits.lights_diffuse = diffuse;
            traits.lights_glossy = glossy;
            scene.add_point_light({0, 0, 2}, Rgb(7), traits);
            scene.add_sphere_light({0, 1, 2}, 0.5, Rgb(2), false, traits);
            scene.add_sun_light({0, 0, -1}, 0.2, Rgb(2), false, traits);
        };
    };
    for (const bool glossy : {false, true}) {
        const Bsdf bsdf = glossy ? Bsdf::ggx(0.5, Rgb(1)) : Bsdf::lambert(Rgb(1));
        EXPECT_GT(floor_under(add(!glossy, glossy), analytic_settings(), bsdf).red(4, 4), 0.0F);
        EXPECT_EQ(floor_under(add(glossy, !glossy), analytic_settings(), bsdf).red(4, 4), 0.0F);
    }
}

TEST(RenderSources, ALightInItsOwnSurfaceIsNoBrightPixel) {
    // The middle pixel's ray meets the floor where the lights are.
    const Vec3d middle = floor_point(4, 4, kSize, kHalf);
    SpotProfile spot = make_spot_profile(lamp_axes({0, 0, -1}), 1, 0.2);
    RenderSettings settings;
    settings.sampling = PixelSampling::refined(1);
    const Image image = floor_under(
        [&](Scene& scene) {
            scene.add_point_light(middle, Rgb(7));
            scene.add_point_light(middle + Vec3d(0, 0, 1e-9), Rgb(7));  // within rounding
            scene.add_spot_light(middle, spot, Rgb(3));
            scene.add_spot_light(middle, spot, Rgb(3), 1e-3);
            scene.add_spot_light(middle, spot, Rgb(3), 1e-3, true);
            scene.add_sphere_light(middle, 1e-3, Rgb(2));
            scene.add_sphere_light(middle, 1e-3, Rgb(2), true);
        },
        settings);
    for (const float value : image.values) {
        EXPECT_TRUE(std::isfinite(value));
    }
    // Whole hemispheres of the four that have an extent.
    const double most = kAlbedo * (2 + 2 + 2 * 3 / (pi * 1e-6));
    EXPECT_LE(image.red(4, 4), most * 1.001);
}

}  // namespace
}  // namespace shlight
