// SPDX-License-Identifier: MIT
#include "shlight/basis.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include "base/checks.h"
#include "base/unit_direction.h"
#include "math/basis_kernel.h"
#include "simd/dot_products.h"

namespace shlight {
namespace {

/// basis_rows() for directions of any length: where their squares leave T's range they are normalised in double.
template <class T>
void rows_of_directions(std::span<const Vec3<T>> directions, int order, T* basis, Output output = Output::cached) {
    if (basis_rows(directions.data(), directions.size(), order, basis, output)) {
        return;
    }
    std::vector<Vec3<T>> units;
    std::transform(directions.begin(), directions.end(), std::back_inserter(units),
                   [](const Vec3<T>& direction) { return Vec3<T>(unit_direction(Vec3d(direction), "directions")); });
    basis_rows(units.data(), units.size(), order, basis, output);
}

/// Number of directions whose basis is in the cache at a time.
constexpr std::size_t kBlock = 64;

}  // namespace

template <class T>
void sh_basis(const Vec3<T>& direction, int order, T* basis) {
    rows_of_directions(std::span(&direction, 1), order, basis);
}

template <class T>
void sh_basis(std::span<const Vec3<T>> directions, int order, std::span<T> basis, Output output) {
    check_order(order);
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("basis", basis.size(), directions.size() * row);
    rows_of_directions(directions, order, basis.data(), output);
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
        rows_of_directions(block, order, basis.data());
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
