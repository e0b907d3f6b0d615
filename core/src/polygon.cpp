// SPDX-License-Identifier: MIT
#include "shlight/polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "checks.h"
#include "light_checks.h"
#include "polygon_boundary.h"
#include "polygon_cubature.h"
#include "polygon_shading.h"
#include "shlight/shading.h"
#include "spherical_polygon.h"

namespace shlight {
namespace {

/// Below this solid angle Ω the edges' contributions, each of order one, cancel to too few digits: their sum is wrong
/// by about 5e-16 / Ω of L_00, at the hand-over 5e-10 (float) and 5e-13 (double).
template <class T>
constexpr double kSmallestForBoundary = std::is_same_v<T, float> ? 1e-6 : 1e-3;

/// Up to this many points along a triangle's side cubature is the faster one.
constexpr int kFewPoints = 4;

template <class T>
PolygonMethod better_method(const SphericalPolygon<Wider<T>>& polygon, int order) {
    if (order <= 2) {
        return PolygonMethod::boundary;  // closed form
    }
    const bool cancels = polygon.solid_angle() < kSmallestForBoundary<T>;
    return cancels || cubature_points<T>(polygon, order) <= kFewPoints ? PolygonMethod::cubature
                                                                       : PolygonMethod::boundary;
}

template <class T>
void integrate(const SphericalPolygon<Wider<T>>& polygon, int order, T* coefficients, PolygonMethod method) {
    if (polygon.empty()) {
        std::fill_n(coefficients, coefficient_count(order), T(0));
        return;
    }
    if (method == PolygonMethod::automatic) {
        method = better_method<T>(polygon, order);
    }
    if (method == PolygonMethod::cubature) {
        polygon_by_cubature(polygon, order, coefficients);
    } else {
        region_coefficients(PolygonRegion<Wider<T>>(polygon, Warp()), order, coefficients);
    }
}

template <class T>
SphericalPolygon<Wider<T>> clipped(std::span<const Vec3<T>> vertices) {
    const std::vector<Vec3<Wider<T>>> exact(vertices.begin(), vertices.end());
    return {exact, true};
}

}  // namespace

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
    if (vertex_count < 3) {
        reject("vertices: a polygon needs at least 3, got " + std::to_string(vertex_count));
    }
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
    if (!warp.is_identity()) {
        return shade_region(PolygonRegion<Wider<T>>(polygon, warp), lobe_terms, order);
    }
    std::array<T, coefficient_count(kMaxOrder)> coefficients;
    integrate(polygon, order, coefficients.data(), PolygonMethod::automatic);
    return shade_cosine(coefficients.data(), lobe_terms, order);
}

template <class T>
T shade_polygon(std::span<const Vec3<T>> vertices, const Warp& warp, const T* lobe_terms, int order) {
    return shade_polygon(clipped<T>(vertices), warp, lobe_terms, order);
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
