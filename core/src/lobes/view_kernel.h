// SPDX-License-Identifier: MIT
//
// Views of a lobe, many at once: where they lie among those that were fitted, their warps, and rows of tables between.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace shlight {

/// Arrays of views, here and of warps, have room for a multiple of this; what lies beyond the last view is overwritten.
inline constexpr std::size_t kViewLanes = 16;
constexpr std::size_t padded_views(std::size_t count) {
    return (count + kViewLanes - 1) / kViewLanes * kViewLanes;
}

/// What is needed of a view to look up any lobe.
struct ViewOutput {
    double* sine;                         ///< sinθ_o
    double *fitted_sine, *fitted_cosine;  ///< of the view's neighbour that is fitted
    float* log_cosine;                    ///< of the same
    /// Where it lies in a table of one row for each fitted view (fit_table.h), before which stands the row of the view
    /// beyond the normal: the first of four rows, and four cubic weights.
    std::uint32_t* row;
    float* weights;
};

/// cos_theta_o: of `count` views, and finite up to padded_views(count).
void find_views(const double* cos_theta_o, std::size_t count, const ViewOutput& out);

/// The members of WarpArrays beside the tilt, to be written.
struct WarpOutput {
    double *speed, *one_minus_speed, *gamma;
    double *horizon_x, *horizon_z;
    double *horizon_height, *horizon_sine;
};

/// The warps of GGX lobes at the views that find_views found: those of lobe_warp(), whose narrowness is rounded to
/// float here. alpha: of each view, as padded as the views.
void warp_views(const float* alpha, const ViewOutput& views, std::size_t count, const WarpOutput& out);

/// Interpolated rows: for each i of `views` the weighted sum of the first `width` numbers, a multiple of 16, of four
/// rows of a table, written to out + i · stride. out: aligned to 64 bytes, stride a multiple of 16.
void interpolate_views(const float* table, std::size_t row_size, std::size_t width, const std::uint32_t* rows,
                       const float* weights, std::span<const std::uint32_t> views, float* out, std::size_t stride);

/// The same between four tables for each view: those of view i from 4 i on, with weights.
struct TableNeighbours {
    const float* const* tables;
    const float* weights;
};
void interpolate_views(const TableNeighbours& neighbours, std::size_t row_size, std::size_t width,
                       const std::uint32_t* rows, const float* weights, std::span<const std::uint32_t> views,
                       float* out, std::size_t stride);

}  // namespace shlight
