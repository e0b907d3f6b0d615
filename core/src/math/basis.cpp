// SPDX-License-Identifier: MIT
#include "shlight/basis.h"

#include <algorithm>
#include <vector>

#include "base/checks.h"
#include "math/basis_kernel.h"
#include "simd/dot_products.h"

namespace shlight {
namespace {

/// What is wrong with the directions, once a kernel has found that something is.
template <class T>
[[noreturn]] void reject_directions(std::span<const Vec3<T>> directions) {
    for (const Vec3<T>& direction : directions) {
        check_finite("directions", direction);
    }
    reject("directions contains a zero vector");
}

/// Directions whose basis is in the cache at a time.
constexpr std::size_t kBlock = 64;

}  // namespace

template <class T>
void sh_basis(const Vec3<T>& direction, int order, T* basis) {
    if (!basis_rows(&direction, 1, order, basis)) {
        reject_directions(std::span(&direction, 1));
    }
}

template <class T>
void sh_basis(std::span<const Vec3<T>> directions, int order, std::span<T> basis, Output output) {
    check_order(order);
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("basis", basis.size(), directions.size() * row);
    if (!basis_rows(directions.data(), directions.size(), order, basis.data(), output)) {
        reject_directions(directions);
    }
}

template <class T>
void evaluate(std::span<const T> coefficients, std::span<const Vec3<T>> directions, int order, std::span<T> values) {
    check_order(order);
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("coefficients", coefficients.size(), directions.size() * row);
    check_size("values", values.size(), directions.size());
    std::vector<T> basis(std::min(kBlock, directions.size()) * row);
    for (std::size_t first = 0; first < directions.size(); first += kBlock) {
        const auto block = directions.subspan(first, std::min(kBlock, directions.size() - first));
        if (!basis_rows(block.data(), block.size(), order, basis.data())) {
            reject_directions(block);
        }
        dot_products(coefficients.data() + first * row, basis.data(), row, block.size(), values.data() + first);
    }
}

template void sh_basis(const Vec3<float>&, int, float*);
template void sh_basis(const Vec3<double>&, int, double*);
template void sh_basis(std::span<const Vec3<float>>, int, std::span<float>, Output);
template void sh_basis(std::span<const Vec3<double>>, int, std::span<double>, Output);
template void evaluate(std::span<const float>, std::span<const Vec3<float>>, int, std::span<float>);
template void evaluate(std::span<const double>, std::span<const Vec3<double>>, int, std::span<double>);

}  // namespace shlight
