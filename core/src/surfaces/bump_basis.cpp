// SPDX-License-Identifier: MIT
#include "surfaces/bump_basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>
#include <variant>

#include <glm/geometric.hpp>

#include "shlight/basis.h"

namespace shlight {
namespace {

/// Angles between the normals that the table has, from 0 to a right angle.
constexpr std::size_t kLeans = 33;
/// Steps of the integrals from the pole to the horizon, half as many as around it.
constexpr int kSteps = 48;
constexpr double kLeastSine = 1e-6;

constexpr std::size_t kAxes = kRecordOrder;
/// For each band l the weights of l + 1 axes.
using AxisWeights = std::array<std::array<double, kAxes>, kRecordOrder>;

/// An axis in the plane of the normals: so many fifths of a half turn from the bump's normal z towards x.
const Vec3d& axis(std::size_t number) {
    static const auto kDirections = [] {
        std::array<Vec3d, kAxes> list;
        for (std::size_t k = 0; k < kAxes; ++k) {
            const double angle = static_cast<double>(k) * std::numbers::pi / static_cast<double>(kAxes);
            list[k] = {std::sin(angle), 0, std::cos(angle)};
        }
        return list;
    }();
    return kDirections[number];
}

using Terms = std::array<double, kRecordTerms>;

Terms harmonics(const Vec3d& direction) {
    Terms basis;
    sh_basis(direction, kRecordOrder, basis.data());
    return basis;
}

/// The cosine terms of a lobe whose smooth normal leans from its own by an angle.
Terms projected(const DiffuseShape& shape, double lean) {
    const Vec3d smooth(std::sin(lean), 0, std::cos(lean));
    Terms sums{};
    for (int i = 0; i < kSteps; ++i) {
        const double z = (i + 0.5) / kSteps, radius = std::sqrt(1 - z * z);
        for (int j = 0; j < 2 * kSteps; ++j) {
            const double angle = (j + 0.5) * std::numbers::pi / kSteps;
            const Vec3d direction(radius * std::cos(angle), radius * std::sin(angle), z);
            const Terms basis = harmonics(direction);
            const double value = shape.value(direction, smooth) * std::numbers::pi / (kSteps * kSteps);
            for (std::size_t k = 0; k < kRecordTerms; ++k) {
                sums[k] += value * basis[k];
            }
        }
    }
    return sums;
}

/// Solves for the axes' weights in a band by elimination.
std::array<double, kAxes> solved(std::size_t l, const Terms& terms) {
    std::array<std::array<double, kAxes + 1>, kAxes> rows{};
    const std::size_t count = l + 1, first = l * l + l;
    for (std::size_t k = 0; k < count; ++k) {
        const Terms basis = harmonics(axis(k));
        for (std::size_t m = 0; m < count; ++m) {
            rows[m][k] = basis[first + m];
            rows[m][kAxes] = terms[first + m];
        }
    }
    for (std::size_t k = 0; k < count; ++k) {
        const auto largest = std::max_element(
            rows.begin() + static_cast<std::ptrdiff_t>(k), rows.begin() + static_cast<std::ptrdiff_t>(count),
            [k](const auto& a, const auto& b) { return std::abs(a[k]) < std::abs(b[k]); });
        std::swap(rows[k], *largest);
        for (std::size_t m = 0; m < count; ++m) {
            const double factor = m == k ? 0 : rows[m][k] / rows[k][k];
            for (std::size_t i = k; i <= kAxes; ++i) {
                rows[m][i] -= factor * rows[k][i];
            }
        }
    }
    std::array<double, kAxes> weights{};
    for (std::size_t k = 0; k < count; ++k) {
        weights[k] = rows[k][kAxes] / rows[k][k];
    }
    return weights;
}

std::array<AxisWeights, kLeans> weights_of(const DiffuseShape& shape) {
    std::array<AxisWeights, kLeans> table;
    for (std::size_t i = 0; i < kLeans; ++i) {
        const double lean = std::min(static_cast<double>(i) / (kLeans - 1), 0.999) * std::numbers::pi / 2;
        const Terms terms = projected(shape, lean);
        for (std::size_t l = 0; l < kRecordOrder; ++l) {
            table[i][l] = solved(l, terms);
        }
    }
    return table;
}

const std::array<AxisWeights, kLeans>& table_of(const DiffuseShape& shape) {
    if (shape.kind == Diffuse::bumped_cubic) {
        static const auto kCubic = weights_of({Diffuse::bumped_cubic});
        return kCubic;
    }
    static const auto kGgx = weights_of({Diffuse::bumped_ggx});
    return kGgx;
}

}  // namespace

std::optional<RecordBasis> bumped_basis(const LobeShape& shape, const Vec3d& normal, const Vec3d& smooth) {
    if (!is_bumped(shape)) {
        return std::nullopt;
    }
    const double cosine = std::clamp(glm::dot(normal, smooth), 0.0, 1.0);
    const Vec3d aside = smooth - cosine * normal;
    const double sine = glm::length(aside);
    const Vec3d across = aside / std::max(sine, kLeastSine);
    const double place = std::atan2(sine, cosine) * (kLeans - 1) / (std::numbers::pi / 2);
    const std::size_t number = std::min(static_cast<std::size_t>(place), kLeans - 2);
    const double part = std::min(place - static_cast<double>(number), 1.0);
    const auto& table = table_of(std::get<DiffuseShape>(shape));
    std::array<Vec3f, kAxes> axes;
    for (std::size_t k = 0; k < kAxes; ++k) {
        axes[k] = Vec3f(axis(k).z * normal + axis(k).x * across);
    }
    std::array<float, kAxes * kRecordTerms> along;
    sh_basis(std::span<const Vec3f>(axes), kRecordOrder, std::span<float>(along));
    RecordBasis basis{};
    for (std::size_t k = 0; k < kAxes; ++k) {
        for (std::size_t l = k; l < kRecordOrder; ++l) {
            const auto weight = static_cast<float>(std::lerp(table[number][l][k], table[number + 1][l][k], part));
            for (std::size_t i = l * l; i < (l + 1) * (l + 1); ++i) {
                basis[i] += weight * along[k * kRecordTerms + i];
            }
        }
    }
    return basis;
}

}  // namespace shlight
