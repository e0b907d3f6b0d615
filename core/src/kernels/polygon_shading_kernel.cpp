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

/// What edges cancel to is about solid angle ÷ outline of what each has. A region with more than this goes through
/// float and loses little that float could hold: less at low orders, where fewer terms bring their rounding.
double least_width_for_float(int order) {
    return std::clamp(0.003 * order, 0.024, 0.05);
}
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

/// Gauss points for waves of κ radians; more than kMaxGaussPoints if one rule does not do.
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
    return hn::IfThenElse(hn::Le(error, tolerance), points, all(d, kMaxGaussPoints + 1));
}

template <class DI, class Vector>
HWY_INLINE auto to_integers(DI di, Vector v) {
    if constexpr (sizeof(hn::TFromV<Vector>) == 4) {
        return hn::ConvertTo(di, v);
    } else {
        return hn::DemoteTo(di, v);
    }
}

/// Stores a vector's 128-bit blocks at column `column` of every kSquare-th row.
template <class D, class T>
HWY_INLINE void store_blocks(D d, V<D> v, T* const* rows, std::size_t column) {
    if constexpr (hn::MaxLanes(d) > kSquare<D>) {
        const hn::Half<D> half;
        store_blocks(half, hn::LowerHalf(half, v), rows, column);
        store_blocks(half, hn::UpperHalf(half, v), rows + hn::MaxLanes(half), column);
    } else {
        hn::StoreU(v, d, *rows + column);
    }
}

/// Copies what lanes have in `columns` to rows.
template <class R, class To, std::size_t kColumns>
HWY_INLINE void write_rows(const std::array<const LaneValues<R>*, kColumns>& columns,
                           const std::array<To*, kLaneCount<Lanes<R>>>& rows) {
    if constexpr (std::is_same_v<R, To>) {
        const Lanes<R> d;
        constexpr std::size_t kSide = kSquare<Lanes<R>>;
        for (std::size_t c = 0; c < kColumns; c += kSide) {
            std::array<V<Lanes<R>>, kSide> square;
            for (std::size_t j = 0; j < kSide; ++j) {
                square[j] = get<R>(*columns[c + j]);
            }
            transpose_squares(d, square);
            for (std::size_t j = 0; j < kSide; ++j) {
                store_blocks(d, square[j], rows.data() + j, c);
            }
        }
    } else {
        for (std::size_t lane = 0; lane < rows.size(); ++lane) {
            for (std::size_t c = 0; c < kColumns; ++c) {
                rows[lane][c] = static_cast<To>((*columns[c])[lane]);
            }
        }
    }
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
        for (auto* list : {&whole_, &cut_, &narrow_whole_, &narrow_cut_, &narrowest_}) {
            list->clear();
        }
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
    std::uint32_t view(std::size_t i) const { return view_of_[first_ + i]; }
    const float* terms(std::size_t i) const { return lobe_.terms + view(i) * lobe_.stride; }

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

    /// What decides about a vector of polygons.
    template <class R>
    struct Measured {
        LaneValues<R> width;      ///< solid angle ÷ outline; 0 if edge-on or without area
        LaneValues<R> low_bands;  ///< of the sum
        LaneValues<R> tolerance;
        std::vector<LaneValues<R>> points;  ///< on each edge; 0 for none, kMaxGaussPoints + 1 for too many
    };

    template <class R, bool kClipped>
    void take_apart(const std::vector<std::uint32_t>& list) {
        constexpr std::size_t kWidth = kLaneCount<Lanes<R>>;
        EdgePreparation<R> preparation(polygons_, kClipped);
        PolygonLanes<R> lanes;
        lanes.edges.resize(polygons_.vertex_count);
        Measured<R> measured;
        measured.points.resize(polygons_.vertex_count);
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
                measure(lanes, Outline<R, kClipped, true>(lanes, &warp).region(), list.data() + start, count, measured);
            } else {
                measure(lanes, Outline<R, kClipped, false>(lanes, nullptr).region(), list.data() + start, count,
                        measured);
            }
            keep<R, kClipped>(lanes, measured, list.data() + start, count);
        }
    }

    template <class R>
    HWY_INLINE void measure(const PolygonLanes<R>& lanes, const RegionLanes<R>& region, const std::uint32_t* list,
                            std::size_t count, Measured<R>& out) const {
        const Lanes<R> d;
        const auto zero = hn::Zero(d);
        const auto seen = hn::And(hn::Ne(get<R>(lanes.side), zero), hn::Gt(region.solid_angle, zero));
        const auto solid_angle = hn::IfThenElseZero(seen, region.solid_angle);
        const auto width = hn::IfThenElseZero(seen, hn::Div(region.solid_angle, region.outline));
        put<R>(out.width, width);
        put<R>(out.low_bands, low_bands(solid_angle, region.first_moment, list, count));
        // Of a harmonic's integral over an arc. What it adds to a coefficient is divided by about the degree.
        const auto wide = hn::Gt(width, all(d, least_width_));
        const double unit = lobe_.order * static_cast<double>(std::numeric_limits<float>::epsilon());
        const auto tolerance = hn::Mul(solid_angle, hn::IfThenElse(wide, all(d, 8 * unit), all(d, unit)));
        put<R>(out.tolerance, tolerance);
        for (std::size_t e = 0; e < lanes.edges.size(); ++e) {
            const auto half = get<R>(lanes.edges[e].half);
            const auto sine = kWarped ? get<R>(lanes.edges[e].sine) : all(d, 1);
            const auto length = hn::Mul(sine, half);
            const auto relative = hn::Max(hn::Div(tolerance, length), all(d, kFinest));
            const auto degree = degree_on<kWarped, R>(static_cast<std::size_t>(lobe_.order), sine);
            const auto points = points_for<R>(hn::Mul(degree, half), relative);
            put<R>(out.points[e], hn::IfThenElseZero(hn::Gt(half, zero), points));
        }
    }

    /// The part of the solid angle and of the vector irradiance.
    template <class R>
    HWY_INLINE V<Lanes<R>> low_bands(V<Lanes<R>> solid_angle, const Vectors3<R>& moment, const std::uint32_t* list,
                                     std::size_t count) const {
        const Lanes<R> d;
        std::array<LaneValues<R>, 3> f;
        const std::size_t terms_count = lobe_.order > 1 ? 3 : 1;
        for (std::size_t lane = 0; lane < f[0].size(); ++lane) {
            const float* from = terms(list[std::min(lane, count - 1)]);
            for (std::size_t j = 0; j < 3; ++j) {
                f[j][lane] = j < terms_count ? static_cast<R>(from[j]) : R(0);
            }
        }
        const auto first = hn::MulAdd(moment.z, get<R>(f[1]), hn::Mul(moment.x, get<R>(f[2])));
        return hn::MulAdd(all(d, kBand0), hn::Mul(solid_angle, get<R>(f[0])), hn::Mul(all(d, kBand1), first));
    }

    /// Chooses each polygon's way: lists its arcs, or the polygon for another way.
    template <class R, bool kClipped>
    void keep(const PolygonLanes<R>& lanes, const Measured<R>& measured, const std::uint32_t* list, std::size_t count) {
        constexpr bool kAlwaysDouble = !kWarped && std::is_same_v<R, double>;
        LaneValues<R> in_float{};
        LaneValues<R> in_double{};
        for (std::size_t lane = 0; lane < count; ++lane) {
            const R width = measured.width[lane];
            sums_[list[lane]] = static_cast<double>(measured.low_bands[lane]);
            if (!kAlwaysDouble && width > static_cast<R>(least_width_)) {
                in_float[lane] = 1;
            } else if (lanes.side[lane] == 0) {
                sums_[list[lane]] = 0;
            } else if (std::is_same_v<R, float>) {
                (kClipped ? narrow_cut_ : narrow_whole_).push_back(list[lane]);
            } else if (!kWarped && !(width > static_cast<R>(kNarrowestForEdges))) {
                narrowest_.push_back(list[lane]);
            } else {
                in_double[lane] = 1;
            }
        }
        if (lobe_.order <= 2) {
            return;
        }
        if constexpr (!kAlwaysDouble) {
            list_arcs<kClipped>(lanes, measured, in_float, list, count, float_arcs_);
        }
        if constexpr (std::is_same_v<R, double>) {
            list_arcs<kClipped>(lanes, measured, in_double, list, count, double_arcs_);
        }
    }

    /// chosen: 1 for the lanes that are listed, else 0.
    template <bool kClipped, class R, class To>
    void list_arcs(const PolygonLanes<R>& lanes, const Measured<R>& measured, const LaneValues<R>& chosen,
                   const std::uint32_t* list, std::size_t count, ArcLists<To>& lists) {
        constexpr std::size_t kWidth = kLaneCount<Lanes<R>>;
        const Lanes<R> d;
        const hn::Rebind<std::int32_t, Lanes<R>> di;
        LaneValues<R> region;
        for (std::size_t lane = 0; lane < kWidth; ++lane) {
            region[lane] = static_cast<R>(list[std::min(lane, count - 1)]);
        }
        alignas(64) std::array<std::int32_t, kWidth> which;
        ArcRow<To> nowhere;
        std::array<To*, kWidth> rows;
        for (std::size_t e = 0; e < lanes.edges.size(); ++e) {
            LaneValues<R> points;
            put<R>(points, hn::Mul(get<R>(chosen), get<R>(measured.points[e])));
            if (!hn::AllTrue(d, hn::Le(get<R>(points), all(d, kMaxGaussPoints)))) {
                add_divided(lanes.edges[e], measured.tolerance, region, points, lists);
            }
            // What is no arc goes to the list of those without points, which nobody reads.
            hn::Store(to_integers(di, get<R>(points)), di, which.data());
            for (std::size_t lane = 0; lane < kWidth; ++lane) {
                rows[lane] = lists.add_arc(static_cast<std::size_t>(which[lane])).data();
            }
            write_rows<R, To>(columns(lanes.edges[e], region), rows);
        }
        for (const HorizonLanes<R>& arc : lanes.horizon) {
            const auto exists = hn::IfThenElseZero(hn::Ne(get<R>(arc.angle), hn::Zero(d)), get<R>(chosen));
            hn::Store(to_integers(di, exists), di, which.data());
            for (std::size_t lane = 0; lane < kWidth; ++lane) {
                rows[lane] = which[lane] != 0 ? lists.add_horizon().data() : nowhere.data();
            }
            const std::array<const LaneValues<R>*, 8> from = {&arc.from_cosine, &arc.from_sine, &arc.to_cosine,
                                                              &arc.to_sine,     &arc.angle,     &arc.angle,
                                                              &arc.angle,       &region};
            write_rows<R, To>(from, rows);
        }
    }

    /// Of an edge's arc, as ArcRow, without what great circles do not need.
    template <class R>
    static auto columns(const EdgeLanes<R>& edge, const LaneValues<R>& region) {
        const std::array<const LaneValues<R>*, 8> great = {&edge.axis_x,   &edge.axis_y,   &edge.axis_z,   &edge.half,
                                                           &edge.middle_x, &edge.middle_y, &edge.middle_z, &region};
        if constexpr (kWarped) {
            std::array<const LaneValues<R>*, 12> columns;
            columns.fill(&edge.sine);
            std::copy(great.begin(), great.end(), columns.begin());
            columns[8] = &edge.cosine;
            return columns;
        } else {
            return great;
        }
    }

    /// Lists the arcs that are too long for one rule in pieces, and takes them out of `points`.
    template <class R, class To>
    void add_divided(const EdgeLanes<R>& edge, const LaneValues<R>& tolerance, const LaneValues<R>& region,
                     LaneValues<R>& points, ArcLists<To>& lists) const {
        for (std::size_t lane = 0; lane < points.size(); ++lane) {
            if (points[lane] > kMaxGaussPoints) {
                add_pieces(edge, lane, region, static_cast<double>(tolerance[lane]), lists);
                points[lane] = 0;
            }
        }
    }

    template <class R, class To>
    void add_pieces(const EdgeLanes<R>& edge, std::size_t lane, const LaneValues<R>& region, double tolerance,
                    ArcLists<To>& lists) const {
        ArcRow<To> piece{};
        const auto from = columns(edge, region);
        for (std::size_t c = 0; c < from.size(); ++c) {
            piece[c] = static_cast<To>((*from[c])[lane]);
        }
        const auto half = static_cast<double>(piece[3]);
        const double sine = kWarped ? static_cast<double>(piece[9]) : 1;
        const double highest = lobe_.order - 1;
        const double degree = kWarped ? std::min(highest, highest * sine + 7) : highest - 1;
        const Division division = divided(degree * half, std::max(tolerance / (sine * half), kFinest));
        const Vec3d axis(piece[0], piece[1], piece[2]);
        const Vec3d middle(piece[4], piece[5], piece[6]);
        const Vec3d across = glm::cross(axis, middle);
        piece[3] = static_cast<To>(half / division.pieces);
        for (int k = 0; k < division.pieces; ++k) {
            const double turn = half * ((2 * k + 1.0) / division.pieces - 1);
            const Vec3<To> turned(std::cos(turn) * middle + std::sin(turn) * across);
            std::copy_n(&turned.x, 3, piece.begin() + 4);
            lists.add_arc(static_cast<std::size_t>(division.points)) = piece;
        }
    }

    template <class R, bool kShared>
    void integrate(const ArcLists<R>& lists) {
        if (lobe_.order <= 2) {
            return;
        }
        PotentialSeries<R, kShared> series(lobe_.order);
        if constexpr (kShared) {
            RowPointers<const float> rows;
            rows.fill(lobe_.terms);
            series.set(rows);
        }
        for (int points = 1; points <= kMaxGaussPoints; ++points) {
            const auto& arcs = lists.arcs(static_cast<std::size_t>(points));
            for (std::size_t first = 0; first < arcs.size(); first += kLaneCount<Lanes<R>>) {
                look(series, arcs, first);
                const ArcLanes<R, !kWarped> lanes(row_pointers<R>(arcs, first));
                add(arcs, first, arc_integral<R, !kWarped, kShared>(series, lanes, gauss_rule(points)));
            }
        }
        integrate_horizon(lists.horizon(), series);
    }

    /// The lobes of the regions that a vector's lanes belong to.
    template <class R, bool kShared, class Rows>
    void look(PotentialSeries<R, kShared>& series, const Rows& regions, std::size_t first) const {
        if constexpr (!kShared) {
            RowPointers<const float> rows;
            for (std::size_t lane = 0; lane < kLaneCount<Lanes<R>>; ++lane) {
                rows[lane] = terms(regions.region(std::min(first + lane, regions.size() - 1)));
            }
            series.set(rows);
        }
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

    template <class R, bool kShared>
    void integrate_horizon(const RowList<HorizonRow<R>>& arcs, PotentialSeries<R, kShared>& series) {
        constexpr std::size_t kWidth = kLaneCount<Lanes<R>>;
        std::vector<R> slopes(series.order() * kWidth);
        for (std::size_t first = 0; first < arcs.size(); first += kWidth) {
            if (!kShared || first == 0) {
                LaneValues<R> height;
                LaneValues<R> sine;
                for (std::size_t lane = 0; lane < kWidth; ++lane) {
                    const std::size_t v = view(arcs.region(std::min(first + lane, arcs.size() - 1)));
                    height[lane] = kWarped ? static_cast<R>(lobe_.warps.horizon_height[v]) : R(0);
                    sine[lane] = kWarped ? static_cast<R>(lobe_.warps.horizon_sine[v]) : R(1);
                }
                look(series, arcs, first);
                horizon_slopes(series, get<R>(height), get<R>(sine), slopes.data());
            }
            add(arcs, first, horizon_integral<R>(slopes.data(), series.order(), row_pointers<R>(arcs, first)));
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
    static constexpr double kBand0 = 0.28209479177387814;  ///< 1 / √4π
    static constexpr double kBand1 = 0.48860251190291992;  ///< √(3 / 4π)

    PolygonArray polygons_;
    const std::uint32_t* polygon_of_;
    const LobeArrays& lobe_;
    const std::uint32_t* view_of_;
    float* values_;
    double least_width_ = least_width_for_float(lobe_.order);

    // Of the present chunk, by index in it.
    std::size_t first_ = 0;
    std::vector<double> sums_;
    std::vector<std::uint32_t> whole_, cut_, narrow_whole_, narrow_cut_, narrowest_;
    ArcLists<float> float_arcs_;
    ArcLists<double> double_arcs_;
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
