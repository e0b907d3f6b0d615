// SPDX-License-Identifier: MIT
//
// Lobes in lanes: f·cos of many directions, with one choice of the shape for all. Included once per instruction set.
//
// Lanes of a shape have
//   view(d, cos_o, alpha)                 what f·cos needs of each lane's ω_o and lobe_width()
//   value(sum, cos_i, view)               f·cos towards ω_i = sum - ω_o, both above the horizon
//   density(sum, cos_i, view)             how densely the lobe spreads rays towards ω_i
//   over_bell(d, cos_i, cos_half, view)   4 f·cos / D(h): in the plane of half vectors (contour_integral.h)
// with cos_half = ω_i·h, and D the GGX distribution of the lobe's width, which is 1/π for a lobe without a peak.
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
#include "shlight/lobe_shape.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// function(lanes of the shape).
template <class Function>
void with_lobe_lanes(const LobeShape& shape, const Function& function) {
    std::visit([&](const auto& s) { with_lanes_of(s, function); }, shape);
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
