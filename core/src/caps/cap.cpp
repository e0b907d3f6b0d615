// SPDX-License-Identifier: MIT
#include "shlight/cap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/checks.h"
#include "caps/cap_checks.h"
#include "caps/cap_rows.h"

namespace shlight {
namespace {

std::size_t check_rows(std::size_t count, int order, std::size_t values) {
    check_order(order);
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("coefficients", values, count * row);
    return row;
}

/// fill(batch, first, size): sets as many circles, those of the caps from `first` on.
template <class T, class Fill>
void rows_of(std::size_t count, int order, bool clip, std::span<T> coefficients, Output output, const Fill& fill) {
    constexpr std::size_t kChunk = 1024;  // few enough for the cache
    const std::size_t row = check_rows(count, order, coefficients.size());
    CircleBatch batch;
    for (std::size_t first = 0; first < count; first += kChunk) {
        const std::size_t size = std::min(kChunk, count - first);
        batch.resize(size);
        fill(batch, first, size);
        cap_rows(batch.arrays(), size, order, clip, coefficients.data() + first * row, output);
    }
}

}  // namespace

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
            [&](CircleBatch& batch, std::size_t first, std::size_t size) {
                batch.set_spheres(centers.subspan(first, size), radii.data() + first);
            });
}

template <class T>
void cap_coefficients(std::span<const Vec3<T>> axes, std::span<const T> half_angles, int order, bool clip,
                      std::span<T> coefficients, Output output) {
    check_size("half_angles", half_angles.size(), axes.size());
    rows_of(axes.size(), order, clip, coefficients, output,
            [&](CircleBatch& batch, std::size_t first, std::size_t size) {
                for (std::size_t i = 0; i < size; ++i) {
                    const Vec3d axis(axes[first + i]);
                    check_cap(axis, half_angles[first + i]);
                    batch.set(i, circle_about_axis(axis, half_angles[first + i]));
                }
            });
}

template <class T>
void circle_coefficients(std::span<const Circle> circles, int order, bool clip, std::span<T> coefficients) {
    rows_of(circles.size(), order, clip, coefficients, Output::cached,
            [&](CircleBatch& batch, std::size_t first, std::size_t size) {
                for (std::size_t i = 0; i < size; ++i) {
                    batch.set(i, circles[first + i]);
                }
            });
}

double clipped_solid_angle(const Circle& circle) {
    double mean = 0;
    circle_coefficients<double>({&circle, 1}, 1, true, {&mean, 1});
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
template void circle_coefficients(std::span<const Circle>, int, bool, std::span<float>);
template void circle_coefficients(std::span<const Circle>, int, bool, std::span<double>);

}  // namespace shlight
