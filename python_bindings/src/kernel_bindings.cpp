// SPDX-License-Identifier: MIT
//
// Selection of the kernels' instruction set, for tests and measurements.
#include <pybind11/stl.h>

#include "bindings.h"
#include "simd/targets.h"

namespace shlight::python {

namespace py = pybind11;

void bind_kernels(py::module_& m) {
    m.def("kernel_targets", &kernel_targets);
    m.def("kernel_target", &kernel_target);
    m.def("force_kernel_target", &force_kernel_target, py::arg("target"));
    choose_kernel_target();
}

}  // namespace shlight::python
