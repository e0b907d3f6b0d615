// SPDX-License-Identifier: MIT
//
// Lobes in lanes: f·cos for many directions, with one switch over the shape for all of them. Included once per
// instruction set.
//
// The lanes class of a shape has
//   view(d, cos_o, parameter)             what f·cos needs of each lane's ω_o and lobe_parameter()
//   value(sum, cos_i, view)               f·cos towards ω_i = sum - ω_o, both above the horizon
//   density(sum, cos_i, view)             density per solid angle of rays drawn from the lobe, towards ω_i
//   over_ndf(d, half, cos_i, view)        4 f·cos / D(h), the slowly varying factor of boundary_integral.h
// with D the GGX distribution of normals for the lobe's width, which is 1/π for diffuse lobes.
#if defined(SHLIGHT_KERNELS_LOBE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_LOBE_LANES_INL_H_
#undef SHLIGHT_KERNELS_LOBE_LANES_INL_H_
#else
#define SHLIGHT_KERNELS_LOBE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <numbers>
#include <variant>

#include "lobes/disney-inl.h"
#include "lobes/ggx-inl.h"
#include "lobes/lambert-inl.h"
#include "lobes/rough_diffuse-inl.h"
#include "lobes/table-inl.h"
#include "lobes/toon-inl.h"
#include "shlight/lobe_shape.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// The half vector of s = ω_i + ω_o, and D(h) / 4 for the square of a lobe's width. It uses sin²θ_h, since 1 - cos²θ_h
/// would lose the digits that decide the peak of a narrow lobe.
template <class D>
struct HalfAndNdf {
    HalfVector<D> half;
    V<D> quarter_ndf;
};
template <class D>
HWY_INLINE HalfAndNdf<D> half_vector(D d, V<D> x, V<D> y, V<D> z, double alpha2) {
    const auto across = hn::MulAdd(x, x, hn::Mul(y, y));
    const auto up = hn::Mul(z, z);
    const auto square = hn::Add(across, up);
    const auto inverse = hn::Div(all(d, 1), hn::Sqrt(square));
    const auto sharpness = hn::Div(square, hn::MulAdd(all(d, alpha2), up, across));
    const auto peak = all(d, alpha2 / (4 * std::numbers::pi));
    return {
        {hn::Mul(x, inverse), hn::Mul(y, inverse), hn::Mul(z, inverse), hn::Mul(all(d, 0.5), hn::Mul(square, inverse))},
        hn::Mul(hn::Mul(peak, sharpness), sharpness)};
}

/// Calls function(lanes) with the lanes class of the shape.
template <class Function>
void with_lobe_lanes(const LobeShape& shape, const Function& function) {
    std::visit([&](const auto& s) { with_lanes_of(s, function); }, shape);
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
