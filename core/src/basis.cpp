// SPDX-License-Identifier: MIT
#include "shlight/basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "checks.h"
#include "legendre.h"

namespace shlight {
namespace {

template <class T>
Vec3<T> checked_direction(const Vec3<T>& direction) {
    check_finite("directions", direction);
    // Scaling by the largest component first keeps the squares of tiny and huge vectors in range.
    const T largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    if (!(largest > 0)) {
        reject("directions contains a zero vector");
    }
    return glm::normalize(direction / largest);
}

}  // namespace

template <class T>
void sh_basis(const Vec3<T>& direction, int order, T* basis) {
    std::array<T, kMaxOrder> cos_part;
    std::array<T, kMaxOrder> sin_part;
    complex_powers(direction.x, direction.y, order, cos_part.data(), sin_part.data());
    for (int m = 1; m < order; ++m) {
        cos_part[m] *= std::numbers::sqrt2_v<T>;
        sin_part[m] *= std::numbers::sqrt2_v<T>;
    }
    LegendreRows<T> legendre(direction.z, direction.x * direction.x + direction.y * direction.y);
    for (int l = 0;; legendre.advance()) {
        T* band = basis + coefficient_index(l, 0);
        band[0] = legendre[0];
        for (int m = 1; m <= l; ++m) {
            band[m] = legendre[m] * cos_part[m];
            band[-m] = legendre[m] * sin_part[m];
        }
        if (++l == order) {
            break;
        }
    }
}

template <class T>
void sh_basis(std::span<const Vec3<T>> directions, int order, std::span<T> basis) {
    check_order(order);
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("basis", basis.size(), directions.size() * row);
    for (std::size_t i = 0; i < directions.size(); ++i) {
        sh_basis(checked_direction(directions[i]), order, basis.data() + i * row);
    }
}

template <class T>
void evaluate(std::span<const T> coefficients, std::span<const Vec3<T>> directions, int order, std::span<T> values) {
    check_order(order);
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("coefficients", coefficients.size(), directions.size() * row);
    check_size("values", values.size(), directions.size());
    std::array<T, static_cast<std::size_t>(coefficient_count(kMaxOrder))> basis;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        sh_basis(checked_direction(directions[i]), order, basis.data());
        T sum = 0;
        for (std::size_t k = 0; k < row; ++k) {
            sum += coefficients[i * row + k] * basis[k];
        }
        values[i] = sum;
    }
}

template void sh_basis(const Vec3<float>&, int, float*);
template void sh_basis(const Vec3<double>&, int, double*);
template void sh_basis(std::span<const Vec3<float>>, int, std::span<float>);
template void sh_basis(std::span<const Vec3<double>>, int, std::span<double>);
template void evaluate(std::span<const float>, std::span<const Vec3<float>>, int, std::span<float>);
template void evaluate(std::span<const double>, std::span<const Vec3<double>>, int, std::span<double>);

}  // namespace shlight
