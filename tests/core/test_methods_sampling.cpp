// SPDX-License-Identifier: MIT
//
// Random numbers, and random directions against their densities.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "lobe_truth.h"
#include "mean.h"
#include "method.h"
#include "polygons/spherical_polygon.h"
#include "random_directions.h"
#include "random_input.h"
#include "random_numbers.h"
#include "random_polygon.h"

namespace shlight {
namespace {

using methods::ConeSampler;
using methods::DiskSampler;
using methods::find_shading_method;
using methods::RandomDirection;
using methods::RandomNumbers;
using methods::SphereSurfaceSampler;
using methods::TriangleSampler;
using testing::kFewSigma;
using testing::Mean;
using testing::PolygonClass;
using testing::RandomInput;
using testing::Vertices;
using testing::view_direction;

constexpr double kPi = std::numbers::pi;

TEST(NumericalMethods, RandomNumbersAreUniformAndIndependent) {
    constexpr int kCount = 200000;
    const double bound = 5 / std::sqrt(static_cast<double>(kCount));
    for (const std::uint32_t seed : {0U, 1U, 0xFFFFFFFFU}) {
        RandomNumbers random(seed);
        RandomNumbers neighbour(seed + 1);
        double before = random.next() - 0.5;
        double mean = 0;
        double square = 0;
        double serial = 0;
        double cross = 0;
        for (int i = 0; i < kCount; ++i) {
            const double x = random.next() - 0.5;
            mean += x / kCount;
            square += 12 * x * x / kCount;
            serial += 12 * x * before / kCount;
            cross += 12 * x * (neighbour.next() - 0.5) / kCount;
            before = x;
            ASSERT_TRUE(x > -0.5 && x < 0.5);
        }
        EXPECT_LE(std::abs(mean) * std::sqrt(12.0), bound) << seed;
        EXPECT_LE(std::abs(square - 1), 0.9 * bound) << seed;
        EXPECT_LE(std::abs(serial), bound) << seed;
        EXPECT_LE(std::abs(cross), bound) << seed;
    }
}

/// ∫ g over the light = the mean of g / density.
template <class Sampler>
void check_sampler(const Sampler& sampler, const std::string& name, double solid_angle, const Vec3d& first_moment) {
    RandomNumbers random(9);
    Mean area_mean;
    std::array<Mean, 3> moment;
    for (int i = 0; i < 40000; ++i) {
        const RandomDirection at = sampler.sample(random.point());
        ASSERT_LE(std::abs(glm::length(at.direction) - 1), 1e-9) << name;
        ASSERT_GE(at.density, 0) << name;
        const double weight = at.density > 0 ? 1 / at.density : 0;
        area_mean.add(weight);
        for (int k = 0; k < 3; ++k) {
            moment[static_cast<std::size_t>(k)].add(weight * at.direction[k]);
        }
    }
    EXPECT_LE(area_mean.deviation(solid_angle, 1e-9 * solid_angle), kFewSigma) << name;
    for (int k = 0; k < 3; ++k) {
        EXPECT_LE(moment[static_cast<std::size_t>(k)].deviation(first_moment[k], 1e-9 * solid_angle), kFewSigma)
            << name << " " << k;
    }
}

/// density() of what was drawn is the density with which it was drawn, and nothing else has one. nothing_in_vain: all
/// that is drawn counts.
template <class Sampler, class Inside>
void check_density(const Sampler& sampler, const std::string& name, double solid_angle, const Inside& inside,
                   bool nothing_in_vain = true) {
    RandomNumbers random(10);
    for (int i = 0; i < 500; ++i) {
        const RandomDirection at = sampler.sample(random.point());
        const double density = sampler.density(at.direction);
        EXPECT_LE(std::abs(density - at.density), 1e-6 * at.density) << name;
    }
    RandomInput input(11);
    Mean share;
    int differ = 0;
    for (int i = 0; i < 40000; ++i) {
        const Vec3d direction = input.direction();
        const double density = sampler.density(direction);
        differ += (density > 0) == inside(direction) ? 0 : 1;
        share.add(4 * kPi * density);
    }
    EXPECT_EQ(differ, 0) << name;
    if (solid_angle > 0.01 && nothing_in_vain) {
        EXPECT_LE(share.deviation(1), kFewSigma) << name;
    }
}

TEST(NumericalMethods, ConesSpheresAndDisksAreSampledAsTheySay) {
    RandomInput random(6);
    for (const double half : {1e-6, 0.1, 0.9, 1.5, 2.0, 3.1, kPi}) {
        const Circle cap = circle_about_axis(random.direction(), half);
        const double solid_angle = 4 * kPi * std::pow(std::sin(half / 2), 2);
        const Vec3d moment = kPi * std::pow(std::sin(half), 2) * cap.axis;
        const std::string name = "half angle " + std::to_string(half);
        check_sampler(ConeSampler(cap), "cone, " + name, solid_angle, moment);
        check_density(ConeSampler(cap), "cone, " + name, solid_angle, [&](const Vec3d& d) {
            return std::atan2(glm::length(glm::cross(d, cap.axis)), glm::dot(d, cap.axis)) <= half;
        });
        if (half < 1.2) {  // beyond, next to nothing of a sphere's surface is seen, and of a disk, much is far away
            check_sampler(SphereSurfaceSampler(cap), "sphere, " + name, solid_angle, moment);
            check_sampler(DiskSampler(cap), "disk, " + name, solid_angle, moment);
        }
    }
}

/// ∫ ω dω over a polygon (Lambert 1760).
Vec3d first_moment(const SphericalPolygon& polygon) {
    Vec3d sum(0);
    for (std::size_t i = 0; i < polygon.directions().size(); ++i) {
        const Vec3d& cross = polygon.edge_cross(i);
        const double sine = glm::length(cross);
        const double cosine =
            glm::dot(polygon.directions()[i], polygon.directions()[(i + 1) % polygon.directions().size()]);
        sum += sine > 0 ? cross * (std::atan2(sine, cosine) / (2 * sine)) : Vec3d(0);
    }
    return sum;
}

/// Whether a ray meets the polygon, by crossings in its plane.
bool meets(const Vertices& vertices, const Vec3d& direction) {
    const Vec3d origin = vertices[0];
    Vec3d normal(0);
    for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
        normal += glm::cross(vertices[i] - origin, vertices[i + 1] - origin);
    }
    const double distance = glm::dot(normal, origin) / glm::dot(normal, direction);
    if (!(distance > 0)) {
        return false;
    }
    const Vec3d x = glm::normalize(glm::cross(normal, Vec3d(0.3, 0.5, 0.8)));
    const Vec3d y = glm::cross(glm::normalize(normal), x);
    const Vec3d p = distance * direction;
    bool inside = false;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3d a = vertices[i] - p;
        const Vec3d b = vertices[(i + 1) % vertices.size()] - p;
        const double ay = glm::dot(a, y);
        const double by = glm::dot(b, y);
        if ((ay > 0) != (by > 0)) {
            const double t = ay / (ay - by);
            inside = inside != (glm::dot(a + t * (b - a), x) > 0);
        }
    }
    return inside;
}

TEST(NumericalMethods, PolygonsAreSampledAsTheySay) {
    using Uniform = TriangleSampler::Uniform;
    for (const PolygonClass& kind : {PolygonClass{"plain", &testing::plain},
                                     {"concave", &testing::concave},
                                     {"small", &testing::small},
                                     {"tiny", &testing::tiny},
                                     {"large", &testing::large}}) {
        for (std::uint64_t i = 0; i < 4; ++i) {
            RandomInput random(i);
            const Vertices vertices = kind.draw(random);
            const SphericalPolygon seen(vertices, false);
            const std::string name = std::string(kind.name) + " " + std::to_string(i);
            const auto inside = [&](const Vec3d& direction) { return meets(vertices, direction); };
            const TriangleSampler by_angle(Uniform::in_solid_angle, seen.directions());
            check_sampler(by_angle, name, seen.solid_angle(), first_moment(seen));
            check_density(by_angle, name, seen.solid_angle(), inside, kind.draw != &testing::concave);
            if (kind.draw != &testing::large) {  // whose far parts leave too few points near by
                const TriangleSampler by_area(Uniform::in_area, vertices);
                check_sampler(by_area, name + " by area", seen.solid_angle(), first_moment(seen));
            }
            if (kind.draw == &testing::plain) {
                check_density(TriangleSampler(Uniform::in_area, vertices), name, 0, inside);
            }
        }
    }
}

}  // namespace
}  // namespace shlight
