// SPDX-License-Identifier: MIT
//
// Whole materials under random lights, against brute force.
#include "shlight/light_shading.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "error_record.h"
#include "lobe_truth.h"
#include "random_input.h"

namespace shlight {
namespace {

using testing::lobe_over_cap;
using testing::PolygonTruth;
using testing::RandomInput;
using testing::view_direction;

struct Light {
    Vec3d axis;
    double half_angle;
};

Vec3d normal_noise(RandomInput& random) {
    Vec3d sum(0);
    for (int i = 0; i < 4; ++i) {
        sum += random.direction();
    }
    return sum * std::sqrt(3.0) / 2.0;
}

/// A third across the horizon, a third about the mirror direction, a third anywhere.
Light random_light(RandomInput& random, int kind, double alpha, double cos_theta_o) {
    const double half = random.chance(0.5) ? random.uniform(0.01, 1.4) : random.log_uniform(0.01, 1.4);
    if (kind == 0) {
        const double elevation = random.uniform(-half, half);
        const double azimuth =
            random.chance(0.5) ? std::numbers::pi + random.uniform(-0.6, 0.6) : random.uniform(0, 6.28);
        const double c = std::cos(elevation);
        return {{c * std::cos(azimuth), c * std::sin(azimuth), std::sin(elevation)}, half};
    }
    Vec3d axis = random.direction();
    if (kind == 1) {
        const Vec3d v = view_direction(cos_theta_o);
        axis = Vec3d(-v.x, 0, v.z) + 0.7 * (half + 2 * alpha) * normal_noise(random);
    }
    axis.z = std::abs(axis.z);
    return {glm::normalize(axis), half};
}

/// Planar and convex: a random quadrilateral in a random plane about the light's axis.
std::vector<Vec3d> random_quad(RandomInput& random, const Light& light) {
    const Vec3d normal = glm::normalize(light.axis + 0.5 * random.direction());
    const Vec3d u = glm::normalize(glm::cross(normal, random.direction()));
    const Vec3d v = glm::cross(normal, u);
    const double size = std::tan(std::min(light.half_angle, 1.2));
    std::vector<Vec3d> quad;
    for (int i = 0; i < 4; ++i) {
        const double angle = std::numbers::pi / 2 * (i + random.uniform(0, 0.6));
        quad.push_back(light.axis + size * (std::cos(angle) * u + std::sin(angle) * v));
    }
    return quad;
}

/// Errors ÷ the brightest light of the same material and view, the largest ÷ the albedo, of which the tolerance is
/// meant, and how many lights took at most 16 of anything.
struct Outcome {
    std::vector<double> errors;
    double worst = 0;
    int few = 0, counted = 0;

    void add(const std::vector<Rgb>& radiance, const std::vector<double>& truth,
             const std::vector<std::int32_t>& effort, const Bsdf& bsdf, double cos_theta_o) {
        const double brightest = *std::max_element(truth.begin(), truth.end());
        const auto albedo = static_cast<double>(bsdf.albedo(cos_theta_o).x);
        for (std::size_t i = 0; i < truth.size(); ++i) {
            const double error = std::abs(static_cast<double>(radiance[i].x) - truth[i]);
            errors.push_back(std::isfinite(error) ? error / brightest : 1e300);
            worst = std::max(worst, errors.back() * (brightest / albedo));
            if (cos_theta_o >= 0.3) {
                ++counted;
                few += effort[i] <= 16 ? 1 : 0;
            }
        }
    }

    void check(double tolerance) {
        std::sort(errors.begin(), errors.end());
        const double most = errors[errors.size() * 99 / 100];
        const std::string name = "over_tolerance_" + std::to_string(tolerance);
        ::testing::Test::RecordProperty("p99_" + name, std::to_string(most / tolerance));
        ::testing::Test::RecordProperty("max_" + name, std::to_string(worst / tolerance));
        EXPECT_LE(most, 2 * tolerance);
        EXPECT_LE(worst, 5 * tolerance);
        EXPECT_GE(few, 0.9 * counted);
    }
};

double random_cosine(RandomInput& random, int i) {
    return i % 4 == 0 ? random.uniform(0.05, 0.25) : random.uniform(0.05, 1);
}

constexpr std::array<double, 2> kTolerances = {1e-2, 1e-3};
const int kMore = testing::all_tests() ? 10 : 1;

TEST(LightShading, SpheresMatchBruteForce) {
    RandomInput random(21);
    std::array<Outcome, kTolerances.size()> outcomes;
    for (int i = 0; i < 48 * kMore; ++i) {
        const auto roughness = static_cast<float>(i % 3 == 0 ? random.uniform(0.05, 0.35) : random.uniform(0.05, 1));
        const double alpha = static_cast<double>(roughness) * roughness;
        const Bsdf bsdf = Bsdf::ggx(roughness, Rgb(1));
        const double cosine = random_cosine(random, i);
        std::vector<Vec3d> centers;
        std::vector<double> radii;
        std::vector<double> truth;
        for (int k = 0; k < 24; ++k) {
            const Light light = random_light(random, k % 3, alpha, cosine);
            const double distance = random.log_uniform(0.1, 10);
            centers.push_back(distance * light.axis);
            radii.push_back(distance * std::sin(light.half_angle));
            truth.push_back(lobe_over_cap({alpha}, cosine, light.axis, light.half_angle, 16));
        }
        std::vector<Rgb> radiance(truth.size());
        std::vector<std::int32_t> effort(truth.size());
        for (std::size_t t = 0; t < kTolerances.size(); ++t) {
            LightShader(bsdf, {0, kTolerances[t]})
                .spheres<double>(centers, radii, std::vector<double>(truth.size(), cosine), radiance, effort);
            outcomes[t].add(radiance, truth, effort, bsdf, cosine);
        }
    }
    for (std::size_t t = 0; t < kTolerances.size(); ++t) {
        outcomes[t].check(kTolerances[t]);
    }
}

TEST(LightShading, PolygonsMatchBruteForce) {
    RandomInput random(22);
    std::array<Outcome, kTolerances.size()> outcomes;
    for (int i = 0; i < 24 * kMore; ++i) {
        const auto roughness = static_cast<float>(i % 3 == 0 ? random.uniform(0.05, 0.35) : random.uniform(0.05, 1));
        const double alpha = static_cast<double>(roughness) * roughness;
        const Bsdf bsdf = Bsdf::ggx(roughness, Rgb(1));
        const double cosine = random_cosine(random, i);
        std::vector<Vec3d> vertices;
        std::vector<double> truth;
        const PolygonTruth brute({alpha}, cosine);
        for (int k = 0; k < 12; ++k) {
            const std::vector<Vec3d> quad = random_quad(random, random_light(random, k % 3, alpha, cosine));
            vertices.insert(vertices.end(), quad.begin(), quad.end());
            truth.push_back(brute.integral(quad));
        }
        std::vector<Rgb> radiance(truth.size());
        std::vector<std::int32_t> effort(truth.size());
        for (std::size_t t = 0; t < kTolerances.size(); ++t) {
            LightShader(bsdf, {0, kTolerances[t]})
                .polygons<double>(vertices, 4, std::vector<double>(truth.size(), cosine), radiance, effort);
            outcomes[t].add(radiance, truth, effort, bsdf, cosine);
        }
    }
    for (std::size_t t = 0; t < kTolerances.size(); ++t) {
        outcomes[t].check(kTolerances[t]);
    }
}

TEST(LightShading, RoughnessHasNoSeams) {
    // Roughness goes from a mirror to the roughest surface in steps over which the light should change little.
    const double cosine = 0.5;
    const Vec3d v = view_direction(cosine);
    const Vec3d center = glm::normalize(Vec3d(-v.x, 0.1, v.z));
    const double radius = 0.2;
    double before = -1;
    double step_before = 0;
    for (int i = 0; i <= 2000; ++i) {
        Rgb radiance;
        LightShader(Bsdf::ggx(static_cast<float>(i) / 2000, Rgb(1)), {})
            .spheres<double>({&center, 1}, {&radius, 1}, {&cosine, 1}, {&radiance, 1});
        const double step = static_cast<double>(radiance.x) - before;
        if (i > 1) {
            // Two methods may each be wrong by the tolerance where one hands over to the other.
            EXPECT_LE(std::abs(step - step_before), 2e-3) << "at roughness " << i / 2000.0;
        }
        step_before = step;
        before = radiance.x;
    }
}

/// Spheres on all sides of the horizon, whose numbers are floats.
struct FloatSpheres {
    std::vector<Vec3f> centers;
    std::vector<float> radii;
    std::vector<double> views;

    explicit FloatSpheres(std::size_t count) {
        RandomInput random(24);
        for (std::size_t i = 0; i < count; ++i) {
            const double distance = random.log_uniform(0.1, 10);
            centers.emplace_back(distance * random.direction());
            radii.push_back(static_cast<float>(distance * random.log_uniform(1e-3, 0.98)));
            // Some vectors of lights have views close to each other, others from one end of the table to the other.
            views.push_back(i / 40 % 2 == 0 ? random.uniform(0, 1) : random.uniform(0.4, 0.9));
        }
        views[3] = 0;
        views[4] = 1;
    }
};

std::vector<Bsdf> materials_of_one_order() {
    return {Bsdf::lambert(Rgb(0.2F, 0.5F, 1)), Bsdf::ggx(0.1F, Rgb(1)), Bsdf::ggx(0.5F, Rgb(1, 0.5F, 0.2F)),
            Bsdf::layer(Bsdf::ggx(0.3F, Rgb(0), 1.5F), Bsdf::lambert(Rgb(0.8F, 0.4F, 0.1F)))};
}

TEST(LightShading, SpheresAsTheyComeAreThoseThatAreSorted) {
    const FloatSpheres lights(3000);
    const std::vector<Vec3d> centers(lights.centers.begin(), lights.centers.end());
    const std::vector<double> radii(lights.radii.begin(), lights.radii.end());
    for (const Bsdf& bsdf : materials_of_one_order()) {
        for (const int order : {1, 3, 8, 16}) {
            std::vector<Rgb> plain(radii.size());
            std::vector<Rgb> sorted(radii.size());
            std::vector<std::int32_t> effort(radii.size());
            std::vector<std::int32_t> sorted_effort(radii.size());
            LightShader shader(bsdf, {order, 1e-3});
            shader.spheres(std::span<const Vec3f>(lights.centers), std::span<const float>(lights.radii),
                           std::span<const double>(lights.views), plain, effort);
            LightShader(bsdf, {order, 1e-3}).spheres<double>(centers, radii, lights.views, sorted, sorted_effort);
            EXPECT_EQ(effort, sorted_effort);
            float largest = 0;
            for (std::size_t i = 0; i < radii.size(); ++i) {
                for (int channel = 0; channel < 3; ++channel) {
                    const float error = std::abs(plain[i][channel] - sorted[i][channel]);
                    largest = std::isnan(error) ? 1e30F : std::max(largest, error);
                }
            }
            EXPECT_LE(largest, 1e-6F * static_cast<float>(order));
        }
    }
}

std::vector<Rgb> shade_floats(const Bsdf& bsdf, const std::vector<Vec3f>& centers, const std::vector<float>& radii,
                              const std::vector<double>& views) {
    std::vector<Rgb> values(radii.size());
    LightShader shader(bsdf, {8, 1e-3});
    shader.spheres(std::span(centers), std::span(radii), std::span(views), values);
    return values;
}

TEST(LightShading, SpheresDependOnNoNeighbour) {
    const FloatSpheres lights(300);
    for (const Bsdf& bsdf : materials_of_one_order()) {
        const auto together = shade_floats(bsdf, lights.centers, lights.radii, lights.views);
        for (std::size_t i = 0; i < together.size(); ++i) {
            const auto alone = shade_floats(bsdf, {lights.centers[i]}, {lights.radii[i]}, {lights.views[i]});
            EXPECT_EQ(alone[0], together[i]) << i;
        }
    }
}

/// Lights on the axis need recurrences of their own, for which they are listed: those of vectors that are whole first,
/// then those of vectors that lights at the horizon share. Here the list's first and last light are as far apart as in
/// a row, for vectors of each length.
TEST(LightShading, ListsOfSpheresNeedNotAscend) {
    const Vec3f axis(0, 0, 2);
    const Vec3f aside(1, 0, 2);
    const Vec3f horizon(2, 0, 0);
    for (const std::size_t lanes : {4, 8, 16}) {
        std::vector<Vec3f> centers(3 * lanes, aside);
        std::fill_n(centers.begin(), lanes - 2, axis);
        centers[lanes - 1] = horizon;
        centers[lanes + 1] = axis;
        centers[2 * lanes] = axis;
        centers[2 * lanes + 1] = horizon;
        std::vector<float> radii(centers.size());
        for (std::size_t i = 0; i < radii.size(); ++i) {
            radii[i] = 0.01F * static_cast<float>(i + 1);
        }
        const std::vector<double> views(radii.size(), 1);
        const auto together = shade_floats(Bsdf::ggx(0.5F, Rgb(1)), centers, radii, views);
        for (std::size_t i = 0; i < together.size(); ++i) {
            EXPECT_EQ(together[i], shade_floats(Bsdf::ggx(0.5F, Rgb(1)), {centers[i]}, {radii[i]}, {views[i]})[0])
                << i << " of vectors of " << lanes;
        }
    }
}

}  // namespace
}  // namespace shlight
