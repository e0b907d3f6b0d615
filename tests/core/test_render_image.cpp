// SPDX-License-Identifier: MIT
//
// Pictures without shadows against closed forms. Lambert floors have exact fits of order 2, so what is left is float
// rounding of the coefficients, of the hit and of the image: 1e-5 is some forty times that of one operation chain.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "quadrature.h"
#include "render_scenes.h"

namespace shlight {
namespace {

using namespace testing;

constexpr double kPi = std::numbers::pi;
constexpr double kTolerance = 1e-5;
constexpr int kSize = 24;
constexpr double kHalf = 2;

void expect_close(double value, double truth, double largest) {
    EXPECT_LE(std::abs(value - truth), kTolerance * largest);
}

/// Largest error of a picture of a floor under one light, ÷ kTolerance and `largest`, about the truth's maximum.
double error_of(const Image& image, double largest, const std::function<double(const Vec3d&)>& truth) {
    const auto expected = [&](int column, int row) { return truth(floor_point(column, row, kSize, kHalf)); };
    return picture_error(image, expected).largest / (kTolerance * largest);
}

Image floor_under(const std::function<void(Scene&)>& add, const RenderSettings& settings = analytic_settings()) {
    Scene scene;
    scene.add_mesh(floor_mesh(10));
    add(scene);
    return render_image(scene, camera_above(kHalf), kSize, kSize, settings);
}

TEST(RenderImage, SphereCutByTheHorizon) {
    // A centre in the floor's plane: half the cap is kept. Seen from above it fills the segment of the unit disk
    // between the horizon's arc and the chord at cosσ, and that area, σ - sinσ cosσ, is ∫ cosθ dω.
    const Image image = floor_under([](Scene& scene) { scene.add_sphere_light({4, 0, 0}, 1, Rgb(1)); });
    const auto truth = [](const Vec3d& point) {
        const double sine = 1 / glm::length(Vec3d(4, 0, 0) - point);
        const double sigma = std::asin(sine);
        return 0.5 / kPi * (sigma - sine * std::cos(sigma));
    };
    EXPECT_LE(error_of(image, 0.05, truth), 1);
}

TEST(RenderImage, PolygonLightShinesToItsFrontOnly) {
    const std::vector<Vec3d> down = {{-0.5, -0.5, 1}, {-0.5, 0.7, 1}, {0.9, 0.7, 1}, {0.9, -0.5, 1}};
    const std::vector<Vec3d> up(down.rbegin(), down.rend());
    const Image bright = floor_under([&](Scene& scene) { scene.add_polygon_light(down, Rgb(3)); });
    EXPECT_LE(error_of(bright, 1, [&](const Vec3d& point) { return 1.5 * form_factor(point, down); }), 1);
    const Image black = floor_under([&](Scene& scene) { scene.add_polygon_light(up, Rgb(3)); });
    EXPECT_EQ(error_of(black, 1, [](const Vec3d&) { return 0.0; }), 0);
}

TEST(RenderImage, PolygonLightCutByTheHorizon) {
    // A wall of light through the floor: what lies below does not count.
    const std::vector<Vec3d> wall = {{3, -1, -2}, {3, -1, 1}, {3, 1, 1}, {3, 1, -2}};
    const std::vector<Vec3d> above = {{3, -1, 0}, {3, -1, 1}, {3, 1, 1}, {3, 1, 0}};
    const Image image = floor_under([&](Scene& scene) { scene.add_polygon_light(wall, Rgb(1)); });
    EXPECT_LE(error_of(image, 0.3, [&](const Vec3d& point) { return 0.5 * form_factor(point, above); }), 1);
}

Mesh emitter(const std::vector<Vec3d>& quad, const Rgb& radiance) {
    Mesh mesh;
    mesh.vertices.assign(quad.begin(), quad.end());
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.emission = {radiance};
    return mesh;
}

TEST(RenderImage, EmissiveQuadEqualsPolygonLightAndIsSeen) {
    const std::vector<Vec3d> quad = {{0.5, -0.5, 0.25}, {0.5, 0.5, 0.25}, {1.5, 0.5, 1.25}, {1.5, -0.5, 1.25}};
    for (const bool reversed : {false, true}) {  // both sides emit
        const std::vector<Vec3d> wound = reversed ? std::vector<Vec3d>(quad.rbegin(), quad.rend()) : quad;
        RenderSettings settings = analytic_settings();
        settings.shadow_rays = 4;  // the emitter must not shadow itself
        const Image image = floor_under([&](Scene& scene) { scene.add_mesh(emitter(wound, Rgb(2))); }, settings);
        const auto truth = [&](const Vec3d& point) {
            return point.x > 0.5 && point.x < 1.5 && std::abs(point.y) < 0.5 ? 2 : form_factor(point, quad);
        };
        EXPECT_LE(error_of(image, 1, truth), 1);
        EXPECT_EQ(image.red(18, 12), 2);
    }
}

TEST(RenderImage, MirroredAndStretchedInstancesKeepTheirNormals) {
    // The top of a smooth ellipsoid, (a) from vertices in the world, (b) as one of two instances, (c) mirrored. Its
    // normal there is by the inverse transpose.
    const glm::dmat4 stretch = frame_matrix({2, 0, 0}, {0, 0.5, 0}, {0.3, 0, 1}, {0.1, 0, 0});
    const glm::dmat4 mirror = frame_matrix({1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, 0});
    const glm::dmat4 far_away = frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {100, 0, 0});
    const Vec3d normal = glm::normalize(Vec3d(glm::transpose(glm::inverse(stretch)) * glm::dvec4(0, 0, 1, 0)));
    const Vec3d light(3, 2, 4);
    const Vec3d top(0.4, 0, 1);
    const Camera close(frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, Vec3d(0.4, 0, 10)),
                       Window{-1e-3, 1e-3, -1e-3, 1e-3}, Projection::orthographic);
    const Vec3d way = light - top;
    const double truth = 0.5 * 10 * 0.25 / glm::dot(way, way) * glm::dot(normal, glm::normalize(way));
    for (const std::vector<glm::dmat4>& transforms :
         {std::vector{stretch}, std::vector{stretch, far_away}, std::vector{stretch * mirror, far_away}}) {
        Mesh ball = sphere_mesh({0, 0, 0}, 1, 24, true);
        ball.transforms = transforms;
        Scene scene;
        scene.add_mesh(ball);
        scene.add_sphere_light(light, 0.5, Rgb(10));
        const Image pole = render_image(scene, close, 1, 1, analytic_settings());
        EXPECT_LE(std::abs(pole.red(0, 0) - truth), 2e-3 * truth);  // smooth normals of 24 rings, 1e-3 from the pole
    }
}

TEST(RenderImage, BackFacesAreTurnedToTheViewer) {
    const auto picture = [](bool flipped, bool smooth) {
        Mesh mesh = floor_mesh(10);
        if (flipped) {
            mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
        }
        if (smooth) {
            mesh.vertex_normals.assign(4, Vec3f(0, 0, flipped ? -3.0F : 3.0F));
        }
        Scene scene;
        scene.add_mesh(mesh);
        scene.add_sphere_light({0, 0, 1}, 0.5, Rgb(1));
        return render_image(scene, camera_above(kHalf), kSize, kSize, analytic_settings()).values;
    };
    const std::vector<float> expected = picture(false, false);
    EXPECT_EQ(picture(true, false), expected);
    EXPECT_EQ(picture(true, true), expected);
    EXPECT_EQ(picture(false, true), expected);
}

TEST(RenderImage, CornerNormalsAreInterpolated) {
    // Normals leaning by ±45° along x: in the middle of the floor they cancel to z.
    Mesh mesh = floor_mesh(2);
    const Vec3f left(-1, 0, 1);
    const Vec3f right(1, 0, 1);
    mesh.corner_normals = {left, right, right, left, right, left};
    Scene scene;
    scene.add_mesh(mesh);
    const Vec3d center(0, 0, 50);
    scene.add_sphere_light(center, 10, Rgb(1));
    const Image image = render_image(scene, camera_above(kHalf), kSize, kSize, analytic_settings());
    for (int column = 0; column < kSize; ++column) {
        const Vec3d point = floor_point(column, kSize / 2, kSize, kHalf);
        const Vec3d normal = glm::normalize(Vec3d(point.x / 2, 0, 1));
        const Vec3d way = center - point;
        const double truth = 0.5 * 100 / glm::dot(way, way) * glm::dot(normal, glm::normalize(way));
        expect_close(image.red(column, kSize / 2), truth, 0.02);
    }
}

TEST(RenderImage, InsideTheSphereTheHemisphereIsLit) {
    for (const int rays : {0, 16}) {
        RenderSettings settings = analytic_settings();
        settings.shadow_rays = rays;
        const Image image = floor_under([](Scene& scene) { scene.add_sphere_light({0, 0, 0.5}, 3, Rgb(1)); }, settings);
        EXPECT_LE(error_of(image, 0.5, [](const Vec3d&) { return 0.5; }), 1);
    }
}

TEST(RenderImage, ContactIsFinite) {
    // Spheres that touch, cut and rest on the floor, polygons in its plane, on it and through it; all orders of GGX.
    Scene scene;
    scene.add_mesh(floor_mesh(4, 0, Bsdf::layer(Bsdf::ggx(0.4F, Rgb(0.04F)), Bsdf::lambert(Rgb(0.5F)))));
    scene.add_sphere_light({1, 1, 0.5}, 0.5, Rgb(1));
    scene.add_sphere_light({-1, 1, 0}, 0.5, Rgb(1));
    scene.add_sphere_light({0, 0, 1e-9}, 1e-9, Rgb(1));
    scene.add_sphere_light({0.0625, 0.0625, 0}, 0.3, Rgb(1), true);
    scene.add_polygon_light({{-1, -1, 0}, {-1, -0.5, 0}, {-0.5, -0.5, 0}, {-0.5, -1, 0}}, Rgb(1));
    scene.add_polygon_light({{0.5, -1, -0.5}, {0.5, -1, 0.5}, {1.5, -1, 0.5}, {1.5, -1, -0.5}}, Rgb(1));
    scene.add_mesh(emitter({{-1, 0, 0}, {-1, 0.5, 0}, {-1.5, 0.5, 0}, {-1.5, 0, 0}}, Rgb(1)));
    scene.add_mesh(emitter({{1, 0, 0}, {1, 0.5, 0}, {1, 0.5, 1}, {1, 0, 1}}, Rgb(1)));
    for (const int rays : {0, 4}) {
        RenderSettings settings = analytic_settings();
        settings.shadow_rays = rays;
        const Image image = render_image(scene, camera_above(2), 64, 64, settings);
        for (const float value : image.values) {
            EXPECT_TRUE(std::isfinite(value));
            EXPECT_GE(value, 0);
            EXPECT_LE(value, 100);
        }
    }
}

TEST(RenderImage, ALightInTheFloorsPlaneDoesNotSpeckle) {
    // A polygon lamp mounted flush in a floor that it shines away from, at coordinates that float cannot hold.
    const float height = 0.1F;
    Scene scene;
    scene.add_mesh(floor_mesh(3.3F, height));
    scene.add_polygon_light({{-1, -1, 0.1}, {-1, 1, 0.1}, {1, 1, 0.1}, {1, -1, 0.1}}, Rgb(1));
    const Image image = render_image(scene, camera_above(2), 64, 64, analytic_settings());
    for (int i = 0; i < 64 * 64; ++i) {
        EXPECT_EQ(image.red(i % 64, i / 64), 0);
    }
}

TEST(RenderImage, SharedShadingPointsStayWithinTheTolerance) {
    // The tolerance decides with a fixed order only how many hits of a pixel share a point; 1e-12: none. Curved and
    // flat, glossy and diffuse, lights near and far.
    const Bsdf material = Bsdf::ggx(0.5F, Rgb(0.9F)) + Bsdf::lambert(Rgb(0.3F));
    Scene scene;
    Mesh ball = sphere_mesh({0, 0, 0.5}, 0.5, 48, true);
    ball.bsdfs = {material};
    scene.add_mesh(floor_mesh(10, 0, material));
    scene.add_mesh(ball);
    scene.add_sphere_light({0.9, -0.5, 0.4}, 0.3, Rgb(1));
    scene.add_polygon_light({{-1, -1, 2}, {-1, 1, 2}, {1, 1, 2}, {1, -1, 2}}, Rgb(1));
    const Camera camera(look_at({0, -3, 2}, {0, 0, 0}), 0.7);
    RenderSettings settings = analytic_settings();
    settings.sampling = PixelSampling::refined(16);
    settings.order = 24;
    const Image shared = render_image(scene, camera, 48, 48, settings);
    settings.tolerance = 1e-12;
    const Image single = render_image(scene, camera, 48, 48, settings);
    double brightest = 0;
    double largest = 0;
    double squares = 0;
    for (std::size_t i = 0; i < single.values.size(); ++i) {
        brightest = std::max<double>(brightest, single.values[i]);
        const double error = std::abs(shared.values[i] - single.values[i]);
        largest = std::max(largest, error);
        squares += error * error / static_cast<double>(single.values.size());
    }
    EXPECT_LE(largest, 1e-3 * brightest);
    EXPECT_LE(std::sqrt(squares), 2e-4 * brightest);
    EXPECT_GT(largest, 0) << "no hits were shared";
}

/// Radiance that a point of a floor reflects from a sphere of radiance 1.
Vec3d reflected(const Bsdf& material, const Vec3d& point, const Vec3d& wo, const Vec3d& center, double radius) {
    const Vec3d way = center - point;
    Vec3d sum(0);
    for (const Sample& sample : clipped_cap_samples(way, std::asin(radius / glm::length(way)), 32)) {
        sum += sample.weight * Vec3d(material.evaluate(sample.direction, wo));
    }
    return sum;
}

TEST(RenderImage, AGlossyFloorKeepsTheToleranceOfTheLightAtEachPoint) {
    const Bsdf material = Bsdf::ggx(0.55F, Rgb(0.3F, 0.6F, 0.9F));
    const std::array<Vec3d, 3> centers = {Vec3d(0.5, 0.3, 1), Vec3d(-1.5, 1, 0.6), Vec3d(0, 2.5, 1.5)};
    constexpr double kRadius = 0.2;
    Scene scene;
    scene.add_mesh(floor_mesh(10, 0, material));
    for (const Vec3d& center : centers) {
        scene.add_sphere_light(center, kRadius, Rgb(1));
    }
    const Vec3d eye(1, -3, 2);
    const Camera camera(look_at(eye, {0, 0.5, 0}), 0.7);
    RenderSettings settings = analytic_settings();
    const Image image = render_image(scene, camera, kSize, kSize, settings);
    const Window window = camera.window(kSize, kSize);
    std::vector<Vec3d> truth;
    Vec3d mean(0);
    for (int row = 0; row < kSize; ++row) {
        for (int column = 0; column < kSize; ++column) {
            const double x = std::lerp(window.left, window.right, (column + 0.5) / kSize);
            const double y = std::lerp(window.top, window.bottom, (row + 0.5) / kSize);
            const Vec3d d(camera.ray(x, y).direction);
            const Vec3d point = eye - d * (eye.z / d.z);
            Vec3d& sum = truth.emplace_back(0);
            for (const Vec3d& center : centers) {
                sum += reflected(material, point, -glm::normalize(d), center, kRadius);
            }
            mean += sum / double{kSize * kSize};
        }
    }
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const Rgb color = image.color(static_cast<int>(i) % kSize, static_cast<int>(i) / kSize);
        for (int channel = 0; channel < 3; ++channel) {
            ASSERT_LE(std::abs(color[channel] - truth[i][channel]),
                      settings.tolerance * std::max(truth[i][channel], 0.1 * mean[channel]))
                << "pixel " << i << ", channel " << channel;
        }
    }
}

}  // namespace
}  // namespace shlight
