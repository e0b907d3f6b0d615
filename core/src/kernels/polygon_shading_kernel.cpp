// SPDX-License-Identifier: MIT
#include "kernels/polygon_shading_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/polygon_shading_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "kernels/polygon_outline-inl.h"
#include "kernels/potential-inl.h"
#include "polygon_shading.h"

HWY_BEFORE_NAMESPACE();
namespace shlight {
namespace HWY_NAMESPACE {
namespace {

/// What edges cancel to is about solid angle ÷ outline of what each has. A region with enough of that goes through
/// float and loses nothing that float could hold.
constexpr double kWideForFloat = 0.05;
/// Below this Gauss points inside a polygon do better.
constexpr double kNarrowestForEdges = 1e-9;

/// A harmonic of degree l has waves of up to l cycles a turn about an axis; on a small circle of radius s those of more
/// than ls + 7 are too weak to count.
template <bool kWarped, class R>
HWY_INLINE V<Lanes<R>> degree_on(std::size_t order, V<Lanes<R>> sine) {
    const Lanes<R> d;
    const auto highest = static_cast<double>(order) - 1;
    if constexpr (kWarped) {
        return hn::Min(all(d, highest), hn::MulAdd(all(d, highest), sine, all(d, 7)));
    } else {
        return all(d, highest - 1);
    }
}

/// Gauss points for waves of κ radians; 0 if there are too many for one piece, or none to integrate.
template <class R>
HWY_INLINE V<Lanes<R>> points_for(V<Lanes<R>> kappa, V<Lanes<R>> tolerance) {
    const Lanes<R> d;
    const auto one = all(d, 1);
    const auto square = hn::Mul(kappa, kappa);
    auto error = hn::Mul(square, all(d, 2 * kGaussErrorGrowth[0]));
    auto points = one;
    for (std::size_t k = 1; k + 1 < kMaxGaussPoints; ++k) {
        const auto more = hn::Gt(error, tolerance);
        if (hn::AllFalse(d, more)) {
            return points;
        }
        points = hn::Add(points, hn::IfThenElseZero(more, one));
        error = hn::IfThenElse(more, hn::Mul(error, hn::Mul(square, all(d, kGaussErrorGrowth[k]))), error);
    }
    return hn::IfThenElseZero(hn::Le(error, tolerance), points);
}

/// Work of one call of shade_polygons.
template <bool kWarped>
class PolygonShading {
  public:
    PolygonShading(const PolygonArray& polygons, const std::uint32_t* polygon_of, const LobeArrays& lobe,
                   const std::uint32_t* view_of, float* values)
        : polygons_(polygons), polygon_of_(polygon_of), lobe_(lobe), view_of_(view_of), values_(values) {}

    void shade(std::size_t first, std::size_t count) {
        first_ = first;
        sums_.assign(count, 0.0);
        whole_.clear();
        cut_.clear();
        narrow_whole_.clear();
        narrow_cut_.clear();
        narrowest_.clear();
        float_arcs_.clear();
        double_arcs_.clear();
        for (std::uint32_t i = 0; i < count; ++i) {
            sort_by_horizon(i);
        }
        if constexpr (kWarped) {
            take_apart<double, false>(whole_);
            take_apart<double, true>(cut_);
        } else {
            take_apart<float, false>(whole_);
            take_apart<float, true>(cut_);
            take_apart<double, false>(narrow_whole_);
            take_apart<double, true>(narrow_cut_);
        }
        if (lobe_.stride == 0) {
            integrate<float, true>(float_arcs_);
            integrate<double, true>(double_arcs_);
        } else {
            integrate<float, false>(float_arcs_);
            integrate<double, false>(double_arcs_);
        }
        for (std::size_t i = 0; i < count; ++i) {
            values_[first + i] = static_cast<float>(sums_[i]);
        }
        shade_narrowest();
    }

  private:
    const double* vertex(std::uint32_t i) const {
        return polygons_.vertices + 3 * polygons_.vertex_count * polygon_of_[first_ + i];
    }
    std::uint32_t view(std::uint32_t i) const { return view_of_[first_ + i]; }
    const float* terms(std::uint32_t i) const { return lobe_.terms + view(i) * lobe_.stride; }

    /// Those below have no light.
    void sort_by_horizon(std::uint32_t i) {
        const double* z = vertex(i) + 2;
        std::size_t above = 0;
        for (std::size_t k = 0; k < polygons_.vertex_count; ++k) {
            above += z[3 * k] >= 0 ? 1 : 0;
        }
        if (above == polygons_.vertex_count) {
            whole_.push_back(i);
        } else if (above > 0) {
            cut_.push_back(i);
        }
    }

    template <class R, bool kClipped>
    void take_apart(const std::vector<std::uint32_t>& list) {
        constexpr std::size_t kWidth = kLaneCount<Lanes<R>>;
        EdgePreparation<R> preparation(polygons_, kClipped);
        PolygonLanes<R> lanes;
        lanes.edges.resize(polygons_.vertex_count);
        for (std::size_t start = 0; start < list.size(); start += kWidth) {
            const std::size_t count = std::min(kWidth, list.size() - start);
            std::array<std::uint32_t, kWidth> polygon;
            std::array<std::uint32_t, kWidth> views;
            for (std::size_t lane = 0; lane < kWidth; ++lane) {
                const std::uint32_t i = list[start + std::min(lane, count - 1)];
                polygon[lane] = polygon_of_[first_ + i];
                views[lane] = view(i);
            }
            preparation.prepare(polygon.data(), lanes);
            if constexpr (kWarped) {
                const WarpLanes warp(lobe_.warps, views.data());
                keep<R, kClipped>(lanes, Outline<R, kClipped, true>(lanes, &warp).region(), list.data() + start, count);
            } else {
                keep<R, kClipped>(lanes, Outline<R, kClipped, false>(lanes, nullptr).region(), list.data() + start,
                                  count);
            }
        }
    }

    /// What decides about a vector of polygons.
    template <class R>
    struct Measured {
        LaneValues<R> solid_angle, outline, moment_x, moment_z, tolerance;
        std::vector<LaneValues<R>> points;  ///< on each edge

        explicit Measured(std::size_t edges) : points(edges) {}
    };

    template <class R>
    void measure(const PolygonLanes<R>& lanes, const RegionLanes<R>& region, Measured<R>& out) const {
        const Lanes<R> d;
        const auto solid_angle = hn::Max(region.solid_angle, hn::Zero(d));
        put<R>(out.solid_angle, solid_angle);
        put<R>(out.outline, region.outline);
        put<R>(out.moment_x, region.first_moment.x);
        put<R>(out.moment_z, region.first_moment.z);
        // Of a harmonic's integral over an arc. What it adds to a coefficient is divided by about the degree.
        const auto wide = hn::Gt(solid_angle, hn::Mul(all(d, kWideForFloat), region.outline));
        const double unit = lobe_.order * static_cast<double>(std::numeric_limits<float>::epsilon());
        const auto tolerance = hn::Mul(solid_angle, hn::IfThenElse(wide, all(d, unit), all(d, 0.25 * unit)));
        put<R>(out.tolerance, tolerance);
        for (std::size_t e = 0; e < lanes.edges.size(); ++e) {
            const auto half = get<R>(lanes.edges[e].half);
            const auto sine = kWarped ? get<R>(lanes.edges[e].sine) : all(d, 1);
            const auto length = hn::Mul(sine, half);
            const auto relative = hn::Max(hn::Div(tolerance, length), all(d, kFinest));
            const auto degree = degree_on<kWarped, R>(static_cast<std::size_t>(lobe_.order), sine);
            put<R>(out.points[e], points_for<R>(hn::Mul(degree, half), relative));
        }
    }

    /// Chooses each polygon's way: lists its arcs, or the polygon for another way.
    template <class R, bool kClipped>
    void keep(const PolygonLanes<R>& lanes, const RegionLanes<R>& region, const std::uint32_t* list,
              std::size_t count) {
        Measured<R> measured(lanes.edges.size());
        measure(lanes, region, measured);
        for (std::size_t lane = 0; lane < count; ++lane) {
            if (lanes.side[lane] == 0) {
                continue;
            }
            const std::uint32_t i = list[lane];
            const R solid_angle = measured.solid_angle[lane];
            const bool wide = solid_angle > static_cast<R>(kWideForFloat) * measured.outline[lane];
            if (!wide && std::is_same_v<R, float>) {
                (kClipped ? narrow_cut_ : narrow_whole_).push_back(i);
            } else if (!kWarped && !(solid_angle > static_cast<R>(kNarrowestForEdges) * measured.outline[lane])) {
                narrowest_.push_back(i);
            } else if (wide) {
                list_arcs<kClipped>(lanes, measured, lane, i, float_arcs_);
            } else {
                list_arcs<kClipped>(lanes, measured, lane, i, double_arcs_);
            }
        }
    }

    template <bool kClipped, class R, class To>
    void list_arcs(const PolygonLanes<R>& lanes, const Measured<R>& measured, std::size_t lane, std::uint32_t i,
                   ArcList<To>& list) {
        low_bands(measured, lane, i);
        if (lobe_.order <= 2) {
            return;
        }
        const auto to = [](R x) { return static_cast<To>(x); };
        for (std::size_t e = 0; e < lanes.edges.size(); ++e) {
            const EdgeLanes<R>& edge = lanes.edges[e];
            if (!(edge.half[lane] > 0)) {
                continue;
            }
            ArcRow<To> row{{to(edge.axis_x[lane]), to(edge.axis_y[lane]), to(edge.axis_z[lane])},
                           to(edge.half[lane]),
                           {to(edge.middle_x[lane]), to(edge.middle_y[lane]), to(edge.middle_z[lane])},
                           kWarped ? to(edge.cosine[lane]) : To(0),
                           kWarped ? to(edge.sine[lane]) : To(1),
                           {}};
            const auto points = static_cast<int>(measured.points[e][lane]);
            if (points > 0) {
                add_arc(row, i, points, list);
            } else {
                add_divided(row, i, static_cast<double>(measured.tolerance[lane]), list);
            }
        }
        if constexpr (kClipped) {
            list_horizon(lanes, lane, i, list);
        }
    }

    /// In pieces: too long for one rule.
    template <class To>
    void add_divided(const ArcRow<To>& row, std::uint32_t i, double tolerance, ArcList<To>& list) const {
        const auto half = static_cast<double>(row.half);
        const auto sine = static_cast<double>(row.sine);
        const double highest = lobe_.order - 1;
        const double degree = kWarped ? std::min(highest, highest * sine + 7) : highest - 1;
        const Division division = divided(degree * half, std::max(tolerance / (sine * half), kFinest));
        const Vec3d axis(row.axis[0], row.axis[1], row.axis[2]);
        const Vec3d middle(row.middle[0], row.middle[1], row.middle[2]);
        const Vec3d across = glm::cross(axis, middle);
        ArcRow<To> piece = row;
        piece.half = static_cast<To>(half / division.pieces);
        for (int k = 0; k < division.pieces; ++k) {
            const double turn = half * ((2 * k + 1.0) / division.pieces - 1);
            const Vec3<To> turned(std::cos(turn) * middle + std::sin(turn) * across);
            piece.middle = {turned.x, turned.y, turned.z};
            add_arc(piece, i, division.points, list);
        }
    }

    template <class To>
    static void add_arc(const ArcRow<To>& row, std::uint32_t i, int points, ArcList<To>& list) {
        list.arcs.reserve(1);
        list.region_of_arc.reserve(1);
        list.points.reserve(1);
        list.arcs.add() = row;
        list.region_of_arc.add() = i;
        list.points.add() = static_cast<std::uint8_t>(points);
    }

    /// Pairs the crossings, any one that leaves with any that enters: only the sum over all counts.
    template <class R, class To>
    void list_horizon(const PolygonLanes<R>& lanes, std::size_t lane, std::uint32_t i, ArcList<To>& list) const {
        const auto to = [](R x) { return static_cast<To>(x); };
        const std::size_t edges = lanes.edges.size();
        std::size_t leaving = 0;
        for (const EdgeLanes<R>& entry : lanes.edges) {
            if (!(entry.crossing[lane] * lanes.side[lane] > 0)) {
                continue;
            }
            while (leaving < edges && !(lanes.edges[leaving].crossing[lane] * lanes.side[lane] < 0)) {
                ++leaving;
            }
            const EdgeLanes<R>& exit = lanes.edges[leaving++];
            list.horizon.reserve(1);
            list.region_of_horizon.reserve(1);
            list.horizon.add() = {to(exit.azimuth_cosine[lane]),
                                  to(exit.azimuth_sine[lane]),
                                  to(entry.azimuth_cosine[lane]),
                                  to(entry.azimuth_sine[lane]),
                                  to(entry.azimuth[lane] - exit.azimuth[lane]),
                                  {}};
            list.region_of_horizon.add() = i;
        }
    }

    /// The solid angle and the vector irradiance.
    template <class R>
    void low_bands(const Measured<R>& measured, std::size_t lane, std::uint32_t i) {
        const float* f = terms(i);
        constexpr double kPi = std::numbers::pi;
        double sum =
            std::sqrt(1 / (4 * kPi)) * static_cast<double>(measured.solid_angle[lane]) * static_cast<double>(f[0]);
        if (lobe_.order > 1) {
            sum +=
                std::sqrt(3 / (4 * kPi)) * (static_cast<double>(measured.moment_z[lane]) * static_cast<double>(f[1]) +
                                            static_cast<double>(measured.moment_x[lane]) * static_cast<double>(f[2]));
        }
        sums_[i] += sum;
    }

    template <class R, bool kShared>
    void integrate(const ArcList<R>& list) {
        if (list.arcs.size() == 0) {
            return;
        }
        PotentialSeries<R, kShared> series(lobe_.order);
        if constexpr (kShared) {
            RowPointers<const float> rows;
            rows.fill(lobe_.terms);
            series.set(rows);
        }
        integrate_arcs(list, series);
        integrate_horizon(list, series);
    }

    /// The lobes of the regions that a vector's lanes belong to.
    template <class R, bool kShared>
    void look(PotentialSeries<R, kShared>& series, const RowList<std::uint32_t>& region_of, const std::uint32_t* index,
              std::size_t count) const {
        if constexpr (!kShared) {
            RowPointers<const float> rows;
            for (std::size_t lane = 0; lane < rows.size(); ++lane) {
                rows[lane] = terms(region_of[index[std::min(lane, count - 1)]]);
            }
            series.set(rows);
        }
    }

    template <class R, bool kShared>
    void integrate_arcs(const ArcList<R>& list, PotentialSeries<R, kShared>& series) {
        constexpr std::size_t kWidth = kLaneCount<Lanes<R>>;
        const ArcOrder order(list.points);
        std::vector<R> integrals(list.arcs.size() + kWidth);
        for (int points = 1; points <= kMaxGaussPoints; ++points) {
            for (std::size_t start = 0; start < order.count(points); start += kWidth) {
                const std::size_t count = std::min(kWidth, order.count(points) - start);
                const std::uint32_t* index = order.begin(points) + start;
                look(series, list.region_of_arc, index, count);
                const ArcLanes<R, !kWarped> arcs(row_pointers<R>(list.arcs, index, count));
                LaneValues<R> values;
                put<R>(values, arc_integral<R, !kWarped, kShared>(series, arcs, gauss_rule(points)));
                for (std::size_t lane = 0; lane < count; ++lane) {
                    integrals[index[lane]] = values[lane];
                }
            }
        }
        for (std::size_t k = 0; k < list.arcs.size(); ++k) {
            sums_[list.region_of_arc[k]] += static_cast<double>(integrals[k]);
        }
    }

    template <class R, bool kShared>
    void integrate_horizon(const ArcList<R>& list, PotentialSeries<R, kShared>& series) {
        const Lanes<R> d;
        constexpr std::size_t kWidth = kLaneCount<Lanes<R>>;
        std::vector<R> slopes(static_cast<std::size_t>(lobe_.order) * kWidth);
        for (std::size_t start = 0; start < list.horizon.size(); start += kWidth) {
            const std::size_t count = std::min(kWidth, list.horizon.size() - start);
            std::array<std::uint32_t, kWidth> index;
            alignas(64) std::array<R, kWidth> height;
            alignas(64) std::array<R, kWidth> sine;
            for (std::size_t lane = 0; lane < kWidth; ++lane) {
                index[lane] = static_cast<std::uint32_t>(start + std::min(lane, count - 1));
                const std::uint32_t v = view(list.region_of_horizon[index[lane]]);
                height[lane] = kWarped ? static_cast<R>(lobe_.warps.horizon_height[v]) : R(0);
                sine[lane] = kWarped ? static_cast<R>(lobe_.warps.horizon_sine[v]) : R(1);
            }
            if (!kShared || start == 0) {
                look(series, list.region_of_horizon, index.data(), count);
                horizon_slopes(series, hn::Load(d, height.data()), hn::Load(d, sine.data()), slopes.data());
            }
            LaneValues<R> values;
            put<R>(values, horizon_integral<R>(slopes.data(), series.order(),
                                               row_pointers<R>(list.horizon, index.data(), count)));
            for (std::size_t lane = 0; lane < count; ++lane) {
                sums_[list.region_of_horizon[index[lane]]] += static_cast<double>(values[lane]);
            }
        }
    }

    void shade_narrowest() {
        std::vector<Vec3d> polygon(polygons_.vertex_count);
        for (const std::uint32_t i : narrowest_) {
            const double* v = vertex(i);
            for (Vec3d& corner : polygon) {
                corner = {v[0], v[1], v[2]};
                v += 3;
            }
            const SphericalPolygon<double> seen(polygon, true);
            values_[first_ + i] = seen.empty() ? 0.0F : shade_polygon(seen, Warp(), terms(i), lobe_.order);
        }
    }

    /// More than float can resolve is not asked for.
    static constexpr double kFinest = 1e-20;

    PolygonArray polygons_;
    const std::uint32_t* polygon_of_;
    const LobeArrays& lobe_;
    const std::uint32_t* view_of_;
    float* values_;

    // Of the present chunk, by index in it.
    std::size_t first_ = 0;
    std::vector<double> sums_;
    std::vector<std::uint32_t> whole_, cut_, narrow_whole_, narrow_cut_, narrowest_;
    ArcList<float> float_arcs_;
    ArcList<double> double_arcs_;
};

/// Polygons that are taken apart before their arcs are integrated: many of them fill vectors of arcs with the same
/// number of points.
constexpr std::size_t kChunk = 1024;

template <bool kWarped>
void shade_all(const PolygonArray& polygons, const std::uint32_t* polygon_of, const LobeArrays& lobe,
               const std::uint32_t* view_of, float* values, std::size_t count) {
    PolygonShading<kWarped> shading(polygons, polygon_of, lobe, view_of, values);
    for (std::size_t first = 0; first < count; first += kChunk) {
        shading.shade(first, std::min(kChunk, count - first));
    }
}

void shade_polygons_in_lanes(const PolygonArray& polygons, const std::uint32_t* polygon_of, const LobeArrays& lobe,
                             const std::uint32_t* view_of, float* values, std::size_t count) {
    (lobe.warped ? shade_all<true> : shade_all<false>)(polygons, polygon_of, lobe, view_of, values, count);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace shlight
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
