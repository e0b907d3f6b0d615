// SPDX-License-Identifier: MIT
#include "regions/polygon_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "regions/polygon_views.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "regions/polygon_edges-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

using Vectors = Vectors3<double>;
constexpr std::size_t kWidth = kLaneCount<Doubles>;

/// The polygons first … of `count`; the last is repeated.
std::array<std::uint32_t, kWidth> indices(std::size_t first, std::size_t count) {
    std::array<std::uint32_t, kWidth> index;
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
        index[lane] = static_cast<std::uint32_t>(std::min(first + lane, count - 1));
    }
    return index;
}

/// Calls use(direction, which lanes) for the corners of what is above the horizon.
template <class Use>
HWY_INLINE void for_each_corner(const VertexLanes& vertices, const Use& use) {
    const Doubles d;
    const auto zero = hn::Zero(d);
    const auto along = [&](const Vectors& v) HWY_ATTR {
        return scaled<double>(v, hn::Div(all(d, 1), hn::Sqrt(hn::Max(dot<double>(v, v), all(d, 1e-300)))));
    };
    for (std::size_t i = 0; i < vertices.count(); ++i) {
        const Vectors a = vertices.vertex(i);
        const Vectors b = vertices.vertex(i + 1 < vertices.count() ? i + 1 : 0);
        const auto above = hn::Ge(a.z, zero);
        use(along(a), above);
        const auto cuts = hn::Xor(above, hn::Ge(b.z, zero));
        if (!hn::AllFalse(d, cuts)) {
            const auto t = hn::IfThenElseZero(cuts, hn::Div(a.z, hn::Sub(a.z, b.z)));
            const Vectors cut = {hn::MulAdd(t, hn::Sub(b.x, a.x), a.x), hn::MulAdd(t, hn::Sub(b.y, a.y), a.y), zero};
            use(along(cut), cuts);
        }
    }
}

struct ExtentLanes {
    Vectors middle;
    V<Doubles> half_angle;
};

HWY_INLINE ExtentLanes extent_of(const VertexLanes& vertices) {
    const Doubles d;
    const auto zero = hn::Zero(d);
    Vectors sum = {zero, zero, zero};
    auto highest = zero;
    for_each_corner(vertices, [&](const Vectors& u, auto which) HWY_ATTR {
        sum.x = hn::Add(sum.x, hn::IfThenElseZero(which, u.x));
        sum.y = hn::Add(sum.y, hn::IfThenElseZero(which, u.y));
        sum.z = hn::Add(sum.z, hn::IfThenElseZero(which, u.z));
        highest = hn::Max(highest, u.z);
    });
    const auto seen = hn::And(hn::Ne(vertices.facing().side, zero), hn::Gt(highest, zero));
    const auto length = hn::Sqrt(dot<double>(sum, sum));
    const Vectors middle = scaled<double>(sum, hn::IfThenElseZero(hn::Gt(length, zero), hn::Div(all(d, 1), length)));
    auto largest = zero;
    for_each_corner(vertices, [&](const Vectors& u, auto which) HWY_ATTR {
        const Vectors chord = u - middle;
        largest = hn::Max(largest, hn::IfThenElseZero(which, dot<double>(chord, chord)));
    });
    return {middle, hn::IfThenElse(seen, hn::Sqrt(largest), all(d, -1))};
}

void extents_in_lanes(const PolygonArray& polygons, const PolygonExtents& extents) {
    const std::size_t count = extents.x.size();
    VertexLanes vertices(polygons);
    for (std::size_t first = 0; first < count; first += kWidth) {
        vertices.load(indices(first, count).data());
        const ExtentLanes lanes = extent_of(vertices);
        const auto copy = [&](V<Doubles> from, std::span<double> to) HWY_ATTR {
            LaneValues<double> values;
            put<double>(values, from);
            std::copy_n(values.begin(), std::min(kWidth, count - first),
                        to.begin() + static_cast<std::ptrdiff_t>(first));
        };
        copy(lanes.middle.x, extents.x);
        copy(lanes.middle.y, extents.y);
        copy(lanes.middle.z, extents.z);
        copy(lanes.half_angle, extents.half_angle);
    }
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(extents_in_lanes);

void polygon_extents(std::span<const Vec3d> vertices, int vertex_count, const PolygonExtents& extents) {
    if (!vertices.empty()) {
        HWY_DYNAMIC_DISPATCH(extents_in_lanes)
        ({&vertices.data()->x, static_cast<std::size_t>(vertex_count)}, extents);
    }
}

}  // namespace shlight
#endif
