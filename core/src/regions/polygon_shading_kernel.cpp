// SPDX-License-Identifier: MIT
#include "regions/polygon_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "regions/polygon_shading_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "regions/polygon_lists-inl.h"
#include "regions/potential-inl.h"
#include "shlight/shading.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// Tolerance of Gauss points in units of that for coefficients: one number sums up the errors of many of them.
constexpr double kLooseness = 8;

/// Work of one call of shade_polygons.
template <bool kBoosted>
class PolygonShading : public PolygonLists<PolygonShading<kBoosted>, float, kBoosted> {
    using Base = PolygonLists<PolygonShading<kBoosted>, float, kBoosted>;
    friend Base;

  public:
    PolygonShading(const PolygonArray& polygons, const std::uint32_t* polygon_of, const LobeArrays& lobe,
                   const std::uint32_t* view_of, float* values)
        : Base(polygons, lobe.order, kLooseness),
          polygon_of_(polygon_of),
          lobe_(lobe),
          view_of_(view_of),
          values_(values) {}

    void shade(std::size_t first, std::size_t count) {
        first_ = first;
        sums_.assign(count, 0.0);
        this->take(count, true);
        integrate(this->float_arcs_);
        integrate(this->double_arcs_);
        for (std::size_t i = 0; i < count; ++i) {
            values_[first + i] = static_cast<float>(sums_[i]);
        }
        shade_narrowest();
    }

  private:
    std::size_t polygon(std::size_t i) const { return polygon_of_[first_ + i]; }
    std::uint32_t view(std::size_t i) const { return view_of_[first_ + i]; }
    const BoostArrays& boosts() const { return lobe_.boosts; }
    const float* terms(std::size_t i) const { return lobe_.terms + view(i) * lobe_.stride; }

    /// The part of the solid angle and of the vector irradiance.
    template <class R>
    HWY_INLINE void low_bands(V<Lanes<R>> solid_angle, const Vectors3<R>& moment, const std::uint32_t* list,
                              std::size_t count) {
        const Lanes<R> d;
        std::array<V<Lanes<R>>, 3> f;
        const std::size_t terms_count = this->order_ > 1 ? 3 : 1;
        for (std::size_t j = 0; j < 3; ++j) {
            f[j] = j < terms_count ? low_term<R>(j, list, count) : hn::Zero(d);
        }
        const auto first = hn::MulAdd(moment.z, f[1], hn::Mul(moment.x, f[2]));
        LaneValues<R> values;
        put<R>(values,
               hn::MulAdd(all(d, Base::kBand0), hn::Mul(solid_angle, f[0]), hn::Mul(all(d, Base::kBand1), first)));
        for (std::size_t lane = 0; lane < count; ++lane) {
            sums_[list[lane]] = static_cast<double>(values[lane]);
        }
    }

    /// Term j of the lobes of a vector's polygons.
    template <class R>
    HWY_INLINE V<Lanes<R>> low_term(std::size_t j, const std::uint32_t* list, std::size_t count) const {
        if (lobe_.stride == 0) {
            return hn::Set(Lanes<R>(), static_cast<R>(lobe_.terms[j]));
        }
        LaneValues<R> values;
        for (std::size_t lane = 0; lane < values.size(); ++lane) {
            values[lane] = static_cast<R>(terms(list[std::min(lane, count - 1)])[j]);
        }
        return get<R>(values);
    }

    template <class R>
    void integrate(const ArcLists<R>& lists) {
        if (this->order_ <= 2) {
            return;
        }
        PotentialSeries<R> series(this->order_);
        bool is_set = false;
        for (int points = 1; points <= kMaxGaussPoints; ++points) {
            const auto& arcs = lists.arcs.rows(static_cast<std::size_t>(points));
            const GaussRule& rule = gauss_rule(points);
            for (std::size_t first = 0; first < arcs.size(); first += kLaneCount<Lanes<R>>) {
                look(series, arcs, first, is_set);
                const ArcLanes<R, !kBoosted> lanes(arcs.from(first));
                add(arcs, first, arc_integral<R, !kBoosted>(series, lanes, rule));
            }
        }
        integrate_horizon(lists.horizon, series, is_set);
    }

    /// Sets the lobes of the regions that a vector's arcs belong to. is_set: whether they were set before, which
    /// suffices where all polygons share a lobe.
    template <class R, class Rows>
    void look(PotentialSeries<R>& series, const Rows& arcs, std::size_t first, bool& is_set) const {
        if (is_set && lobe_.stride == 0) {
            return;
        }
        is_set = true;
        RowPointers<const float> rows;
        for (std::size_t lane = 0; lane < kLaneCount<Lanes<R>>; ++lane) {
            rows[lane] = terms(arcs.region(std::min(first + lane, arcs.size() - 1)));
        }
        series.set(rows);
    }

    template <class Rows, class Vector>
    HWY_INLINE void add(const Rows& regions, std::size_t first, Vector v) {
        using R = hn::TFromV<Vector>;
        LaneValues<R> values;
        put<R>(values, v);
        const std::size_t count = std::min(values.size(), regions.size() - first);
        for (std::size_t lane = 0; lane < count; ++lane) {
            sums_[regions.region(first + lane)] += static_cast<double>(values[lane]);
        }
    }

    template <class R>
    void integrate_horizon(const RowList<HorizonArc<R>>& arcs, PotentialSeries<R>& series, bool& is_set) {
        constexpr std::size_t kWidth = kLaneCount<Lanes<R>>;
        std::vector<R> slopes(series.order() * kWidth);
        for (std::size_t first = 0; first < arcs.size(); first += kWidth) {
            if (first == 0 || lobe_.stride != 0) {
                LaneValues<R> height;
                LaneValues<R> sine;
                for (std::size_t lane = 0; lane < kWidth; ++lane) {
                    const std::size_t v = view(arcs.region(std::min(first + lane, arcs.size() - 1)));
                    height[lane] = kBoosted ? static_cast<R>(lobe_.boosts.horizon_height[v]) : R(0);
                    sine[lane] = kBoosted ? static_cast<R>(lobe_.boosts.horizon_sine[v]) : R(1);
                }
                look(series, arcs, first, is_set);
                horizon_slopes<R>(series, get<R>(height), get<R>(sine), slopes.data());
            }
            add(arcs, first, horizon_integral<R>(slopes.data(), series.order(), arcs.from(first)));
        }
    }

    void shade_narrowest() {
        std::vector<Vec3d> polygon(this->polygons_.vertex_count);
        std::array<float, static_cast<std::size_t>(coefficient_count(kMaxOrder))> coefficients;
        for (const std::uint32_t i : this->narrowest_) {
            std::copy_n(this->vertex(i), 3 * polygon.size(), &polygon.data()->x);
            polygon_by_cubature(polygon, this->order_, true, coefficients.data());
            values_[first_ + i] = shade_cosine(coefficients.data(), terms(i), this->order_);
        }
    }

    const std::uint32_t* polygon_of_;
    const LobeArrays& lobe_;
    const std::uint32_t* view_of_;
    float* values_;

    std::size_t first_ = 0;  ///< first light of the present chunk
    std::vector<double> sums_;
};

/// Polygons that are taken apart before their arcs are integrated: many of them fill vectors of arcs with the same
/// number of points.
constexpr std::size_t kChunk = 2048;

template <bool kBoosted>
void shade_all(const PolygonArray& polygons, const std::uint32_t* polygon_of, const LobeArrays& lobe,
               const std::uint32_t* view_of, float* values, std::size_t count) {
    PolygonShading<kBoosted> shading(polygons, polygon_of, lobe, view_of, values);
    for (std::size_t first = 0; first < count; first += kChunk) {
        shading.shade(first, std::min(kChunk, count - first));
    }
}

void shade_polygons_in_lanes(const PolygonArray& polygons, const std::uint32_t* polygon_of, const LobeArrays& lobe,
                             const std::uint32_t* view_of, float* values, std::size_t count) {
    (lobe.boosted ? shade_all<true> : shade_all<false>)(polygons, polygon_of, lobe, view_of, values, count);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(shade_polygons_in_lanes);

void shade_polygons(std::span<const Vec3d> vertices, int vertex_count, std::span<const std::uint32_t> polygon_of,
                    const LobeArrays& lobe, std::span<const std::uint32_t> view_of, std::span<float> values) {
    HWY_DYNAMIC_DISPATCH(shade_polygons_in_lanes)
    ({&vertices.data()->x, static_cast<std::size_t>(vertex_count)}, polygon_of.data(), lobe, view_of.data(),
     values.data(), values.size());
}

}  // namespace shlight
#endif
