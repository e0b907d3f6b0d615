// SPDX-License-Identifier: MIT
//
// The edges of polygons in lanes, with their crosses and where the horizon cuts them, prepared in double. Included once
// per instruction set.
#if defined(SHLIGHT_KERNELS_POLYGON_EDGES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_POLYGON_EDGES_INL_H_
#undef SHLIGHT_KERNELS_POLYGON_EDGES_INL_H_
#else
#define SHLIGHT_KERNELS_POLYGON_EDGES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "regions/arc_points-inl.h"
#include "regions/polygon_array.h"
#include "regions/polygon_vertices-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// What a vector of polygons has at one edge, from vertex e to the next.
template <class R>
struct EdgeLanes {
    using Values = LaneValues<R>;

    Values x, y, z;                    ///< the vertex
    Values cross_x, cross_y, cross_z;  ///< vertex × next, towards the interior
    Values cut_x, cut_y;               ///< where the edge meets the horizon
    Values share;                      ///< of the edge that is kept
    Values crossing;                   ///< 1: enters, -1: leaves the upper half, from vertex to next
    // The arc that is kept, as ArcRow; half is 0 if nothing is.
    Values axis_x, axis_y, axis_z, middle_x, middle_y, middle_z, cosine, sine, half;
};

/// One arc of each boundary that lies in the horizon, as HorizonRow; where a polygon has none, `angle` is 0.
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
    LaneValues<R> normal_x, normal_y, normal_z;  ///< of the plane, away from the origin
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

/// What is missing of a product that was rounded.
HWY_INLINE V<Doubles> product_error(V<Doubles> a, V<Doubles> b, V<Doubles> product) {
#if HWY_NATIVE_FMA
    return hn::MulSub(a, b, product);
#else
    const Doubles d;  // Dekker 1971: the products of halves of the digits are exact
    const auto upper = [&](V<Doubles> x) HWY_ATTR {
        const auto shifted = hn::Mul(x, all(d, 134217729));
        return hn::Sub(shifted, hn::Sub(shifted, x));
    };
    const auto a1 = upper(a);
    const auto b1 = upper(b);
    const auto a2 = hn::Sub(a, a1);
    const auto b2 = hn::Sub(b, b1);
    const auto rest = hn::Add(hn::Sub(hn::Mul(a1, b1), product), hn::Add(hn::Mul(a1, b2), hn::Mul(a2, b1)));
    return hn::Add(rest, hn::Mul(a2, b2));
#endif
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
