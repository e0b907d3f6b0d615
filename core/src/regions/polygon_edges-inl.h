// SPDX-License-Identifier: MIT
//
// Polygons in lanes: their vertices, scaled into the range of float, the side of their plane that is seen, and their
// edges with crosses and the points where the horizon cuts them, all in double. Included once per instruction set.
#if defined(SHLIGHT_KERNELS_POLYGON_EDGES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_POLYGON_EDGES_INL_H_
#undef SHLIGHT_KERNELS_POLYGON_EDGES_INL_H_
#else
#define SHLIGHT_KERNELS_POLYGON_EDGES_INL_H_
#endif

#include <hwy/aligned_allocator.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "regions/arc_lanes-inl.h"
#include "regions/polygon_kernels.h"
#include "regions/spherical_polygon.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// One number for each lane.
template <class R>
struct alignas(64) LaneValues : std::array<R, kLaneCount<Lanes<R>>> {};

template <class R>
HWY_INLINE V<Lanes<R>> get(const LaneValues<R>& values) {
    return hn::Load(Lanes<R>(), values.data());
}

template <class R>
HWY_INLINE void put(LaneValues<R>& values, V<Lanes<R>> v) {
    hn::Store(v, Lanes<R>(), values.data());
}

/// The vertices of a vector of polygons.
class VertexLanes {
    using D = Doubles;

  public:
    static constexpr std::size_t kWidth = kLaneCount<D>;

    explicit VertexLanes(const PolygonArray& polygons)
        : polygons_(polygons), vertices_(hwy::AllocateAligned<double>(3 * polygons.vertex_count * kWidth)) {}

    std::size_t count() const { return polygons_.vertex_count; }

    /// index: which polygon each lane takes. Scales those far from the range of float.
    HWY_INLINE void load(const std::uint32_t* index) {
        const D d;
        const std::size_t numbers = 3 * polygons_.vertex_count;
        RowPointers<const double> rows;
        for (std::size_t lane = 0; lane < kWidth; ++lane) {
            rows[lane] = polygons_.vertices + numbers * index[lane];
        }
        auto largest = hn::Zero(d);
        for (std::size_t i = 0; i < numbers; i += kSquare<D>) {
            const std::size_t column = std::min(i, numbers - kSquare<D>);
            const auto columns = load_columns(d, rows.data(), column);
            for (std::size_t j = 0; j < kSquare<D>; ++j) {
                largest = hn::Max(largest, hn::Abs(columns[j]));
                hn::StoreU(columns[j], d, vertices_.get() + (column + j) * kWidth);
            }
        }
        const auto usual = hn::And(hn::Gt(largest, all(d, 1e-6)), hn::Lt(largest, all(d, 1e6)));
        if (!hn::AllTrue(d, usual)) {
            rescale(hn::IfThenElse(usual, all(d, 1), power_of_two_scale(largest)));
        }
    }

    HWY_INLINE Vectors3<double> vertex(std::size_t i) const {
        const double* at = vertices_.get() + 3 * i * kWidth;
        return {hn::LoadU(D(), at), hn::LoadU(D(), at + kWidth), hn::LoadU(D(), at + 2 * kWidth)};
    }

    struct Facing {
        V<D> side;                ///< side of the polygon's plane with the origin, ±1; 0 if edge-on or without area
        Vectors3<double> normal;  ///< unit, to the polygon from the origin
    };
    HWY_INLINE Facing facing() const {
        const D d;
        const Vectors3<double> v0 = vertex(0);
        Vectors3<double> normal = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        Vectors3<double> sum = v0 + vertex(1);
        auto farthest = hn::Max(dot<double>(v0, v0), dot<double>(vertex(1), vertex(1)));
        Vectors3<double> before = vertex(1) - v0;
        for (std::size_t i = 2; i < polygons_.vertex_count; ++i) {
            const Vectors3<double> v = vertex(i);
            const Vectors3<double> after = v - v0;
            normal = normal + cross<double>(before, after);
            before = after;
            sum = sum + v;
            farthest = hn::Max(farthest, dot<double>(v, v));
        }
        const auto distance =
            hn::Mul(dot<double>(normal, sum), all(d, 1 / static_cast<double>(polygons_.vertex_count)));
        const auto least = hn::Mul(all(d, kEdgeOn * kEdgeOn), hn::Mul(farthest, dot<double>(normal, normal)));
        const auto square = hn::Mul(distance, distance);
        auto seen = hn::Gt(square, least);
        const auto rounded = hn::Mul(all(d, kRounded * kRounded), hn::Mul(farthest, dot<double>(normal, normal)));
        const auto level = hn::And(seen, hn::Lt(square, rounded));
        if (!hn::AllFalse(d, level)) {
            seen = hn::AndNot(hn::And(level, is_among_corners(normal)), seen);
        }
        const auto side = hn::IfThenElseZero(seen, hn::CopySign(all(d, 1), distance));
        const auto length = hn::Sqrt(hn::Max(dot<double>(normal, normal), all(d, std::numeric_limits<double>::min())));
        return {side, scaled<double>(normal, hn::Div(side, length))};
    }

  private:
    /// Whether corners lie on both sides of the plane through the origin with this normal.
    HWY_NOINLINE M<D> is_among_corners(const Vectors3<double>& normal) const {
        auto low = dot<double>(normal, vertex(0));
        auto high = low;
        for (std::size_t i = 1; i < polygons_.vertex_count; ++i) {
            const auto height = dot<double>(normal, vertex(i));
            low = hn::Min(low, height);
            high = hn::Max(high, height);
        }
        return hn::And(hn::Lt(low, hn::Zero(D())), hn::Gt(high, hn::Zero(D())));
    }
    /// Powers of two change no digit, and squares of tiny and huge coordinates stay in the range of float. A lane of a
    /// usual unit has the scale 1, since its own subnormal coordinates would lose digits.
    HWY_NOINLINE void rescale(V<D> scale) {
        for (std::size_t i = 0; i < 3 * polygons_.vertex_count; ++i) {
            double* v = vertices_.get() + i * kWidth;
            hn::StoreU(hn::Mul(hn::LoadU(D(), v), scale), D(), v);
        }
    }

    PolygonArray polygons_;
    hwy::AlignedFreeUniquePtr<double[]> vertices_;  // NOLINT(modernize-avoid-c-arrays): as Highway names it
};

/// One edge of each polygon of a vector, from vertex e to the next.
template <class R>
struct EdgeLanes {
    using Values = LaneValues<R>;

    Values x, y, z;                    ///< the vertex
    Values cross_x, cross_y, cross_z;  ///< vertex × next, towards the interior
    Values cut_x, cut_y;               ///< the point in which the edge meets the horizon
    Values share;                      ///< kept part of the edge, 0 … 1
    Values crossing;                   ///< 1: enters, -1: leaves the upper half, from vertex to next
    // The arc that is kept, as Arc; half is 0 if nothing is.
    Values axis_x, axis_y, axis_z, middle_x, middle_y, middle_z, cosine, sine, half;
};

/// One arc of each boundary that lies in the horizon, as HorizonArc; where a polygon has none, `angle` is 0.
template <class R>
struct HorizonLanes {
    LaneValues<R> from_cosine, from_sine, to_cosine, to_sine, angle;
};

/// A vector of polygons.
template <class R>
struct PolygonLanes {
    std::vector<EdgeLanes<R>> edges;
    std::vector<HorizonLanes<R>> horizon;
    LaneValues<R> side;                          ///< 1 or -1 by the winding, 0 if edge-on or without area
    LaneValues<R> normal_x, normal_y, normal_z;  ///< the plane's normal, away from the origin
};

/// Rounds lanes of doubles to lanes [offset, …) of R.
template <class R>
HWY_INLINE void put_rounded(LaneValues<R>& values, std::size_t offset, V<Doubles> v) {
    if constexpr (std::is_same_v<R, double>) {
        hn::Store(v, Doubles(), values.data() + offset);
    } else {
        const hn::Rebind<float, Doubles> d;
        hn::StoreU(hn::DemoteTo(d, v), d, values.data() + offset);
    }
}

/// a b - c d, right to two roundings however much of it cancels (Kahan).
HWY_INLINE V<Doubles> difference_of_products(V<Doubles> a, V<Doubles> b, V<Doubles> c, V<Doubles> d) {
    const auto ab = hn::Mul(a, b);
    const auto cd = hn::Mul(c, d);
    return hn::Add(hn::Sub(ab, cd), hn::Sub(product_error(a, b, ab), product_error(c, d, cd)));
}

/// a × b of which every component has all its digits, however close to the origin the line through a and b passes.
HWY_INLINE Vectors3<double> exact_cross(const Vectors3<double>& a, const Vectors3<double>& b) {
    return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
            difference_of_products(a.x, b.y, a.y, b.x)};
}

/// Fills the first part of EdgeLanes in double, whatever R is: crosses, cuts and orientation are differences of the
/// vertices. index: which polygon each lane has. T: what results are wanted in.
template <class R, class T>
class EdgePreparation {
    using D = Doubles;

  public:
    EdgePreparation(const PolygonArray& polygons, bool clip) : vertices_(polygons), clip_(clip) {}

    void prepare(const std::uint32_t* index, PolygonLanes<R>& lanes) {
        for (std::size_t offset = 0; offset < kLaneCount<Lanes<R>>; offset += kLaneCount<D>) {
            vertices_.load(index + offset);
            const auto [side, normal] = vertices_.facing();
            put_rounded<R>(lanes.side, offset, side);
            put_rounded<R>(lanes.normal_x, offset, normal.x);
            put_rounded<R>(lanes.normal_y, offset, normal.y);
            put_rounded<R>(lanes.normal_z, offset, normal.z);
            for (std::size_t e = 0; e < vertices_.count(); ++e) {
                fill(lanes.edges[e], offset, e, e + 1 < vertices_.count() ? e + 1 : 0, side);
            }
        }
    }

  private:
    HWY_INLINE void fill(EdgeLanes<R>& edge, std::size_t offset, std::size_t from, std::size_t to, V<D> side) const {
        const D d;
        const Vectors3<double> a = vertices_.vertex(from);
        const Vectors3<double> b = vertices_.vertex(to);
        Vectors3<double> c;
        if constexpr (std::is_same_v<T, double>) {
            c = exact_cross(a, b);
        } else {
            c = cross<double>(a, b - a);
        }
        put_rounded<R>(edge.x, offset, a.x);
        put_rounded<R>(edge.y, offset, a.y);
        put_rounded<R>(edge.z, offset, a.z);
        put_rounded<R>(edge.cross_x, offset, hn::Mul(c.x, side));
        put_rounded<R>(edge.cross_y, offset, hn::Mul(c.y, side));
        put_rounded<R>(edge.cross_z, offset, hn::Mul(c.z, side));
        if (!clip_) {
            return;
        }
        const auto zero = hn::Zero(d);
        const auto one = all(d, 1);
        const auto above_a = hn::Ge(a.z, zero);
        const auto above_b = hn::Ge(b.z, zero);
        const auto cuts = hn::Xor(above_a, above_b);
        // The cut is (a.z b - b.z a) / (a.z - b.z), a point in the horizon at right angles to the pole.
        const auto over = hn::IfThenElseZero(cuts, hn::Div(one, hn::Sub(a.z, b.z)));
        put_rounded<R>(edge.cut_x, offset, hn::Mul(c.y, over));
        put_rounded<R>(edge.cut_y, offset, hn::Neg(hn::Mul(c.x, over)));
        const auto part = hn::Mul(over, hn::IfThenElse(above_a, a.z, hn::Neg(b.z)));
        put_rounded<R>(edge.share, offset, hn::IfThenElse(cuts, part, hn::IfThenElseZero(above_a, one)));
        const auto crossing = hn::IfThenElseZero(cuts, hn::IfThenElse(above_b, one, hn::Neg(one)));
        put_rounded<R>(edge.crossing, offset, crossing);
    }

    VertexLanes vertices_;
    bool clip_;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
