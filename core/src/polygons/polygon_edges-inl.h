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

#include "polygons/arc_points-inl.h"
#include "polygons/polygon_array.h"
#include "polygons/polygon_vertices-inl.h"
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

/// One arc of each outline that lies in the horizon, as HorizonRow; where a polygon has none, `angle` is 0.
template <class R>
struct HorizonLanes {
    LaneValues<R> from_cosine, from_sine, to_cosine, to_sine, angle;
};

/// A vector of polygons.
template <class R>
struct PolygonLanes {
    std::vector<EdgeLanes<R>> edges;
    std::vector<HorizonLanes<R>> horizon;
    LaneValues<R> side;  ///< 1 or -1 by the winding, 0 if edge-on or without area
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

/// Fills the first part of EdgeLanes in double, whatever R is: crosses, cuts and orientation are differences of the
/// vertices. index: which polygon each lane has.
template <class R>
class EdgePreparation {
    using D = Doubles;

  public:
    EdgePreparation(const PolygonArray& polygons, bool clip) : vertices_(polygons), clip_(clip) {}

    void prepare(const std::uint32_t* index, PolygonLanes<R>& lanes) {
        for (std::size_t offset = 0; offset < kLaneCount<Lanes<R>>; offset += kLaneCount<D>) {
            vertices_.load(index + offset);
            const V<D> side = vertices_.side();
            put_rounded<R>(lanes.side, offset, side);
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
        const Vectors3<double> c = cross<double>(a, b - a);
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
        const auto t = hn::IfThenElseZero(cuts, hn::Div(a.z, hn::Sub(a.z, b.z)));
        put_rounded<R>(edge.cut_x, offset, hn::MulAdd(t, hn::Sub(b.x, a.x), a.x));
        put_rounded<R>(edge.cut_y, offset, hn::MulAdd(t, hn::Sub(b.y, a.y), a.y));
        const auto kept_whole = hn::IfThenElseZero(above_a, one);
        put_rounded<R>(edge.share, offset,
                       hn::IfThenElse(cuts, hn::IfThenElse(above_a, t, hn::Sub(one, t)), kept_whole));
        const auto crossing = hn::IfThenElseZero(cuts, hn::IfThenElse(above_b, one, hn::Neg(one)));
        put_rounded<R>(edge.crossing, offset, crossing);
    }

    VertexLanes vertices_;
    bool clip_;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
