// SPDX-License-Identifier: MIT
#include "shlight/disk.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <vector>

#include "base/checks.h"
#include "regions/boundary_points.h"
#include "regions/disk_sweep.h"
#include "regions/region_checks.h"
#include "regions/spherical_ellipse.h"

namespace shlight {
namespace {

/// Below this ratio of solid angle to length of boundary the boundary cancels to too few digits: its sum is wrong by
/// about 1e-15 of L_00 ÷ that ratio. Where the horizon cuts a boundary, its ends are off by a rounding of unit vectors:
/// below this solid angle that is too much.
template <class T>
constexpr double kNarrowestForBoundary = std::is_same_v<T, float> ? 1e-7 : 2e-4;
template <class T>
constexpr double kSmallestCut = std::is_same_v<T, float> ? 1e-8 : 1e-4;

template <class T>
bool takes_sweep(const SphericalEllipse<Wider<T>>& ellipse) {
    return can_be_swept(ellipse) && (ellipse.least_solid_angle() < kNarrowestForBoundary<T> * ellipse.boundary() ||
                                     (ellipse.cut() && ellipse.least_solid_angle() < kSmallestCut<T>));
}

/// Pieces of a boundary: they have the half length `half`, and the first lies about `middle`.
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
ConeArc<R> arc_of(const SphericalEllipse<Real>& ellipse, std::size_t number) {
    const auto to = [](Real x) { return static_cast<R>(x); };
    const Cone<Real>& cone = ellipse.cone();
    ConeArc<R> arc{};
    arc.long_axis = Vec3<R>(cone.long_axis);
    arc.short_axis = Vec3<R>(cone.short_axis);
    arc.axis = Vec3<R>(cone.axis);
    arc.complement = to(cone.complement);
    arc.region = static_cast<R>(number);
    arc.sin_long = to(cone.sin_long);
    arc.cos_long = to(cone.cos_long);
    arc.sin_short = to(cone.sin_short);
    arc.cos_short = to(cone.cos_short);
    return arc;
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
void add_horizon(const SphericalEllipse<Real>& ellipse, int order, std::size_t number, ArcLists<R, ConeArc<R>>& lists,
                 R* coefficients) {
    const HorizonCut<Real>& cut = *ellipse.cut();
    const auto to = [](Real x) { return static_cast<R>(x); };
    lists.add_horizon() = {to(cut.last.x),        to(cut.last.y), to(cut.first.x), to(cut.first.y), to(cut.angle), {},
                           static_cast<R>(number)};
    constexpr Real kPi = std::numbers::pi_v<Real>;
    coefficients[0] += to(horizon_fan(cut, ellipse.cone().axis) * std::sqrt(1 / (4 * kPi)));
    if (order > 1) {
        coefficients[2] += to(cut.angle / 2 * std::sqrt(3 / (4 * kPi)));
    }
}

/// Whether the points go through the recurrences in float, twice as many at once: wide boundaries lose nothing by it
/// that float could hold, as with polygons; the result is right to 4e-6 of L_00. Up to order 2 double costs next to
/// nothing.
template <class T>
bool disk_boundary_in_float(const SphericalEllipse<Wider<T>>& ellipse, int order) {
    constexpr double kWideForFloat = 0.1;
    // Long periods would enlarge the rounding of a point's place.
    constexpr double kRoundest = 0.1;
    return std::is_same_v<T, float> && order > 2 && ellipse.cone().complement > kRoundest &&
           ellipse.least_solid_angle() > kWideForFloat * ellipse.boundary();
}

/// Lists a disk's boundary under its number, to the precision of T. coefficients: order² zeros, to which bands 0 and 1
/// of what lies along the horizon are added.
template <class T, class R>
void start_disk_boundary(const SphericalEllipse<Wider<T>>& ellipse, int order, std::size_t number,
                         ArcLists<R, ConeArc<R>>& lists, R* coefficients) {
    const Pieces pieces = cut_up<T>(ellipse, order);
    ConeArc<R> arc = arc_of<R>(ellipse, number);
    const auto turn = std::numbers::pi / (2 * static_cast<double>(ellipse.functions().quarter_period()));
    arc.half_turn = static_cast<R>(turn * pieces.half);
    arc.half = static_cast<R>(pieces.half);
    for (int i = 0; i < pieces.division.pieces; ++i) {
        arc.middle = static_cast<R>(turn * (pieces.middle + 2 * i * pieces.half));
        lists.arcs.add(static_cast<std::size_t>(pieces.division.points), pieces.spacing) = arc;
    }
    if (ellipse.cut()) {
        add_horizon(ellipse, order, number, lists, coefficients);
    }
}

/// Boundaries that wait for the lanes, with sums in R, and where their results go.
template <class R, class T>
class WaitingBoundaries {
  public:
    WaitingBoundaries(std::size_t most, int order)
        : order_(order), row_(static_cast<std::size_t>(coefficient_count(order))), sums_(most * row_) {}

    void add(const SphericalEllipse<Wider<T>>& ellipse, T* result) {
        R* const sums = sums_.data() + results_.size() * row_;
        std::fill_n(sums, row_, R(0));
        start_disk_boundary<T>(ellipse, order_, results_.size(), boundaries_, sums);
        results_.push_back(result);
    }

    void finish() {
        if (results_.empty()) {
            return;
        }
        add_cone_coefficients(boundaries_, order_, sums_.data());
        const R* from = sums_.data();
        for (T* const result : results_) {
            std::transform(from, from + row_, result, [](R c) { return static_cast<T>(c); });
            from += row_;
        }
        boundaries_.clear();
        results_.clear();
    }

  private:
    int order_;
    std::size_t row_;
    std::vector<R> sums_;
    ArcLists<R, ConeArc<R>> boundaries_;
    std::vector<T*> results_;
};

/// disk(i): number i of `count`, in the wider type.
template <class T, class Disk>
void integrate(std::size_t count, int order, bool clip, T* coefficients, const Disk& disk) {
    constexpr std::size_t kChunk = 128;
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    WaitingBoundaries<double, T> boundaries(std::min(count, kChunk), order);
    WaitingBoundaries<float, T> in_float(std::is_same_v<T, float> ? std::min(count, kChunk) : 0, order);
    for (std::size_t first = 0; first < count; first += kChunk) {
        for (std::size_t i = first; i < std::min(first + kChunk, count); ++i) {
            T* const result = coefficients + i * row;
            const SphericalEllipse<Wider<T>> ellipse(disk(i), clip);
            if (ellipse.empty()) {
                std::fill_n(result, row, T(0));
            } else if (takes_sweep<T>(ellipse)) {
                disk_by_sweep(ellipse, order, result);
            } else if (disk_boundary_in_float<T>(ellipse, order)) {
                if constexpr (std::is_same_v<T, float>) {
                    in_float.add(ellipse, result);
                }
            } else {
                boundaries.add(ellipse, result);
            }
        }
        boundaries.finish();
        in_float.finish();
    }
}

template <class T>
Ellipse<Wider<T>> widened(const Vec3<T>& center, const Vec3<T>& u, const Vec3<T>& v) {
    using Wide = Vec3<Wider<T>>;
    return {Wide(center), Wide(u), Wide(v)};
}

}  // namespace

template <class T>
void disk_coefficients(const Ellipse<T>& disk, int order, bool clip, T* coefficients) {
    integrate(1, order, clip, coefficients,
              [&](std::size_t) { return widened(disk.center, disk.half_axis_u, disk.half_axis_v); });
}

template <class T>
void disk_coefficients(std::span<const Vec3<T>> centers, std::span<const Vec3<T>> half_axes_u,
                       std::span<const Vec3<T>> half_axes_v, int order, bool clip, std::span<T> coefficients) {
    check_order(order);
    const std::size_t count = centers.size();
    check_size("half_axes_u", half_axes_u.size(), count);
    check_size("half_axes_v", half_axes_v.size(), count);
    check_size("coefficients", coefficients.size(), count * static_cast<std::size_t>(coefficient_count(order)));
    const auto disk = [&](std::size_t i) { return widened(centers[i], half_axes_u[i], half_axes_v[i]); };
    for (std::size_t i = 0; i < count; ++i) {
        check_disk<T>(disk(i));
    }
    integrate(count, order, clip, coefficients.data(), disk);
}

template void disk_coefficients(const Ellipse<float>&, int, bool, float*);
template void disk_coefficients(const Ellipse<double>&, int, bool, double*);
template void disk_coefficients(std::span<const Vec3f>, std::span<const Vec3f>, std::span<const Vec3f>, int, bool,
                                std::span<float>);
template void disk_coefficients(std::span<const Vec3d>, std::span<const Vec3d>, std::span<const Vec3d>, int, bool,
                                std::span<double>);

}  // namespace shlight
