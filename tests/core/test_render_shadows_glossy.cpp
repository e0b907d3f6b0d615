// SPDX-License-Identifier: MIT
//
// Shadows in reflections: silhouettes in mirrors where geometry has them, and glossy penumbrae against dense cubature
// of what is seen of the light.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "quadrature.h"
#include "render_scenes.h"

namespace shlight {
namespace {

using namespace testing;

constexpr int kSize = 32;

/// A floor that reflects lights at height 2, the half plane x < 0 at height 1 before them and a ceiling behind, which
/// must not block.
struct Reflection {
    Scene scene;
    // Below the half plane. The reflected middle of the picture is at (0, 3.4, 2).
    Camera camera = Camera(look_at({0.3, -1.7, 0.95}, {0, 0, 0}), 0.5);

    explicit Reflection(const Bsdf& bsdf, double blocked_up_to = 0) {
        scene.add_mesh(floor_mesh(10, 0, bsdf));
        Mesh blocker = floor_mesh(20, 1);
        blocker.transforms = {frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {blocked_up_to - 20, 0, 0})};
        scene.add_mesh(blocker);
        scene.add_mesh(floor_mesh(10, 3));
        scene.add_mesh(sail_mesh());
    }

    /// The floor point on the ray through a pixel's centre, and the direction back.
    struct View {
        Vec3d point, towards_viewer;
    };
    View view(int column, int row, int size) const {
        const Window w = camera.window(size, size);
        const Ray ray = camera.ray(w.left + (column + 0.5) / size * (w.right - w.left),
                                   w.top + (row + 0.5) / size * (w.bottom - w.top));
        const Vec3d direction(ray.direction);
        return {Vec3d(ray.origin) - ray.origin.z / direction.z * direction, -direction};
    }
};

RenderSettings with_rays(int shadow_rays) {
    RenderSettings settings = analytic_settings();
    settings.shadow_rays = shadow_rays;
    return settings;
}

const std::vector<Vec3d> kRectangle = {{-0.7, 2.8, 2}, {-0.7, 4.1, 2}, {0.5, 4.1, 2}, {0.5, 2.8, 2}};

/// How far inside the light's outline a ray along a unit direction meets it, as a length or angle.
double depth_in_rectangle(const Vec3d& point, const Vec3d& direction) {
    const Vec3d met = point + 2 / direction.z * direction;
    return std::min({met.x + 0.7, 0.5 - met.x, met.y - 2.8, 4.1 - met.y});
}

double depth_in_cap(const Vec3d& point, const Vec3d& direction, bool facing_disk) {
    const Vec3d center = Vec3d(0.1, 3.4, 2) - point;
    const double angle = std::atan2(glm::length(glm::cross(direction, center)), glm::dot(direction, center));
    return (facing_disk ? std::atan(0.6 / glm::length(center)) : std::asin(0.6 / glm::length(center))) - angle;
}

/// Kinds of light: a lamp, a glowing face, a sphere, a disk.
constexpr int kKinds = 4;

void add_light(Scene& scene, int kind, float radiance) {
    if (kind == 0) {
        scene.add_polygon_light(kRectangle, Rgb(radiance));
    } else if (kind == 1) {
        Mesh face;
        for (const Vec3d& v : kRectangle) {
            face.vertices.emplace_back(v);
        }
        face.triangles = {{0, 1, 2}, {0, 2, 3}};
        face.bsdfs = {Bsdf()};
        face.emission = {Rgb(radiance)};
        scene.add_mesh(face);
    } else {
        scene.add_sphere_light({0.1, 3.4, 2}, 0.6, Rgb(radiance), kind == 3);
    }
}

TEST(RenderShadowsGlossy, AMirrorShowsSilhouettesExactly) {
    for (const int rays : {1, 16}) {
        for (int kind = 0; kind < kKinds; ++kind) {
            Reflection setup(Bsdf::ggx(0, Rgb(1)));
            add_light(setup.scene, kind, 3);
            const Image image = render_image(setup.scene, setup.camera, kSize, kSize, with_rays(rays));
            int seen = 0;
            int blocked = 0;
            for (int row = 0; row < kSize; ++row) {
                for (int column = 0; column < kSize; ++column) {
                    const auto view = setup.view(column, row, kSize);
                    const Vec3d mirrored(-view.towards_viewer.x, -view.towards_viewer.y, view.towards_viewer.z);
                    const double inside = kind < 2 ? depth_in_rectangle(view.point, mirrored)
                                                   : depth_in_cap(view.point, mirrored, kind == 3);
                    const double beside = view.point.x + mirrored.x / mirrored.z;  // of the half plane
                    if (std::abs(inside) < 1e-4 || std::abs(beside) < 1e-4) continue;
                    seen += inside > 0 && beside > 0 ? 1 : 0;
                    blocked += inside > 0 && beside < 0 ? 1 : 0;
                    EXPECT_EQ(image.red(column, row), inside > 0 && beside > 0 ? 3 : 0)
                        << "kind " << kind << ", pixel " << column << ", " << row;
                }
            }
            EXPECT_GE(seen, 25) << kind;
            EXPECT_GE(blocked, 25) << kind;
            EXPECT_LE(image.report.shadow_rays, image.report.hits) << "no more than the one direction";
        }
    }
}

/// Radiance from the visible part of the unit-radiance rectangle next to the half plane, over cells much smaller than
/// any lobe here is wide.
double reflected(const Bsdf& bsdf, const Vec3d& point, const Vec3d& towards_viewer) {
    const double left = std::max(-0.7, -point.x);  // the line over the edge at height 1 goes on to height 2
    const std::vector<Vec3d> seen = {{left, 2.8, 2}, {left, 4.1, 2}, {0.5, 4.1, 2}, {0.5, 2.8, 2}};
    const auto value = [&](const Vec3d& wi) { return double{bsdf.evaluate(wi, towards_viewer).x}; };
    return left < 0.5 ? over_parallelogram(point, seen, 80, value) : 0;
}

TEST(RenderShadowsGlossy, AHalfHiddenLightAgainstCubature) {
    // n points spread evenly measure a straight cut with an error of about n^-3/4 of what is cut, here in the third or
    // so of the lit pixels in which the lobe is cut; twice that for the unevenness of weights. Of the mean
    // of 256 pixels it is a 16th.
    constexpr int kPixels = 16;
    for (const float roughness : {0.1F, 0.2F, 0.3F, 0.6F}) {
        SCOPED_TRACE(roughness);
        const Bsdf bsdf = Bsdf::ggx(roughness, Rgb(1));
        Reflection setup(bsdf);
        add_light(setup.scene, 0, 1);
        std::vector<double> truth;
        double mean = 0;
        for (int i = 0; i < kPixels * kPixels; ++i) {
            const auto view = setup.view(i % kPixels, i / kPixels, kPixels);
            truth.push_back(reflected(bsdf, view.point, view.towards_viewer));
            mean += truth.back() / (kPixels * kPixels);
        }
        for (const int rays : {16, 1024}) {
            const Image image = render_image(setup.scene, setup.camera, kPixels, kPixels, with_rays(rays));
            double squares = 0;
            double bias = 0;
            for (int i = 0; i < kPixels * kPixels; ++i) {
                const double error = image.red(i % kPixels, i / kPixels) - truth[static_cast<std::size_t>(i)];
                squares += error * error / (kPixels * kPixels);
                bias += error / (kPixels * kPixels);
            }
            EXPECT_LE(std::sqrt(squares), mean * 2 * std::pow(rays, -0.75)) << rays;
            EXPECT_LE(std::abs(bias), mean * 0.125 * std::pow(rays, -0.75) + 1e-3 * mean) << rays;
        }
    }
}

TEST(RenderShadowsGlossy, WhollySeenLightsKeepEveryBit) {
    for (const float roughness : {0.0F, 0.01F, 0.1F, 0.3F, 1.0F}) {
        for (int kind = 0; kind < kKinds; ++kind) {
            Reflection setup(Bsdf::ggx(roughness, Rgb(0.1F), 1.5F) + Bsdf::lambert(Rgb(0.3F)), -15);
            add_light(setup.scene, kind, 1);
            const Image plain = render_image(setup.scene, setup.camera, kSize, kSize, with_rays(0));
            const Image shadowed = render_image(setup.scene, setup.camera, kSize, kSize, with_rays(16));
            EXPECT_GT(shadowed.report.shadow_rays, 0U);
            EXPECT_EQ(plain.values, shadowed.values) << "roughness " << roughness << ", kind " << kind;
        }
    }
}

TEST(RenderShadowsGlossy, WhollyHiddenLightsAreBlack) {
    for (const float roughness : {0.0F, 0.01F, 0.1F, 0.3F, 1.0F}) {
        for (int kind = 0; kind < kKinds; ++kind) {
            Reflection setup(Bsdf::ggx(roughness, Rgb(0.1F), 1.5F), 20);
            add_light(setup.scene, kind, 1);
            const Image image = render_image(setup.scene, setup.camera, kSize, kSize, with_rays(16));
            EXPECT_EQ(image.report.shadow_rays > 0, roughness > 0);  // a mirror shows what is in its way
            for (int i = 0; i < kSize * kSize; ++i) {
                ASSERT_EQ(image.red(i % kSize, i / kSize), 0) << "roughness " << roughness << ", kind " << kind;
            }
        }
    }
}

TEST(RenderShadowsGlossy, AHiddenPeakStaysHiddenUnderAdaptiveRays) {
    // A ball in a long reflection at a grazing view: behind it a narrow lobe's peak is hidden, its tails are not, and
    // the pixels on its shadow's edge take more camera rays with fewer shadow rays each.
    Scene scene;
    scene.add_mesh(floor_mesh(200, 0, Bsdf::ggx(0.2F, Rgb(0.9F))));
    scene.add_mesh(sphere_mesh({2.3, 6, 0.4}, 0.4, 24, true));
    scene.add_polygon_light({{2.5, 30, 1.4}, {6.5, 30, 1.4}, {6.5, 30, 3.4}, {2.5, 30, 3.4}}, Rgb(15));
    const Camera camera(look_at({0, -7, 1}, {2.2, 5, 0}), 0.16);
    RenderSettings settings;
    settings.sampling = PixelSampling::fixed(16);
    settings.shadow_rays = 128;
    const Image truth = render_image(scene, camera, kSize, kSize, settings);
    settings.sampling = PixelSampling();
    settings.shadow_rays = 16;
    const Image image = render_image(scene, camera, kSize, kSize, settings);
    double excess = 0;
    double all = 0;
    for (std::size_t i = 0; i < truth.values.size(); i += 4) {
        excess += std::max(0.0, static_cast<double>(image.values[i]) - 1.1 * truth.values[i]);
        all += truth.values[i];
    }
    // The bound covers noise and differently sampled edges; light leaking through the ball would be several times
    // larger.
    EXPECT_LE(excess, 0.006 * all);
    RecordProperty("excess", std::to_string(excess / all));
}

}  // namespace
}  // namespace shlight
