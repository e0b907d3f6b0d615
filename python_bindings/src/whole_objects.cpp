// SPDX-License-Identifier: MIT
#include "whole_objects.h"

namespace shlight::python {

namespace py = pybind11;

namespace {

PyObject* refuse(PyTypeObject* type, PyObject* /*args*/, PyObject* /*keywords*/) {
    PyErr_Format(PyExc_TypeError, "%s has no constructor: see help(%s) for what returns one", type->tp_name,
                 type->tp_name);
    return nullptr;
}

/// pybind11 does not run __init__ for an object that already has a value.
PyObject* construct(PyTypeObject* type, PyObject* /*args*/, PyObject* /*keywords*/) {
    try {
        auto self = py::reinterpret_steal<py::object>(py::detail::make_new_instance(type));
        const auto bound = py::detail::all_type_info(type).front();
        py::handle(reinterpret_cast<PyObject*>(bound->type)).attr("__init__")(self);
        return self.release().ptr();
    } catch (py::error_already_set& error) {
        error.restore();
        return nullptr;
    }
}

py::custom_type_setup with_new(newfunc function) {
    return py::custom_type_setup([function](PyHeapTypeObject* type) { type->ht_type.tp_new = function; });
}

}  // namespace

py::custom_type_setup without_constructor() {
    return with_new(&refuse);
}

py::custom_type_setup constructed_when_new() {
    return with_new(&construct);
}

}  // namespace shlight::python
