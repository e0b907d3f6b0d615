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

#include <variant>

#include "lobes/ggx-inl.h"
#include "lobes/lambert-inl.h"
#include "lobes/rough_diffuse-inl.h"
#include "lobes/table-inl.h"
#include "shlight/lobe_shape.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Calls function(lanes) with the lanes class of the shape.
template <class Function>
void with_lobe_lanes(const LobeShape& shape, const Function& function) {
    std::visit([&](const auto& s) { with_lanes_of(s, function); }, shape);
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
