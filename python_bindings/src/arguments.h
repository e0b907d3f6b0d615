// SPDX-License-Identifier: MIT
//
// Conversion of Python arguments of any type to C++ values, for all public functions. Errors are ValueError or
// TypeError and start with the argument's name. numpy's overflow warnings are suppressed, since overflow gives
// infinity, which is rejected.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>

#include "arrays.h"

namespace shlight::python {

/// A number or a zero-dimensional array of real numbers; an integer beyond double's range is infinite.
double real_from(const char* name, const py::handle& value);

/// An object with __index__ that is not a bool.
std::int64_t integer_from(const char* name, const py::handle& value, std::int64_t least, std::int64_t largest);

/// An int whose range the caller's callee checks.
int int_from(const char* name, const py::handle& value);

/// True or False, of Python or numpy.
bool flag_from(const char* name, const py::handle& value);

/// Real numbers of any shape. kinds: numpy's letters of accepted types.
template <class T>
AnyArray<T> array_from(const char* name, const py::handle& value, const char* kinds = "fiub");

extern template AnyArray<float> array_from(const char* name, const py::handle& value, const char* kinds);
extern template AnyArray<double> array_from(const char* name, const py::handle& value, const char* kinds);
extern template AnyArray<std::int64_t> array_from(const char* name, const py::handle& value, const char* kinds);

/// A colour: one number, or RGB.
Rgb color_from(const char* name, const py::handle& value);

/// An object of a bound class. kind: its name.
template <class T>
T& object_from(const char* name, const py::handle& value, const char* kind) {
    if (!py::isinstance<T>(value)) {
        throw py::type_error(std::string(name) + " must be a " + kind + ", got " + Py_TYPE(value.ptr())->tp_name);
    }
    return value.cast<T&>();
}

}  // namespace shlight::python
