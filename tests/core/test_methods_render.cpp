// SPDX-License-Identifier: MIT
//
// Pictures by Monte Carlo: their mean is what the library renders, within their own standard error.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "monte_carlo_render.h"
#include "render_scenes.h"

namespace shlight {
namespace {

using methods::MonteCarloSettings;
using methods::render_monte_carlo;
using namespace testing;

constexpr int kSize = 8;

using Picture = std::vector<float>;

Picture picture(const CompiledScene& scene, const Camera& camera, const MonteCarloSettings& settings,
                const Progress& progress = {}) {
    Picture image(4 * kSize * kSize, -1.0F);
    render_monte_carlo(scene, camera, kSize, kSize, settings, image, progress);
    return image;
}

/// A floor and a wall of a material, a shade, and one light of each kind.
Scene room(const Bsdf& bsdf, const std::string& lights) {
    Scene scene;
    scene.add_mesh(floor_mesh(3, 0, bsdf));
    Mesh shade = floor_mesh(0.4F, 0.5F);
    scene.add_mesh(shade);
    const auto has = [&](char kind) { return lights.find(kind) != std::string::npos; };
    if (has('s')) {
        scene.add_sphere_light({0.5, 0.25, 1.5}, 0.5, {4, 2, 1});
    }
    if (has('d')) {
        scene.add_sphere_light({-1, -0.5, 0.8}, 0.4, {1, 2, 4}, true);
    }
    if (has('i')) {
        scene.add_sphere_light({0, 0, 0}, 1.2, {1, 1, 1});  // most of what is seen lies within
    }
    if (has('p')) {
        scene.add_polygon_light({{-1, 0.5, 1.5}, {0, 0.1, 1.5}, {1, 0.5, 1.5}, {0, -0.8, 1.5}}, {-1, 2, 3});
        scene.add_polygon_light({{-1, 1.5, -1}, {-1, 1.5, 1}, {1, 1.5, 1}, {1, 1.5, -1}}, {2, 1, 0.5});
        scene.add_polygon_light({{1, 1.5, -1}, {1, 1.5, 1}, {-1, 1.5, 1}, {-1, 1.5, -1}}, {2, 1, 0.5});
    }
    if (has('o')) {
        scene.add_disk_light({0.3, 0.2, 1.4}, {0.1, 0.5, 0.1}, {0.8, -0.1, 0}, {1, 2, 3});
        scene.add_disk_light({0.2, 1.5, 0.1}, {1, 0, 0.2}, {0, 0.1, 0.7}, {3, 2, 1}, 2.0);  // through the floor
        scene.add_disk_light({-1.3, -0.5, 0.15}, {0, 0.6, 0}, {0.6, 0, 0.05}, {1, 1, 1});   // close to it
    }
    if (has('e')) {
        Mesh glowing;
        glowing.vertices = {{1.2F, -1, 0.1F}, {1.2F, 1, 0.1F}, {1.2F, 1, 0.9F}, {1.2F, -1, 0.9F}};
        glowing.triangles = {{0, 1, 2}, {0, 2, 3}};
        glowing.bsdfs = {Bsdf()};
        glowing.emission = {Rgb(3)};
        scene.add_mesh(glowing);
    }
    return scene;
}

struct Case {
    const char* name;
    Bsdf bsdf;
    const char* lights;
};

/// Sums over pixels of what each run gives beside the truth, and how far that is off in standard errors.
void check_mean(const Case& c) {
    constexpr int kRuns = 10;
    const auto scene = room(c.bsdf, c.lights).compile();
    const Camera camera(look_at({0.5, -3, 2.5}, {0, 0, 0.2}), 0.9);
    RenderSettings fine;
    fine.sampling = PixelSampling::fixed(100);
    fine.shadow_rays = 32;
    fine.tolerance = 1e-4;
    Picture expected(4 * kSize * kSize);
    render(*scene, camera, kSize, kSize, fine, expected);
    std::vector<Picture> runs;
    for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
        runs.push_back(picture(*scene, camera, {.samples = 128, .seed = 50 + seed}));
    }
    for (std::size_t channel = 0; channel < 4; ++channel) {
        double truth = 0;
        std::vector<double> totals(kRuns, 0.0);
        for (std::size_t i = channel; i < expected.size(); i += 4) {
            truth += expected[i];
            for (std::size_t run = 0; run < kRuns; ++run) {
                totals[run] += runs[run][i];
            }
        }
        double mean = 0;
        for (const double total : totals) {
            mean += total / kRuns;
        }
        double squares = 0;
        for (const double total : totals) {
            squares += (total - mean) * (total - mean);
        }
        const double error = std::sqrt(squares / (kRuns * (kRuns - 1)));
        std::printf("%-24s channel %zu: %+.1e of the truth, %.1f standard errors\n", c.name, channel, mean / truth - 1,
                    (mean - truth) / error);
        EXPECT_LE(std::abs(mean - truth), 5 * error) << c.name << " channel " << channel;
        EXPECT_LE(error, 0.03 * std::abs(truth)) << c.name << " channel " << channel;
    }
}

TEST(MonteCarloRender, TheMeanIsWhatTheLibraryRenders) {
    const Bsdf lambert = Bsdf::lambert(Rgb(0.5F));
    const Bsdf gold = Bsdf::ggx(0.3F, {0.9F, 0.6F, 0.2F});
    const Bsdf plastic = Bsdf::layer(Bsdf::ggx(0.25F, Rgb(0.04F), 1.45F), Bsdf::lambert({0.1F, 0.5F, 0.8F}));
    const Bsdf mirror = Bsdf::ggx(0, {0.9F, 0.6F, 0.2F}) + Bsdf::lambert(Rgb(0.1F));
    for (const Case& c : {Case{"lambert, spheres", lambert, "sd"},
                          {"lambert, inside", lambert, "i"},
                          {"lambert, polygons", lambert, "p"},
                          {"lambert, glowing mesh", lambert, "e"},
                          {"lambert, disks", lambert, "o"},
                          {"gold, spheres", gold, "sd"},
                          {"gold, inside", gold, "i"},
                          {"gold, polygons", gold, "pe"},
                          {"gold, disks", gold, "o"},
                          {"plastic, all", plastic, "sdpeo"},
                          {"mirror, all", mirror, "sdpeo"}}) {
        check_mean(c);
    }
}

TEST(MonteCarloRender, AMountedLampIsNotBlockedByItsMount) {
    // Tilted, so that neither the mesh's float vertices nor the rays lie in the lamp's plane exactly.
    const Vec3d along = glm::normalize(Vec3d(1, 0.3, 0.2));
    const Vec3d across = glm::normalize(glm::cross(Vec3d(0.1, 0.2, 1), along));
    const Vec3d center(0.1, -0.2, 3);
    const auto corners = [&](double half) {
        return std::vector<Vec3d>{center - half * along - half * across, center - half * along + half * across,
                                  center + half * along + half * across, center + half * along - half * across};
    };
    Scene free;
    free.add_mesh(floor_mesh(3));
    free.add_polygon_light(corners(0.5), Rgb(3));
    Scene mounted = free;
    Mesh mount;
    for (const Vec3d& corner : corners(2)) {
        mount.vertices.emplace_back(corner);
    }
    mount.triangles = {{0, 1, 2}, {0, 2, 3}};
    mount.bsdfs = {Bsdf::lambert(Rgb(0.5F))};
    mounted.add_mesh(mount);
    const Camera below = camera_above(1, 1);
    const Picture expected = picture(*free.compile(), below, {.samples = 512});
    EXPECT_GT(expected[0], 0.01F);
    EXPECT_EQ(picture(*mounted.compile(), below, {.samples = 512}), expected);
}

TEST(MonteCarloRender, PixelsHaveRandomNumbersOfTheirOwn) {
    Scene scene;
    scene.add_mesh(floor_mesh(9));
    scene.add_sphere_light({0, 0, 0}, 50, Rgb(1));  // all pixels see the same
    Picture image = picture(*scene.compile(), camera_above(1), {.samples = 1024});
    std::set<float> values;
    for (std::size_t i = 0; i < image.size(); i += 4) {
        values.insert(image[i]);
        EXPECT_NEAR(image[i], 0.5, 0.1);
    }
    EXPECT_GT(values.size(), std::size_t{kSize * kSize - 3});
}

TEST(MonteCarloRender, NoLightIsBlackAndNothingIsTransparent) {
    Scene scene;
    scene.add_mesh(floor_mesh(1));
    const Picture image = picture(*scene.compile(), camera_above(2), {.samples = 64});
    double covered = 0;
    for (std::size_t i = 0; i < image.size(); i += 4) {
        EXPECT_EQ(std::abs(image[i]) + std::abs(image[i + 1]) + std::abs(image[i + 2]), 0.0F);
        covered += image[i + 3] / (kSize * kSize);
    }
    EXPECT_NEAR(covered, 0.25, 1e-6);  // its edges lie between pixels
}

}  // namespace
}  // namespace shlight
