// SPDX-License-Identifier: MIT
#include "polygons/polygon_views.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "polygons/polygon_views.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "polygons/polygon_vertices-inl.h"

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

/// check_polygon's condition with both sides multiplied by what it divides by: nothing is lost where a polygon has no
/// area or no extent.
HWY_INLINE bool are_sound(const VertexLanes& vertices) {
    const Doubles d;
    const Vectors origin = vertices.vertex(0);
    const auto zero = hn::Zero(d);
    Vectors area = {zero, zero, zero};
    auto farthest = zero;
    auto extent = zero;
    auto sum = zero;
    Vectors before = {zero, zero, zero};
    for (std::size_t i = 0; i < vertices.count(); ++i) {
        const Vectors v = vertices.vertex(i);
        const Vectors step = v - origin;
        area = area + cross<double>(before, step);
        before = step;
        farthest = hn::Max(farthest, dot<double>(v, v));
        extent = hn::Max(extent, dot<double>(step, step));
        sum = hn::Add(sum, hn::Add(dot<double>(v, v), dot<double>(step, step)));
    }
    auto deviation = zero;
    for (std::size_t i = 1; i < vertices.count(); ++i) {
        deviation = hn::Max(deviation, hn::Abs(dot<double>(area, vertices.vertex(i) - origin)));
    }
    constexpr double kEpsilon = std::numeric_limits<float>::epsilon();
    const auto room = hn::MulAdd(all(d, 1e-4), hn::Sqrt(extent), hn::Mul(all(d, 8 * kEpsilon), hn::Sqrt(farthest)));
    const auto most = hn::Mul(hn::Sqrt(dot<double>(area, area)), room);
    // A NaN may be lost in a maximum, not in a sum.
    return hn::AllTrue(d, hn::And(hn::Le(deviation, most), hn::IsFinite(sum)));
}

/// Of the polygons from `first` on, before `end`.
bool are_sound_between(VertexLanes& vertices, std::size_t first, std::size_t end) {
    for (; first < end; first += kWidth) {
        vertices.load(indices(first, end).data());
        if (!are_sound(vertices)) {
            return false;
        }
    }
    return true;
}

bool are_all_sound(const PolygonArray& polygons, std::size_t count) {
    VertexLanes vertices(polygons);
    return are_sound_between(vertices, 0, count);
}

/// Loads columns of rows in lanes; rows of `numbers` ≥ 4, which may be no multiple of four.
class FloatRows {
    using D = Floats;

  public:
    static constexpr std::size_t kFloatWidth = kLaneCount<D>;

    FloatRows(const float* rows, std::size_t numbers)
        : rows_(rows), numbers_(numbers), columns_(numbers * kFloatWidth) {}

    /// Rows first … before `end`; the last is repeated.
    HWY_INLINE void load(std::size_t first, std::size_t end) {
        const D d;
        RowPointers<const float> rows;
        for (std::size_t lane = 0; lane < kFloatWidth; ++lane) {
            rows[lane] = rows_ + numbers_ * std::min(first + lane, end - 1);
        }
        for (std::size_t i = 0; i < numbers_; i += kSquare<D>) {
            const std::size_t column = std::min(i, numbers_ - kSquare<D>);
            const auto columns = load_columns(d, rows.data(), column);
            for (std::size_t j = 0; j < kSquare<D>; ++j) {
                hn::StoreU(columns[j], d, columns_.data() + (column + j) * kFloatWidth);
            }
        }
    }
    HWY_INLINE Vectors3<float> vertex(std::size_t i) const {
        const float* at = columns_.data() + 3 * i * kFloatWidth;
        return {hn::LoadU(D(), at), hn::LoadU(D(), at + kFloatWidth), hn::LoadU(D(), at + 2 * kFloatWidth)};
    }

  private:
    const float* rows_;
    std::size_t numbers_;
    std::vector<float> columns_;
};

/// Half of what check_polygon grants must do for what float finds and may be wrong by: a few roundings of extent³ for
/// each vertex, because differences of given numbers are right to one rounding. Where anything overflows or vanishes
/// nothing is said.
HWY_INLINE bool are_surely_sound(const FloatRows& rows, std::size_t vertex_count) {
    const Floats d;
    const auto zero = hn::Zero(d);
    const Vectors3<float> origin = rows.vertex(0);
    Vectors3<float> area = {zero, zero, zero};
    Vectors3<float> before = rows.vertex(1) - origin;
    auto square = dot<float>(before, before);
    auto sum = square;
    for (std::size_t i = 2; i < vertex_count; ++i) {
        const Vectors3<float> step = rows.vertex(i) - origin;
        area = area + cross<float>(before, step);
        before = step;
        const auto length = dot<float>(step, step);
        square = hn::Max(square, length);
        sum = hn::Add(sum, length);
    }
    auto deviation = zero;
    for (std::size_t i = 1; i < vertex_count; ++i) {
        deviation = hn::Max(deviation, hn::Abs(dot<float>(area, rows.vertex(i) - origin)));
    }
    const auto extent = hn::Sqrt(square);
    const double rounding = 16.0 * std::numeric_limits<float>::epsilon() * static_cast<double>(vertex_count);
    const auto most = hn::Mul(hn::Mul(all(d, 0.5e-4), extent), hn::Sqrt(dot<float>(area, area)));
    const auto least = hn::MulAdd(all(d, rounding), hn::Mul(extent, square), deviation);
    // A NaN may be lost in a maximum, not in a sum.
    return hn::AllTrue(d, hn::And(hn::Lt(least, most), hn::IsFinite(hn::Add(sum, most))));
}

bool are_all_sound_in_float(const float* given, const PolygonArray& polygons, std::size_t count) {
    FloatRows rows(given, 3 * polygons.vertex_count);
    VertexLanes vertices(polygons);
    for (std::size_t first = 0; first < count; first += FloatRows::kFloatWidth) {
        const std::size_t end = std::min(first + FloatRows::kFloatWidth, count);
        rows.load(first, end);
        if (!are_surely_sound(rows, polygons.vertex_count) && !are_sound_between(vertices, first, end)) {
            return false;
        }
    }
    return true;
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
    const auto seen = hn::And(hn::Ne(vertices.side(), zero), hn::Gt(highest, zero));
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

HWY_EXPORT(are_all_sound);
HWY_EXPORT(are_all_sound_in_float);
HWY_EXPORT(extents_in_lanes);

namespace {

PolygonArray array_of(std::span<const Vec3d> vertices, int vertex_count) {
    return {&vertices.data()->x, static_cast<std::size_t>(vertex_count)};
}

}  // namespace

bool polygons_are_sound(std::span<const Vec3d> vertices, int vertex_count) {
    return vertices.empty() ||
           HWY_DYNAMIC_DISPATCH(are_all_sound)(array_of(vertices, vertex_count),
                                               vertices.size() / static_cast<std::size_t>(vertex_count));
}

bool polygons_are_sound(std::span<const Vec3f> given, std::span<const Vec3d> vertices, int vertex_count) {
    return vertices.empty() ||
           HWY_DYNAMIC_DISPATCH(are_all_sound_in_float)(&given.data()->x, array_of(vertices, vertex_count),
                                                        vertices.size() / static_cast<std::size_t>(vertex_count));
}

void polygon_extents(std::span<const Vec3d> vertices, int vertex_count, const PolygonExtents& extents) {
    if (!vertices.empty()) {
        HWY_DYNAMIC_DISPATCH(extents_in_lanes)(array_of(vertices, vertex_count), extents);
    }
}

}  // namespace shlight
#endif
