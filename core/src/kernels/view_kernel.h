// SPDX-License-Identifier: MIT
//
// Views of a lobe, many at once: where they lie among those that were fitted, their warps, and rows of tables between.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace shlight {

/// Where a view lies in a table of one row for each fitted view (warped_row.h), before which stands the row of the view
/// beyond the normal: the first of four rows, and cubic weights of the four.
/// rows: one for each view; weights: four for each.
void find_views(std::span<const double> cos_theta_o, std::uint32_t* rows, float* weights);

/// The members of WarpArrays, to be written.
struct WarpOutput {
    double *sin_tilt, *cos_tilt;
    double *speed, *one_minus_speed, *gamma;
    double *horizon_x, *horizon_z;
    double *horizon_height, *horizon_sine;
};

/// The warps of a GGX lobe: those of lobe_warp(), whose logarithms are rounded to float here.
void warp_views(double alpha, std::span<const double> cos_theta_o, const WarpOutput& out);

/// Interpolated rows: for each i of `views` the weighted sum of four rows of a table of `width` columns, a multiple of
/// 16, written to out + i · stride. table and out: aligned to 64 bytes, stride a multiple of 16.
void interpolate_views(const float* table, std::size_t width, const std::uint32_t* rows, const float* weights,
                       std::span<const std::uint32_t> views, float* out, std::size_t stride);

}  // namespace shlight
