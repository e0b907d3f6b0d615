// SPDX-License-Identifier: MIT
//
// One lobe at many views, in the arrays that batch kernels read. All lights at a view share them.
#pragma once

#include <cstddef>

namespace shlight {

/// ω_o = (x, 0, z) for each view.
struct ViewArrays {
    const double *x, *z;
    bool shared;  ///< whether all lights have the same view
};

/// The members of Boost for many views, one array for each member.
struct BoostArrays {
    const double *sin_tilt, *cos_tilt;
    const double *speed, *one_minus_speed, *gamma;
    const double *horizon_x, *horizon_z;          ///< the boosted horizon's middle in the boost's frame
    const double *horizon_height, *horizon_sine;  ///< z_0 and √(1 - z_0²)
};

struct LobeArrays {
    bool boosted;  ///< false: no view is boosted, and `boosts` is not read
    BoostArrays boosts;
    /// The cosine terms of view v are at terms + v · stride: cosine_count(order) numbers, and those up to the next
    /// multiple of 16 may be read.
    const float* terms;
    std::size_t stride;  ///< 0: the views share their terms
    int order;
};

}  // namespace shlight
