// SPDX-License-Identifier: MIT
#include "shlight/sphere_gradient.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/checks.h"
#include "regions/cap_motion.h"
#include "shlight/cap.h"

namespace shlight {
namespace {

/// 1/x, finite for 0, where it is 0, and for the smallest numbers.
template <class T>
T bounded_inverse(double x) {
    constexpr double kLargestInverse = double{std::numeric_limits<T>::max()} / 1e6;
    return static_cast<T>(x > 0 ? std::min(1 / x, kLargestInverse) : 0);
}

template <class T>
CapMotion<T> motion_of(const Vec3<T>& center, T radius, bool clip) {
    const Vec3d c(center);
    const double r = radius;
    const SphericalCap cap = cap_of_sphere(c, r);
    const double distance = r / cap.sine;
    const Vec3<T> axis(cap.axis);
    CapMotion<T> motion{axis.x,
                        axis.y,
                        axis.z,
                        bounded_inverse<T>(distance),
                        bounded_inverse<T>(distance * cap.cosine),
                        bounded_inverse<T>(r * cap.cosine),
                        1,
                        0,
                        1,
                        0,
                        0,
                        0};
    if (clip && std::abs(c.z) < r) {
        // Eq. 8 of docs/theory.md, for radii of any size.
        const double height = std::abs(c.z);
        const double chord = cap.sine * std::sqrt((r - height) / r * (1 + height / r));
        const double across = std::hypot(chord, cap.cosine);
        const double radial = std::hypot(cap.axis.x, cap.axis.y);
        motion.azimuth_cosine = static_cast<T>(radial > 0 ? cap.axis.x / radial : 1);
        motion.azimuth_sine = static_cast<T>(radial > 0 ? cap.axis.y / radial : 0);
        motion.cut_cosine = static_cast<T>(across > 0 ? cap.cosine / across : 0);
        motion.cut_sine = static_cast<T>(across > 0 ? chord / across : 1);
        motion.cut = static_cast<T>(std::atan2(chord, cap.cosine));
    }
    return motion;
}

}  // namespace

template <class T>
void sphere_coefficients_gradient(std::span<const Vec3<T>> centers, std::span<const T> radii, int order, bool clip,
                                  std::span<T> coefficients, std::span<T> by_center, std::span<T> by_radius) {
    check_order(order);
    if (order > kMaxGradientOrder) {
        reject("order must be 1 … " + std::to_string(kMaxGradientOrder) + " with derivatives");
    }
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    const auto longer = static_cast<std::size_t>(coefficient_count(order + 1));
    check_size("radii", radii.size(), centers.size());
    check_size("coefficients", coefficients.size(), centers.size() * row);
    check_size("by_center", by_center.size(), centers.size() * row * 3);
    check_size("by_radius", by_radius.size(), centers.size() * row);
    constexpr std::size_t kNumbers = 32768;  // few enough for the cache
    const std::size_t chunk = std::max<std::size_t>(16, kNumbers / longer / 16 * 16);
    std::vector<T> rows(std::min(chunk, centers.size()) * longer + 4);
    std::vector<CapMotion<T>> caps;
    for (std::size_t first = 0; first < centers.size(); first += chunk) {
        const std::size_t count = std::min(chunk, centers.size() - first);
        const auto c = centers.subspan(first, count);
        const auto r = radii.subspan(first, count);
        sphere_coefficients(c, r, order + 1, clip, std::span(rows).first(count * longer));
        caps.clear();
        for (std::size_t i = 0; i < count; ++i) {
            caps.push_back(motion_of(c[i], r[i], clip));
            std::copy_n(rows.data() + i * longer, row, coefficients.data() + (first + i) * row);
        }
        write_cap_motion(caps.data(), count, order, rows.data(), by_center.data() + first * row * 3,
                         by_radius.data() + first * row);
    }
}

template void sphere_coefficients_gradient(std::span<const Vec3f>, std::span<const float>, int, bool, std::span<float>,
                                           std::span<float>, std::span<float>);
template void sphere_coefficients_gradient(std::span<const Vec3d>, std::span<const double>, int, bool,
                                           std::span<double>, std::span<double>, std::span<double>);

}  // namespace shlight
