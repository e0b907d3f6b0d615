// SPDX-License-Identifier: MIT
//
// What callers pass, of whatever type, as C++ values: the one way for all functions that users see. Everything throws a
// ValueError or TypeError that starts with the argument's name; numpy's warnings of what does not fit are not given,
// since that becomes infinite, which is refused as such.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>

#include "arrays.h"

namespace shlight::python {

/// A number or an array of real numbers without axes; an integer beyond double's range is infinite.
double real_from(const char* name, const py::handle& value);

/// Something with __index__, but no bool.
std::int64_t integer_from(const char* name, const py::handle& value, std::int64_t least, std::int64_t largest);

/// An int whose range something else checks.
int int_from(const char* name, const py::handle& value);

/// True or False, of Python or numpy.
bool flag_from(const char* name, const py::handle& value);

/// Real numbers of any shape. kinds: numpy's letters of the types that are accepted.
template <class T>
AnyArray<T> array_from(const char* name, const py::handle& value, const char* kinds = "fiub");

extern template AnyArray<float> array_from(const char* name, const py::handle& value, const char* kinds);
extern template AnyArray<double> array_from(const char* name, const py::handle& value, const char* kinds);
extern template AnyArray<std::int64_t> array_from(const char* name, const py::handle& value, const char* kinds);

/// A colour: one number, or RGB.
Rgb color_from(const char* name, const py::handle& value);

/// An object of a class that is bound. kind: its name.
template <class T>
T& object_from(const char* name, const py::handle& value, const char* kind) {
    if (!py::isinstance<T>(value)) {
        throw py::type_error(std::string(name) + " must be a " + kind + ", got " + Py_TYPE(value.ptr())->tp_name);
    }
    return value.cast<T&>();
}

}  // namespace shlight::python
