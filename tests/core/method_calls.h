// SPDX-License-Identifier: MIT
//
// Coefficients of one light by a method's name.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "batch.h"
#include "method.h"
#include "random_polygon.h"

namespace shlight::testing {

template <class T>
std::vector<T> of_sphere(const char* method, const Vec3d& center, double radius, int order, bool clip = true,
                         const methods::Options& options = {}, std::size_t number = 0) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const Vec3<T> c(center);
    const auto r = static_cast<T>(radius);
    methods::sphere_coefficients<T>(methods::find_method(method), std::span(&c, 1), std::span(&r, 1), order, clip,
                                    options, number, result);
    return result;
}

template <class T>
std::vector<T> of_cap(const char* method, const Vec3d& axis, double half_angle, int order, bool clip = true,
                      const methods::Options& options = {}, std::size_t number = 0) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const Vec3<T> a(axis);
    const auto h = static_cast<T>(half_angle);
    methods::cap_coefficients<T>(methods::find_method(method), std::span(&a, 1), std::span(&h, 1), order, clip, options,
                                 number, result);
    return result;
}

template <class T>
std::vector<T> of_polygon(const char* method, const Vertices& vertices, int order, bool clip = true,
                          const methods::Options& options = {}, std::size_t number = 0) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const std::vector<Vec3<T>> v(vertices.begin(), vertices.end());
    methods::polygon_coefficients<T>(methods::find_method(method), v, static_cast<int>(v.size()), order, clip, options,
                                     number, result);
    return result;
}

}  // namespace shlight::testing
