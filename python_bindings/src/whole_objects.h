// SPDX-License-Identifier: MIT
//
// Prevents objects of pybind11 classes without a value, whose use would end the process, and makes objects copyable and
// picklable.
#pragma once

#include <pybind11/pybind11.h>

namespace shlight::python {

/// For a class whose objects are made by functions only: T() and T.__new__(T) raise TypeError.
pybind11::custom_type_setup without_constructor();

/// For a class with a default constructor: T.__new__(T) runs it.
pybind11::custom_type_setup constructed_when_new();

/// Copies and pickles objects by state(object), in Python's built-in types, from which from_state makes an equal
/// object.
template <class T, class... Options, class State, class FromState>
void define_pickling(pybind11::class_<T, Options...>& type, const State& state, const FromState& from_state) {
    type.def_static("_from_state", from_state);
    type.def("__reduce__", [state](const T& self) {
        const auto restored = pybind11::module_::import("shlight._pickling").attr("restored");
        return pybind11::make_tuple(restored, pybind11::make_tuple(pybind11::type::of<T>(), state(self)));
    });
}

}  // namespace shlight::python
