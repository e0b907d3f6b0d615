// SPDX-License-Identifier: MIT
//
// From polygons to lists of arcs that wait for their Gauss points. Included once per instruction set.
#if defined(SHLIGHT_KERNELS_POLYGON_LISTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_POLYGON_LISTS_INL_H_
#undef SHLIGHT_KERNELS_POLYGON_LISTS_INL_H_
#else
#define SHLIGHT_KERNELS_POLYGON_LISTS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "regions/clipped_edges-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Least ratio of solid angle to boundary at which arcs go through float. Edges cancel to about that ratio of each, so
/// wider regions lose little that float could hold, and less at low orders, where fewer terms bring their rounding.
/// Orders up to 2, all that a diffuse surface needs, never do: closed forms in double are right to the last digit of a
/// float.
HWY_INLINE double least_width_for_float(int order) {
    return order <= 2 ? std::numeric_limits<float>::max() : std::clamp(0.003 * order, 0.024, 0.05);
}
/// Below this ratio of solid angle to length of edges Gauss points inside a polygon do better: those on the edges
/// cancel to an error of about 2e-15 of L_00 ÷ that ratio. Arcs of the horizon lie between points that are rounded,
/// which counts twice for a region that is narrow because it is small.
template <class T, bool kClipped>
constexpr double kNarrowestForEdges = std::is_same_v<T, float> ? 1e-9
                                      : kClipped               ? 2e-3
                                                               : 3e-4;

/// A harmonic of degree l has waves of up to l cycles a turn about an axis; on a small circle of radius s those of more
/// than ls + 7 are too weak to count.
template <bool kBoosted, class R>
HWY_INLINE V<Lanes<R>> degree_on(std::size_t order, V<Lanes<R>> sine) {
    const Lanes<R> d;
    const auto highest = static_cast<double>(order) - 1;
    if constexpr (kBoosted) {
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
            store_columns(d, square, rows.data(), c);
        }
    } else {
        for (std::size_t lane = 0; lane < rows.size(); ++lane) {
            for (std::size_t c = 0; c < kColumns; ++c) {
                rows[lane][c] = static_cast<To>((*columns[c])[lane]);
            }
        }
    }
}

/// Takes a chunk of polygons apart, sorted by the horizon and by the precision that they need for results in T. Derived
/// tells by number in the chunk: polygon(i), view(i), and takes low_bands(solid angles, ∫ u du, numbers, count) of
/// vectors, the last word for each number being the right one, 0 for what is not seen.
template <class Derived, class T, bool kBoosted>
class PolygonLists {
  protected:
    /// looseness: of the Gauss points' tolerance, 1 for that of coefficients.
    PolygonLists(const PolygonArray& polygons, int order, double looseness)
        : polygons_(polygons),
          order_(order),
          least_width_(kInDouble ? std::numeric_limits<float>::max() : least_width_for_float(order)),
          looseness_(looseness) {}

    void take(std::size_t count, bool clip) {
        for (auto* list : {&narrow_whole_, &narrow_cut_, &narrowest_}) {
            list->clear();
        }
        float_arcs_.clear();
        double_arcs_.clear();
        sort_by_horizon(count, clip);
        if (kBoosted || kInDouble || order_ <= 2) {
            take_apart<double, false>(whole_);
            take_apart<double, true>(cut_);
            return;
        }
        if constexpr (!kBoosted && !kInDouble) {
            take_apart<float, false>(whole_);
            take_apart<float, true>(cut_);
            take_apart<double, false>(narrow_whole_);
            take_apart<double, true>(narrow_cut_);
        }
    }

    const double* vertex(std::size_t i) { return polygons_.vertices + 3 * polygons_.vertex_count * self().polygon(i); }

    static constexpr double kBand0 = 0.28209479177387814;  ///< 1 / √4π
    static constexpr double kBand1 = 0.48860251190291992;  ///< √(3 / 4π)

    PolygonArray polygons_;
    int order_;
    std::vector<std::uint32_t> narrowest_;  ///< cubature is better
    ArcLists<float> float_arcs_;
    ArcLists<double> double_arcs_;

  private:
    static constexpr bool kInDouble = std::is_same_v<T, double>;

    Derived& self() { return static_cast<Derived&>(*this); }

    /// Polygons below the horizon have no light. There are no branches, which would be foretold badly.
    void sort_by_horizon(std::size_t count, bool clip) {
        whole_.resize(count);
        cut_.resize(count);
        std::size_t whole = 0;
        std::size_t cut = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            const double* z = vertex(i) + 2;
            std::size_t above = 0;
            for (std::size_t k = 0; k < polygons_.vertex_count; ++k) {
                above += z[3 * k] >= 0 ? 1 : 0;
            }
            const bool is_whole = !clip | (above == polygons_.vertex_count);
            whole_[whole] = i;
            cut_[cut] = i;
            whole += is_whole ? 1 : 0;
            cut += (!is_whole & (above > 0)) ? 1 : 0;
        }
        whole_.resize(whole);
        cut_.resize(cut);
    }

    /// The measures that decide about a vector of polygons.
    template <class R>
    struct Measured {
        LaneValues<R> width;  ///< solid angle ÷ length of the edges; 0 if edge-on or without area
        LaneValues<R> tolerance;
        std::vector<LaneValues<R>> points;  ///< on each edge; 0 for none, kMaxGaussPoints + 1 for too many
    };

    template <class R, bool kClipped>
    void take_apart(const std::vector<std::uint32_t>& list) {
        constexpr std::size_t kWidth = kLaneCount<Lanes<R>>;
        EdgePreparation<R, T> preparation(polygons_, kClipped);
        PolygonLanes<R> lanes;
        lanes.edges.resize(polygons_.vertex_count);
        Measured<R> measured;
        measured.points.resize(polygons_.vertex_count);
        for (std::size_t start = 0; start < list.size(); start += kWidth) {
            const std::size_t count = std::min(kWidth, list.size() - start);
            std::array<std::uint32_t, kWidth> polygon;
            std::array<std::int64_t, kWidth> views;
            for (std::size_t lane = 0; lane < kWidth; ++lane) {
                const std::uint32_t i = list[start + std::min(lane, count - 1)];
                polygon[lane] = static_cast<std::uint32_t>(self().polygon(i));
                views[lane] = self().view(i);
            }
            preparation.prepare(polygon.data(), lanes);
            if constexpr (kBoosted) {
                const Doubles d;
                const BoostLanes boost = load_boosts(self().boosts(), [&](const double* values) HWY_ATTR {
                    return hn::GatherIndex(d, values, hn::LoadU(hn::RebindToSigned<Doubles>(), views.data()));
                });
                measure(lanes, ClippedEdges<R, kClipped, true>(lanes, &boost).region(), list.data() + start, count,
                        measured);
            } else {
                measure(lanes, ClippedEdges<R, kClipped, false>(lanes, nullptr).region(), list.data() + start, count,
                        measured);
            }
            keep<R, kClipped>(lanes, measured, list.data() + start, count);
        }
    }

    template <class R>
    HWY_INLINE void measure(const PolygonLanes<R>& lanes, const RegionLanes<R>& region, const std::uint32_t* list,
                            std::size_t count, Measured<R>& out) {
        const Lanes<R> d;
        const auto zero = hn::Zero(d);
        const auto seen = hn::And(hn::Ne(get<R>(lanes.side), zero), hn::Gt(region.solid_angle, zero));
        const auto solid_angle = hn::IfThenElseZero(seen, region.solid_angle);
        const auto width = hn::IfThenElseZero(seen, hn::Div(region.solid_angle, region.perimeter));
        put<R>(out.width, width);
        const Vectors3<R>& moment = region.first_moment;
        self().template low_bands<R>(solid_angle,
                                     {hn::IfThenElseZero(seen, moment.x), hn::IfThenElseZero(seen, moment.y),
                                      hn::IfThenElseZero(seen, moment.z)},
                                     list, count);
        // This is the tolerance of a harmonic's integral over an arc, which a coefficient divides by about the degree.
        const auto wide = hn::Gt(width, all(d, least_width_));
        const double unit = order_ * static_cast<double>(std::numeric_limits<T>::epsilon());
        const auto tolerance =
            hn::Mul(solid_angle, hn::IfThenElse(wide, all(d, looseness_ * unit), all(d, 0.25 * looseness_ * unit)));
        put<R>(out.tolerance, tolerance);
        for (std::size_t e = 0; e < lanes.edges.size(); ++e) {
            const auto half = get<R>(lanes.edges[e].half);
            const auto sine = kBoosted ? get<R>(lanes.edges[e].sine) : all(d, 1);
            const auto length = hn::Mul(sine, half);
            const auto relative = hn::Max(hn::Div(tolerance, length), all(d, kFinest));
            const auto degree = degree_on<kBoosted, R>(static_cast<std::size_t>(order_), sine);
            const auto points = points_for<R>(hn::Mul(degree, half), relative);
            put<R>(out.points[e], hn::IfThenElseZero(hn::Gt(half, zero), points));
        }
    }

    /// Chooses each polygon's way: lists its arcs, or the polygon for another way.
    template <class R, bool kClipped>
    void keep(const PolygonLanes<R>& lanes, const Measured<R>& measured, const std::uint32_t* list, std::size_t count) {
        constexpr bool kAlwaysDouble = !kBoosted && std::is_same_v<R, double>;
        LaneValues<R> in_float{};
        LaneValues<R> in_double{};
        for (std::size_t lane = 0; lane < count; ++lane) {
            const R width = measured.width[lane];
            if (!kAlwaysDouble && width > static_cast<R>(least_width_)) {
                in_float[lane] = 1;
            } else if (lanes.side[lane] == 0) {
                continue;
            } else if (std::is_same_v<R, float>) {
                (kClipped ? narrow_cut_ : narrow_whole_).push_back(list[lane]);
            } else if (!kBoosted && !(width > static_cast<R>(kNarrowestForEdges<T, kClipped>))) {
                narrowest_.push_back(list[lane]);
            } else {
                in_double[lane] = 1;
            }
        }
        if (order_ <= 2) {
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
        HorizonArc<To> nowhere;
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
                rows[lane] = numbers(lists.arcs.add(static_cast<std::size_t>(which[lane])));
            }
            write_rows<R, To>(columns(lanes.edges[e], region), rows);
        }
        for (const HorizonLanes<R>& arc : lanes.horizon) {
            const auto exists = hn::IfThenElseZero(hn::Ne(get<R>(arc.angle), hn::Zero(d)), get<R>(chosen));
            hn::Store(to_integers(di, exists), di, which.data());
            for (std::size_t lane = 0; lane < kWidth; ++lane) {
                rows[lane] = numbers(which[lane] != 0 ? lists.add_horizon() : nowhere);
            }
            const std::array<const LaneValues<R>*, 8> from = {&arc.from_cosine, &arc.from_sine, &arc.to_cosine,
                                                              &arc.to_sine,     &arc.angle,     &arc.angle,
                                                              &arc.angle,       &region};
            write_rows<R, To>(from, rows);
        }
    }

    /// The numbers of an edge's arc; great circles do without cosine and sine.
    template <class R>
    static auto columns(const EdgeLanes<R>& edge, const LaneValues<R>& region) {
        const std::array<const LaneValues<R>*, 8> great = {&edge.axis_x,   &edge.axis_y,   &edge.axis_z,   &edge.half,
                                                           &edge.middle_x, &edge.middle_y, &edge.middle_z, &region};
        if constexpr (kBoosted) {
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
        Arc<To> piece{};
        const auto from = columns(edge, region);
        for (std::size_t c = 0; c < from.size(); ++c) {
            numbers(piece)[c] = static_cast<To>((*from[c])[lane]);
        }
        const auto half = static_cast<double>(piece.half);
        const double sine = kBoosted ? static_cast<double>(piece.sine) : 1;
        const double highest = order_ - 1;
        const double degree = kBoosted ? std::min(highest, highest * sine + 7) : highest - 1;
        const Division division = divided(degree * half, std::max(tolerance / (sine * half), kFinest));
        const Vec3d middle(piece.middle);
        const Vec3d across = glm::cross(Vec3d(piece.axis), middle);
        piece.half = static_cast<To>(half / division.pieces);
        for (int k = 0; k < division.pieces; ++k) {
            const double turn = half * ((2 * k + 1.0) / division.pieces - 1);
            piece.middle = Vec3<To>(std::cos(turn) * middle + std::sin(turn) * across);
            lists.arcs.add(static_cast<std::size_t>(division.points)) = piece;
        }
    }

    /// Double cannot resolve more than this.
    static constexpr double kFinest = 1e-20;

    double least_width_, looseness_;
    std::vector<std::uint32_t> whole_, cut_, narrow_whole_, narrow_cut_;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
