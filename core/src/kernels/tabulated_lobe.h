// SPDX-License-Identifier: MIT
//
// A lobe's table, for batch kernels that interpolate in it themselves.
#pragma once

#include <cstddef>

namespace shlight {

/// Numbers from one column of TabulatedLobe to the next.
inline constexpr std::size_t kViewColumn = 64;

/// One warped lobe at all views. Rows as interpolate_views (view_kernel.h) has them.
struct TabulatedLobe {
    double alpha;
    const float* rows;     ///< `width` cosine terms for each fitted view
    const float* columns;  ///< the same numbers term after term: term k of all views at columns + k · kViewColumn
    std::size_t width;     ///< a multiple of 16, at least cosine_count(order)
    int order;
};

}  // namespace shlight
