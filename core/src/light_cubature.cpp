// SPDX-License-Identifier: MIT
#include "light_cubature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "perpendicular.h"
#include "triangle_cubature.h"

namespace shlight {
namespace {

/// Relative error of a rule for a light of relative size x, about (x / reach)^(2 half_power).
struct RuleError {
    double reach;
    int half_power;

    double operator()(double size) const {
        const double square = size * size / (reach * reach);
        double error = square;
        for (int i = 1; i < half_power; ++i) {
            error *= square;
        }
        return error;
    }
};

/// Points on a circle about a cap's axis that divides the cap's area at `inside`; weights of a rule sum to 1.
struct Ring {
    double inside, weight;
    int spokes;
};

/// The middle; one ring, degree 3; the middle and one ring, degree 5; Gauss's three rings, degree 7 around.
constexpr std::array<Ring, 1> kOnePoint = {Ring{0, 1, 1}};
constexpr std::array<Ring, 1> kFourPoints = {Ring{0.5, 1, 4}};
constexpr std::array<Ring, 2> kSevenPoints = {Ring{0, 0.25, 1}, {2.0 / 3, 0.75, 6}};
constexpr std::array<Ring, 3> kTwentyFourPoints = {
    Ring{0.112701665379258, 5.0 / 18, 8}, {0.5, 4.0 / 9, 8}, {0.887298334620742, 5.0 / 18, 8}};

/// Measured over random lobes, views and lights (95th percentile).
constexpr std::array<RuleError, 4> kCapRules = {RuleError{0.7, 1}, {1.0, 2}, {1.0, 3}, {1.0, 4}};

std::span<const Ring> cap_rule(int number) {
    switch (number) {
        case 1:
            return kOnePoint;
        case 2:
            return kFourPoints;
        case 3:
            return kSevenPoints;
        default:
            return kTwentyFourPoints;
    }
}

/// Of three and seven points a triangle, then product rules.
constexpr std::array<RuleError, 4> kPolygonRules = {RuleError{1.5, 2}, {1.65, 3}, {1.6, 4}, {1.6, 5}};

std::span<const TrianglePoint> polygon_rule(int number) {
    return number == 1 ? three_point_rule() : number == 2 ? seven_point_rule() : product_rule(number + 1);
}

int smallest_rule(std::span<const RuleError> rules, double size, double tolerance) {
    const auto* rule = std::find_if(rules.data(), rules.data() + rules.size(),
                                    [&](const RuleError& error) { return error(size) <= tolerance; });
    return rule == rules.data() + rules.size() ? 0 : static_cast<int>(rule - rules.data()) + 1;
}

}  // namespace

double relative_size(const GgxShape& shape, const Vec3d& view, const Vec3d& middle, double half_angle) {
    // On the sphere where the bell is round, (h_x/α, h_y/α, h_z) normalised, a step of the direction is at most 1/α
    // long before normalising.
    const Vec3d half = middle + view;
    return half_angle / std::hypot(half.x, half.y, shape.alpha * half.z);
}

int cap_rule_number(double relative_size, double tolerance) {
    return smallest_rule(kCapRules, relative_size, tolerance);
}

int polygon_rule_number(double relative_size, double tolerance) {
    return smallest_rule(kPolygonRules, relative_size, tolerance);
}

CubatureSum cap_cubature(const GgxShape& shape, const Vec3d& view, const Circle& cap, int rule_number) {
    const double height = cap.sine * cap.sine / (1 + cap.cosine);  // 1 - cosσ
    const Vec3d u = perpendicular(cap.axis);
    const Vec3d v = glm::cross(cap.axis, u);
    double sum = 0;
    int points = 0;
    double phase = 0;  // half a step from ring to ring
    for (const Ring& ring : cap_rule(rule_number)) {
        const double drop = height * ring.inside;  // 1 - cosine of the ring's angle
        const double sine = std::sqrt(drop * (2 - drop));
        double around = 0;
        for (int i = 0; i < ring.spokes; ++i) {
            const double phi = 2 * std::numbers::pi * (i + phase) / ring.spokes;
            around += lobe_value(shape, (1 - drop) * cap.axis + sine * (std::cos(phi) * u + std::sin(phi) * v), view);
        }
        sum += ring.weight * around / ring.spokes;
        points += ring.spokes;
        phase = 0.5 - phase;
    }
    return {2 * std::numbers::pi * height * sum, points};
}

CubatureSum polygon_cubature(const GgxShape& shape, const Vec3d& view, const SphericalPolygon<double>& polygon,
                             int rule_number) {
    const std::vector<Vec3d>& v = polygon.directions();
    const auto rule = polygon_rule(rule_number);
    double sum = 0;
    double weights = 0;
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        weights += visit_triangle(v[0], v[i], v[i + 1], rule, [&](const Vec3d& direction, double weight) {
            sum += weight * lobe_value(shape, direction, view);
        });
    }
    // As for coefficients: the area of a tiny polygon drowns in the rounding of unit vectors, its solid angle does not.
    const int count = static_cast<int>(rule.size() * (v.size() - 2));
    return {weights > 0 ? sum * polygon.solid_angle() / weights : 0.0, count};
}

}  // namespace shlight
