// SPDX-License-Identifier: MIT
//
// Many views of a lobe at once: their positions among the fitted views, their boosts, and interpolated table rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace shlight {

/// Arrays of views and of boosts have room for a multiple of this; entries beyond the last view are overwritten.
inline constexpr std::size_t kViewLanes = 16;
constexpr std::size_t padded_views(std::size_t count) {
    return (count + kViewLanes - 1) / kViewLanes * kViewLanes;
}

/// Arrays, one entry for each view, that are needed to look up any lobe.
struct ViewOutput {
    double* sine;                         ///< sinθ_o
    double *fitted_sine, *fitted_cosine;  ///< those of the nearest fitted view
    float* log_cosine;                    ///< logarithm of fitted_cosine
    /// Place in a FitTable: the first of four rows, counted from the row of the view beyond the normal, and four cubic
    /// weights.
    std::uint32_t* row;
    float* weights;
};

/// cos_theta_o: `count` cosines; the array must hold finite numbers up to padded_views(count).
void find_views(const double* cos_theta_o, std::size_t count, const ViewOutput& out);

/// Output arrays for the members of BoostArrays, except the tilt.
struct BoostOutput {
    double *speed, *one_minus_speed, *gamma;
    double *horizon_x, *horizon_z;
    double *horizon_height, *horizon_sine;
};

/// The boosts of GGX lobes, as lobe_boost() with its narrowness rounded to float. alpha: width at each view, padded
/// like the views.
void boost_views(const float* alpha, const ViewOutput& views, std::size_t count, const BoostOutput& out);

/// Tables between which rows are interpolated: those of view i, and their weights, begin at count · i; one table serves
/// all views.
struct TableNeighbours {
    std::size_t count;
    const float* const* tables;
    const float* weights;
};

/// Interpolated rows: for each i of `views` the weighted sum of four rows of each neighbouring table, of which the
/// first `width` numbers are written to out + i · stride. width and stride: multiples of 16. out: aligned to 64 bytes.
void interpolate_views(const TableNeighbours& neighbours, std::size_t row_size, std::size_t width,
                       const std::uint32_t* rows, const float* weights, std::span<const std::uint32_t> views,
                       float* out, std::size_t stride);

}  // namespace shlight
