// SPDX-License-Identifier: MIT
//
// Polygons in lanes: boosted, measured, and taken apart into arcs (docs/theory.md, 4.4 to 4.7). Included once per
// instruction set.
#if defined(SHLIGHT_KERNELS_CLIPPED_EDGES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_CLIPPED_EDGES_INL_H_
#undef SHLIGHT_KERNELS_CLIPPED_EDGES_INL_H_
#else
#define SHLIGHT_KERNELS_CLIPPED_EDGES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <type_traits>
#include <vector>

#include "regions/arc_lanes-inl.h"
#include "regions/arcs.h"
#include "regions/polygon_edges-inl.h"
#include "simd/lanes-inl.h"
#include "simd/lobe_arrays.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Measures of a region in each lane.
template <class R>
struct RegionLanes {
    V<Lanes<R>> solid_angle, perimeter;
    Vectors3<R> first_moment;  ///< ∫ u du
};

/// The edges of a vector of polygons above the horizon. kClipped: some edges cross the horizon; kBoosted: the result is
/// the boosts' images.
template <class R, bool kClipped, bool kBoosted>
class ClippedEdges {
    using D = Lanes<R>;
    static_assert(!kBoosted || std::is_same_v<R, double>);

  public:
    ClippedEdges(PolygonLanes<R>& lanes, const BoostLanes* boost) : lanes_(lanes), boost_(boost) {}

    HWY_INLINE RegionLanes<R> region() {
        const D d;
        const auto zero = hn::Zero(d);
        RegionLanes<R> region = {zero, zero, {zero, zero, zero}};
        const End first = end(lanes_.edges.front());
        reference_ = {get<R>(lanes_.normal_x), get<R>(lanes_.normal_y), get<R>(lanes_.normal_z)};
        re_ = all(d, 1);
        im_ = zero;
        End from = first;
        const std::size_t count = lanes_.edges.size();
        for (std::size_t e = 0; e < count; ++e) {
            const End to = e + 1 < count ? end(lanes_.edges[e + 1]) : first;
            add_edge(lanes_.edges[e], from, to, region);
            from = to;
            if (e % 16 == 15) {
                const auto scale = hn::Div(all(d, 1), hn::Add(hn::Abs(re_), hn::Abs(im_)));
                re_ = hn::Mul(re_, scale);
                im_ = hn::Mul(im_, scale);
            }
        }
        if constexpr (kClipped) {
            add_horizon(region);
        }
        // Half of what a region of at most half the sphere has: 0 … π.
        auto half = arctangent(d, im_, re_);
        half = hn::Add(half, hn::IfThenElseZero(hn::Lt(half, all(d, -1)), all(d, 2 * std::numbers::pi)));
        region.solid_angle = hn::MulAdd(all(d, 2), half, region.solid_angle);
        return region;
    }

  private:
    /// An end of an edge: its direction, and 1 ÷ its distance in the polygon.
    struct End {
        Vectors3<R> u;
        V<D> inverse;
    };
    static HWY_INLINE V<D> inverse_root(V<D> square) {
        const D d;
        return hn::IfThenElseZero(hn::Gt(square, hn::Zero(d)), hn::Div(all(d, 1), hn::Sqrt(square)));
    }
    static HWY_INLINE End direction(const Vectors3<R>& v) {
        const auto inverse = inverse_root(dot<R>(v, v));
        return {scaled<R>(v, inverse), inverse};
    }
    static HWY_INLINE End end(const EdgeLanes<R>& edge) {
        return direction({get<R>(edge.x), get<R>(edge.y), get<R>(edge.z)});
    }
    static HWY_INLINE End cut(const EdgeLanes<R>& edge) {
        return direction({get<R>(edge.cut_x), get<R>(edge.cut_y), hn::Zero(D())});
    }
    static HWY_INLINE Vectors3<R> select(M<D> which, const Vectors3<R>& yes, const Vectors3<R>& no) {
        return {hn::IfThenElse(which, yes.x, no.x), hn::IfThenElse(which, yes.y, no.y),
                hn::IfThenElse(which, yes.z, no.z)};
    }
    static HWY_INLINE End select(M<D> which, const End& yes, const End& no) {
        return {select(which, yes.u, no.u), hn::IfThenElse(which, yes.inverse, no.inverse)};
    }

    /// The point at which a boundary leaves (way = -1) or enters (1) the upper half for the time that `number` tells.
    HWY_INLINE Vectors3<R> crossing(int way, V<D> number) const {
        const D d;
        Vectors3<R> found = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        auto passed = hn::Zero(d);
        for (const EdgeLanes<R>& edge : lanes_.edges) {
            const auto crosses = hn::Eq(get<R>(edge.crossing), all(d, way));
            const auto is_it = hn::And(crosses, hn::Eq(passed, number));
            found.x = hn::IfThenElse(is_it, get<R>(edge.cut_x), found.x);
            found.y = hn::IfThenElse(is_it, get<R>(edge.cut_y), found.y);
            passed = hn::Add(passed, hn::IfThenElseZero(crosses, all(d, 1)));
        }
        return direction(found).u;
    }

    /// Let M be the middle, N the pole and h half the length: the triangle from a reference R to both ends has the
    /// solid angle 2 arg (cos h + R·M + i sin h R·N): Van Oosterom & Strackee 1983, divided by 2 cos h, which vanishes
    /// where the ends are opposite. R is the plane's normal: all of the polygon is less than a quarter turn away from
    /// it, so no end is opposite to it, and of an edge of nearly half a turn M or N is near it.
    HWY_INLINE void add_triangle(M<D> exists, const Vectors3<R>& middle, const Vectors3<R>& pole, V<D> sine,
                                 V<D> cosine) {
        const D d;
        const auto re = hn::IfThenElse(exists, hn::Add(cosine, dot<R>(reference_, middle)), all(d, 1));
        const auto im = hn::IfThenElseZero(exists, hn::Mul(sine, dot<R>(reference_, pole)));
        const auto next = hn::MulSub(re_, re, hn::Mul(im_, im));
        im_ = hn::MulAdd(re_, im, hn::Mul(im_, re));
        re_ = next;
    }

    HWY_INLINE void add_edge(EdgeLanes<R>& edge, End a, End b, RegionLanes<R>& region) {
        const D d;
        const auto zero = hn::Zero(d);
        const auto one = all(d, 1);
        const Vectors3<R> c = {get<R>(edge.cross_x), get<R>(edge.cross_y), get<R>(edge.cross_z)};
        const auto square = dot<R>(c, c);
        const auto length = hn::Sqrt(square);
        const Vectors3<R> pole = scaled<R>(c, hn::IfThenElseZero(hn::Gt(length, zero), hn::Div(one, length)));
        auto sine_of_whole = length;
        if constexpr (kClipped) {
            const auto crossing = get<R>(edge.crossing);
            const End at = cut(edge);
            a = select(hn::Gt(crossing, zero), at, a);
            b = select(hn::Lt(crossing, zero), at, b);
            sine_of_whole = hn::Mul(length, get<R>(edge.share));
        }
        sine_of_whole = hn::Mul(sine_of_whole, hn::Mul(a.inverse, b.inverse));
        const auto kept = hn::Gt(sine_of_whole, zero);
        const auto cosine_of_whole = dot<R>(a.u, b.u);
        // Half the length by its larger part; the middle by the ends' sum, or across their difference if that is
        // longer.
        const auto larger = hn::Sqrt(hn::Mul(all(d, 0.5), hn::Add(one, hn::Abs(cosine_of_whole))));
        const auto over = hn::Div(all(d, 0.5), larger);
        const auto smaller = hn::Mul(sine_of_whole, over);
        const auto is_long = hn::Lt(cosine_of_whole, zero);
        const auto sine = hn::IfThenElse(is_long, larger, smaller);
        const auto cosine = hn::IfThenElse(is_long, smaller, larger);
        Vectors3<R> middle = a.u + b.u;
        if (!hn::AllFalse(d, is_long)) {
            middle = select(is_long, sided(cross<R>(b.u - a.u, pole)), middle);
        }
        middle = scaled<R>(middle, over);
        add_triangle(kept, middle, pole, sine, cosine);
        if constexpr (kBoosted) {
            add_image(edge, pole, middle, sine, cosine, kept, region);
        } else {
            const auto half = hn::IfThenElseZero(kept, arctangent(d, sine, cosine));
            put_arc(edge, pole, middle, half);
            region.first_moment = region.first_moment + scaled<R>(pole, half);
            region.perimeter = hn::MulAdd(all(d, 2), half, region.perimeter);
        }
    }

    /// The pole points to the interior; a polygon wound the other way runs through its edges backwards.
    HWY_INLINE Vectors3<R> sided(const Vectors3<R>& v) const { return scaled<R>(v, get<R>(lanes_.side)); }

    static HWY_INLINE void put_arc(EdgeLanes<R>& edge, const Vectors3<R>& axis, const Vectors3<R>& middle, V<D> half) {
        put<R>(edge.axis_x, axis.x);
        put<R>(edge.axis_y, axis.y);
        put<R>(edge.axis_z, axis.z);
        put<R>(edge.middle_x, middle.x);
        put<R>(edge.middle_y, middle.y);
        put<R>(edge.middle_z, middle.z);
        put<R>(edge.half, half);
    }

    /// The image of an edge, whose circle meets the one that has the edge as its diameter at right angles, before the
    /// boost and after it: both axes and the arc's middle lie on one great circle, and an end of the arc makes a right
    /// triangle with the two axes.
    HWY_INLINE void add_image(EdgeLanes<R>& edge, const Vectors3<R>& pole, const Vectors3<R>& middle, V<D> sine,
                              V<D> cosine, M<D> kept, RegionLanes<R>& region) {
        const D d;
        const auto one = all(d, 1);
        const BoostLanes::Image arc = boost_->image(pole, one);
        const auto one_minus_cos = hn::Div(hn::Mul(sine, sine), hn::Add(one, cosine));
        const BoostLanes::Image diameter = boost_->image(middle, one_minus_cos);
        const auto arc_sine = arc.sine_ratio;
        const auto rise = hn::Mul(sine, diameter.sine_ratio);
        const auto run = hn::Mul(arc_sine, diameter.cosine);
        const auto half = hn::IfThenElseZero(kept, arctangent(d, rise, run));
        const Vectors3<R> across = diameter.axis - scaled<R>(arc.axis, hn::Mul(arc.cosine, diameter.cosine));
        const Vectors3<R> image_middle = direction(across).u;
        put_arc(edge, arc.axis, image_middle, half);
        put<R>(edge.cosine, arc.cosine);
        put<R>(edge.sine, arc_sine);
        // Gauss–Bonnet before and after: the boost keeps the angles at the corners, so only the arcs' turning differs.
        const auto twice = hn::Add(half, half);
        const auto turning = hn::IfThenElseZero(kept, hn::Mul(arc.cosine, twice));
        region.solid_angle = hn::Sub(region.solid_angle, turning);
        region.perimeter = hn::Add(region.perimeter, hn::IfThenElseZero(kept, hn::Mul(arc_sine, twice)));
        const auto sine_of_half = hn::Mul(rise, inverse_root(hn::MulAdd(rise, rise, hn::Mul(run, run))));
        const auto along = hn::IfThenElseZero(kept, hn::Mul(hn::Mul(arc_sine, arc_sine), half));
        const auto radial = hn::IfThenElseZero(kept, hn::Mul(hn::Mul(arc_sine, arc.cosine), sine_of_half));
        region.first_moment = region.first_moment + scaled<R>(arc.axis, along) - scaled<R>(image_middle, radial);
    }

    /// The arcs of the horizon between the crossings, any that leaves with any that enters: only the sum over all
    /// counts. The crossings of a planar polygon lie on one line, so they are less than half a turn from each other.
    HWY_INLINE void add_horizon(RegionLanes<R>& region) {
        const D d;
        const auto side = get<R>(lanes_.side);
        auto most = hn::Zero(d);
        for (const EdgeLanes<R>& edge : lanes_.edges) {
            most = hn::Add(most, hn::Max(hn::Zero(d), get<R>(edge.crossing)));
        }
        lanes_.horizon.clear();
        for (auto number = hn::Zero(d); !hn::AllFalse(d, hn::Lt(number, most)); number = hn::Add(number, all(d, 1))) {
            const auto exists = hn::Lt(number, most);
            const Vectors3<R> leaving = crossing(-1, number);
            const Vectors3<R> entering = crossing(1, number);
            const auto backwards = hn::Lt(side, hn::Zero(d));
            add_horizon_arc(exists, select(backwards, entering, leaving), select(backwards, leaving, entering), region);
        }
    }

    HWY_INLINE void add_horizon_arc(M<D> exists, const Vectors3<R>& from, const Vectors3<R>& to,
                                    RegionLanes<R>& region) {
        const D d;
        lanes_.horizon.emplace_back();
        HorizonLanes<R>& out = lanes_.horizon.back();
        const auto sine = hn::MulSub(from.x, to.y, hn::Mul(from.y, to.x));
        const auto cosine = hn::MulAdd(from.x, to.x, hn::Mul(from.y, to.y));
        const auto half = all(d, 0.5);
        const SineCosine<R> turn = halved(sine, cosine);
        const auto zero = hn::Zero(d);
        const Vectors3<R> middle = {hn::MulSub(from.x, turn.cosine, hn::Mul(from.y, turn.sine)),
                                    hn::MulAdd(from.y, turn.cosine, hn::Mul(from.x, turn.sine)), zero};
        add_triangle(exists, middle, {zero, zero, all(d, 1)}, turn.sine, turn.cosine);
        if constexpr (kBoosted) {
            const auto angle = hn::IfThenElseZero(exists, boosted_angle(from, turn));
            const Vectors3<R> boosted_from = boosted(from);
            const Vectors3<R> boosted_to = boosted(to);
            put_horizon(out, boosted_from, boosted_to, angle);
            region.solid_angle = hn::NegMulAdd(boost_->horizon_height, angle, region.solid_angle);
            region.perimeter = hn::MulAdd(boost_->horizon_sine, angle, region.perimeter);
            const auto slant =
                hn::IfThenElseZero(exists, hn::Mul(half, hn::Mul(boost_->horizon_height, boost_->horizon_sine)));
            const Vectors3<R> step = boosted_to - boosted_from;
            region.first_moment.x = hn::NegMulAdd(slant, step.y, region.first_moment.x);
            region.first_moment.y = hn::MulAdd(slant, step.x, region.first_moment.y);
            region.first_moment.z = hn::MulAdd(hn::Mul(half, hn::Mul(boost_->horizon_sine, boost_->horizon_sine)),
                                               angle, region.first_moment.z);
        } else {
            const auto angle = hn::IfThenElseZero(exists, arctangent(d, sine, cosine));
            put_horizon(out, from, to, angle);
            region.perimeter = hn::Add(region.perimeter, angle);
            region.first_moment.z = hn::MulAdd(half, angle, region.first_moment.z);
        }
    }

    static HWY_INLINE void put_horizon(HorizonLanes<R>& out, const Vectors3<R>& from, const Vectors3<R>& to,
                                       V<D> angle) {
        put<R>(out.from_cosine, from.x);
        put<R>(out.from_sine, from.y);
        put<R>(out.to_cosine, to.x);
        put<R>(out.to_sine, to.y);
        put<R>(out.angle, angle);
    }

    /// Along the horizon a boost is an aberration itself: tan(φ'/2) = √((1-β)/(1+β)) tan(φ/2), β = speed · sin tilt.
    HWY_INLINE V<D> aberration() const { return hn::Mul(boost_->speed, boost_->sin_tilt); }
    HWY_INLINE V<D> contraction() const {
        const auto one = all(D(), 1);
        return hn::Sqrt(hn::Mul(hn::Sub(one, aberration()), hn::Add(one, aberration())));
    }
    /// Cosine and sine of half an angle in -π … π.
    static HWY_INLINE SineCosine<R> halved(V<D> sine, V<D> cosine) {
        const D d;
        const auto half = all(d, 0.5);
        const auto larger = hn::Sqrt(hn::Mul(half, hn::Add(all(d, 1), hn::Abs(cosine))));
        const auto smaller = hn::Div(hn::Mul(half, hn::Abs(sine)), larger);
        const auto wide = hn::Lt(cosine, hn::Zero(d));
        return {hn::CopySign(hn::IfThenElse(wide, larger, smaller), sine), hn::IfThenElse(wide, smaller, larger)};
    }
    HWY_INLINE Vectors3<R> boosted(const Vectors3<R>& u) const {
        const D d;
        const auto over = hn::Div(all(d, 1), hn::MulAdd(aberration(), u.x, all(d, 1)));
        return {hn::Mul(hn::Add(u.x, aberration()), over), hn::Mul(hn::Mul(contraction(), u.y), over), hn::Zero(d)};
    }
    /// Angle of the image of the arc that begins at `from`. turn: half of the arc's angle, which is less than half a
    /// turn.
    HWY_INLINE V<D> boosted_angle(const Vectors3<R>& from, const SineCosine<R>& turn) const {
        const D d;
        const SineCosine<R> start = halved(from.y, from.x);
        const auto end_cosine = hn::MulSub(start.cosine, turn.cosine, hn::Mul(start.sine, turn.sine));
        const auto end_sine = hn::MulAdd(start.sine, turn.cosine, hn::Mul(start.cosine, turn.sine));
        const auto narrowing = hn::Div(contraction(), hn::Add(all(d, 1), aberration()));
        const auto before = arctangent(d, hn::Mul(narrowing, start.sine), start.cosine);
        const auto after = arctangent(d, hn::Mul(narrowing, end_sine), end_cosine);
        return hn::Mul(all(d, 2), hn::Sub(after, before));
    }

    PolygonLanes<R>& lanes_;
    const BoostLanes* boost_;
    Vectors3<R> reference_;
    V<D> re_, im_;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
