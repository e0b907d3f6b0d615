// SPDX-License-Identifier: MIT
#include "bindings.h"
#include "environment/environment_map.h"
#include "gil.h"
#include "shlight/types.h"

PYBIND11_MODULE(_core, m) {
    m.doc() = "The compiled core of shlight; use it through the package `shlight`.";
    m.attr("DEFAULT_TOLERANCE") = shlight::kDefaultTolerance;
    m.attr("LUMINANCE") = pybind11::make_tuple(shlight::kLuminance.x, shlight::kLuminance.y, shlight::kLuminance.z);
    shlight::python::wait_at_end();
    shlight::python::bind_arguments(m);
    shlight::python::bind_kernels(m);
    shlight::python::bind_coefficients(m);
    shlight::python::bind_tables(m);
    shlight::python::bind_bsdf(m);
    shlight::python::bind_shader(m);
    shlight::python::bind_shading(m);
    shlight::python::bind_gradients(m);
    shlight::python::bind_scene(m);
    shlight::python::bind_render(m);
}
