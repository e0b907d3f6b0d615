// SPDX-License-Identifier: MIT
#include "lights/whole_rectangle.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lights/whole_rectangle.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "lights/local_light.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

static_assert(kLightPointLanes % kLaneCount<Floats> == 0);

using Integers = hn::RebindToUnsigned<Floats>;

template <int kShift>
HWY_INLINE V<Integers> swapped(V<Integers> x, std::uint32_t low) {
    const auto mask = hn::Set(Integers(), low);
    return hn::Or(hn::And(hn::ShiftRight<kShift>(x), mask), hn::ShiftLeft<kShift>(hn::And(x, mask)));
}

// The functions of math/sampling.cpp, in lanes.

HWY_INLINE V<Integers> reverse_bits(V<Integers> x) {
    x = swapped<1>(x, 0x55555555U);
    x = swapped<2>(x, 0x33333333U);
    x = swapped<4>(x, 0x0F0F0F0FU);
    x = swapped<8>(x, 0x00FF00FFU);
    return hn::Or(hn::ShiftRight<16>(x), hn::ShiftLeft<16>(x));
}

HWY_INLINE V<Integers> scramble_reversed(V<Integers> x, std::uint32_t seed) {
    const Integers d;
    x = hn::Xor(x, hn::Mul(x, hn::Set(d, 0x3D20ADEAU)));
    x = hn::Add(x, hn::Set(d, seed));
    x = hn::Mul(x, hn::Set(d, (seed >> 16) | 1U));
    x = hn::Xor(x, hn::Mul(x, hn::Set(d, 0x05526C56U)));
    return hn::Xor(x, hn::Mul(x, hn::Set(d, 0x53A22864U)));
}

HWY_INLINE V<Integers> pascal(V<Integers> x) {
    const Integers d;
    x = hn::Xor(x, hn::ShiftRight<16>(x));
    x = hn::Xor(x, hn::And(hn::ShiftRight<8>(x), hn::Set(d, 0x00FF00FFU)));
    x = hn::Xor(x, hn::And(hn::ShiftRight<4>(x), hn::Set(d, 0x0F0F0F0FU)));
    x = hn::Xor(x, hn::And(hn::ShiftRight<2>(x), hn::Set(d, 0x33333333U)));
    return hn::Xor(x, hn::And(hn::ShiftRight<1>(x), hn::Set(d, 0x55555555U)));
}

/// The upper 23 bits as a number in the open interval (0, 1).
HWY_INLINE V<Floats> unit(V<Integers> x) {
    const Floats d;
    const auto high = hn::ConvertTo(d, hn::BitCast(hn::RebindToSigned<Floats>(), hn::ShiftRight<9>(x)));
    return hn::MulAdd(high, hn::Set(d, 0x1p-23F), hn::Set(d, 0x1p-24F));
}

HWY_INLINE V<Floats> at(float corner, float along, float across, V<Floats> u, V<Floats> v) {
    const Floats d;
    return hn::MulAdd(u, hn::Set(d, along), hn::MulAdd(v, hn::Set(d, across), hn::Set(d, corner)));
}

/// Weight of the point at the end of a vector: dω = |cos at the light| dA / distance². Distances are relative to the
/// nearest one, so that powers stay within a float's range.
HWY_INLINE V<Floats> weight(const WholeRectangle& r, V<Floats> x, V<Floats> y, V<Floats> z) {
    const Floats d;
    const auto square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const auto relative = hn::Div(hn::Set(d, r.nearest_square), square);
    return hn::Mul(hn::Set(d, r.most_weight), hn::Mul(relative, hn::Sqrt(relative)));
}

void draw_square(const SobolSequence& sequence, std::uint32_t first, std::size_t count, float* u, float* v) {
    const Floats d;
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        const auto index = hn::Iota(Integers(), first + static_cast<std::uint32_t>(i));
        const auto place = reverse_bits(scramble_reversed(reverse_bits(index), sequence.order_seed()));
        hn::StoreU(unit(reverse_bits(scramble_reversed(place, sequence.x_seed()))), d, u + i);
        hn::StoreU(unit(reverse_bits(scramble_reversed(pascal(place), sequence.y_seed()))), d, v + i);
    }
}

void place(const WholeRectangle& r, const float* square_u, const float* square_v, std::size_t count,
           const LightPointArrays& points) {
    const Floats d;
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        const auto u = hn::LoadU(d, square_u + i);
        const auto v = hn::LoadU(d, square_v + i);
        const auto x = at(r.corner.x, r.along.x, r.across.x, u, v);
        const auto y = at(r.corner.y, r.along.y, r.across.y, u, v);
        const auto z = at(r.corner.z, r.along.z, r.across.z, u, v);
        hn::StoreU(x, d, points.x + i);
        hn::StoreU(y, d, points.y + i);
        hn::StoreU(z, d, points.z + i);
        hn::StoreU(weight(r, x, y, z), d, points.weight + i);
    }
}

HWY_INLINE V<Floats> dot(V<Floats> x, V<Floats> y, V<Floats> z, const Vec3f& b) {
    const Floats d;
    return hn::MulAdd(x, hn::Set(d, b.x), hn::MulAdd(y, hn::Set(d, b.y), hn::Mul(z, hn::Set(d, b.z))));
}

void meet(const WholeRectangle& r, const ShadingFrame& frame, std::size_t count, const LightPointArrays& points) {
    const Floats d;
    // Rows of the matrix from the shading frame to the world.
    const Vec3f row_x(frame.x.x, frame.y.x, frame.z.x);
    const Vec3f row_y(frame.x.y, frame.y.y, frame.z.y);
    const Vec3f row_z(frame.x.z, frame.y.z, frame.z.z);
    const Vec3f normal = glm::normalize(glm::cross(glm::normalize(r.along), glm::normalize(r.across)));
    const auto height = hn::Set(d, glm::dot(normal, r.corner));
    const Vec3f along = r.along / glm::dot(r.along, r.along);
    const Vec3f across = r.across / glm::dot(r.across, r.across);
    const auto along_corner = hn::Set(d, glm::dot(along, r.corner));
    const auto across_corner = hn::Set(d, glm::dot(across, r.corner));
    const auto zero = hn::Zero(d);
    const auto one = hn::Set(d, 1.0F);
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        const auto x = hn::LoadU(d, points.x + i);
        const auto y = hn::LoadU(d, points.y + i);
        const auto z = hn::LoadU(d, points.z + i);
        const auto world_x = dot(x, y, z, row_x);
        const auto world_y = dot(x, y, z, row_y);
        const auto world_z = dot(x, y, z, row_z);
        const auto distance = hn::Div(height, dot(world_x, world_y, world_z, normal));
        const auto way_x = hn::Mul(distance, world_x);
        const auto way_y = hn::Mul(distance, world_y);
        const auto way_z = hn::Mul(distance, world_z);
        const auto u = hn::Sub(dot(way_x, way_y, way_z, along), along_corner);
        const auto v = hn::Sub(dot(way_x, way_y, way_z, across), across_corner);
        const auto inside = hn::And(hn::Ge(hn::Min(u, v), zero), hn::Le(hn::Max(u, v), one));
        const auto met = hn::And(hn::Gt(distance, zero), inside);
        hn::StoreU(way_x, d, points.x + i);
        hn::StoreU(way_y, d, points.y + i);
        hn::StoreU(way_z, d, points.z + i);
        hn::StoreU(hn::IfThenElseZero(met, weight(r, way_x, way_y, way_z)), d, points.weight + i);
    }
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {
namespace {

/// Largest ratio of the farthest to the nearest point's distance; weights vary by its third power.
constexpr double kEvenRectangle = 1.6;

}  // namespace

HWY_EXPORT(draw_square);
HWY_EXPORT(place);
HWY_EXPORT(meet);

std::optional<WholeRectangle> WholeRectangle::see(const Light& light, const ShadingFrame& frame, double error) {
    const auto* polygon = std::get_if<PolygonLight>(&light);
    if (polygon == nullptr || !polygon->rectangle || !std::holds_alternative<EvenProfile>(polygon->traits.profile)) {
        return std::nullopt;
    }
    const Vec3d corner = polygon->vertices[0] - frame.origin;
    const Vec3d along = polygon->vertices[1] - polygon->vertices[0];
    const Vec3d across = polygon->vertices[3] - polygon->vertices[0];
    const double height = -glm::dot(polygon->normal, corner);
    const double lowest =
        glm::dot(frame.z, corner) + std::min(0.0, glm::dot(frame.z, along)) + std::min(0.0, glm::dot(frame.z, across));
    const double middle = glm::length(polygon->center - frame.origin);
    const double nearest = std::max(std::abs(height), middle - polygon->radius);
    if (!is_lit_side(*polygon, height, error) || !(lowest >= 0) ||
        !(middle + polygon->radius < kEvenRectangle * nearest)) {
        return std::nullopt;
    }
    const double area = std::sqrt(glm::dot(along, along) * glm::dot(across, across));
    return WholeRectangle{Vec3f(corner), Vec3f(along), Vec3f(across), static_cast<float>(nearest * nearest),
                          static_cast<float>(area * std::abs(height) / (nearest * nearest * nearest))};
}

void draw_square_points(const SobolSequence& sequence, std::uint32_t first, std::size_t count, float* u, float* v) {
    HWY_DYNAMIC_DISPATCH(draw_square)(sequence, first, count, u, v);
}

void place_points(const WholeRectangle& rectangle, const float* u, const float* v, std::size_t count,
                  const LightPointArrays& points) {
    HWY_DYNAMIC_DISPATCH(place)(rectangle, u, v, count, points);
}

void meet_rectangle(const WholeRectangle& rectangle, const ShadingFrame& frame, std::size_t count,
                    const LightPointArrays& points) {
    HWY_DYNAMIC_DISPATCH(meet)(rectangle, frame, count, points);
}

}  // namespace shlight
#endif
