// SPDX-License-Identifier: MIT
//
// Kernels over many polygons: coefficients, their product with lobes without the coefficients (Eq. 5), extents.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "shlight/types.h"
#include "simd/lobe_arrays.h"

namespace shlight {

/// Polygons of vertex_count vertices each, in double, one after the other.
struct PolygonArray {
    const double* vertices;
    std::size_t vertex_count;
};

/// order² coefficients of each polygon, to the precision of T, float or double.
/// vertices: as polygon_coefficients has them.
template <class T>
void polygon_rows(std::span<const Vec3d> vertices, int vertex_count, int order, bool clip, T* rows);

/// order² coefficients of a polygon by Gauss cubature on its triangles, to the precision of double for every size and
/// shape. Slow where the polygon is large: for those whose edges would cancel (docs/theory.md, 4.6).
/// vertices: as polygon_coefficients has them, seen neither edge-on nor without area.
template <class T>
void polygon_by_cubature(std::span<const Vec3d> vertices, int order, bool clip, T* coefficients);

/// values[i] = Σ f_lm L_lm of polygon polygon_of[i], clipped by the horizon, under the lobe at view view_of[i].
/// vertices: vertex_count for each polygon, planar, finite, in the shading frame, before any boost.
/// No value depends on what else is in the lists.
void shade_polygons(std::span<const Vec3d> vertices, int vertex_count, std::span<const std::uint32_t> polygon_of,
                    const LobeArrays& lobe, std::span<const std::uint32_t> view_of, std::span<float> values);

/// Polygons as directions, and their half angles: negative where nothing is seen.
struct PolygonArrays {
    const double *x, *y, *z;
    const double* half_angle;
};

/// One for each polygon.
struct PolygonExtents {
    std::span<double> x, y, z;     ///< a unit vector in the middle of the vertices that the horizon leaves
    std::span<double> half_angle;  ///< the longest chord from there to one of them; negative if nothing is seen
};

/// The polygons as directions above the horizon. Nothing is seen of one that lies below it, is seen edge-on or has no
/// area.
void polygon_extents(std::span<const Vec3d> vertices, int vertex_count, const PolygonExtents& extents);

}  // namespace shlight
