// SPDX-License-Identifier: MIT
#include "lighting/polygon_rule_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lighting/polygon_rule_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <vector>

#include "lobes/lobe_lanes-inl.h"
#include "math/triangle_cubature.h"
#include "regions/spherical_polygon.h"
#include "simd/gather-inl.h"
#include "simd/lanes-inl.h"

#ifndef SHLIGHT_KERNELS_POLYGON_RULE
#define SHLIGHT_KERNELS_POLYGON_RULE
namespace shlight {

inline std::span<const TrianglePoint> polygon_rule(int number) {
    return number == 1 ? three_point_rule() : number == 2 ? seven_point_rule() : product_rule(number + 1);
}

inline constexpr std::size_t kMostTrianglePoints = 25;

}  // namespace shlight
#endif

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

struct Direction {
    V<Doubles> x, y, z;
};

HWY_INLINE V<Doubles> dot(const Direction& a, const Direction& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_INLINE Direction scaled(const Direction& a, V<Doubles> factor) {
    return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}

HWY_INLINE Direction difference(const Direction& a, const Direction& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

/// a + t b
HWY_INLINE Direction sum(const Direction& a, V<Doubles> t, const Direction& b) {
    return {hn::MulAdd(t, b.x, a.x), hn::MulAdd(t, b.y, a.y), hn::MulAdd(t, b.z, a.z)};
}

HWY_INLINE V<Doubles> triple_product(const Direction& a, const Direction& b, const Direction& c) {
    const Direction cross = {hn::NegMulAdd(b.z, c.y, hn::Mul(b.y, c.z)), hn::NegMulAdd(b.x, c.z, hn::Mul(b.z, c.x)),
                             hn::NegMulAdd(b.y, c.x, hn::Mul(b.x, c.y))};
    return dot(a, cross);
}

HWY_INLINE V<Doubles> inverse_length(const Direction& a) {
    return hn::Div(hn::Set(Doubles(), 1.0), hn::Sqrt(dot(a, a)));
}

constexpr std::size_t kPolygons = kLaneCount<Floats>;
using PolygonLanes = std::array<double, kPolygons>;

/// A group of polygons above the horizon, one for each lane of Floats, and a rule's points on one of their triangles.
/// Points are computed in double, in two vectors.
class PolygonGroup {
  public:
    /// Points as a lobe in lanes takes them: directions added to the view, their cosines, and shares of the solid
    /// angle.
    struct Points {
        alignas(64) std::array<std::array<float, kPolygons>, kMostTrianglePoints> x, y, z, cosine, weight;
    };

    void assign(std::span<const Vec3d> vertices, std::size_t vertex_count, std::span<const std::uint32_t> polygon_of) {
        corner_count_ = vertex_count;
        std::array<std::span<const Vec3d>, kPolygons> polygons;
        for (std::size_t lane = 0; lane < kPolygons; ++lane) {
            const std::size_t polygon = polygon_of[std::min(lane, polygon_of.size() - 1)];
            polygons[lane] = vertices.subspan(polygon * vertex_count, vertex_count);
            if (std::any_of(polygons[lane].begin(), polygons[lane].end(), [](const Vec3d& v) { return v.z < 0; })) {
                kept_[lane] = clipped_by_horizon(polygons[lane]);
                polygons[lane] = kept_[lane];
                corner_count_ = std::max(corner_count_, kept_[lane].size());
            }
        }
        corners_.resize(corner_count_);
        for (std::size_t i = 0; i < corner_count_; ++i) {
            for (std::size_t lane = 0; lane < kPolygons; ++lane) {
                // A repeated vertex makes a triangle without area.
                const std::span<const Vec3d> own = polygons[lane];
                const Vec3d v = own.empty() ? Vec3d(0, 0, 1) : own[std::min(i, own.size() - 1)];
                corners_[i].x[lane] = v.x;
                corners_[i].y[lane] = v.y;
                corners_[i].z[lane] = v.z;
            }
        }
        measure();
    }

    std::size_t triangle_count() const { return corner_count_ - 2; }
    V<Floats> solid_angle() const { return hn::Abs(Contiguous(0).load(solid_angle_.data())); }

    /// Places the points of a triangle, projected as in visit_triangle(). view_x, view_z: ω_o.
    HWY_INLINE void place(std::size_t triangle, std::span<const TrianglePoint> rule, const DoublePair& view_x,
                          const DoublePair& view_z, Points& points) const {
        place(triangle, rule, 0, view_x.low, view_z.low, points);
        place(triangle, rule, kLaneCount<Doubles>, view_x.high, view_z.high, points);
    }

  private:
    /// A vertex of each polygon; and, once measured, the triple product of unit vectors to it, to the next and to the
    /// first one.
    struct Corner {
        alignas(64) PolygonLanes x, y, z, triple;
    };

    HWY_INLINE static V<Doubles> load(const PolygonLanes& values, std::size_t lane) {
        return hn::Load(Doubles(), values.data() + lane);
    }
    HWY_INLINE static Direction vertex(const Corner& corner, std::size_t lane) {
        return {load(corner.x, lane), load(corner.y, lane), load(corner.z, lane)};
    }

    void measure() {
        for (std::size_t lane = 0; lane < kPolygons; lane += kLaneCount<Doubles>) {
            measure(lane);
        }
    }

    /// Solid angles (Van Oosterom & Strackee 1983), and vertices to unit vectors. Triple products are taken of edges
    /// between the vertices as given, as the digits of a small triangle are lost in unit vectors. No side is near half
    /// a turn, where more would be lost: such polygons are not small.
    HWY_INLINE void measure(std::size_t lane) {
        const Doubles d;
        const Direction first = vertex(corners_[0], lane);
        const auto over_first = inverse_length(first);
        const Direction a = scaled(first, over_first);
        auto solid_angle = hn::Zero(d);
        Direction b = vertex(corners_[1], lane);
        auto over_b = inverse_length(b);
        for (std::size_t i = 1; i + 1 < corner_count_; ++i) {
            const Direction c = vertex(corners_[i + 1], lane);
            const auto over_c = inverse_length(c);
            const auto triple =
                triple_product(a, scaled(difference(b, first), over_b), scaled(difference(c, first), over_c));
            const Direction unit_b = scaled(b, over_b);
            const Direction unit_c = scaled(c, over_c);
            const auto cosines = hn::Add(dot(a, unit_b), hn::Add(dot(unit_b, unit_c), dot(unit_c, a)));
            const auto half = arctangent(d, triple, hn::Add(hn::Set(d, 1.0), cosines));
            solid_angle = hn::Add(solid_angle, hn::Add(half, half));
            hn::Store(triple, d, corners_[i].triple.data() + lane);
            store(unit_b, lane, corners_[i]);
            b = c;
            over_b = over_c;
        }
        store(a, lane, corners_[0]);
        store(scaled(b, over_b), lane, corners_[corner_count_ - 1]);
        hn::Store(solid_angle, d, solid_angle_.data() + lane);
    }

    HWY_INLINE static void store(const Direction& direction, std::size_t lane, Corner& corner) {
        const Doubles d;
        hn::Store(direction.x, d, corner.x.data() + lane);
        hn::Store(direction.y, d, corner.y.data() + lane);
        hn::Store(direction.z, d, corner.z.data() + lane);
    }

    HWY_INLINE void place(std::size_t triangle, std::span<const TrianglePoint> rule, std::size_t lane,
                          V<Doubles> view_x, V<Doubles> view_z, Points& points) const {
        const Doubles d;
        const HalfFloats half;
        const Direction a = vertex(corners_[0], lane);
        const Direction b = vertex(corners_[triangle + 1], lane);
        const Direction c = vertex(corners_[triangle + 2], lane);
        const auto one = hn::Set(d, 1.0);
        const Direction middle = sum(sum(a, one, b), one, c);
        const Direction axis = scaled(middle, inverse_length(middle));
        const auto a_along = dot(a, axis);
        const auto b_along = dot(b, axis);
        const auto c_along = dot(c, axis);
        const Direction corner = scaled(a, hn::Div(one, a_along));
        const Direction ab = difference(scaled(b, hn::Div(one, b_along)), corner);
        const Direction ac = difference(scaled(c, hn::Div(one, c_along)), corner);
        const auto solid_angle = load(solid_angle_, lane);
        const auto divisor = hn::Mul(hn::Mul(hn::Add(a_along, a_along), hn::Mul(b_along, c_along)), solid_angle);
        const auto area = hn::IfThenElseZero(hn::Ne(solid_angle, hn::Zero(d)),
                                             hn::Div(load(corners_[triangle + 1].triple, lane), divisor));
        for (std::size_t i = 0; i < rule.size(); ++i) {
            const Direction p = sum(sum(corner, hn::Set(d, rule[i].first), ab), hn::Set(d, rule[i].second), ac);
            const auto inverse = inverse_length(p);
            const Direction direction = scaled(p, inverse);
            const auto cube = hn::Mul(hn::Mul(inverse, inverse), inverse);
            const auto weight = hn::Mul(hn::Mul(hn::Set(d, rule[i].weight), area), cube);
            hn::Store(hn::DemoteTo(half, hn::Add(direction.x, view_x)), half, points.x[i].data() + lane);
            hn::Store(hn::DemoteTo(half, direction.y), half, points.y[i].data() + lane);
            hn::Store(hn::DemoteTo(half, hn::Add(direction.z, view_z)), half, points.z[i].data() + lane);
            hn::Store(hn::DemoteTo(half, direction.z), half, points.cosine[i].data() + lane);
            hn::Store(hn::DemoteTo(half, weight), half, points.weight[i].data() + lane);
        }
    }

    std::size_t corner_count_ = 3;
    std::vector<Corner> corners_;
    alignas(64) PolygonLanes solid_angle_;  // signed by the winding
    std::array<std::vector<Vec3d>, kPolygons> kept_;
};

/// f·cos integrated over a group, divided by the sum of the rule's weights, which are approximate.
template <class Lobe>
HWY_INLINE V<Floats> integral(const Lobe& lobe, const PolygonGroup& group, std::span<const TrianglePoint> rule,
                              const DoublePair& view_x, const DoublePair& view_z, V<Floats> width) {
    const Floats d;
    const auto cos_o = rounded(view_z);
    const auto view = lobe.view(d, cos_o, width);
    PolygonGroup::Points points;  // all are written before they are read
    auto values = hn::Zero(d);
    auto weights = hn::Zero(d);
    for (std::size_t triangle = 0; triangle < group.triangle_count(); ++triangle) {
        group.place(triangle, rule, view_x, view_z, points);
        for (std::size_t i = 0; i < rule.size(); ++i) {
            const HalfSum half = {hn::Load(d, points.x[i].data()), hn::Load(d, points.y[i].data()),
                                  hn::Load(d, points.z[i].data())};
            const auto cos_i = hn::Load(d, points.cosine[i].data());
            const auto weight = hn::Load(d, points.weight[i].data());
            const auto above = hn::Gt(hn::Min(cos_i, cos_o), hn::Zero(d));
            values = hn::MulAdd(weight, hn::IfThenElseZero(above, lobe.value(half, cos_i, view)), values);
            weights = hn::Add(weights, weight);
        }
    }
    const auto mean = hn::IfThenElseZero(hn::Gt(weights, hn::Zero(d)), hn::Div(values, weights));
    return hn::Mul(group.solid_angle(), mean);
}

template <class Views, class Lobe>
void integrate(const Lobe& lobe, const float* parameters, std::span<const Vec3d> vertices, int vertex_count,
               std::span<const std::uint32_t> polygon_of, const ViewArrays& views,
               std::span<const std::uint32_t> view_of, int rule, std::span<float> values) {
    const Floats d;
    PolygonGroup group;
    for (std::size_t i = 0; i < values.size(); i += kPolygons) {
        const std::size_t count = std::min(kPolygons, values.size() - i);
        group.assign(vertices, static_cast<std::size_t>(vertex_count), polygon_of.subspan(i, count));
        const Views view(view_of.data() + i, count);
        const auto value =
            integral(lobe, group, polygon_rule(rule), view.pair(views.x), view.pair(views.z), view.load(parameters));
        store_some(d, value, count, values.data() + i);
    }
}

void integrate_polygons_in_lanes(const LobeShape& shape, const float* parameters, std::span<const Vec3d> vertices,
                                 int vertex_count, std::span<const std::uint32_t> polygon_of, const ViewArrays& views,
                                 std::span<const std::uint32_t> view_of, int rule, std::span<float> values) {
    with_lobe_lanes(shape, [&](const auto& lobe) {
        if (views.shared) {
            integrate<Broadcast>(lobe, parameters, vertices, vertex_count, polygon_of, views, view_of, rule, values);
        } else {
            integrate<Gather>(lobe, parameters, vertices, vertex_count, polygon_of, views, view_of, rule, values);
        }
    });
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(integrate_polygons_in_lanes);

void integrate_polygons(const LobeShape& shape, const float* parameters, std::span<const Vec3d> vertices,
                        int vertex_count, std::span<const std::uint32_t> polygon_of, const ViewArrays& views,
                        std::span<const std::uint32_t> view_of, int rule, std::span<float> values) {
    HWY_DYNAMIC_DISPATCH(integrate_polygons_in_lanes)
    (shape, parameters, vertices, vertex_count, polygon_of, views, view_of, rule, values);
}

int polygon_rule_points(int rule, int vertex_count) {
    return static_cast<int>(polygon_rule(rule).size()) * (vertex_count - 2);
}

}  // namespace shlight
#endif
