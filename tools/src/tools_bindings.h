// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/pybind11.h>

namespace shlight::python {

void bind_methods(pybind11::module_& m);
void bind_monte_carlo_render(pybind11::module_& m);

}  // namespace shlight::python
