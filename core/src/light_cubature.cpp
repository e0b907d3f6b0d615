// SPDX-License-Identifier: MIT
#include "light_cubature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "triangle_cubature.h"

namespace shlight {
namespace {

/// Relative error of a rule for a light of relative size x, about (x / reach)^power.
struct RuleError {
    double reach, power;
};

/// Measured over random lobes, views and lights (95th percentile).
constexpr std::array<RuleError, 4> kCapRules = {RuleError{0.7, 2}, {1.0, 4}, {1.0, 6}, {1.0, 8}};
/// From two points along a side on: a product rule of one point is not even exact for linear functions.
constexpr std::array<RuleError, 3> kPolygonRules = {RuleError{1.0, 4}, {1.4, 6}, {1.5, 8}};

int smallest_rule(std::span<const RuleError> rules, double size, double tolerance) {
    constexpr double kOwnShare = 1;
    for (std::size_t i = 0; i < rules.size(); ++i) {
        const double relative = std::pow(size / rules[i].reach, rules[i].power);
        // A light of relative size x receives at most about x² of the albedo.
        if (relative * std::min(1.0, size * size) <= tolerance && relative <= kOwnShare * tolerance) {
            return static_cast<int>(i) + 1;
        }
    }
    return 0;
}

}  // namespace

double relative_size(const GgxShape& shape, const Vec3d& view, const Vec3d& middle, double half_angle) {
    // On the sphere where the bell is round, (h_x/α, h_y/α, h_z) normalised, a step of the direction is at most 1/α
    // long before normalising.
    const Vec3d half = middle + view;
    return half_angle / std::hypot(half.x, half.y, shape.alpha * half.z);
}

int cap_rings(double relative_size, double tolerance) {
    return smallest_rule(kCapRules, relative_size, tolerance);
}

int polygon_points(double relative_size, double tolerance) {
    const int rule = smallest_rule(kPolygonRules, relative_size, tolerance);
    return rule > 0 ? rule + 1 : 0;
}

CubatureSum cap_cubature(const GgxShape& shape, const Vec3d& view, const Circle& cap, int rings) {
    const double height = cap.sine * cap.sine / (1 + cap.cosine);  // 1 - cosσ
    if (rings == 1) {
        return {2 * std::numbers::pi * height * lobe_value(shape, cap.axis, view), 1};
    }
    const Vec3d side = std::abs(cap.axis.z) < 0.9 ? Vec3d(0, 0, 1) : Vec3d(1, 0, 0);
    const Vec3d u = glm::normalize(glm::cross(side, cap.axis));
    const Vec3d v = glm::cross(cap.axis, u);
    const GaussRule& rule = gauss_rule(rings - 1);
    const int spokes = 2 * rings;
    double sum = 0;
    for (std::size_t ring = 0; ring < rule.nodes.size(); ++ring) {
        const double drop = height * rule.nodes[ring];  // 1 - cosine of the ring's angle
        const double sine = std::sqrt(drop * (2 - drop));
        double around = 0;
        for (int i = 0; i < spokes; ++i) {
            const double phi = 2 * std::numbers::pi * (i + 0.5 * static_cast<double>(ring % 2)) / spokes;
            around += lobe_value(shape, (1 - drop) * cap.axis + sine * (std::cos(phi) * u + std::sin(phi) * v), view);
        }
        sum += rule.weights[ring] * around;
    }
    return {2 * std::numbers::pi * height * sum / spokes, spokes * (rings - 1)};
}

CubatureSum polygon_cubature(const GgxShape& shape, const Vec3d& view, const SphericalPolygon<double>& polygon,
                             int points) {
    const std::vector<Vec3d>& v = polygon.directions();
    const GaussRule& rule = gauss_rule(points);
    double sum = 0;
    double weights = 0;
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        weights += visit_triangle(v[0], v[i], v[i + 1], rule, [&](const Vec3d& direction, double weight) {
            sum += weight * lobe_value(shape, direction, view);
        });
    }
    // As for coefficients: the area of a tiny polygon drowns in the rounding of unit vectors, its solid angle does not.
    const int count = points * points * static_cast<int>(v.size() - 2);
    return {weights > 0 ? sum * polygon.solid_angle() / weights : 0.0, count};
}

}  // namespace shlight
