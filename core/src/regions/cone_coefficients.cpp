// SPDX-License-Identifier: MIT
#include "regions/arcs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "regions/cone_coefficients.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "regions/arc_lanes-inl.h"
#include "regions/moments-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// The place of point number i on -1 … 1, and its share of the length.
struct Node {
    double place, share;
};

Node node(Spacing spacing, std::size_t points, std::size_t i) {
    if (spacing == Spacing::equal) {
        const auto count = static_cast<double>(points);
        return {(2 * static_cast<double>(i) + 1) / count - 1, 1 / count};
    }
    const GaussRule& rule = gauss_rule(static_cast<int>(points));
    return {2 * rule.nodes[i] - 1, rule.weights[i]};
}

/// Pieces in lanes, all bands.
template <class R>
void integrate(const ConeLanes<R>& pieces, Spacing spacing, std::size_t points, ArcMoments<R, false>& moments) {
    const Lanes<R> d;
    const auto length = pieces.length();
    auto fan = hn::Zero(d);
    Vectors3<R> sum = {fan, fan, fan};
    moments.integrate_points(points, [&](std::size_t i) HWY_ATTR {
        const Node at = node(spacing, points, i);
        const auto weight = hn::Mul(length, all(d, at.share));
        const auto point = pieces.at(at.place);
        fan = hn::MulAdd(point.fan, weight, fan);
        sum = sum + scaled<R>(point.on.normal, weight);
        return std::pair(point.on, weight);
    });
    const double band_0 = std::sqrt(0.25 / std::numbers::pi);
    const double band_1 = std::sqrt(0.75 / std::numbers::pi) / 2;
    moments.put_low_bands(hn::Mul(fan, all(d, band_0)), scaled<R>(sum, all(d, band_1)));
}

template <class R>
void add_cones(const ArcLists<R, ConeArc<R>>& lists, int order, R* coefficients) {
    const auto row_of = [&](std::size_t region) {
        return coefficients + region * static_cast<std::size_t>(coefficient_count(order));
    };
    ArcMoments<R, false> moments(order);
    for (const Spacing spacing : {Spacing::gauss, Spacing::equal}) {
        for (std::size_t points = 1; points <= kMaxGaussPoints; ++points) {
            add_list(moments, lists.arcs.rows(points, spacing), row_of,
                     [&](const ConeArc<R>* arcs) HWY_ATTR { integrate(ConeLanes<R>(arcs), spacing, points, moments); });
        }
    }
    add_list(moments, lists.horizon, row_of,
             [&](const HorizonArc<R>* arcs) HWY_ATTR { moments.integrate_horizon(arcs); });
}

void add_float_cones(const ArcLists<float, ConeArc<float>>& lists, int order, float* coefficients) {
    add_cones(lists, order, coefficients);
}

void add_double_cones(const ArcLists<double, ConeArc<double>>& lists, int order, double* coefficients) {
    add_cones(lists, order, coefficients);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(add_float_cones);
HWY_EXPORT(add_double_cones);

void add_cone_coefficients(const ArcLists<float, ConeArc<float>>& lists, int order, float* coefficients) {
    HWY_DYNAMIC_DISPATCH(add_float_cones)(lists, order, coefficients);
}

void add_cone_coefficients(const ArcLists<double, ConeArc<double>>& lists, int order, double* coefficients) {
    HWY_DYNAMIC_DISPATCH(add_double_cones)(lists, order, coefficients);
}

}  // namespace shlight
#endif
