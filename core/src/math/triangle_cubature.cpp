// SPDX-License-Identifier: MIT
#include "math/triangle_cubature.h"

#include <array>
#include <cmath>
#include <vector>

#include "math/gauss_legendre.h"

namespace shlight {
namespace {

std::vector<std::vector<TrianglePoint>> all_product_rules() {
    std::vector<std::vector<TrianglePoint>> rules(kMaxGaussPoints + 1);
    for (int side = 1; side <= kMaxGaussPoints; ++side) {
        const GaussRule& gauss = gauss_rule(side);
        for (std::size_t i = 0; i < gauss.nodes.size(); ++i) {
            for (std::size_t j = 0; j < gauss.nodes.size(); ++j) {
                const double u = gauss.nodes[i];
                const double v = gauss.nodes[j];
                rules[side].push_back({u * (1 - v), u * v, 2 * u * gauss.weights[i] * gauss.weights[j]});
            }
        }
    }
    return rules;
}

}  // namespace

std::span<const TrianglePoint> product_rule(int side) {
    static const std::vector<std::vector<TrianglePoint>> rules = all_product_rules();
    return rules[side];
}

std::span<const TrianglePoint> three_point_rule() {
    static constexpr std::array<TrianglePoint, 3> rule = {
        TrianglePoint{1.0 / 6, 1.0 / 6, 1.0 / 3}, {1.0 / 6, 2.0 / 3, 1.0 / 3}, {2.0 / 3, 1.0 / 6, 1.0 / 3}};
    return rule;
}

std::span<const TrianglePoint> seven_point_rule() {
    static const std::array<TrianglePoint, 7> rule = [] {
        const double root = std::sqrt(15.0);
        const double near = (6 - root) / 21;
        const double far = (6 + root) / 21;
        const double near_weight = (155 - root) / 1200;
        const double far_weight = (155 + root) / 1200;
        return std::array<TrianglePoint, 7>{TrianglePoint{1.0 / 3, 1.0 / 3, 9.0 / 40},
                                            {near, near, near_weight},
                                            {near, 1 - 2 * near, near_weight},
                                            {1 - 2 * near, near, near_weight},
                                            {far, far, far_weight},
                                            {far, 1 - 2 * far, far_weight},
                                            {1 - 2 * far, far, far_weight}};
    }();
    return rule;
}

}  // namespace shlight
