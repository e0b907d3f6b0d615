// SPDX-License-Identifier: MIT
#include "disk_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernels/polygon_rows.h"
#include "outline_points.h"

namespace shlight {
namespace {

/// More than double can resolve is not asked for.
constexpr double kLeastTolerance = 1e-19;

/// Where pieces of an outline lie: `pieces` of the half length `half`, the first about `middle`.
struct Pieces {
    Spacing spacing;
    Division division;
    double middle, half;
};

template <class T>
Pieces cut_up(const SphericalEllipse<Wider<T>>& ellipse, int order) {
    const Cone<Wider<T>>& cone = ellipse.cone();
    const OutlinePoints points(static_cast<double>(cone.sin_long), static_cast<double>(cone.complement));
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

template <class Real>
ConeRow<double> row_of(const SphericalEllipse<Real>& ellipse, std::size_t number) {
    const auto to = [](Real x) { return static_cast<double>(x); };
    const Cone<Real>& cone = ellipse.cone();
    return {to(cone.long_axis.x),
            to(cone.long_axis.y),
            to(cone.long_axis.z),
            to(cone.complement),
            to(cone.short_axis.x),
            to(cone.short_axis.y),
            to(cone.short_axis.z),
            static_cast<double>(number),
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

template <class Real>
void add_horizon(const SphericalEllipse<Real>& ellipse, int order, std::size_t number, ArcLists<double>& arcs,
                 double* coefficients) {
    const HorizonCut<Real>& cut = *ellipse.cut();
    const auto to = [](Real x) { return static_cast<double>(x); };
    arcs.add_horizon() = {to(cut.last.x),
                          to(cut.last.y),
                          to(cut.first.x),
                          to(cut.first.y),
                          to(cut.angle),
                          0,
                          0,
                          static_cast<double>(number)};
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
                           static_cast<double>(ellipse.least_solid_angle() / ellipse.outline());
    return -std::log(std::max(allowed, kLeastTolerance));
}

template <class T>
void start_disk_outline(const SphericalEllipse<Wider<T>>& ellipse, int order, std::size_t number,
                        DiskOutlines& outlines, double* coefficients) {
    const Pieces pieces = cut_up<T>(ellipse, order);
    ConeRow<double> row = row_of(ellipse, number);
    const auto turn = std::numbers::pi / (2 * static_cast<double>(ellipse.functions().quarter_period()));
    for (int i = 0; i < pieces.division.pieces; ++i) {
        row[11] = turn * (pieces.middle + 2 * i * pieces.half);
        row[12] = turn * pieces.half;
        row[13] = pieces.half;
        outlines.cones.add(pieces.spacing, static_cast<std::size_t>(pieces.division.points)) = row;
    }
    if (ellipse.cut()) {
        add_horizon(ellipse, order, number, outlines.horizon, coefficients);
    }
}

void add_disk_outlines(const DiskOutlines& outlines, int order, double* coefficients) {
    add_cone_coefficients(outlines.cones, order, coefficients);
    add_arc_coefficients(outlines.horizon, true, order, coefficients);
}

template void start_disk_outline<float>(const SphericalEllipse<double>&, int, std::size_t, DiskOutlines&, double*);
template void start_disk_outline<double>(const SphericalEllipse<long double>&, int, std::size_t, DiskOutlines&,
                                         double*);
template double digits_for<float>(const SphericalEllipse<double>&, int);
template double digits_for<double>(const SphericalEllipse<long double>&, int);

}  // namespace shlight
