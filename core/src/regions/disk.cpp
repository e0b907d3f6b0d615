// SPDX-License-Identifier: MIT
#include "shlight/disk.h"

#include <algorithm>
#include <cmath>
#include <limits>
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
constexpr double kNarrowestForBoundary = std::is_same_v<T, float> ? 1e-7 : 1e-3;
template <class T>
constexpr double kSmallestCut = std::is_same_v<T, float> ? 1e-8 : 1e-4;

template <class T>
bool takes_sweep(const SphericalEllipse& ellipse) {
    return can_be_swept(ellipse) && (ellipse.least_solid_angle() < kNarrowestForBoundary<T> * ellipse.boundary() ||
                                     (ellipse.cut() && ellipse.least_solid_angle() < kSmallestCut<T>));
}

/// Whether the points go through the recurrences in float, twice as many at once: wide boundaries lose nothing by it
/// that float could hold, as with polygons; the result is right to 4e-6 of L_00. Up to order 2 double costs next to
/// nothing.
template <class T>
bool boundary_in_float(const SphericalEllipse& ellipse, int order) {
    constexpr double kWideForFloat = 0.1;
    // Long periods would enlarge the rounding of a point's place.
    constexpr double kRoundest = 0.1;
    return std::is_same_v<T, float> && order > 2 && ellipse.cone().complement > kRoundest &&
           ellipse.least_solid_angle() > kWideForFloat * ellipse.boundary();
}

/// Pieces of a boundary: they have the half length `half`, and the first lies about `middle`.
struct Pieces {
    Spacing spacing;
    Division division;
    double middle, half;
};

Pieces cut_up(const SphericalEllipse& ellipse, int order, double epsilon) {
    const BoundaryPoints points(ellipse.cone().sin_long, ellipse.cone().complement);
    const double degree = order - 1;
    const double digits = digits_for(ellipse, order, epsilon);
    if (!ellipse.cut()) {
        const double quarter = ellipse.functions().quarter_period();
        const Division division = points.closed(quarter, degree, digits);
        const double half = 2 * quarter / division.pieces;
        return {Spacing::equal, division, half - 2 * quarter, half};
    }
    const double from = ellipse.cut()->from;
    const double half = (ellipse.cut()->to - from) / 2;
    const Division division = points.open(half, degree, digits);
    return {Spacing::gauss, division, from + half / division.pieces, half / division.pieces};
}

/// Between an arc of the horizon and the axis q: 2 arg (cos h + q·m + i sin h q·z), m the arc's middle and h half of
/// it.
double horizon_fan(const HorizonCut& cut, const Vec3d& axis) {
    return 2 *
           std::atan2(std::sin(cut.angle / 2) * axis.z, std::cos(cut.angle / 2) + glm::dot(axis, horizon_middle(cut)));
}

/// Boundaries that wait for the lanes, with sums in R, and where their results go.
template <class R, class T>
class WaitingBoundaries {
  public:
    WaitingBoundaries(std::size_t most, int order)
        : order_(order), row_(static_cast<std::size_t>(coefficient_count(order))), sums_(most * row_) {}

    /// Lists a disk's boundary, to the precision of T.
    void add(const SphericalEllipse& ellipse, T* result) {
        R* const sums = sums_.data() + results_.size() * row_;
        std::fill_n(sums, row_, R(0));
        const auto number = static_cast<R>(results_.size());
        const Cone& cone = ellipse.cone();
        const Pieces pieces = cut_up(ellipse, order_, std::numeric_limits<T>::epsilon());
        const double turn = std::numbers::pi / (2 * ellipse.functions().quarter_period());
        const auto r = [](double x) { return static_cast<R>(x); };
        for (int i = 0; i < pieces.division.pieces; ++i) {
            const double middle = turn * (pieces.middle + 2 * i * pieces.half);
            boundaries_.arcs.add(static_cast<std::size_t>(pieces.division.points), pieces.spacing) = {
                Vec3<R>(cone.long_axis),
                r(cone.complement),
                Vec3<R>(cone.short_axis),
                number,
                Vec3<R>(cone.axis),
                r(middle),
                r(turn * pieces.half),
                r(pieces.half),
                r(cone.sin_long),
                r(cone.cos_long),
                r(cone.sin_short),
                r(cone.cos_short),
                {}};
        }
        if (ellipse.cut()) {
            const HorizonCut& cut = *ellipse.cut();
            boundaries_.add_horizon() = {r(cut.last.x), r(cut.last.y), r(cut.first.x), r(cut.first.y), r(cut.angle), {},
                                         number};
            // Bands 0 and 1 of what lies along the horizon.
            sums[0] = r(horizon_fan(cut, cone.axis) * std::sqrt(0.25 / std::numbers::pi));
            if (order_ > 1) {
                sums[2] = r(cut.angle / 2 * std::sqrt(0.75 / std::numbers::pi));
            }
        }
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

}  // namespace

template <class T>
void disk_coefficients(std::span<const Vec3<T>> centers, std::span<const Vec3<T>> half_axes_u,
                       std::span<const Vec3<T>> half_axes_v, int order, bool clip, std::span<T> coefficients) {
    constexpr std::size_t kChunk = 128;
    check_order(order);
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    const std::size_t count = centers.size();
    check_size("half_axes_u", half_axes_u.size(), count);
    check_size("half_axes_v", half_axes_v.size(), count);
    check_size("coefficients", coefficients.size(), count * row);
    const auto disk = [&](std::size_t i) {
        return Ellipse{Vec3d(centers[i]), Vec3d(half_axes_u[i]), Vec3d(half_axes_v[i])};
    };
    for (std::size_t i = 0; i < count; ++i) {
        check_disk(disk(i), std::numeric_limits<T>::epsilon());
    }
    WaitingBoundaries<double, T> boundaries(std::min(count, kChunk), order);
    WaitingBoundaries<float, T> in_float(std::is_same_v<T, float> ? std::min(count, kChunk) : 0, order);
    for (std::size_t first = 0; first < count; first += kChunk) {
        for (std::size_t i = first; i < std::min(first + kChunk, count); ++i) {
            const auto result = coefficients.subspan(i * row, row);
            const SphericalEllipse ellipse(disk(i), clip);
            if (ellipse.empty()) {
                std::fill(result.begin(), result.end(), T(0));
            } else if (takes_sweep<T>(ellipse)) {
                const std::vector<double> swept = disk_by_sweep(ellipse, order, std::numeric_limits<T>::epsilon());
                std::transform(swept.begin(), swept.end(), result.begin(), [](double c) { return static_cast<T>(c); });
            } else if (boundary_in_float<T>(ellipse, order)) {
                in_float.add(ellipse, result.data());
            } else {
                boundaries.add(ellipse, result.data());
            }
        }
        boundaries.finish();
        in_float.finish();
    }
}

template void disk_coefficients(std::span<const Vec3f>, std::span<const Vec3f>, std::span<const Vec3f>, int, bool,
                                std::span<float>);
template void disk_coefficients(std::span<const Vec3d>, std::span<const Vec3d>, std::span<const Vec3d>, int, bool,
                                std::span<double>);

}  // namespace shlight
