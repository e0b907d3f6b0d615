// SPDX-License-Identifier: MIT
#include "lobes/lobe_rays.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lobes/lobe_rays.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "lobes/lobe_lanes-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

static_assert(kLobeRayLanes % kLaneCount<Floats> == 0);

/// Least lobe width; the square of a narrower one would underflow in float.
constexpr double kLeastAlpha = 1e-9;

struct Vectors {
    V<Floats> x, y, z;
};

HWY_INLINE Vectors load(const ConstRayVectors& arrays, std::size_t i) {
    const Floats d;
    return {hn::LoadU(d, arrays.x + i), hn::LoadU(d, arrays.y + i), hn::LoadU(d, arrays.z + i)};
}

HWY_INLINE V<Floats> dot(const Vectors& a, const Vec3d& b) {
    const Floats d;
    return hn::MulAdd(a.x, all(d, b.x), hn::MulAdd(a.y, all(d, b.y), hn::Mul(a.z, all(d, b.z))));
}

HWY_INLINE Vectors scaled(const Vectors& a, V<Floats> factor) {
    return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}

/// Divides by the largest component first, because the square of the length may leave a float's range.
HWY_INLINE Vectors normalized(const Vectors& a) {
    const auto one = hn::Set(Floats(), 1.0F);
    const auto largest = hn::Max(hn::Abs(a.x), hn::Max(hn::Abs(a.y), hn::Abs(a.z)));
    const Vectors b = scaled(a, hn::Div(one, largest));
    const auto square = hn::MulAdd(b.x, b.x, hn::MulAdd(b.y, b.y, hn::Mul(b.z, b.z)));
    return scaled(b, hn::Div(one, hn::Sqrt(square)));
}

// The shapes' sample() in lanes, with the same names of variables.

HWY_INLINE Vectors sample(const LambertShape& /*shape*/, const Vec3d& /*view*/, V<Floats> u, V<Floats> v) {
    const Floats d;
    const auto sine = hn::Sqrt(u);
    const auto azimuth = hn::Mul(all(d, 2 * std::numbers::pi), v);
    return {hn::Mul(sine, hn::Cos(d, azimuth)), hn::Mul(sine, hn::Sin(d, azimuth)), root(d, hn::Sub(all(d, 1), u))};
}

HWY_INLINE Vectors sample(const GgxShape& shape, const Vec3d& view, V<Floats> u, V<Floats> v) {
    const Floats d;
    const auto one = all(d, 1);
    const double c = std::cos(shape.azimuth);
    const double s = std::sin(shape.azimuth);
    const double width_y = shape.across != 0 ? shape.across : shape.alpha;
    const Vec3d own(c * view.x, s * view.x, view.z);  // in the lobe's axes
    const Vec3d bent = glm::normalize(Vec3d(shape.alpha * own.x, width_y * own.y, own.z));
    // z + bent.z
    const auto raised = hn::Mul(hn::Sub(one, v), all(d, 1 + bent.z));
    const auto z = hn::Sub(raised, all(d, bent.z));
    const auto sine = root(d, hn::Mul(hn::Sub(one, z), hn::Add(one, z)));
    const auto azimuth = hn::Mul(all(d, 2 * std::numbers::pi), u);
    const Vectors normal =
        normalized({hn::Mul(all(d, shape.alpha), hn::MulAdd(sine, hn::Cos(d, azimuth), all(d, bent.x))),
                    hn::Mul(all(d, width_y), hn::MulAdd(sine, hn::Sin(d, azimuth), all(d, bent.y))),
                    hn::Max(raised, all(d, 1e-30))});
    const auto cosine = dot(normal, own);
    const Vectors twice = scaled(normal, hn::Add(cosine, cosine));
    const auto x = hn::Sub(twice.x, all(d, own.x));
    const auto y = hn::Sub(twice.y, all(d, own.y));
    return {hn::MulAdd(all(d, c), x, hn::Mul(all(d, s), y)), hn::MulSub(all(d, c), y, hn::Mul(all(d, s), x)),
            hn::Sub(twice.z, all(d, own.z))};
}

HWY_INLINE Vectors sample(const ToonShape& shape, const Vec3d& view, V<Floats> u, V<Floats> v) {
    const Floats d;
    const auto below = hn::Mul(u, all(d, 1 - std::cos(ToonCone(shape).outer)));
    const auto sine = hn::Sqrt(hn::Mul(below, hn::Sub(all(d, 2), below)));
    const auto z = hn::Sub(all(d, 1), below);
    const auto azimuth = hn::Mul(all(d, 2 * std::numbers::pi), v);
    const auto x = hn::Mul(sine, hn::Cos(d, azimuth));
    const glm::dmat3 frame = toon_frame(shape, view);
    return {hn::MulAdd(all(d, frame[0].x), x, hn::Mul(all(d, frame[2].x), z)), hn::Mul(sine, hn::Sin(d, azimuth)),
            hn::MulAdd(all(d, frame[0].z), x, hn::Mul(all(d, frame[2].z), z))};
}

template <class Shape>
void sample_all(const Shape& shape, const Vec3d& view, const float* u, const float* v, std::size_t count,
                const RayVectors& directions) {
    const Floats d;
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        const Vectors direction = sample(shape, view, hn::LoadU(d, u + i), hn::LoadU(d, v + i));
        hn::StoreU(direction.x, d, directions.x + i);
        hn::StoreU(direction.y, d, directions.y + i);
        hn::StoreU(direction.z, d, directions.z + i);
    }
}

void sample_rays(const LobeShape& shape, const Vec3d& view, const float* u, const float* v, std::size_t count,
                 const RayVectors& directions) {
    std::visit(
        [&](const auto& s) {
            // No other shapes are sampled ones.
            if constexpr (requires { sample(s, view, V<Floats>(), V<Floats>()); }) {
                sample_all(s, view, u, v, count, directions);
            }
        },
        sampled_shape(shape));
}

template <class Lobe>
void weigh_all(const Lobe& lobe, double parameter, const ShadingFrame& frame, const Vec3d& view,
               const ConstRayVectors& ways, std::size_t count, float* values, float* densities) {
    const Floats d;
    const auto zero = hn::Zero(d);
    const auto cos_o = all(d, view.z);
    const auto of_view = lobe.view(d, cos_o, all(d, std::max(parameter, kLeastAlpha)));
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        const Vectors way = normalized(load(ways, i));
        const auto cos_i = dot(way, frame.z);
        const HalfSum sum = {hn::Add(dot(way, frame.x), all(d, view.x)), dot(way, frame.y), hn::Add(cos_i, cos_o)};
        const auto above = hn::Gt(hn::Min(cos_i, cos_o), zero);
        hn::StoreU(hn::IfThenElseZero(above, lobe.value(sum, cos_i, of_view)), d, values + i);
        if (densities != nullptr) {
            hn::StoreU(hn::IfThenElseZero(above, lobe.density(sum, cos_i, of_view)), d, densities + i);
        }
    }
}

void weigh_rays(const LobeShape& shape, const ShadingFrame& frame, const Vec3d& view, const ConstRayVectors& ways,
                std::size_t count, float* values, float* densities) {
    with_lobe_lanes(shape, [&](const auto& lobe) {
        weigh_all(lobe, lobe_parameter(shape), frame, view, ways, count, values, densities);
    });
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(sample_rays);
HWY_EXPORT(weigh_rays);

void sample_lobe_rays(const LobeShape& shape, const Vec3d& view, const float* u, const float* v, std::size_t count,
                      const RayVectors& directions) {
    HWY_DYNAMIC_DISPATCH(sample_rays)(shape, view, u, v, count, directions);
}

void weigh_lobe_rays(const LobeShape& shape, const ShadingFrame& frame, const Vec3d& view, const ConstRayVectors& ways,
                     std::size_t count, float* values, float* densities) {
    HWY_DYNAMIC_DISPATCH(weigh_rays)(shape, frame, view, ways, count, values, densities);
}

}  // namespace shlight
#endif
