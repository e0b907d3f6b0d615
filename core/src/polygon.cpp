// SPDX-License-Identifier: MIT
#include "shlight/polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "checks.h"
#include "light_checks.h"
#include "polygon_boundary.h"
#include "polygon_cubature.h"
#include "polygon_edge_points.h"
#include "polygon_low_bands.h"
#include "polygon_shading.h"
#include "shlight/shading.h"
#include "spherical_polygon.h"

namespace shlight {
namespace {

/// Below this solid angle Ω the recurrences' contributions, each of order one, cancel to too few digits: their sum is
/// wrong by about 5e-16 / Ω of L_00.
template <class T>
constexpr double kSmallestForBoundary = std::is_same_v<T, float> ? 1e-6 : 1e-3;

/// Closed forms lose as much, in the wider type.
constexpr double kSmallestForClosedForm = 1e-8;

/// Below this ratio of solid angle to length of outline Gauss points on the edges, too, cancel to too few digits: their
/// sum is wrong by about 1e-15 of L_00 ÷ that ratio.
template <class T>
constexpr double kNarrowestForEdges = std::is_same_v<T, float> ? 1e-9 : 2e-3;

/// Up to this order Gauss points on the edges are faster than the edges' recurrences, however many it takes.
constexpr int kEdgePointsUpTo = 8;
/// Up to this many points on an edge they are faster at any order; more where they feed one number.
constexpr int kPointsForCoefficients = 15;
constexpr int kPointsForShading = 22;
/// Times as many where they go through the recurrences in float.
constexpr double kFloatGain = 1.8;

template <class T>
bool edge_points_are_better(const PolygonRegion<Wider<T>>& region, int order, int points) {
    if (order <= 2) {
        return false;  // closed form, without either
    }
    if (order <= kEdgePointsUpTo || region.solid_angle() < kSmallestForBoundary<T>) {
        return true;
    }
    const double limit = edge_points_in_float<T>(region) ? kFloatGain * points : points;
    return edge_points<T>(region, order) <= limit * static_cast<double>(region.arcs().size());
}

template <class T>
bool is_narrow(const SphericalPolygon<Wider<T>>& polygon, const PolygonRegion<Wider<T>>& region) {
    return polygon.solid_angle() < kNarrowestForEdges<T> * region.outline();
}

template <class T>
void integrate(const SphericalPolygon<Wider<T>>& polygon, int order, T* coefficients, PolygonMethod method) {
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
    } else if (method == PolygonMethod::edge_points) {
        edge_point_coefficients(region, order, coefficients);
    } else if (order > 2 && is_narrow<T>(polygon, region)) {  // up to order 2 there is a closed form
        polygon_by_cubature(polygon, order, coefficients);
    } else if (order <= kLowOrder && polygon.solid_angle() > kSmallestForClosedForm) {
        low_band_coefficients(region, order, coefficients);
    } else {
        region_coefficients(region, order, coefficients);
    }
}

template <class T>
SphericalPolygon<Wider<T>> clipped(std::span<const Vec3<T>> vertices) {
    const std::vector<Vec3<Wider<T>>> exact(vertices.begin(), vertices.end());
    return {exact, true};
}

}  // namespace

template <class T>
void region_coefficients(const PolygonRegion<Wider<T>>& region, int order, T* coefficients) {
    if (edge_points_are_better<T>(region, order, kPointsForCoefficients)) {
        edge_point_coefficients(region, order, coefficients);
    } else {
        boundary_coefficients(region, order, coefficients);
    }
}

template <class T>
T shade_region(const PolygonRegion<Wider<T>>& region, const T* lobe_terms, int order) {
    return edge_points_are_better<T>(region, order, kPointsForShading) ? shade_by_edge_points(region, lobe_terms, order)
                                                                       : shade_by_boundary(region, lobe_terms, order);
}

template <class T>
void polygon_coefficients(std::span<const Vec3<T>> vertices, int order, bool clip, T* coefficients,
                          PolygonMethod method) {
    const std::vector<Vec3<Wider<T>>> exact(vertices.begin(), vertices.end());
    integrate(SphericalPolygon<Wider<T>>(exact, clip), order, coefficients, method);
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
    std::vector<Vec3<Wider<T>>> exact(k);
    for (std::size_t i = 0; i < count; ++i) {
        const auto polygon = vertices.subspan(i * k, k);
        std::transform(polygon.begin(), polygon.end(), exact.begin(),
                       [](const Vec3<T>& v) { return Vec3<Wider<T>>(v); });
        check_polygon<T>(exact);
        integrate(SphericalPolygon<Wider<T>>(exact, clip), order, coefficients.data() + i * row, method);
    }
}

template <class T>
void warped_polygon_coefficients(std::span<const Vec3<T>> vertices, const Warp& warp, int order, T* coefficients) {
    const SphericalPolygon<Wider<T>> polygon = clipped<T>(vertices);
    if (warp.is_identity()) {
        integrate(polygon, order, coefficients, PolygonMethod::automatic);
    } else {
        region_coefficients(PolygonRegion<Wider<T>>(polygon, warp), order, coefficients);
    }
}

template <class T>
T shade_polygon(const SphericalPolygon<Wider<T>>& polygon, const Warp& warp, const T* lobe_terms, int order) {
    const PolygonRegion<Wider<T>> region(polygon, warp);
    if (!warp.is_identity() || order <= 2 || !is_narrow<T>(polygon, region)) {
        return shade_region(region, lobe_terms, order);
    }
    std::array<T, coefficient_count(kMaxOrder)> coefficients;
    polygon_by_cubature(polygon, order, coefficients.data());
    return shade_cosine(coefficients.data(), lobe_terms, order);
}

template <class T>
T shade_polygon(std::span<const Vec3<T>> vertices, const Warp& warp, const T* lobe_terms, int order) {
    return shade_polygon(clipped<T>(vertices), warp, lobe_terms, order);
}

template void region_coefficients(const PolygonRegion<double>&, int, float*);
template void region_coefficients(const PolygonRegion<long double>&, int, double*);
template float shade_region(const PolygonRegion<double>&, const float*, int);
template double shade_region(const PolygonRegion<long double>&, const double*, int);
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
