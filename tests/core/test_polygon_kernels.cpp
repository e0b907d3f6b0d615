// SPDX-License-Identifier: MIT
//
// The kernels that shade polygons in lanes: Eq. 5 under lobes of any terms, and what may be passed as a polygon.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "random_polygon.h"
#include "regions/polygon_kernels.h"
#include "regions/region_checks.h"
#include "shlight/polygon.h"
#include "shlight/shading.h"

namespace shlight {
namespace {

using testing::RandomInput;

constexpr double kEpsilon = std::numeric_limits<float>::epsilon();

/// Squares about the unit sphere, half of them cut by the horizon, rounded to float.
std::vector<Vec3d> squares(RandomInput& random, int count) {
    std::vector<Vec3d> vertices;
    for (int i = 0; i < count; ++i) {
        Vec3d center = random.direction();
        center.z = i % 2 == 0 ? random.uniform(-0.2, 0.2) : std::abs(center.z);
        center = glm::normalize(center);
        const testing::Plane plane(random, center);
        const double half = random.uniform(0.1, 0.6);
        for (const auto& [a, b] :
             {std::pair(1.0, 1.0), std::pair(-1.0, 1.0), std::pair(-1.0, -1.0), std::pair(1.0, -1.0)}) {
            vertices.push_back(testing::as_float(center + half * (a * plane.u + b * plane.v)));
        }
    }
    return vertices;
}

/// Terms that fall as (1+l)^-decay; with odd bands or without.
std::vector<double> random_lobe(RandomInput& random, int order, double decay, bool odd) {
    std::vector<double> terms(static_cast<std::size_t>(cosine_count(order)));
    for (int l = 0; l < order; ++l) {
        for (int m = 0; m <= l; ++m) {
            const bool there = odd || l < 2 || l % 2 == 0;
            const double term = there ? random.uniform(-1, 1) * std::pow(1.0 + l, -decay) : 0;
            terms[static_cast<std::size_t>(cosine_index(l, m))] = static_cast<double>(static_cast<float>(term));
        }
    }
    return terms;
}

/// Largest difference from double precision ÷ (L_00 · the largest term).
double worst_error(const std::vector<Vec3d>& vertices, const std::vector<double>& terms, int order) {
    const std::size_t count = vertices.size() / 4;
    std::vector<float> padded(terms.begin(), terms.end());
    padded.resize(terms.size() + 16);
    std::vector<std::uint32_t> numbers(count);
    for (std::size_t i = 0; i < count; ++i) {
        numbers[i] = static_cast<std::uint32_t>(i);
    }
    const std::vector<std::uint32_t> views(count, 0);
    std::vector<float> values(count);
    shade_polygons(vertices, 4, numbers, {false, {}, padded.data(), 0, order}, views, values);
    const double largest = std::abs(
        *std::max_element(terms.begin(), terms.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
    double worst = 0;
    std::vector<double> light(static_cast<std::size_t>(coefficient_count(order)));
    for (std::size_t i = 0; i < count; ++i) {
        polygon_coefficients<double>(std::span(vertices).subspan(4 * i, 4), 4, order, true, light);
        const double truth = shade_cosine(light.data(), terms.data(), order);
        const double size = light[0] * std::sqrt(4 * std::numbers::pi);
        const double error = std::abs(static_cast<double>(values[i]) - truth);
        worst = error <= worst * size * largest ? worst : size > 0 ? error / (size * largest) : error;
    }
    return worst;
}

/// Four arcs may each err by 2 n ε Ω, which is 7 n ε L_00; they did by a quarter of that. The rest is rounding.
TEST(PolygonKernels, ShadeUnderLobesOfAnyTerms) {
    RandomInput random(41);
    const std::vector<Vec3d> vertices = squares(random, 2000);
    for (const int order : {3, 4, 5, 6, 7, 8, 9, 12, 16}) {
        for (const double decay : {0.0, 1.0, 3.0}) {
            for (const bool odd : {true, false}) {
                const double worst = worst_error(vertices, random_lobe(random, order, decay, odd), order);
                EXPECT_LE(worst, 1e-5 + 8 * order * kEpsilon) << "order " << order << ", decay " << decay;
            }
        }
    }
}

bool accepted(std::vector<Vec3d> vertices, int vertex_count) {
    try {
        prepare_polygons<float>(vertices, vertex_count);
    } catch (const std::invalid_argument&) {
        return false;
    }
    return true;
}

/// Regular polygons with one vertex off the plane of the others, of all sizes, far and near, one of them among flat
/// ones.
TEST(PolygonKernels, BentPolygonsAreFound) {
    RandomInput random(42);
    for (int round = 0; round < 4000; ++round) {
        const int k = random.integer(4, 7);
        const double scale = random.log_uniform(1e-25, 1e25);
        const auto count = static_cast<std::size_t>(random.integer(1, 40));
        const auto bent = static_cast<std::size_t>(random.integer(0, static_cast<int>(count) - 1));
        const double bend = random.log_uniform(1e-5, 1e-1);
        std::vector<Vec3d> vertices;
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3d normal = random.direction();
            const testing::Plane plane(random, normal);
            const Vec3d center = random.log_uniform(0.1, 1e3) * random.direction();
            for (int j = 0; j < k; ++j) {
                const double angle = 2 * std::numbers::pi * j / k;
                const Vec3d v = center + std::cos(angle) * plane.u + std::sin(angle) * plane.v +
                                (i == bent && j == k - 1 ? bend : 0) * normal;
                vertices.push_back(testing::as_float(scale * v));
            }
        }
        // Some of the bend turns the mean plane; 1e3 away a float's rounding is granted, 1e-3 in all.
        if (bend < 0.5e-4 || bend > 1e-2) {
            EXPECT_EQ(accepted(vertices, k), bend < 1e-3) << "round " << round << ", bend " << bend;
        }
        vertices[bent].y =
            random.chance(0.5) ? std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::infinity();
        EXPECT_FALSE(accepted(vertices, k));
    }
}

}  // namespace
}  // namespace shlight
