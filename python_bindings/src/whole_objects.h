// SPDX-License-Identifier: MIT
//
// What keeps pybind11's classes from having objects without a value, which end the process when they are used, and lets
// objects be copied and pickled.
#pragma once

#include <pybind11/pybind11.h>

namespace shlight::python {

/// For a class whose objects only functions make: T() and T.__new__(T) raise TypeError.
pybind11::custom_type_setup without_constructor();

/// For a class with a constructor without arguments: T.__new__(T) runs it.
pybind11::custom_type_setup constructed_when_new();

/// Objects are copied and pickled by what state(object) returns, of Python's own types, from which from_state makes an
/// equal one.
template <class T, class State, class FromState>
void define_pickling(pybind11::class_<T>& type, const State& state, const FromState& from_state) {
    type.def_static("_from_state", from_state);
    type.def("__reduce__", [state](const T& self) {
        const auto restored = pybind11::module_::import("shlight._pickling").attr("restored");
        return pybind11::make_tuple(restored, pybind11::make_tuple(pybind11::type::of<T>(), state(self)));
    });
}

}  // namespace shlight::python
