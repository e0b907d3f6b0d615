// SPDX-License-Identifier: MIT
#include "shlight/disk.h"

#include <algorithm>
#include <type_traits>
#include <vector>

#include "base/checks.h"
#include "regions/disk_boundary.h"
#include "regions/disk_checks.h"
#include "regions/disk_sweep.h"
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
        add_disk_boundarys(boundaries_, order_, sums_.data());
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
    DiskBoundarys<R> boundaries_;
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
