// SPDX-License-Identifier: MIT
#include "polygons/polygon_edge_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "polygons/polygon_rows.h"

namespace shlight {
namespace {

/// A harmonic of degree l has waves of up to l cycles a turn about the axis; on a small circle of radius s those of
/// more than ls + 7 are too weak to count.
template <class Real>
double degree_on(const Arc<Real>& arc, int order) {
    return arc.cosine == 0 ? order - 2 : std::min(order - 1.0, (order - 1) * static_cast<double>(arc.sine) + 7);
}

/// tolerance: of the integral of a harmonic of unit size.
template <class Real>
Division division_of(const Arc<Real>& arc, int order, double tolerance) {
    const double kappa = degree_on(arc, order) * static_cast<double>(arc.angle) / 2;
    const double half = static_cast<double>(arc.sine * arc.angle) / 2;
    // More than double can resolve is not asked for.
    return divided(kappa, std::max(tolerance / half, 1e-20));
}

/// Of a harmonic's integral over an arc. What it adds to a coefficient is divided by about the degree, and the region's
/// L_00 is what errors are measured by.
template <class T>
double tolerance_for(const PolygonRegion<Wider<T>>& region, int order) {
    const double share = edge_points_in_float<T>(region) ? 1 : 0.25;
    return share * order * std::numeric_limits<T>::epsilon() * static_cast<double>(region.solid_angle());
}

template <class R, class Real>
ArcRow<R> row_of(const Arc<Real>& arc, Real half, const Vec3<Real>& middle, std::size_t number) {
    const auto to = [](Real x) { return static_cast<R>(x); };
    return {to(arc.axis.x), to(arc.axis.y), to(arc.axis.z),         to(half),       to(middle.x),
            to(middle.y),   to(middle.z),   static_cast<R>(number), to(arc.cosine), to(arc.sine)};
}

template <class Real>
bool are_great(const std::vector<Arc<Real>>& arcs) {
    return std::all_of(arcs.begin(), arcs.end(), [](const Arc<Real>& arc) { return arc.cosine == 0; });
}

/// work(R()) with the type that edge_points_in_float tells.
template <class T, class Work>
void in_wide_enough_type(const PolygonRegion<Wider<T>>& region, const Work& work) {
    if constexpr (std::is_same_v<T, float>) {
        if (edge_points_in_float<T>(region)) {
            work(float());
            return;
        }
    }
    work(double());
}

template <class T, class R>
void set_low_bands(const PolygonRegion<Wider<T>>& region, int order, R* coefficients) {
    const auto low = region.low_bands();
    std::transform(low.begin(), low.begin() + std::min(4, coefficient_count(order)), coefficients,
                   [](auto c) { return static_cast<R>(c); });
}

/// The arcs of a region that has this number in the lists, with the Gauss points that they take.
template <class T, class R>
void list_arcs(const PolygonRegion<Wider<T>>& region, int order, std::size_t number, ArcLists<R>& lists) {
    using Real = Wider<T>;
    const double tolerance = tolerance_for<T>(region, order);
    for (const Arc<Real>& arc : region.arcs()) {
        const Division division = division_of(arc, order, tolerance);
        const Real half = arc.angle / static_cast<Real>(2 * division.pieces);
        const Vec3<Real> start = (arc.from - arc.cosine * arc.axis) / arc.sine;
        const Vec3<Real> across = glm::cross(arc.axis, start);
        for (int piece = 0; piece < division.pieces; ++piece) {
            const Real turn = static_cast<Real>(2 * piece + 1) * half;
            lists.add_arc(static_cast<std::size_t>(division.points)) =
                row_of<R>(arc, half, std::cos(turn) * start + std::sin(turn) * across, number);
        }
    }
}

/// order² coefficients before they are rounded.
template <class T>
std::vector<double> sums_over_points(const PolygonRegion<Wider<T>>& region, int order) {
    std::vector<double> sums(static_cast<std::size_t>(coefficient_count(order)));
    in_wide_enough_type<T>(region, [&]<class R>(R /*type*/) {
        ArcLists<R> arcs;
        list_arcs<T>(region, order, 0, arcs);
        std::vector<R> row(sums.size());
        add_arc_coefficients(arcs, are_great(region.arcs()), order, row.data());
        std::copy(row.begin(), row.end(), sums.begin());
    });
    set_low_bands<T>(region, order, sums.data());
    return sums;
}

}  // namespace

void start_edge_points(const PolygonRegion<long double>& region, int order, std::size_t number, ArcLists<double>& arcs,
                       double* coefficients) {
    std::fill_n(coefficients, coefficient_count(order), 0.0);
    set_low_bands<double>(region, order, coefficients);
    list_arcs<double>(region, order, number, arcs);
}

template <class T>
void edge_point_coefficients(const PolygonRegion<Wider<T>>& region, int order, T* coefficients) {
    const std::vector<double> sums = sums_over_points<T>(region, order);
    std::transform(sums.begin(), sums.end(), coefficients, [](double c) { return static_cast<T>(c); });
}

template <class T>
T shade_by_edge_points(const PolygonRegion<Wider<T>>& region, const T* lobe_terms, int order) {
    const std::vector<double> sums = sums_over_points<T>(region, order);
    double total = 0;
    for (int l = 0; l < order; ++l) {
        for (int m = 0; m <= l; ++m) {
            total += static_cast<double>(lobe_terms[cosine_index(l, m)]) *
                     sums[static_cast<std::size_t>(coefficient_index(l, m))];
        }
    }
    return static_cast<T>(total);
}

template <class T>
bool edge_points_in_float(const PolygonRegion<Wider<T>>& region) {
    constexpr double kWideForFloat = 0.05;
    return std::is_same_v<T, float> && region.solid_angle() > kWideForFloat * region.outline() &&
           are_great(region.arcs());
}

template <class T>
int edge_points(const PolygonRegion<Wider<T>>& region, int order) {
    const double tolerance = tolerance_for<T>(region, order);
    int total = 0;
    for (const auto& arc : region.arcs()) {
        const Division division = division_of(arc, order, tolerance);
        total += division.pieces * division.points;
    }
    return total;
}

template void edge_point_coefficients(const PolygonRegion<double>&, int, float*);
template void edge_point_coefficients(const PolygonRegion<long double>&, int, double*);
template float shade_by_edge_points(const PolygonRegion<double>&, const float*, int);
template double shade_by_edge_points(const PolygonRegion<long double>&, const double*, int);
template bool edge_points_in_float<float>(const PolygonRegion<double>&);
template bool edge_points_in_float<double>(const PolygonRegion<long double>&);
template int edge_points<float>(const PolygonRegion<double>&, int);
template int edge_points<double>(const PolygonRegion<long double>&, int);

}  // namespace shlight
