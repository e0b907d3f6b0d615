// SPDX-License-Identifier: MIT
//
// Depth of field and panoramas: where rays start and go, and what that makes of edges, points and the picture's rim.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "render_scenes.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

using namespace testing;

constexpr double kPi = std::numbers::pi;

Vec3d at_depth(const Ray& ray, double depth) {
    const Vec3d origin(ray.origin);
    const Vec3d direction(ray.direction);
    return origin + direction * ((depth + origin.z) / -direction.z);
}

TEST(CameraLens, RaysThroughTheApertureMeetInFocus) {
    const Window window = {-1, 1, -1, 1};
    const Aperture aperture = {.size = 0.4, .focus_distance = 3, .blades = 5, .rotation = 0.3, .ratio = 1.6};
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        const Camera camera(glm::dmat4(1), window, projection, {0.5, 20}, aperture);
        const double scale = projection == Projection::perspective ? 3 : 1;
        for (const glm::dvec2& square : nested_points(64)) {
            const Ray ray = camera.ray(0.3, -0.6, square);
            EXPECT_LE(glm::distance(at_depth(ray, 3), Vec3d(0.3 * scale, -0.6 * scale, -3)), 1e-5);
            const glm::dvec2 lens = aperture.point(square);
            const Vec3d start = projection == Projection::perspective ? Vec3d(0) : Vec3d(0.3, -0.6, 0);
            EXPECT_LE(glm::distance(at_depth(ray, 0), start + Vec3d(lens, 0)), 1e-5);
            // Clipping is by depth.
            EXPECT_NEAR(ray.t_min * -ray.direction.z, 0.5, 1e-5);
            EXPECT_NEAR(ray.t_max * -ray.direction.z, 20, 1e-4);
        }
    }
}

TEST(CameraLens, ApertureIsADiskOrAPolygonWithoutPreference) {
    constexpr std::uint32_t kCount = 1 << 14;
    for (const int blades : {0, 3, 6}) {
        const Aperture aperture = {.size = 0.5, .blades = blades, .rotation = blades > 0 ? 0.2 : 0.0, .ratio = 2};
        double moment = 0;  // of the distance across a polygon's first side from the middle
        double farthest = 0;
        glm::dvec2 sum(0);
        for (const glm::dvec2& square : nested_points(kCount)) {
            const glm::dvec2 p = aperture.point(square) * glm::dvec2(2, 1) / 0.5;
            sum += p;
            moment += glm::dot(p, p);
            farthest = std::max(farthest, p.x * std::cos(0.2) + p.y * std::sin(0.2));
        }
        // A regular polygon of circumradius 1 has ⟨r²⟩ = (2 + cos 2π/n) / 6, a disk 1/2.
        const double expected = blades > 0 ? (2 + std::cos(2 * kPi / blades)) / 6 : 0.5;
        EXPECT_NEAR(moment / kCount, expected, 1e-3) << blades;
        EXPECT_NEAR(farthest, blades > 0 ? std::cos(kPi / blades) : 1, 1e-2) << blades;
        EXPECT_LE(glm::length(sum) / kCount, 1e-3) << blades;
    }
}

/// Share of a disk of radius 1 with x < edge.
double disk_share(double edge) {
    const double x = std::clamp(edge, -1.0, 1.0);
    return 0.5 + (x * std::sqrt(1 - x * x) + std::asin(x)) / kPi;
}

TEST(CameraLens, AnEdgeIsBlurredByTheAperturesProjection) {
    // A shining half plane x < 0 at depth 6, seen through a disk of radius 0.2 that is in focus at 2: a point there is
    // spread over a disk of radius 0.2 · (6 - 2) / 2 = 0.4.
    Mesh mesh = floor_mesh(50, -6);
    mesh.transforms = {frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-50, 0, 0})};
    mesh.emission = {Rgb(1)};
    Scene scene;
    scene.add_mesh(mesh);
    const Aperture aperture = {.size = 0.2, .focus_distance = 2};
    constexpr int kSize = 24;
    RenderSettings settings = analytic_settings();
    settings.sampling = {.first_samples = 1, .min_samples = 4, .max_samples = 1024, .noise_threshold = 0.003};
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        const double half = projection == Projection::perspective ? 0.1 : 0.6;
        const Camera camera(glm::dmat4(1), {-half, half, -half, half}, projection, {}, aperture);
        const Image image = render_image(scene, camera, kSize, kSize, settings);
        double squares = 0;
        for (int column = 0; column < kSize; ++column) {
            // The mean over the pixel, by the midpoints of 16 strips.
            double truth = 0;
            for (int i = 0; i < 16; ++i) {
                const double x = ((column + (i + 0.5) / 16) / kSize * 2 - 1) * 0.6;
                truth += disk_share(-x / 0.4) / 16;
            }
            for (int row = 0; row < kSize; ++row) {
                squares += std::pow(image.red(column, row) - truth, 2);
                EXPECT_NEAR(image.red(column, row), truth, 0.03) << column << " " << row;
            }
        }
        EXPECT_LE(std::sqrt(squares) / kSize, 0.004);
    }
}

TEST(CameraLens, APointFarOutOfFocusIsFound) {
    // It fills 0.6 % of the disk that it is blurred to, and most pixels see nothing of it with their first rays.
    Scene scene;
    const Bsdf black = Bsdf::lambert(Rgb(0));
    Mesh wall = floor_mesh(50, -20, black);
    wall.emission = {Rgb(1)};
    scene.add_mesh(wall);
    Mesh point = floor_mesh(0.04F, -8, black);
    point.emission = {Rgb(250)};
    scene.add_mesh(point);
    const Aperture aperture = {.size = 0.2, .focus_distance = 2};
    constexpr int kSize = 32;
    const Camera camera(glm::dmat4(1), {-0.12, 0.12, -0.12, 0.12}, Projection::perspective, {}, aperture);
    RenderSettings settings = analytic_settings();
    settings.sampling = {.first_samples = 1, .min_samples = 4, .max_samples = 1024, .noise_threshold = 0.02};
    const Image image = render_image(scene, camera, kSize, kSize, settings);
    // The point's light, its share 0.08² of the unit disk, is spread evenly over a disk of radius 0.6 at depth 8.
    const double bright = 1 + 249 * 0.08 * 0.08 / (kPi * 0.6 * 0.6);
    const double pixel = 2 * 0.12 * 8 / kSize;
    double inside = 0;
    double outside = 0;
    double pixels = 0;
    for (int column = 0; column < kSize; ++column) {
        for (int row = 0; row < kSize; ++row) {
            const double distance = std::hypot(column + 0.5 - kSize / 2.0, row + 0.5 - kSize / 2.0) * pixel;
            if (distance < 0.5) {
                inside += image.red(column, row);
                ++pixels;
                EXPECT_GE(image.red(column, row), 1.2) << column << " " << row;
            } else if (distance > 0.7) {
                outside = std::max<double>(outside, std::abs(image.red(column, row) - 1));
            }
        }
    }
    EXPECT_NEAR(inside / pixels, bright, 0.03 * bright);
    EXPECT_EQ(outside, 0);
}

TEST(CameraLens, ThePictureIsTheSameForAnyNumberOfThreadsAndPixelsDiffer) {
    Mesh mesh = floor_mesh(50, -6);
    mesh.transforms = {frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-50, 0, 0})};
    mesh.emission = {Rgb(1)};
    Scene scene;
    scene.add_mesh(mesh);
    const Camera camera(glm::dmat4(1), {-0.05, 0.05, -0.05, 0.05}, Projection::perspective, {},
                        {.size = 0.2, .focus_distance = 2});
    const auto pixels = [&](int threads) {
        RenderSettings settings = analytic_settings();
        settings.sampling = {.first_samples = 1, .min_samples = 4, .max_samples = 64};
        settings.threads = threads;
        return render_image(scene, camera, 24, 24, settings).values;
    };
    const std::vector<float> one = pixels(1);
    EXPECT_EQ(one, pixels(3));
    // Rows see the same, by other points of the aperture.
    EXPECT_FALSE(std::equal(one.begin(), one.begin() + 96, one.begin() + 96));
}

TEST(CameraLens, PanoramasLookWhereTheirFormulasSay) {
    const auto looks = [](const Panorama& panorama, double u, double v, const Vec3d& expected) {
        const Ray ray = Camera(look_at({1, 2, 3}, {4, 1, 2}), panorama, {0, 1, 0, 1}, {0.5, 9}).ray(u, v);
        const Vec3d direction = glm::dmat3(look_at({1, 2, 3}, {4, 1, 2})) * expected;
        EXPECT_LE(glm::distance(Vec3d(ray.direction), direction), 1e-6) << panorama.index();
        EXPECT_EQ(ray.origin, Vec3f(1, 2, 3));
        EXPECT_NEAR(ray.t_min, 0.5, 1e-6);
        EXPECT_NEAR(ray.t_max, 9, 1e-5);
    };
    const auto around = [](double longitude, double latitude) {
        return Vec3d(std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                     -std::cos(latitude) * std::cos(longitude));
    };
    const auto off_axis = [](double angle, double side) {
        return Vec3d(std::sin(angle) * std::cos(side), std::sin(angle) * std::sin(side), -std::cos(angle));
    };
    looks(Equirectangular{}, 0.75, 0.75, around(kPi / 2, kPi / 4));
    looks(Equirectangular{-0.5, 1.5, -0.2, 1.2}, 0.25, 0.5, around(0, 0.5));
    looks(CentralCylindrical{-1, 1, -2, 2}, 0.75, 0.75, glm::normalize(Vec3d(std::sin(0.5), 1, -std::cos(0.5))));
    looks(FisheyeEquidistant{3}, 0.5 + 0.3, 0.5 + 0.4, off_axis(1.5, std::atan2(4, 3)));
    // 0.01 m from the sensor's middle: sin θ/2 = 0.01 / (2 · 0.0125).
    looks(FisheyeEquisolid{0.0125, 3, {0.06, 0.04}}, 0.6, 0.7, off_axis(2 * std::asin(0.4), std::atan2(8, 6)));
    looks(FisheyeLensPolynomial{{-0.1, -20, 100, 0, 0}, 3, {0.06, 0.04}}, 0.6, 0.7,
          off_axis(0.1 + 20 * 0.01 - 100 * 1e-4, std::atan2(8, 6)));
    looks(EquiangularCubemapFace{}, 1, 0.5, glm::normalize(Vec3d(1, 0, -1)));
    // The ball's normal halves the angle between the view and what is mirrored.
    const Vec3d normal(0.6, 0, 0.8);
    looks(MirrorBall{}, 0.8, 0.5, glm::reflect(Vec3d(0, 0, -1), normal) * Vec3d(1, 1, -1));
}

TEST(CameraLens, OutsideAPanoramasImageIsBlackAndOpaque) {
    Scene scene;
    scene.set_environment(Environment(Rgb(1)), true);
    for (const Panorama& panorama : std::vector<Panorama>{FisheyeEquidistant{}, MirrorBall{}}) {
        const Image image = render_image(scene, Camera(glm::dmat4(1), panorama), 64, 64, analytic_settings());
        for (int column = 0; column < 64; ++column) {
            for (int row = 0; row < 64; ++row) {
                const bool inside = std::hypot(column - 31.5, row - 31.5) < 32;
                EXPECT_EQ(image.red(column, row), inside ? 1 : 0);
                EXPECT_EQ(image.alpha(column, row), 1);
            }
        }
    }
}

TEST(CameraLens, PanoramasFocusAlongTheRay) {
    const Aperture aperture = {.size = 0.3, .focus_distance = 2, .blades = 5};
    for (const Panorama& panorama : std::vector<Panorama>{Equirectangular{}, MirrorBall{}, FisheyeEquidistant{}}) {
        const Camera camera(glm::dmat4(1), panorama, {0, 1, 0, 1}, {}, aperture);
        const Vec3d ahead = *panorama_direction(panorama, 0.6, 0.7);
        for (const glm::dvec2& square : nested_points(16)) {
            const Ray ray = camera.ray(0.6, 0.7, square);
            const Vec3d origin(ray.origin);
            EXPECT_NEAR(glm::dot(origin, ahead), 0, 1e-6);
            EXPECT_NEAR(glm::length(origin), glm::length(aperture.point(square)), 1e-6);
            EXPECT_LE(glm::length(glm::cross(2.0 * ahead - origin, Vec3d(ray.direction))), 1e-6);
        }
    }
}

TEST(CameraLens, FourCoordinatesFillTheirCube) {
    // Each of 4 × 4 × 4 × 4 boxes contains four of 1024 points of pixels and lens.
    constexpr std::uint32_t kCount = 1024;
    const std::vector<glm::dvec2> pixel = nested_points(kCount);
    for (const std::uint32_t seed : {1U, 77U}) {
        std::array<int, 256> boxes{};
        for (std::uint32_t i = 0; i < kCount; ++i) {
            const glm::dvec2 lens = sobol_beyond(i, seed);
            const auto cell = [](double x) { return static_cast<std::size_t>(4 * x); };
            ++boxes[cell(pixel[i].x) + 4 * cell(pixel[i].y) + 16 * cell(lens.x) + 64 * cell(lens.y)];
        }
        EXPECT_EQ(*std::min_element(boxes.begin(), boxes.end()), 4);
        EXPECT_EQ(*std::max_element(boxes.begin(), boxes.end()), 4);
    }
    EXPECT_GE(glm::distance(sobol_beyond(0, 1), sobol_beyond(0, 77)), 1e-3);
}

}  // namespace
}  // namespace shlight
