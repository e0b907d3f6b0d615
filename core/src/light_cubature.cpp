// SPDX-License-Identifier: MIT
#include "light_cubature.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/cap_cubature_kernel.h"
#include "triangle_cubature.h"

namespace shlight {
namespace {

/// Relative error of a rule for a light of relative size x, about (x / reach)^(2 half_power): measured over random
/// lobes, views and lights (95th percentile).
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

int polygon_rule_number(double relative_size, double tolerance) {
    return smallest_rule(kPolygonRules, relative_size, tolerance);
}

CubatureSum cap_cubature(const GgxShape& shape, const Vec3d& view, const Circle& cap, int rule_number) {
    constexpr std::uint32_t kOnly = 0;
    float value = 0;
    integrate_caps(shape, {&cap.axis.x, &cap.axis.y, &cap.axis.z, &cap.cosine, &cap.sine}, {&kOnly, 1},
                   {&view.x, &view.z, true}, {&kOnly, 1}, rule_number, {&value, 1});
    return {value, cap_rule_points(rule_number)};
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
