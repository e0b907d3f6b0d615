// SPDX-License-Identifier: MIT
//
// Point sets, directions to lights and of lobes: evenness, integrals over the light against its exact coefficients,
// densities of lobes against f·cos, and where directions meet lights.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "lights/ellipse_sampling.h"
#include "lights/light_sampling.h"
#include "random_disk.h"
#include "random_input.h"
#include "shlight/bsdf.h"
#include "shlight/cap.h"
#include "shlight/disk.h"
#include "shlight/polygon.h"
#include "shlight/render.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

using testing::RandomInput;

constexpr std::uint32_t kPoints = 1 << 14;

TEST(RenderSampling, SeedsGiveIndependentUnbiasedSets) {
    // The share of 16 points below a slanted line, for many seeds: right on average, far less spread than for random
    // points, and unrelated from one seed to the next.
    constexpr std::uint32_t kSeeds = 4000;
    std::vector<double> errors;
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
        double share = 0;
        for (std::uint32_t i = 0; i < 16; ++i) {
            const glm::dvec2 p = SobolSequence(seed).point(i);
            share += p.y < 0.2 + 0.3 * p.x ? 1.0 / 16 : 0;
        }
        errors.push_back(share - 0.35);
    }
    double mean = 0;
    double variance = 0;
    double neighbours = 0;
    for (std::size_t i = 0; i < kSeeds; ++i) {
        mean += errors[i] / kSeeds;
        variance += errors[i] * errors[i] / kSeeds;
        neighbours += errors[i] * errors[(i + 1) % kSeeds] / kSeeds;
    }
    // Statistical bounds: five standard deviations.
    EXPECT_LE(std::abs(mean), 5 * std::sqrt(variance / kSeeds));
    EXPECT_LE(variance, 0.25 * 0.35 * 0.65 / 16);
    EXPECT_LE(std::abs(neighbours), 5 * variance / std::sqrt(kSeeds));
}

TEST(RenderSampling, HammersleyIsCentredAndEvenForAnyCount) {
    EXPECT_EQ(hammersley(1).front(), glm::dvec2(0.5));
    for (const std::uint32_t count : {1U, 2U, 3U, 5U, 9U, 16U, 100U}) {
        const std::vector<glm::dvec2> points = hammersley(count);
        ASSERT_EQ(points.size(), count);
        std::set<int> columns;
        std::set<int> rows;
        glm::dvec2 mean(0);
        for (const glm::dvec2& p : points) {
            columns.insert(static_cast<int>(count * p.x));
            rows.insert(static_cast<int>(count * p.y));
            mean += p / static_cast<double>(count);
        }
        EXPECT_EQ(columns.size(), count);
        EXPECT_EQ(rows.size(), count);
        EXPECT_LE(glm::length(mean - glm::dvec2(0.5)), 1e-14) << count;
    }
}

/// Means of weight and weight · z: the solid angle above the horizon, and its projection.
template <class Sampler>
glm::dvec2 solid_angle_and_projection(const Sampler& sampler) {
    glm::dvec2 sum(0);
    static const std::vector<glm::dvec2> points = nested_points(4 * kPoints);
    for (const glm::dvec2& point : points) {
        const LightSample sample = sampler.sample(point);
        EXPECT_GE(sample.direction.z, -1e-9);
        EXPECT_LE(std::abs(glm::length(sample.direction) - 1), 1e-9);
        EXPECT_GE(sample.weight, 0);
        sum += glm::dvec2(1, sample.direction.z) * sample.weight;
    }
    return sum / static_cast<double>(points.size());
}

/// The same from coefficients of order 2.
glm::dvec2 exact(const std::vector<double>& coefficients) {
    return {coefficients[0] * std::sqrt(4 * std::numbers::pi), coefficients[2] * std::sqrt(4 * std::numbers::pi / 3)};
}

/// Quasi-Monte Carlo with 2^16 points of a bounded integrand: an error of some 1e-4; 1e-3 is ten times that.
void expect_near(const glm::dvec2& sampled, const glm::dvec2& truth) {
    EXPECT_LE(std::abs(sampled.x - truth.x), 1e-3 * truth.x);
    EXPECT_LE(std::abs(sampled.y - truth.y), 1e-3 * truth.y + 1e-3 * truth.x * truth.x);
}

TEST(RenderSampling, CapsCoverWhatIsAboveTheHorizon) {
    RandomInput random(11);
    for (int i = 0; i < 100; ++i) {
        const double half_angle = random.log_uniform(1e-3, 1.55);
        const double tilt = std::min(3.1, random.uniform(0, std::numbers::pi / 2 + 0.98 * half_angle));
        const double distance = random.log_uniform(0.1, 100);
        const Vec3d center = distance * random.at_tilt(tilt);
        const bool disk = random.chance(0.5);
        const double radius = distance * (disk ? std::tan(half_angle) : std::sin(half_angle));
        const CapView cap = {disk ? CapView::Kind::facing_disk : CapView::Kind::sphere, center, radius};
        std::vector<double> coefficients(4);
        const SphericalCap circle = circle_of(cap);
        cap_coefficients<double>({&circle, 1}, 2, true, coefficients);
        SCOPED_TRACE(::testing::Message() << "half angle " << half_angle << ", tilt " << tilt);
        expect_near(solid_angle_and_projection(CapSampler(cap)), exact(coefficients));
    }
}

TEST(RenderSampling, PolygonsCoverWhatIsAboveTheHorizon) {
    RandomInput random(12);
    PolygonSampler sampler;
    for (int i = 0; i < 100; ++i) {
        const double size = random.log_uniform(1e-3, 30);  // from area sampling to nearly the whole hemisphere
        const Vec3d center = random.direction();
        const Vec3d u = size * random.direction();
        const Vec3d v = size * glm::cross(random.direction(), glm::normalize(u));
        std::vector<Vec3d> vertices = {center - u - v, center + u - v, center + u + v, center - u + v};
        const PolygonLight light = make_polygon_light(vertices, Rgb(1), true);
        std::vector<double> coefficients(4);
        polygon_coefficients<double>(light.vertices, static_cast<int>(light.vertices.size()), 2, true, coefficients);
        const glm::dvec2 truth = exact(coefficients);
        if (truth.x < 1e-9) continue;
        sampler.reset(light.vertices, light.triangles, light.normal);
        SCOPED_TRACE(::testing::Message() << "size " << size << ", solid angle " << truth.x);
        expect_near(solid_angle_and_projection(sampler), truth);
    }
}

TEST(RenderSampling, EllipsesCoverWhatIsAboveTheHorizon) {
    for (const testing::EllipseClass& c : testing::kEllipseClasses) {
        RandomInput random(24);
        for (int i = 0; i < 20; ++i) {
            const testing::EllipseInput e = c.draw(random);
            const Ellipse disk = {e.center, e.half_axis_u, e.half_axis_v};
            std::vector<double> coefficients(4);
            disk_coefficients<double>({&e.center, 1}, {&e.half_axis_u, 1}, {&e.half_axis_v, 1}, 2, true, coefficients);
            const glm::dvec2 truth = exact(coefficients);
            const EllipseSampler sampler(disk);
            const glm::dvec2 sampled = solid_angle_and_projection(sampler);
            // The weights of cut ones are uneven.
            EXPECT_LE(std::abs(sampled.x - truth.x), 3e-3 * truth.x) << c.name;
            EXPECT_LE(std::abs(sampled.y - truth.y), 3e-3 * truth.x) << c.name;
            EXPECT_LE(std::abs(sampler.solid_angle() - truth.x), 0.05 * truth.x) << c.name;
        }
    }
}

TEST(RenderSampling, APolygonBelowTheHorizonHasNoWeight) {
    const PolygonLight light = make_polygon_light({{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}}, Rgb(1), true);
    PolygonSampler sampler;
    sampler.reset(light.vertices, light.triangles, light.normal);
    EXPECT_EQ(sampler.sample({0.5, 0.5}).weight, 0);
}

Vec3d view_at(double cosine) {
    return {std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine};
}

TEST(RenderSampling, LobeDirectionsHaveTheirDensity) {
    // The mean of f·cos/density over the directions is the albedo, from the fit; f·cos is never much above the density.
    for (const double roughness : {0.01, 0.1, 0.3, 0.7, 1.0}) {
        const Bsdf bsdf = Bsdf::ggx(static_cast<float>(roughness), Rgb(1));
        const auto& lobe = bsdf.lobes()[0];
        for (const double cosine : {0.05, 0.3, 0.8, 1.0}) {
            const Vec3d view = view_at(cosine);
            double sum = 0;
            for (std::uint32_t i = 0; i < kPoints; ++i) {
                const Vec3d direction = sample_lobe(lobe.shape, view, SobolSequence(3).point(i));
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
    LocalLight seen;
    ASSERT_TRUE(seen.look(light, frame, 0));
    sampler.reset(seen);
    double weight = 0;
    int missed = 0;
    double met = 0;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        const LightSample sample = sampler.sample(SobolSequence(8).point(i));
        weight += sample.weight / kPoints;
        const Vec3d place = sample.distance * sample.direction;
        EXPECT_LE(distance_from(light, place), 1e-6);
        if (const auto* sphere = std::get_if<SphereLight>(&light);
            sphere != nullptr && !sphere->facing_disk && glm::length(sphere->center) > sphere->radius) {
            EXPECT_LE(glm::dot(place - sphere->center, sample.direction), 1e-6) << "on the far side";
        }
        const auto distance = sampler.meets(sample.direction);
        missed += distance ? 0 : 1;  // an edge may be missed by rounding
        if (distance) {
            // A sphere is met at a grazing angle near its outline.
            EXPECT_LE(std::abs(*distance - sample.distance), 1e-6 * sample.distance);
        }
        const glm::dvec2 p = SobolSequence(9).point(i);
        const double radius = std::sqrt(1 - p.x * p.x);
        const double azimuth = 2 * std::numbers::pi * p.y;
        met += sampler.meets({radius * std::cos(azimuth), radius * std::sin(azimuth), p.x}) ? 1.0 / kPoints : 0;
    }
    EXPECT_LE(missed, 2);
    EXPECT_LE(std::abs(weight - sampler.solid_angle()), 1e-3 * weight);
    EXPECT_LE(std::abs(2 * std::numbers::pi * met - sampler.solid_angle()), 2 * std::numbers::pi * 3e-3);
}

TEST(RenderSampling, FilteredWidthIsTheMeanOverADiffuseLobe) {
    for (const double filter : {0.05, 0.3, 1.0, 100.0}) {
        double mean = 0;
        for (std::uint32_t i = 0; i < kPoints; ++i) {
            const double cosine = std::sqrt((i + 0.5) / kPoints);  // of directions by the cosine
            mean += 0.5 * std::sqrt(std::max(1 - cosine / std::numbers::pi / filter, 0.0)) / kPoints;
        }
        EXPECT_LE(std::abs(least_width_after_diffuse(filter) - mean), 1e-5) << filter;
    }
}

TEST(RenderSampling, RaysMeetLightsWhereTheyAre) {
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
