// SPDX-License-Identifier: MIT
//
// Emissive meshes of many faces in pictures, against sphere lights and closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "render_scenes.h"
#include "solids.h"

namespace shlight {
namespace {

using testing::camera_above;
using testing::Image;
using testing::render_image;

constexpr int kSize = 16;
constexpr double kHalf = 2;

Mesh emissive(const testing::Solid& solid, const Vec3d& center, double scale) {
    Mesh mesh;
    for (const Vec3d& v : solid.vertices) {
        mesh.vertices.emplace_back(center + scale * v);
    }
    mesh.triangles = solid.triangles;
    mesh.bsdfs = {Bsdf::lambert(Rgb(0))};
    mesh.emission = {Rgb(1)};
    return mesh;
}

/// Beside the square that camera_above shows.
const Vec3d kCenter(0.4, 3.5, 1.2);

Image of_sphere_light(const RenderSettings& settings, const Bsdf& floor, const Mesh* blocker) {
    Scene scene;
    scene.add_mesh(testing::floor_mesh(10, 0, floor));
    if (blocker != nullptr) {
        scene.add_mesh(*blocker);
    }
    scene.add_sphere_light(kCenter, 1, Rgb(1));
    return render_image(scene, camera_above(kHalf), kSize, kSize, settings);
}

Image of_mesh(const Mesh& mesh, const RenderSettings& settings, const Bsdf& floor, const Mesh* blocker) {
    Scene scene;
    scene.add_mesh(testing::floor_mesh(10, 0, floor));
    if (blocker != nullptr) {
        scene.add_mesh(*blocker);
    }
    scene.add_mesh(mesh);
    return render_image(scene, camera_above(kHalf), kSize, kSize, settings);
}

void expect_close(const Image& a, const Image& b, double relative) {
    for (int row = 0; row < kSize; ++row) {
        for (int column = 0; column < kSize; ++column) {
            EXPECT_LE(std::abs(a.red(column, row) - b.red(column, row)), relative * b.red(column, row))
                << column << " " << row;
        }
    }
}

/// Of the sums, relative.
double mean_difference(const Image& a, const Image& b) {
    double difference = 0;
    double sum = 0;
    for (int row = 0; row < kSize; ++row) {
        for (int column = 0; column < kSize; ++column) {
            difference += a.red(column, row) - b.red(column, row);
            sum += b.red(column, row);
        }
    }
    return std::abs(difference) / sum;
}

TEST(RenderEmitters, AFineIcosphereShinesAsASphere) {
    // 5120 faces show 0.14 % less than the sphere, a level of detail about as much more or less.
    const RenderSettings settings = testing::analytic_settings();
    for (const Bsdf& floor : {Bsdf::lambert(Rgb(0.5F)), Bsdf::ggx(0.5F, Rgb(0.9F))}) {
        expect_close(of_mesh(emissive(testing::icosphere(4), kCenter, 1), settings, floor, nullptr),
                     of_sphere_light(settings, floor, nullptr), 0.02);
    }
}

TEST(RenderEmitters, NothingButWhatIsInTheWayShadows) {
    RenderSettings settings = testing::analytic_settings();
    settings.shadow_rays = 64;
    const Bsdf floor = Bsdf::lambert(Rgb(0.5F));
    const Mesh emitter = emissive(testing::icosphere(3), kCenter, 1);
    expect_close(of_mesh(emitter, settings, floor, nullptr),
                 of_mesh(emitter, testing::analytic_settings(), floor, nullptr), 1e-6);
    const Mesh blocker = testing::sphere_mesh({0, 2.2, 0.5}, 0.5, 16, false);
    const Image shadowed = of_mesh(emitter, settings, floor, &blocker);
    const Image expected = of_sphere_light(settings, floor, &blocker);
    // 0.6 % of the solid angle, and the noise of 64 rays in a few pixels.
    EXPECT_LE(mean_difference(shadowed, expected), 0.015);
}

TEST(RenderEmitters, LayersBehindEachOtherShineOnce) {
    // Two spheres, the smaller hidden in the other.
    RenderSettings settings = testing::analytic_settings();
    settings.shadow_rays = 64;
    testing::Solid both = testing::icosphere(3);
    const auto count = static_cast<std::uint32_t>(both.vertices.size());
    const testing::Solid inner = both;
    for (const Vec3d& v : inner.vertices) {
        both.vertices.push_back(0.5 * v);
    }
    for (const Triangle& t : inner.triangles) {
        both.triangles.push_back(t + count);
    }
    const Bsdf floor = Bsdf::lambert(Rgb(0.5F));
    const Image alone = of_mesh(emissive(inner, kCenter, 1), settings, floor, nullptr);
    const Image layered = of_mesh(emissive(both, kCenter, 1), settings, floor, nullptr);
    // In each pixel 64 rays find which quarter of the light is two layers deep.
    EXPECT_LE(mean_difference(layered, alone), 0.015);
}

TEST(RenderEmitters, WithinOneAllDirectionsShine) {
    for (const int rays : {0, 16}) {
        RenderSettings settings = testing::analytic_settings();
        settings.shadow_rays = rays;
        Scene scene;
        scene.add_mesh(testing::floor_mesh(10, 0, Bsdf::lambert(Rgb(0.5F))));
        scene.add_mesh(emissive(testing::icosphere(3), Vec3d(0, 0, 0), 20));
        const Image image = render_image(scene, camera_above(kHalf), kSize, kSize, settings);
        for (int row = 0; row < kSize; ++row) {
            for (int column = 0; column < kSize; ++column) {
                EXPECT_NEAR(image.red(column, row), 0.5, 1e-5);
            }
        }
    }
}

TEST(RenderEmitters, AnEmitterDoesNotLightItself) {
    Mesh mesh = emissive(testing::icosphere(4), Vec3d(0, 0, 0), 1);
    mesh.bsdfs = {Bsdf::lambert(Rgb(0.8F))};
    for (const int rays : {0, 16}) {
        RenderSettings settings = testing::analytic_settings();
        settings.shadow_rays = rays;
        Scene scene;
        scene.add_mesh(mesh);
        const Image image = render_image(scene, camera_above(0.6), kSize, kSize, settings);
        for (int row = 0; row < kSize; ++row) {
            for (int column = 0; column < kSize; ++column) {
                EXPECT_NEAR(image.red(column, row), 1, 0.01);
            }
        }
    }
}

}  // namespace
}  // namespace shlight
