// SPDX-License-Identifier: MIT
#include "gil.h"
#include "simd/targets.h"
#include "tools_bindings.h"

PYBIND11_MODULE(_methods, m) {
    m.doc() = "The methods that shlight is compared with; use them through shlight_tools.methods.";
    shlight::python::wait_at_end();
    // This module has a core of its own, which takes the instruction set that shlight._core takes.
    shlight::choose_kernel_target();
    shlight::python::bind_methods(m);
    shlight::python::bind_monte_carlo_render(m);
}
