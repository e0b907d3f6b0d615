// SPDX-License-Identifier: MIT
#include "regions/ellipse_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "regions/ellipse_rows.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "regions/cone_points-inl.h"
#include "regions/moments-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// Where on -1 … 1 point number i lies, and its share of the length.
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
void add_cones(const ConeLists<R>& lists, int order, R* coefficients) {
    constexpr std::size_t kWidth = kLaneCount<Lanes<R>>;
    const auto numbers = static_cast<std::size_t>(coefficient_count(order));
    ArcMoments<R, false> moments(order);
    for (const Spacing spacing : {Spacing::gauss, Spacing::equal}) {
        for (std::size_t points = 1; points <= kMaxGaussPoints; ++points) {
            const auto& list = lists.rows(spacing, points);
            for (std::size_t first = 0; first < list.size(); first += kWidth) {
                integrate(ConeLanes<R>(list.from(first)), spacing, points, moments);
                std::array<R*, kWidth> rows{};
                const std::size_t count = std::min(kWidth, list.size() - first);
                for (std::size_t lane = 0; lane < count; ++lane) {
                    rows[lane] = coefficients + list.region(first + lane) * numbers;
                }
                moments.add_to(rows, count);
            }
        }
    }
}

void add_float_cones(const ConeLists<float>& lists, int order, float* coefficients) {
    add_cones(lists, order, coefficients);
}

void add_double_cones(const ConeLists<double>& lists, int order, double* coefficients) {
    add_cones(lists, order, coefficients);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(add_float_cones);
HWY_EXPORT(add_double_cones);

void add_cone_coefficients(const ConeLists<float>& lists, int order, float* coefficients) {
    HWY_DYNAMIC_DISPATCH(add_float_cones)(lists, order, coefficients);
}

void add_cone_coefficients(const ConeLists<double>& lists, int order, double* coefficients) {
    HWY_DYNAMIC_DISPATCH(add_double_cones)(lists, order, coefficients);
}

}  // namespace shlight
#endif
