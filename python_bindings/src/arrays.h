// SPDX-License-Identifier: MIT
//
// numpy arrays as spans: no copy where the type fits.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "shlight/types.h"

namespace shlight::python {

namespace py = pybind11;

/// A C-contiguous array of exactly this type; pass the argument with .noconvert() to forbid hidden copies.
template <class T>
using Array = py::array_t<T, py::array::c_style>;
/// A C-contiguous array, converted if need be.
template <class T>
using AnyArray = py::array_t<T, py::array::c_style | py::array::forcecast>;

template <class T, int Flags>
std::span<const T> values(const py::array_t<T, Flags>& a) {
    return {a.data(), static_cast<std::size_t>(a.size())};
}

/// An array of shape (..., 3) as vectors. Throws ValueError naming the argument.
template <class T, int Flags>
std::span<const Vec3<T>> vectors(const char* name, const py::array_t<T, Flags>& a) {
    static_assert(sizeof(Vec3<T>) == 3 * sizeof(T) && std::is_trivially_copyable_v<Vec3<T>>);
    if (a.ndim() < 1 || a.shape(a.ndim() - 1) != 3) {
        throw std::invalid_argument(std::string(name) + " must have shape (..., 3)");
    }
    return {reinterpret_cast<const Vec3<T>*>(a.data()), static_cast<std::size_t>(a.size()) / 3};
}

/// The shape of an array with `dropped` trailing axes replaced by `added`.
inline std::vector<py::ssize_t> shape_with(const py::array& a, py::ssize_t dropped,
                                           const std::vector<py::ssize_t>& added) {
    std::vector<py::ssize_t> shape(a.shape(), a.shape() + a.ndim() - dropped);
    shape.insert(shape.end(), added.begin(), added.end());
    return shape;
}

/// Throws ValueError naming the argument if any value is not finite.
template <class T>
void check_all_finite(const char* name, std::span<const T> all) {
    for (const T x : all) {
        if (!std::isfinite(x)) {
            throw std::invalid_argument(std::string(name) + " contains a number that is not finite");
        }
    }
}

}  // namespace shlight::python
