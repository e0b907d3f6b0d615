// SPDX-License-Identifier: MIT
//
// Lights that do not shine evenly: factors, their bounds, and pictures against plain quadrature of radiance times
// f·cos.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "quadrature.h"
#include "random_input.h"
#include "render_scenes.h"
#include "shlight/emission_profile.h"
#include "slanted_floor.h"

namespace shlight {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): the scenes' own
using std::numbers::pi;

/// Tolerance relative to the largest radiance: the settings' tolerance plus the error of even lights.
constexpr double kTolerance = 3e-4;

double smoothstep(double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

TEST(RenderProfiles, SpotWithoutExtentHasASoftRim) {
    const Vec3d position(0.4, -0.3, 1.2);
    const Vec3d shines(0.2, 0.1, -1);
    const double c = std::cos(0.55);
    for (const bool times_cosine : {false, true}) {
        for (const double blend : {0.3, 1.0}) {
            const SpotProfile profile = make_spot_profile(lamp_axes(shines), 1.1, blend, times_cosine);
            EXPECT_LE(error_under([&](Scene& scene) { scene.add_spot_light(position, profile, Rgb(5)); },
                                  [&](const Vec3d& p, const Reflection& f) {
                                      const Vec3d way = position - p;
                                      const double d2 = glm::dot(way, way);
                                      const Vec3d w = way / std::sqrt(d2);
                                      const double z = -glm::dot(w, glm::normalize(shines));
                                      return 5 / d2 * smoothstep((z - c) / ((1 - c) * blend)) *
                                             (times_cosine ? z : 1.0) * f(w);
                                  },
                                  kDiffuse),
                      4e-6 * 5);
        }
    }
}

TEST(RenderProfiles, ScaledSpotHasAnEllipticalCone) {
    // Twice as wide along x, half as wide along y.
    const SpotProfile profile = make_spot_profile({{4, 0, 0}, {0, 1, 0}, {0, 0, 2}}, pi / 2, 0);
    const auto factor = [&](double x, double y) { return profile_factor(profile, glm::normalize(Vec3d(x, y, -1))); };
    EXPECT_EQ(factor(1.99, 0), 1.0);
    EXPECT_EQ(factor(2.01, 0), 0.0);
    EXPECT_EQ(factor(0, 0.49), 1.0);
    EXPECT_EQ(factor(0, -0.51), 0.0);
    EXPECT_EQ(profile_factor(profile, {0, 0, 1}), 0.0);
}

TEST(RenderProfiles, SpotWithARadiusVariesOverIt) {
    const Vec3d position(0.4, -0.3, 1.2);
    const Vec3d shines = glm::normalize(Vec3d(0.2, 0.1, -1));
    const double radius = 0.3;
    const double radiance = 5 / (pi * radius * radius);
    const double c = std::cos(0.5);
    for (const bool disk : {false, true}) {
        const auto truth = [&](const Vec3d& p, const Reflection& f) {
            const Vec3d way = position - p;
            const double half = disk ? std::atan(radius / glm::length(way)) : std::asin(radius / glm::length(way));
            const auto value = [&](const Vec3d& w) {
                return smoothstep((-glm::dot(w, shines) - c) / ((1 - c) * 0.4)) * f(w);
            };
            return radiance * integral(clipped_cap_samples(way, half, 160), value);
        };
        const SpotProfile profile = make_spot_profile(lamp_axes(shines), 1, 0.4);
        const auto add = [&](Scene& scene) { scene.add_spot_light(position, profile, Rgb(5), radius, disk); };
        for (const double roughness : {kDiffuse, 0.5, 0.15}) {
            EXPECT_LE(error_under(add, truth, roughness), kTolerance * radiance) << disk << ' ' << roughness;
        }
    }
}

TEST(RenderProfiles, SpreadOfAnAreaLight) {
    const std::vector<Vec3d> corners = {{-0.8, -0.5, 1.1}, {-0.8, 0.7, 1.1}, {1, 0.7, 1.1}, {1, -0.5, 1.1}};
    for (const double spread : {0.2, pi / 3, 3.1}) {
        const double h = spread / 2;
        const auto truth = [&](const Vec3d& p, const Reflection& f) {
            return over_parallelogram(p, corners, 200, [&](const Vec3d& w) {
                const double tangent = std::hypot(w.x, w.y) / w.z;
                return 3 * std::max(0.0, std::tan(h) - tangent) / (std::tan(h) - h) * f(w);
            });
        };
        const auto add = [&](Scene& scene) { scene.add_polygon_light(corners, Rgb(3), spread); };
        const double most = 3 * std::tan(h) / (std::tan(h) - h);
        for (const double roughness : {kDiffuse, 0.5, 0.15}) {
            // Nodes of narrow lobes meet the panel's edge in steps.
            const double steps = roughness < 0.5 ? 3 : 1;
            EXPECT_LE(error_under(add, truth, roughness), steps * kTolerance * most) << spread << ' ' << roughness;
        }
    }
}

TEST(RenderProfiles, SpreadKeepsTheLightsPower) {
    for (const double spread : {1e-3, 0.019, 0.021, 0.5, 2.0, 3.0}) {
        const EmissionProfile profile = make_spread_profile({0, 0, 2}, spread);
        double flux = 0;  // ∫ factor cosα dω = π
        for (const Node& alpha : gauss_nodes(40, 0, spread / 2)) {
            flux += alpha.weight * 2 * pi * std::sin(alpha.x) * std::cos(alpha.x) *
                    profile_factor(profile, {std::sin(alpha.x), 0, std::cos(alpha.x)});
        }
        EXPECT_LE(std::abs(flux / pi - 1), 1e-9) << spread;
    }
}

TEST(RenderProfiles, BoundsHoldOverTheirCap) {
    RandomInput random(5);
    for (int i = 0; i < 400; ++i) {
        const Vec3d axis = random.direction();
        const glm::dmat3 axes = lamp_axes(axis);
        const double blend = i % 5 == 0 ? 0.0 : random.uniform(0, 1);
        const std::vector<EmissionProfile> profiles = {
            make_spot_profile(axes, random.uniform(0.05, 3), blend, i % 2 == 0),
            make_spot_profile({random.uniform(0.2, 3) * axes[0], random.uniform(0.2, 3) * axes[1], axes[2]},
                              random.uniform(0.05, 3), blend),
            make_spread_profile(axis, random.uniform(0.05, 3.1))};
        const Vec3d middle = glm::normalize(axis + random.uniform(0, 1) * random.direction());
        const double half = random.uniform(0, 0.5);
        for (const EmissionProfile& profile : profiles) {
            const ProfileRange range = profile_range(profile, middle, half);
            EXPECT_LE(range.low, range.high);
            for (int k = 0; k < 50; ++k) {
                const Vec3d side = glm::normalize(glm::cross(middle, random.direction()));
                const double angle = half * std::sqrt(random.uniform(0, 1));
                const double factor = profile_factor(profile, std::cos(angle) * middle + std::sin(angle) * side);
                EXPECT_GE(factor, range.low - 1e-9);
                EXPECT_LE(factor, range.high + 1e-9);
            }
        }
    }
}

TEST(RenderProfiles, ASharpRimIsResolvedWithinPixels) {
    // The disk that a spot of no blend lights, of radius 1: its share of the picture, in pixels of a third of it.
    Scene scene;
    scene.add_mesh(floor_mesh(5));
    scene.add_spot_light({0, 0, 100}, make_spot_profile(lamp_axes({0, 0, -1}), 2 * std::atan(0.01), 0), Rgb(1e4F));
    RenderSettings settings;
    settings.sampling = PixelSampling::fixed(256);
    const Image image = render_image(scene, camera_above(1.1), 7, 7, settings);
    double sum = 0;
    for (int i = 0; i < 49; ++i) {
        sum += image.red(i % 7, i / 7);
    }
    const double share = sum / 49 / (0.5 / pi);
    EXPECT_LE(std::abs(share / (pi / 4.84) - 1), 4e-3);
}

TEST(RenderProfiles, PenumbraeCountWhatTheProfileLetsThrough) {
    // A spot with a radius over an edge that hides half of it, against the same picture by quadrature.
    const Vec3d position(0, 0, 2);
    const double radius = 0.5;
    const double c = std::cos(0.5);
    Scene scene;
    scene.add_mesh(floor_mesh(5));
    Mesh screen = floor_mesh(4, 1);
    for (auto& v : screen.vertices) {
        v.x += 4;  // hides x > 0
    }
    scene.add_mesh(screen);
    scene.add_spot_light(position, make_spot_profile(lamp_axes({0, 0, -1}), 1, 1), Rgb(5), radius);
    RenderSettings settings;
    settings.sampling = PixelSampling::fixed(16);
    settings.shadow_rays = 256;
    // Pixels left of the screen, which still see part of the light.
    const Image image = render_image(scene, camera_above(0.4), 8, 8, settings);
    double error = 0;
    for (int column = 0; column < 4; ++column) {
        const Vec3d p = floor_point(column, 3, 8, 0.4);
        const Vec3d way = position - p;
        double truth = 0;
        for (const Sample& s : clipped_cap_samples(way, std::asin(radius / glm::length(way)), 200)) {
            const bool seen = p.x + s.direction.x / s.direction.z <= 0;
            const double factor = smoothstep((s.direction.z - c) / (1 - c));
            truth += seen ? s.weight * s.direction.z * factor : 0;
        }
        truth *= 5 / (pi * radius * radius) * 0.5 / pi;
        error = std::max(error, std::abs(image.red(column, 3) / truth - 1));
    }
    EXPECT_LE(error, 0.02);
}

}  // namespace
}  // namespace shlight
