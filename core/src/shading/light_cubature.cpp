// SPDX-License-Identifier: MIT
#include "shading/light_cubature.h"

#include <cstdint>

#include "math/triangle_cubature.h"
#include "shading/cubature_kernel.h"

namespace shlight {
namespace {

std::span<const TrianglePoint> polygon_rule(int number) {
    return number == 1 ? three_point_rule() : number == 2 ? seven_point_rule() : product_rule(number + 1);
}

}  // namespace

CubatureSum cap_cubature(const LobeShape& shape, const Vec3d& view, const Circle& cap, int rule_number) {
    constexpr std::uint32_t kOnly = 0;
    float value = 0;
    const auto width = static_cast<float>(lobe_width(shape));
    integrate_caps(shape, &width, {&cap.axis.x, &cap.axis.y, &cap.axis.z, &cap.cosine, &cap.sine}, {&kOnly, 1},
                   {&view.x, &view.z, true}, {&kOnly, 1}, rule_number, {&value, 1});
    return {value, cap_rule_points(rule_number)};
}

CubatureSum polygon_cubature(const LobeShape& shape, const Vec3d& view, const SphericalPolygon& polygon,
                             int rule_number) {
    const std::vector<Vec3d>& v = polygon.directions();
    const auto rule = polygon_rule(rule_number);
    double sum = 0;
    double weights = 0;
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        const double triple = glm::dot(v[0], glm::cross(v[i] - v[0], v[i + 1] - v[0]));
        visit_triangle(v[0], v[i], v[i + 1], triple, rule, [&](const Vec3d& direction, double weight) {
            sum += weight * lobe_value(shape, direction, view);
            weights += weight;
        });
    }
    // As for coefficients: the area of a tiny polygon drowns in the rounding of unit vectors, its solid angle does not.
    const int count = static_cast<int>(rule.size() * (v.size() - 2));
    return {weights > 0 ? sum * polygon.solid_angle() / weights : 0.0, count};
}

}  // namespace shlight
