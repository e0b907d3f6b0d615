// SPDX-License-Identifier: MIT
//
// Affine transforms as 4×4 matrices.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "base/checks.h"
#include "shlight/types.h"

namespace shlight {

inline Vec3d transform_point(const glm::dmat4& to_world, const Vec3d& point) {
    return Vec3d(to_world * glm::dvec4(point, 1.0));
}

inline Vec3d transform_vector(const glm::dmat4& to_world, const Vec3d& vector) {
    return Vec3d(to_world * glm::dvec4(vector, 0.0));
}

inline double inf_norm(const glm::dmat3& m) {
    double norm = 0;
    for (int row = 0; row < 3; ++row) {
        norm = std::max(norm, std::abs(m[0][row]) + std::abs(m[1][row]) + std::abs(m[2][row]));
    }
    return norm;
}

/// Throws std::invalid_argument naming the argument unless the matrix is finite, affine and invertible.
inline void check_transform(const char* name, const glm::dmat4& matrix) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            if (!std::isfinite(matrix[column][row])) {
                reject(std::string(name) + " contains a number that is not finite");
            }
        }
        if (std::abs(matrix[column][3] - (column == 3 ? 1.0 : 0.0)) > 1e-6) {
            reject(std::string(name) + " is not affine: its last row must be 0 0 0 1");
        }
    }
    // The determinant ÷ the product of the axes' lengths measures flatness independently of scale. Axes whose squares
    // vanish have no length.
    const glm::dmat3 linear(matrix);
    double lengths = 1, least = 1;
    for (int axis = 0; axis < 3; ++axis) {
        lengths *= glm::length(linear[axis]);
        least = std::min(least, glm::dot(linear[axis], linear[axis]));
    }
    if (!(least >= std::numeric_limits<double>::min() && std::abs(glm::determinant(linear)) > 1e-9 * lengths)) {
        reject(std::string(name) + " is degenerate: it flattens space");
    }
}

}  // namespace shlight
