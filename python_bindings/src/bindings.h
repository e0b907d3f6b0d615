// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/pybind11.h>

namespace shlight::python {

void bind_arguments(pybind11::module_& m);
void bind_coefficients(pybind11::module_& m);
void bind_kernels(pybind11::module_& m);
void bind_tables(pybind11::module_& m);
void bind_bsdf(pybind11::module_& m);
void bind_shader(pybind11::module_& m);
void bind_shading(pybind11::module_& m);
void bind_gradients(pybind11::module_& m);
void bind_scene(pybind11::module_& m);
void bind_render(pybind11::module_& m);

}  // namespace shlight::python
