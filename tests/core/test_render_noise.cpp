// SPDX-License-Identifier: MIT
//
// The noise that a render tells is the noise that its picture has, and pixels that end early do not shift the mean.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render_scenes.h"

namespace shlight {
namespace {

using namespace testing;

constexpr int kSize = 24;

/// A box of half sizes about a place.
Mesh box(const Vec3d& half, const Vec3d& place) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.vertices.emplace_back((i & 4) != 0 ? half.x : -half.x, (i & 2) != 0 ? half.y : -half.y,
                                   (i & 1) != 0 ? half.z : -half.z);
    }
    for (const glm::uvec4& q : {glm::uvec4(0, 1, 3, 2), glm::uvec4(4, 6, 7, 5), glm::uvec4(0, 4, 5, 1),
                                glm::uvec4(2, 3, 7, 6), glm::uvec4(0, 2, 6, 4), glm::uvec4(1, 5, 7, 3)}) {
        mesh.triangles.emplace_back(q.x, q.y, q.z);
        mesh.triangles.emplace_back(q.x, q.z, q.w);
    }
    mesh.bsdfs = {Bsdf::lambert(Rgb(0.5F))};
    mesh.transforms = {frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, place)};
    return mesh;
}

Scene box_under_sky() {
    Scene scene;
    scene.add_mesh(floor_mesh(6));
    scene.add_mesh(box({0.4, 0.4, 0.8}, {0, 0, 0.8}));
    scene.set_environment(Environment(Rgb(0.5F)), false);
    return scene;
}

/// The shadow of thin bars, which cross the light many times.
Scene bars_before_disk() {
    Scene scene;
    scene.add_mesh(floor_mesh(6));
    for (int i = 0; i < 40; ++i) {
        scene.add_mesh(box({0.01, 1, 0.01}, {-1.3 + 0.066 * i, 0, 1}));
    }
    scene.add_disk_light({0, 0, 3}, {0, 0.6, 0}, {0.6, 0, 0}, Rgb(5));
    return scene;
}

struct Errors {
    double bias, rms;  // of pixels' values ÷ √(r² + 0.01 r̄²), as RenderReport::noise; bias: of the mean ÷ the mean
};

Errors errors(const Image& image, const Image& truth) {
    double mean = 0;
    double sum = 0;
    double squares = 0;
    const std::size_t count = truth.values.size() / 4;
    for (std::size_t i = 0; i < count; ++i) {
        mean += truth.values[4 * i] / static_cast<double>(count);
    }
    for (std::size_t i = 0; i < count; ++i) {
        const double value = truth.values[4 * i];
        const double error = image.values[4 * i] - value;
        sum += error;
        squares += error * error / (value * value + 0.01 * mean * mean);
    }
    const auto n = static_cast<double>(count);
    return {sum / n / mean, std::sqrt(squares / n)};
}

/// The floor seen from above, from below what hangs over it.
Image picture(const Scene& scene, double threshold, int samples, std::uint32_t seed = 0) {
    RenderSettings settings;
    settings.sampling.noise_threshold = threshold;
    settings.sampling.max_samples = samples;
    settings.seed = seed;
    return render_image(scene, camera_above(1.5, 4), kSize, kSize, settings);
}

TEST(RenderNoise, PixelsThatEndEarlyDoNotShiftTheMean) {
    const Scene scene = box_under_sky();
    const Image truth = picture(scene, 0, 1024);
    double bias = 0;
    for (const std::uint32_t seed : {1U, 2U, 3U, 4U}) {
        bias += errors(picture(scene, 0.02, 256, seed), truth).bias / 4;
    }
    EXPECT_LE(std::abs(bias), 1e-3);
}

TEST(RenderNoise, TheNoiseThatIsToldIsThere) {
    const Scene scene = bars_before_disk();
    const Image truth = picture(scene, 0, 2048);
    for (const double threshold : {0.05, 0.02}) {
        const Image image = picture(scene, threshold, 4096);
        const double rms = errors(image, truth).rms;
        EXPECT_LE(rms, 1.3 * image.report.noise) << threshold;
        EXPECT_GE(rms, 0.4 * image.report.noise) << threshold;
        EXPECT_LE(image.report.noise, threshold);
        EXPECT_LT(image.report.hits, truth.report.hits / 4) << "pixels end early";
    }
}

TEST(RenderNoise, ASeedDrawsOtherRays) {
    const Scene scene = box_under_sky();
    const Image first = picture(scene, 0.05, 64, 7);
    EXPECT_EQ(picture(scene, 0.05, 64, 7).values, first.values);
    const Image second = picture(scene, 0.05, 64, 8);
    // Noise of two pictures that are independent of each other.
    const double rms = errors(first, second).rms;
    EXPECT_GE(rms, 0.5 * first.report.noise);
    EXPECT_LE(rms, 2 * first.report.noise);
}

}  // namespace
}  // namespace shlight
