// SPDX-License-Identifier: MIT
//
// Directions of lobes, whose density is that of f·cos, and where directions meet lights.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lights/light_sampling.h"
#include "random_input.h"
#include "shlight/bsdf.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

using namespace testing;

constexpr std::uint32_t kPoints = 1 << 14;

Vec3d view_at(double cosine) {
    return {std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine};
}

TEST(RenderShadowsSampling, LobeDirectionsHaveTheirDensity) {
    // The mean of f·cos/density over the directions is the albedo, from the fit; f·cos is never much above the density.
    for (const double roughness : {0.01, 0.1, 0.3, 0.7, 1.0}) {
        const Bsdf bsdf = Bsdf::ggx(static_cast<float>(roughness), Rgb(1));
        const auto& lobe = bsdf.lobes()[0];
        for (const double cosine : {0.05, 0.3, 0.8, 1.0}) {
            const Vec3d view = view_at(cosine);
            double sum = 0;
            for (std::uint32_t i = 0; i < kPoints; ++i) {
                const Vec3d direction = sample_lobe(lobe.shape, view, sobol(i, 3));
                ASSERT_LE(std::abs(glm::length(direction) - 1), 1e-12);
                if (direction.z <= 0) continue;
                const double density = lobe_density(lobe.shape, view, direction);
                const double ratio = lobe_value(lobe.shape, direction, view) / density;
                EXPECT_LE(density, largest_lobe_density(lobe.shape, view) * (1 + 1e-9));
                ASSERT_LE(ratio, 1 + 1e-9) << "G₂/G₁";
                sum += ratio / kPoints;
            }
            EXPECT_LE(std::abs(sum - lobe.albedo(cosine)), 2e-3) << roughness << ", cosine " << cosine;
        }
    }
}

/// How far a point lies off a light's surface or plane.
double distance_from(const Light& light, const Vec3d& p) {
    if (const auto* sphere = std::get_if<SphereLight>(&light)) {
        const double beyond = glm::length(p - sphere->center) - sphere->radius;
        return sphere->facing_disk
                   ? std::max(beyond, std::abs(glm::dot(p - sphere->center, glm::normalize(sphere->center))))
                   : std::abs(beyond);
    }
    const auto* polygon = std::get_if<PolygonLight>(&light);
    const auto* disk = std::get_if<DiskLight>(&light);
    return std::abs(polygon != nullptr ? glm::dot(p - polygon->center, polygon->normal)
                                       : glm::dot(p - disk->center, disk->normal));
}

/// Samples lie on the light, and rays there meet it at the same distance; the share of even directions that do is the
/// solid angle.
void expect_met(const Light& light) {
    const ShadingFrame frame = {Vec3d(0), {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    LightSampler sampler;
    SeenLight seen;
    ASSERT_TRUE(seen.look(light, frame, 0));
    sampler.reset(seen);
    double weight = 0;
    int missed = 0;
    double met = 0;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        const LightSample sample = sampler.sample(sobol(i, 8));
        weight += sample.weight / kPoints;
        EXPECT_LE(distance_from(light, sample.distance * sample.direction), 1e-6);
        const auto distance = sampler.meets(sample.direction);
        missed += distance ? 0 : 1;  // an edge may be missed by rounding
        if (distance) {
            // A sphere is met at a grazing angle near its outline.
            EXPECT_LE(std::abs(*distance - sample.distance), 1e-6 * sample.distance);
        }
        const glm::dvec2 p = sobol(i, 9);
        const double radius = std::sqrt(1 - p.x * p.x);
        const double azimuth = 2 * std::numbers::pi * p.y;
        met += sampler.meets({radius * std::cos(azimuth), radius * std::sin(azimuth), p.x}) ? 1.0 / kPoints : 0;
    }
    EXPECT_LE(missed, 2);
    EXPECT_LE(std::abs(weight - sampler.solid_angle()), 1e-3 * weight);
    EXPECT_LE(std::abs(2 * std::numbers::pi * met - sampler.solid_angle()), 2 * std::numbers::pi * 3e-3);
}

TEST(RenderShadowsSampling, RaysMeetLightsWhereTheyAre) {
    for (const bool disk : {false, true}) {
        expect_met(make_sphere_light({0.3, 0.2, 1}, 0.6, Rgb(1), disk));
        expect_met(make_sphere_light({1, 0.2, 0.1}, 0.7, Rgb(1), disk));   // cut by the horizon
        expect_met(make_sphere_light({1, 0.2, -0.2}, 0.6, Rgb(1), disk));  // its middle below it
    }
    expect_met(make_sphere_light({0.1, 0.2, 0.3}, 1, Rgb(1), false));  // around the hit
    expect_met(make_disk_light({0.3, -0.5, 1}, {1, 0.2, 0.3}, {-0.2, 0.5, 0.4}, Rgb(1), true));
    // Concave and near, cut by the horizon, wound either way.
    expect_met(make_polygon_light({{-1, -1, 0.5}, {0, -0.2, 0.5}, {1, -1, 0.5}, {0, 1, 0.5}}, Rgb(1), true));
    expect_met(make_polygon_light({{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}, Rgb(1), true));
    expect_met(make_polygon_light({{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}}, Rgb(1), true));
}

}  // namespace
}  // namespace shlight
