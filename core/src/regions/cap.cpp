// SPDX-License-Identifier: MIT
#include "shlight/cap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/checks.h"
#include "base/exact_sums.h"
#include "base/safe_length.h"
#include "regions/cap_kernels.h"
#include "regions/region_checks.h"

namespace shlight {
namespace {

std::size_t check_rows(std::size_t count, int order, std::size_t values) {
    check_order(order);
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("coefficients", values, count * row);
    return row;
}

/// fill(batch, first, size): sets as many caps, those from `first` on.
template <class T, class Fill>
void rows_of(std::size_t count, int order, bool clip, std::span<T> coefficients, Output output, const Fill& fill) {
    constexpr std::size_t kChunk = 1024;  // few enough for the cache
    const std::size_t row = check_rows(count, order, coefficients.size());
    CapBatch batch;
    for (std::size_t first = 0; first < count; first += kChunk) {
        const std::size_t size = std::min(kChunk, count - first);
        batch.resize(size);
        fill(batch, first, size);
        cap_rows(batch.arrays(), size, order, clip, coefficients.data() + first * row, output);
    }
}

}  // namespace

SphericalCap cap_of_sphere(const Vec3d& center, double radius) {
    const double scale = safe_scale(center);
    const Vec3d c = center * scale;
    const double r = radius * scale;
    const double tangent_squared = std::max(0.0, difference_of_squares({c.x, c.y, c.z}, r));
    const double inverse = 1 / glm::length(c);
    return {c * inverse, std::sqrt(tangent_squared) * inverse, std::min(1.0, r * inverse)};
}

SphericalCap cap_of_facing_disk(const Vec3d& center, double radius) {
    const double distance = safe_length(center);
    const double slant = std::hypot(distance, radius);
    return {center / distance, distance / slant, radius / slant};
}

SphericalCap cap_about_axis(const Vec3d& axis, double half_angle) {
    const double half = std::min(half_angle, std::numbers::pi);
    const Vec3d scaled = axis * safe_scale(axis);
    return {scaled / glm::length(scaled), std::cos(half), std::sin(half)};
}

template <class T>
void sphere_coefficients(std::span<const Vec3<T>> centers, std::span<const T> radii, int order, bool clip,
                         std::span<T> coefficients, Output output) {
    check_size("radii", radii.size(), centers.size());
    check_spheres(centers, radii, std::numeric_limits<T>::epsilon());
    if constexpr (sizeof(T) == 4) {
        check_rows(centers.size(), order, coefficients.size());
        cap_rows(SphereArrays{centers.data(), radii.data()}, centers.size(), order, clip, coefficients.data(), output);
        return;
    }
    rows_of(centers.size(), order, clip, coefficients, output,
            [&](CapBatch& batch, std::size_t first, std::size_t size) {
                batch.set_spheres(centers.subspan(first, size), radii.data() + first);
            });
}

template <class T>
void cap_coefficients(std::span<const Vec3<T>> axes, std::span<const T> half_angles, int order, bool clip,
                      std::span<T> coefficients, Output output) {
    check_size("half_angles", half_angles.size(), axes.size());
    rows_of(axes.size(), order, clip, coefficients, output, [&](CapBatch& batch, std::size_t first, std::size_t size) {
        for (std::size_t i = 0; i < size; ++i) {
            const Vec3d axis(axes[first + i]);
            check_cap(axis, half_angles[first + i]);
            batch.set(i, cap_about_axis(axis, half_angles[first + i]));
        }
    });
}

template <class T>
void cap_coefficients(std::span<const SphericalCap> caps, int order, bool clip, std::span<T> coefficients) {
    rows_of(caps.size(), order, clip, coefficients, Output::cached,
            [&](CapBatch& batch, std::size_t first, std::size_t size) {
                for (std::size_t i = 0; i < size; ++i) {
                    batch.set(i, caps[first + i]);
                }
            });
}

double clipped_solid_angle(const SphericalCap& cap) {
    double mean = 0;
    cap_coefficients<double>({&cap, 1}, 1, true, {&mean, 1});
    return mean * 2 / std::numbers::inv_sqrtpi;
}

template void sphere_coefficients(std::span<const Vec3<float>>, std::span<const float>, int, bool, std::span<float>,
                                  Output);
template void sphere_coefficients(std::span<const Vec3<double>>, std::span<const double>, int, bool, std::span<double>,
                                  Output);
template void cap_coefficients(std::span<const Vec3<float>>, std::span<const float>, int, bool, std::span<float>,
                               Output);
template void cap_coefficients(std::span<const Vec3<double>>, std::span<const double>, int, bool, std::span<double>,
                               Output);
template void cap_coefficients(std::span<const SphericalCap>, int, bool, std::span<float>);
template void cap_coefficients(std::span<const SphericalCap>, int, bool, std::span<double>);

}  // namespace shlight
