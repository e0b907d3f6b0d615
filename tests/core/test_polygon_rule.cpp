// SPDX-License-Identifier: MIT
//
// Rules of points in lanes against a fine product rule of the scalar lobes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lighting/polygon_rule_kernel.h"
#include "math/triangle_cubature.h"
#include "random_input.h"
#include "regions/spherical_polygon.h"
#include "shlight/lobe_shape.h"

namespace shlight {
namespace {

using testing::RandomInput;

double integral(const LobeShape& shape, const Vec3d& view, std::span<const Vec3d> vertices) {
    const SphericalPolygon polygon(vertices, true);
    const std::vector<Vec3d>& v = polygon.directions();
    double sum = 0;
    double area = 0;
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        const double triple = glm::dot(v[0], glm::cross(v[i] - v[0], v[i + 1] - v[0]));
        visit_triangle(v[0], v[i], v[i + 1], triple, product_rule(16), [&](const Vec3d& direction, double weight) {
            sum += weight * lobe_value(shape, direction, view);
            area += weight;
        });
    }
    return area > 0 ? sum * (polygon.solid_angle() / area) : 0;
}

/// Five vertices around a direction near or above the horizon, of about this size, at any distance and with either
/// winding.
std::vector<Vec3d> random_pentagon(RandomInput& random, double size) {
    Vec3d axis = random.direction();
    axis.z = std::abs(axis.z) * random.uniform(0, 1);
    axis = glm::normalize(axis);
    const Vec3d u = glm::normalize(glm::cross(axis, random.direction()));
    const Vec3d v = glm::cross(axis, u);
    const double distance = random.log_uniform(1e-3, 1e6);
    std::vector<Vec3d> vertices;
    for (int i = 0; i < 5; ++i) {
        const double angle = 1.25 * (i + random.uniform(0, 0.5));
        vertices.push_back(distance * (axis + size * (std::cos(angle) * u + std::sin(angle) * v)));
    }
    if (random.uniform(0, 1) < 0.5) {
        std::reverse(vertices.begin(), vertices.end());
    }
    return vertices;
}

/// The rules' errors fall with the size to the powers of kPolygonErrors: at a size of 0.02 the first one's is below
/// 1e-6 of a lobe that changes over a radian, and ten times that near the horizon. Diffuse lobes have kinks, across
/// which all rules are of low order.
TEST(PolygonRule, AgreesWithAFineRuleOfTheScalarLobes) {
    constexpr std::size_t kCount = 100;
    RandomInput random(31);
    const std::vector<LobeShape> shapes = {
        GgxShape{0.9},
        GgxShape{0.8, Fresnel::schlick},
        GgxShape{0.7, Fresnel::dip},
        GgxShape{0.9, Fresnel::dielectric, 1.5},
        LambertShape{},
        DiffuseShape{Diffuse::oren_nayar},
        DiffuseShape{Diffuse::bumped_ggx},
        DiffuseShape{Diffuse::bumped_cubic},
        kDisneyDiffuse,
        kDisneyRetroSquare,
        kDisneySheen,
    };
    for (const LobeShape& shape : shapes) {
        std::vector<Vec3d> vertices;
        std::vector<double> x, z, truth;
        std::vector<float> widths(kCount, static_cast<float>(lobe_width(shape)));
        std::vector<std::uint32_t> numbers;
        for (std::uint32_t i = 0; i < kCount; ++i) {
            const double cosine = random.uniform(0.3, 1);
            x.push_back(std::sqrt(1 - cosine * cosine));
            z.push_back(cosine);
            const std::vector<Vec3d> polygon = random_pentagon(random, 0.02);
            vertices.insert(vertices.end(), polygon.begin(), polygon.end());
            truth.push_back(integral(shape, Vec3d(x.back(), 0, z.back()), polygon));
            numbers.push_back(i);
        }
        const double share = std::holds_alternative<DiffuseShape>(shape) ? 1e-3 : 2e-5;
        const double allowed = share * *std::max_element(truth.begin(), truth.end());
        for (int rule = 1; rule <= 4; ++rule) {
            std::vector<float> values(kCount);
            integrate_polygons(shape, widths.data(), vertices, 5, numbers, {x.data(), z.data(), false}, numbers, rule,
                               values);
            for (std::size_t i = 0; i < kCount; ++i) {
                EXPECT_LE(std::abs(double{values[i]} - truth[i]), allowed)
                    << "shape " << shape.index() << " rule " << rule << " polygon " << i;
            }
        }
    }
}

TEST(PolygonRule, GivesNothingOfPolygonsBelowTheHorizonOrWithoutArea) {
    const std::vector<Vec3d> vertices = {{0, 0, -1}, {1, 0, -1}, {0, 1, -1}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
    const std::vector<std::uint32_t> numbers = {0, 1};
    constexpr double kViewX = 0.6;
    constexpr double kViewZ = 0.8;
    const float width = 1;
    std::vector<float> values(2, 1.0F);
    integrate_polygons(LambertShape{}, &width, vertices, 3, numbers, {&kViewX, &kViewZ, true}, std::vector{0U, 0U}, 1,
                       values);
    EXPECT_EQ(values[0], 0);
    EXPECT_LE(values[1], 1e-15F);
}

}  // namespace
}  // namespace shlight
