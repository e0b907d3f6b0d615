// SPDX-License-Identifier: MIT
#include "shlight/cap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/checks.h"
#include "base/safe_length.h"
#include "caps/cap_checks.h"
#include "caps/cap_kernel.h"

namespace shlight {
namespace {

constexpr double kPi = std::numbers::pi;

/// Prepared in double, whatever T.
template <class T>
Cap<T> rounded(const Cap<double>& cap) {
    const auto r = [](double x) { return static_cast<T>(x); };
    return {r(cap.cos_tilt),    r(cap.sin_tilt), r(cap.cos_azimuth),    r(cap.sin_azimuth), r(cap.cos_half),
            r(cap.sin_half),    r(cap.arc),      r(cap.cos_arc),        r(cap.sin_arc),     r(cap.edge),
            r(cap.solid_angle), cap.crossing,    r(cap.horizon_height), r(cap.horizon_sine)};
}

}  // namespace

template <class T>
Cap<T> Cap<T>::of_sphere(const Vec3d& center, double radius, const Warp& warp) {
    const double distance = safe_length(center);
    const double crossing_squared = ((radius - center.z) / distance) * ((radius + center.z) / distance);
    return rounded<T>(cap_inside(circle_of_sphere(center, radius), crossing_squared, warp));
}

template <class T>
Cap<T> Cap<T>::of_facing_disk(const Vec3d& center, double radius, const Warp& warp) {
    return inside(circle_of_facing_disk(center, radius), warp);
}

template <class T>
Cap<T> Cap<T>::about_axis(const Vec3d& axis, double half_angle, const Warp& warp) {
    return inside(circle_about_axis(axis, half_angle), warp);
}

template <class T>
Cap<T> Cap<T>::inside(const Circle& circle, const Warp& warp) {
    return rounded<T>(cap_inside(circle, warp));
}

template <class T>
Cap<T> Cap<T>::against(double horizon_height, double horizon_sine, const Vec3d& axis, double half_angle) {
    const double sigma = std::min(half_angle, kPi);
    const double theta = std::atan2(std::hypot(axis.x, axis.y), axis.z);
    const double eta = std::atan2(horizon_sine, horizon_height);
    // The half-angle formulas of the triangle with the sides θ, σ, η: four sines give everything.
    const double whole = std::sin((theta + sigma + eta) / 2);
    const double less_theta = std::sin((sigma + eta - theta) / 2);
    const double less_sigma = std::sin((theta + eta - sigma) / 2);
    const double less_eta = std::sin((theta + sigma - eta) / 2);
    const double nested = whole * less_theta;
    const double apart = less_sigma * less_eta;
    const double chord = 2 * std::sqrt(std::max(0.0, nested * apart));
    return rounded<T>(cap_in_contact({{axis / safe_length(axis), std::cos(sigma), std::sin(sigma)},
                                      horizon_height,
                                      horizon_sine,
                                      chord,
                                      nested - apart,
                                      whole * less_sigma - less_theta * less_eta,
                                      whole * less_eta - less_theta * less_sigma}));
}

template <class T>
Cap<T> Cap<T>::unclipped() const {
    Cap whole = *this;
    const T lack = cos_half > 0 ? sin_half * sin_half / (1 + cos_half) : 1 - cos_half;
    whole.arc = 0;
    whole.edge = std::numbers::pi_v<T>;
    whole.solid_angle = 2 * std::numbers::pi_v<T> * lack;
    whole.crossing = false;
    return whole;
}

template <class T>
void clipped_cap_terms(const Cap<T>& cap, int order, T* cosine_terms) {
    terms_of_cap(cap, order, cosine_terms);
}

template <class T>
T shade_cap(const Cap<T>& cap, const T* lobe_terms, int order) {
    return cap.solid_angle > 0 ? shade_one_cap(cap, lobe_terms, order) : T(0);
}

template <class T>
void cap_coefficients(const Cap<T>& cap, int order, bool clip, T* coefficients) {
    row_of_cap(clip ? cap : cap.unclipped(), order, coefficients);
}

template <class T>
void sphere_coefficients(std::span<const Vec3<T>> centers, std::span<const T> radii, int order, bool clip,
                         std::span<T> coefficients, Output output) {
    check_order(order);
    check_size("radii", radii.size(), centers.size());
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("coefficients", coefficients.size(), centers.size() * row);
    check_spheres(centers, radii, std::numeric_limits<T>::epsilon());
    sphere_rows(centers.data(), radii.data(), centers.size(), order, clip, coefficients.data(), output);
}

template <class T>
void cap_coefficients(std::span<const Vec3<T>> axes, std::span<const T> half_angles, int order, bool clip,
                      std::span<T> coefficients, Output output) {
    check_order(order);
    check_size("half_angles", half_angles.size(), axes.size());
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("coefficients", coefficients.size(), axes.size() * row);
    std::array<Circle, 256> circles;
    for (std::size_t first = 0; first < axes.size(); first += circles.size()) {
        const std::size_t count = std::min(circles.size(), axes.size() - first);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3d axis(axes[first + i]);
            check_cap(axis, half_angles[first + i]);
            circles[i] = circle_about_axis(axis, half_angles[first + i]);
        }
        circle_rows(circles.data(), count, order, clip, coefficients.data() + first * row, output);
    }
}

template struct Cap<float>;
template struct Cap<double>;
template void clipped_cap_terms(const Cap<float>&, int, float*);
template void clipped_cap_terms(const Cap<double>&, int, double*);
template float shade_cap(const Cap<float>&, const float*, int);
template double shade_cap(const Cap<double>&, const double*, int);
template void cap_coefficients(const Cap<float>&, int, bool, float*);
template void cap_coefficients(const Cap<double>&, int, bool, double*);
template void sphere_coefficients(std::span<const Vec3<float>>, std::span<const float>, int, bool, std::span<float>,
                                  Output);
template void sphere_coefficients(std::span<const Vec3<double>>, std::span<const double>, int, bool, std::span<double>,
                                  Output);
template void cap_coefficients(std::span<const Vec3<float>>, std::span<const float>, int, bool, std::span<float>,
                               Output);
template void cap_coefficients(std::span<const Vec3<double>>, std::span<const double>, int, bool, std::span<double>,
                               Output);

}  // namespace shlight
