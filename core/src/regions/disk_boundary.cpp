// SPDX-License-Identifier: MIT
#include "regions/disk_boundary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "regions/boundary_points.h"

namespace shlight {
namespace {

/// More than double can resolve is not asked for.
constexpr double kLeastTolerance = 1e-19;

/// Where pieces of a boundary lie: `pieces` of the half length `half`, the first about `middle`.
struct Pieces {
    Spacing spacing;
    Division division;
    double middle, half;
};

template <class T>
Pieces cut_up(const SphericalEllipse<Wider<T>>& ellipse, int order) {
    const Cone<Wider<T>>& cone = ellipse.cone();
    const BoundaryPoints points(static_cast<double>(cone.sin_long), static_cast<double>(cone.complement));
    const double degree = order - 1;
    const double digits = digits_for<T>(ellipse, order);
    if (!ellipse.cut()) {
        const auto quarter = static_cast<double>(ellipse.functions().quarter_period());
        const Division division = points.closed(quarter, degree, digits);
        const double half = 2 * quarter / division.pieces;
        return {Spacing::equal, division, half - 2 * quarter, half};
    }
    const auto from = static_cast<double>(ellipse.cut()->from);
    const auto half = static_cast<double>((ellipse.cut()->to - ellipse.cut()->from) / 2);
    const Division division = points.open(half, degree, digits);
    return {Spacing::gauss, division, from + half / division.pieces, half / division.pieces};
}

template <class R, class Real>
ConeRow<R> row_of(const SphericalEllipse<Real>& ellipse, std::size_t number) {
    const auto to = [](Real x) { return static_cast<R>(x); };
    const Cone<Real>& cone = ellipse.cone();
    return {to(cone.long_axis.x),
            to(cone.long_axis.y),
            to(cone.long_axis.z),
            to(cone.complement),
            to(cone.short_axis.x),
            to(cone.short_axis.y),
            to(cone.short_axis.z),
            static_cast<R>(number),
            to(cone.axis.x),
            to(cone.axis.y),
            to(cone.axis.z),
            0,
            0,
            0,
            to(cone.sin_long),
            to(cone.cos_long),
            to(cone.sin_short),
            to(cone.cos_short),
            0,
            0};
}

/// Between an arc of the horizon and the axis q: 2 arg (cos h + q·m + i sin h q·z), m the arc's middle and h half of
/// it.
template <class Real>
Real horizon_fan(const HorizonCut<Real>& cut, const Vec3<Real>& axis) {
    const Real half = cut.angle / 2;
    const Real c = std::cos(half);
    const Real s = std::sin(half);
    const Vec3<Real> middle(cut.last.x * c - cut.last.y * s, cut.last.x * s + cut.last.y * c, 0);
    return 2 * std::atan2(s * axis.z, c + glm::dot(axis, middle));
}

template <class R, class Real>
void add_horizon(const SphericalEllipse<Real>& ellipse, int order, std::size_t number, ArcLists<R>& arcs,
                 R* coefficients) {
    const HorizonCut<Real>& cut = *ellipse.cut();
    const auto to = [](Real x) { return static_cast<R>(x); };
    arcs.add_horizon() = {to(cut.last.x),        to(cut.last.y), to(cut.first.x), to(cut.first.y), to(cut.angle), 0, 0,
                          static_cast<R>(number)};
    constexpr Real kPi = std::numbers::pi_v<Real>;
    coefficients[0] += to(horizon_fan(cut, ellipse.cone().axis) * std::sqrt(1 / (4 * kPi)));
    if (order > 1) {
        coefficients[2] += to(cut.angle / 2 * std::sqrt(3 / (4 * kPi)));
    }
}

}  // namespace

template <class T>
double digits_for(const SphericalEllipse<Wider<T>>& ellipse, int order) {
    const double allowed = 0.25 * order * std::numeric_limits<T>::epsilon() *
                           static_cast<double>(ellipse.least_solid_angle() / ellipse.boundary());
    return -std::log(std::max(allowed, kLeastTolerance));
}

template <class T>
bool disk_boundary_in_float(const SphericalEllipse<Wider<T>>& ellipse, int order) {
    constexpr double kWideForFloat = 0.1;
    // Long periods would enlarge the rounding of a point's place.
    constexpr double kRoundest = 0.1;
    return std::is_same_v<T, float> && order > 2 && ellipse.cone().complement > kRoundest &&
           ellipse.least_solid_angle() > kWideForFloat * ellipse.boundary();
}

template <class T, class R>
void start_disk_boundary(const SphericalEllipse<Wider<T>>& ellipse, int order, std::size_t number,
                         DiskBoundarys<R>& boundaries, R* coefficients) {
    const Pieces pieces = cut_up<T>(ellipse, order);
    ConeRow<R> row = row_of<R>(ellipse, number);
    const auto turn = std::numbers::pi / (2 * static_cast<double>(ellipse.functions().quarter_period()));
    for (int i = 0; i < pieces.division.pieces; ++i) {
        row[11] = static_cast<R>(turn * (pieces.middle + 2 * i * pieces.half));
        row[12] = static_cast<R>(turn * pieces.half);
        row[13] = static_cast<R>(pieces.half);
        boundaries.cones.add(pieces.spacing, static_cast<std::size_t>(pieces.division.points)) = row;
    }
    if (ellipse.cut()) {
        add_horizon(ellipse, order, number, boundaries.horizon, coefficients);
    }
}

template bool disk_boundary_in_float<float>(const SphericalEllipse<double>&, int);
template bool disk_boundary_in_float<double>(const SphericalEllipse<long double>&, int);
template void start_disk_boundary<float>(const SphericalEllipse<double>&, int, std::size_t, DiskBoundarys<float>&,
                                         float*);
template void start_disk_boundary<float>(const SphericalEllipse<double>&, int, std::size_t, DiskBoundarys<double>&,
                                         double*);
template void start_disk_boundary<double>(const SphericalEllipse<long double>&, int, std::size_t,
                                          DiskBoundarys<double>&, double*);
template double digits_for<float>(const SphericalEllipse<double>&, int);
template double digits_for<double>(const SphericalEllipse<long double>&, int);

}  // namespace shlight
