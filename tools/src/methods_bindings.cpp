// SPDX-License-Identifier: MIT
//
// Methods for comparison: batch functions on flat arrays, like coefficients_bindings.cpp and shading_bindings.cpp of
// python_bindings.
#include <pybind11/stl.h>

#include "arrays.h"
#include "batch.h"
#include "chunks.h"
#include "shaded.h"
#include "tools_bindings.h"
#include "whole_objects.h"
#include "zonal_factorization.h"

namespace shlight::python {
namespace {

/// Lights per task: the methods take long.
constexpr std::size_t kSmallChunk = 16;

using methods::find_method;
using methods::find_shading_method;
using methods::Method;
using methods::Options;
using methods::Sampling;
using methods::ShadingMethod;

Sampling sampling_from(const std::string& name) {
    if (name == "solid_angle") {
        return Sampling::solid_angle;
    }
    if (name == "area") {
        return Sampling::area;
    }
    if (name == "bsdf") {
        return Sampling::bsdf;
    }
    if (name == "mis") {
        return Sampling::mis;
    }
    throw std::invalid_argument("sampling must be 'solid_angle', 'area', 'bsdf' or 'mis', got '" + name + "'");
}

/// Coefficients of `count` lights; integrate(first, count, coefficients) fills some rows.
template <class T, class Integrate>
Array<T> integrated(std::size_t count, int order, int threads, const Integrate& integrate) {
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    Array<T> out({static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(row)});
    T* data = out.mutable_data();
    in_chunks(
        count, threads,
        [&](std::size_t first, std::size_t some) {
            integrate(first, some, std::span<T>(data + first * row, some * row));
        },
        kSmallChunk);
    return out;
}

template <class T>
void bind_methods_for(py::module_& m) {
    m.def(
        "sphere_coefficients",
        [](const std::string& method, const Options& options, const Array<T>& centers, const Array<T>& radii, int order,
           bool clip, int threads) {
            const Method& found = find_method(method);
            const auto c = vectors("centers", centers);
            const auto r = values(radii);
            return integrated<T>(c.size(), order, threads, [&](std::size_t first, std::size_t count, auto out) {
                methods::sphere_coefficients(found, c.subspan(first, count), r.subspan(first, count), order, clip,
                                             options, first, out);
            });
        },
        py::arg("method"), py::arg("options"), py::arg("centers").noconvert(), py::arg("radii").noconvert(),
        py::arg("order"), py::arg("clip"), py::arg("threads"));
    m.def(
        "cap_coefficients",
        [](const std::string& method, const Options& options, const Array<T>& axes, const Array<T>& half_angles,
           int order, bool clip, int threads) {
            const Method& found = find_method(method);
            const auto a = vectors("axes", axes);
            const auto h = values(half_angles);
            return integrated<T>(a.size(), order, threads, [&](std::size_t first, std::size_t count, auto out) {
                methods::cap_coefficients(found, a.subspan(first, count), h.subspan(first, count), order, clip, options,
                                          first, out);
            });
        },
        py::arg("method"), py::arg("options"), py::arg("axes").noconvert(), py::arg("half_angles").noconvert(),
        py::arg("order"), py::arg("clip"), py::arg("threads"));
    m.def(
        "polygon_coefficients",
        [](const std::string& method, const Options& options, const Array<T>& vertices, int order, bool clip,
           int threads) {
            const Method& found = find_method(method);
            const auto v = vectors("vertices", vertices);
            const auto k = static_cast<std::size_t>(vertices.shape(1));
            const auto total = static_cast<std::size_t>(vertices.shape(0));
            return integrated<T>(total, order, threads, [&](std::size_t first, std::size_t count, auto out) {
                methods::polygon_coefficients(found, v.subspan(first * k, count * k), static_cast<int>(k), order, clip,
                                              options, first, out);
            });
        },
        py::arg("method"), py::arg("options"), py::arg("vertices").noconvert(), py::arg("order"), py::arg("clip"),
        py::arg("threads"));
}

py::tuple shaded_spheres(const std::string& method, const Options& options, const Array<double>& centers,
                         const Array<double>& radii, const Bsdf& bsdf, const Array<double>& cos_theta_o, int threads) {
    const ShadingMethod& found = find_shading_method(method);
    const auto c = vectors("centers", centers);
    const auto r = values(radii);
    const auto views = values(cos_theta_o);
    const Shaded out(c.size());
    in_chunks(
        c.size(), threads,
        [&](std::size_t first, std::size_t count) {
            methods::shade_spheres(found, c.subspan(first, count), r.subspan(first, count), bsdf,
                                   views.subspan(first, count), options, first, out.colors.subspan(first, count),
                                   out.efforts.subspan(first, count));
        },
        kSmallChunk);
    return out.result();
}

py::tuple shaded_polygons(const std::string& method, const Options& options, const Array<double>& vertices,
                          const Bsdf& bsdf, const Array<double>& cos_theta_o, int threads) {
    const ShadingMethod& found = find_shading_method(method);
    const auto v = vectors("vertices", vertices);
    const auto k = static_cast<std::size_t>(vertices.shape(1));
    const auto views = values(cos_theta_o);
    const Shaded out(views.size());
    in_chunks(
        views.size(), threads,
        [&](std::size_t first, std::size_t count) {
            methods::shade_polygons(found, v.subspan(first * k, count * k), static_cast<int>(k), bsdf,
                                    views.subspan(first, count), options, first, out.colors.subspan(first, count),
                                    out.efforts.subspan(first, count));
        },
        kSmallChunk);
    return out.result();
}

}  // namespace

void bind_methods(py::module_& m) {
    const py::class_<Options> options_type(m, "MethodOptions", without_constructor());
    m.def(
        "method_options",
        [](double tolerance, int order, int samples, std::uint32_t seed, const std::string& sampling) {
            return Options{tolerance, order, samples, seed, sampling_from(sampling)};
        },
        py::kw_only(), py::arg("tolerance"), py::arg("order"), py::arg("samples"), py::arg("seed"),
        py::arg("sampling"));
    py::class_<Method> method_type(m, "Method", without_constructor());
    define_pickling(
        method_type, [](const Method& method) { return method.name; }, &find_method);
    method_type.def_readonly("name", &Method::name)
        .def_readonly("source", &Method::source)
        .def_readonly("largest_order", &Method::largest_order)
        .def_readonly("adaptive", &Method::adaptive)
        .def_readonly("random", &Method::random)
        .def_property_readonly("knows_caps", [](const Method& method) { return method.f32.cap != nullptr; })
        .def_property_readonly("knows_polygons", [](const Method& method) { return method.f32.polygon != nullptr; });
    py::class_<ShadingMethod> shading_method_type(m, "ShadingMethod", without_constructor());
    define_pickling(
        shading_method_type, [](const ShadingMethod& method) { return method.name; }, &find_shading_method);
    shading_method_type.def_readonly("name", &ShadingMethod::name)
        .def_readonly("source", &ShadingMethod::source)
        .def_readonly("harmonic", &ShadingMethod::harmonic)
        .def_readonly("adaptive", &ShadingMethod::adaptive)
        .def_readonly("sampled", &ShadingMethod::sampled)
        .def_readonly("random", &ShadingMethod::random);
    m.def("all_methods", [] {
        const auto all = methods::all_methods();
        return std::vector<Method>(all.begin(), all.end());
    });
    m.def("all_shading_methods", [] {
        const auto all = methods::all_shading_methods();
        return std::vector<ShadingMethod>(all.begin(), all.end());
    });
    m.def(
        "lobe_condition",
        [](int band) {
            if (band < 0 || band >= methods::kMaxZonalOrder) {
                throw std::invalid_argument("band must be 0 … " + std::to_string(methods::kMaxZonalOrder - 1));
            }
            return methods::lobe_condition(band);
        },
        py::arg("band"));
    bind_methods_for<float>(m);
    bind_methods_for<double>(m);
    m.def("shade_spheres", &shaded_spheres, py::arg("method"), py::arg("options"), py::arg("centers").noconvert(),
          py::arg("radii").noconvert(), py::arg("bsdf"), py::arg("cos_theta_o").noconvert(), py::arg("threads"));
    m.def("shade_polygons", &shaded_polygons, py::arg("method"), py::arg("options"), py::arg("vertices").noconvert(),
          py::arg("bsdf"), py::arg("cos_theta_o").noconvert(), py::arg("threads"));
}

}  // namespace shlight::python
