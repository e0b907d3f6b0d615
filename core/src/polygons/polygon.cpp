// SPDX-License-Identifier: MIT
#include "shlight/polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "base/checks.h"
#include "polygons/polygon_boundary.h"
#include "polygons/polygon_checks.h"
#include "polygons/polygon_cubature.h"
#include "polygons/polygon_edge_points.h"
#include "polygons/polygon_low_bands.h"
#include "polygons/polygon_rows.h"
#include "polygons/polygon_shading.h"
#include "polygons/spherical_polygon.h"
#include "shlight/shading.h"

namespace shlight {
namespace {

/// Closed forms lose as much, in the wider type.
constexpr double kSmallestForClosedForm = 1e-8;

/// Below this ratio of solid angle to length of outline Gauss points on the edges, too, cancel to too few digits: their
/// sum is wrong by about 1e-15 of L_00 ÷ that ratio.
template <class T>
constexpr double kNarrowestForEdges = std::is_same_v<T, float> ? 1e-9 : 2e-3;

template <class T>
bool is_narrow(const SphericalPolygon<Wider<T>>& polygon, const PolygonRegion<Wider<T>>& region) {
    return polygon.solid_angle() < kNarrowestForEdges<T> * region.outline();
}

/// points(region, coefficients) is what takes Gauss points.
template <class T, class Points>
void integrate(const SphericalPolygon<Wider<T>>& polygon, int order, T* coefficients, PolygonMethod method,
               const Points& points) {
    if (polygon.empty()) {
        std::fill_n(coefficients, coefficient_count(order), T(0));
        return;
    }
    if (method == PolygonMethod::cubature) {
        polygon_by_cubature(polygon, order, coefficients);
        return;
    }
    if (order == 1) {
        *coefficients = static_cast<T>(polygon.solid_angle() * std::sqrt(1 / (4 * std::numbers::pi_v<Wider<T>>)));
        return;
    }
    const PolygonRegion<Wider<T>> region(polygon, Warp());
    if (method == PolygonMethod::boundary) {
        boundary_coefficients(region, order, coefficients);
        return;
    }
    const bool automatic = method == PolygonMethod::automatic;
    if (automatic && order > 2 && is_narrow<T>(polygon, region)) {  // up to order 2 there is a closed form
        polygon_by_cubature(polygon, order, coefficients);
    } else if (automatic && order <= kLowOrder && polygon.solid_angle() > kSmallestForClosedForm) {
        low_band_coefficients(region, order, coefficients);
    } else {
        points(region, coefficients);
    }
}

template <class T>
void integrate(const SphericalPolygon<Wider<T>>& polygon, int order, T* coefficients, PolygonMethod method) {
    integrate(polygon, order, coefficients, method,
              [order](const PolygonRegion<Wider<T>>& region, T* to) { edge_point_coefficients(region, order, to); });
}

template <class T>
SphericalPolygon<Wider<T>> spherical(std::span<const Vec3<T>> vertices, bool clip) {
    const std::vector<Vec3<Wider<T>>> exact(vertices.begin(), vertices.end());
    return {exact, clip};
}

template <class T>
void check_each(std::span<const Vec3<T>> vertices, std::size_t vertex_count) {
    std::vector<Vec3<Wider<T>>> exact(vertex_count);
    for (std::size_t first = 0; first < vertices.size(); first += vertex_count) {
        std::copy_n(vertices.begin() + static_cast<std::ptrdiff_t>(first), vertex_count, exact.begin());
        check_polygon<T>(exact);
    }
}

/// In lanes, and one by one what is too narrow for them. checked: the vertices have been checked before.
void automatic_coefficients(std::span<const Vec3f> vertices, std::size_t vertex_count, int order, bool clip,
                            float* coefficients, bool checked) {
    const std::vector<Vec3d> exact(vertices.begin(), vertices.end());
    const auto k = static_cast<int>(vertex_count);
    if (!checked) {
        check_polygons(vertices, exact, k);
    }
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    for (const std::uint32_t i : polygon_rows(exact, k, order, clip, coefficients)) {
        integrate(spherical(vertices.subspan(i * vertex_count, vertex_count), clip), order, coefficients + i * row,
                  PolygonMethod::automatic);
    }
}

/// One polygon after the other is taken apart in extended precision, and many give their arcs to the lanes.
void automatic_coefficients(std::span<const Vec3d> vertices, std::size_t vertex_count, int order, bool clip,
                            double* coefficients, bool checked) {
    if (!checked) {
        check_each(vertices, vertex_count);
    }
    constexpr std::size_t kChunk = 128;
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    const std::size_t count = vertices.size() / vertex_count;
    ArcLists<double> arcs;
    for (std::size_t first = 0; first < count; first += kChunk) {
        double* const rows = coefficients + first * row;
        arcs.clear();
        for (std::size_t i = 0; i < std::min(kChunk, count - first); ++i) {
            const auto polygon = vertices.subspan((first + i) * vertex_count, vertex_count);
            integrate(spherical(polygon, clip), order, rows + i * row, PolygonMethod::automatic,
                      [&](const PolygonRegion<long double>& region, double* to) {
                          start_edge_points(region, order, i, arcs, to);
                      });
        }
        add_arc_coefficients(arcs, true, order, rows);
    }
}

}  // namespace

template <class T>
void polygon_coefficients(std::span<const Vec3<T>> vertices, int order, bool clip, T* coefficients,
                          PolygonMethod method) {
    if (method == PolygonMethod::automatic) {
        automatic_coefficients(vertices, vertices.size(), order, clip, coefficients, true);
    } else {
        integrate(spherical(vertices, clip), order, coefficients, method);
    }
}

template <class T>
void polygon_coefficients(std::span<const Vec3<T>> vertices, int vertex_count, int order, bool clip,
                          std::span<T> coefficients, PolygonMethod method) {
    check_order(order);
    check_vertex_count(vertex_count);
    const auto k = static_cast<std::size_t>(vertex_count);
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    const std::size_t count = vertices.size() / k;
    check_size("vertices", vertices.size(), count * k);
    check_size("coefficients", coefficients.size(), count * row);
    if (method == PolygonMethod::automatic) {
        automatic_coefficients(vertices, k, order, clip, coefficients.data(), false);
        return;
    }
    check_each(vertices, k);
    for (std::size_t i = 0; i < count; ++i) {
        integrate(spherical(vertices.subspan(i * k, k), clip), order, coefficients.data() + i * row, method);
    }
}

template <class T>
void warped_polygon_coefficients(std::span<const Vec3<T>> vertices, const Warp& warp, int order, T* coefficients) {
    if (warp.is_identity()) {
        polygon_coefficients(vertices, order, true, coefficients, PolygonMethod::automatic);
    } else {
        edge_point_coefficients(PolygonRegion<Wider<T>>(spherical(vertices, true), warp), order, coefficients);
    }
}

template <class T>
T shade_polygon(const SphericalPolygon<Wider<T>>& polygon, const Warp& warp, const T* lobe_terms, int order) {
    const PolygonRegion<Wider<T>> region(polygon, warp);
    if (!warp.is_identity() || order <= 2 || !is_narrow<T>(polygon, region)) {
        return shade_by_edge_points(region, lobe_terms, order);
    }
    std::array<T, coefficient_count(kMaxOrder)> coefficients;
    polygon_by_cubature(polygon, order, coefficients.data());
    return shade_cosine(coefficients.data(), lobe_terms, order);
}

template <class T>
T shade_polygon(std::span<const Vec3<T>> vertices, const Warp& warp, const T* lobe_terms, int order) {
    return shade_polygon(spherical(vertices, true), warp, lobe_terms, order);
}

template void polygon_coefficients(std::span<const Vec3f>, int, bool, float*, PolygonMethod);
template void polygon_coefficients(std::span<const Vec3d>, int, bool, double*, PolygonMethod);
template void polygon_coefficients(std::span<const Vec3f>, int, int, bool, std::span<float>, PolygonMethod);
template void polygon_coefficients(std::span<const Vec3d>, int, int, bool, std::span<double>, PolygonMethod);
template void warped_polygon_coefficients(std::span<const Vec3f>, const Warp&, int, float*);
template void warped_polygon_coefficients(std::span<const Vec3d>, const Warp&, int, double*);
template float shade_polygon(const SphericalPolygon<double>&, const Warp&, const float*, int);
template double shade_polygon(const SphericalPolygon<long double>&, const Warp&, const double*, int);
template float shade_polygon(std::span<const Vec3f>, const Warp&, const float*, int);
template double shade_polygon(std::span<const Vec3d>, const Warp&, const double*, int);

}  // namespace shlight
