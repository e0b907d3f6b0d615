// SPDX-License-Identifier: MIT
//
// Batch functions on flat arrays; shlight/coefficients.py broadcasts their arguments.
#include <algorithm>
#include <cmath>
#include <exception>
#include <initializer_list>
#include <string>
#include <utility>

#include "arrays.h"
#include "bindings.h"
#include "chunks.h"
#include "result_memory.h"
#include "shlight/basis.h"
#include "shlight/cap.h"
#include "shlight/disk.h"
#include "shlight/polygon.h"
#include "shlight/shading.h"

namespace shlight::python {
namespace {

/// Rows for results: those of `out`, whose type and shape shlight/coefficients.py has checked, or new ones for None.
template <class T>
Array<T> rows(const py::object& out, std::size_t count, int order) {
    check_order(order);
    if (!out.is_none()) {
        return Array<T>(out);
    }
    return uninitialized<T>({static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(coefficient_count(order))});
}

/// The rows [first, first + count) of a matrix of order² columns.
template <class T>
std::span<T> slice(T* data, int order, std::size_t first, std::size_t count) {
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    return {data + first * row, count * row};
}

/// Checks for finite numbers by the sum, which is finite only if all terms are; terms are searched only if it is not.
template <class T>
void check_sums(std::span<const T> sums, std::initializer_list<std::pair<const char*, std::span<const T>>> terms) {
    if (std::all_of(sums.begin(), sums.end(), [](T sum) { return std::isfinite(sum); })) {
        return;
    }
    for (const auto& [name, values] : terms) {
        const auto* wrong =
            std::find_if(values.data(), values.data() + values.size(), [](T x) { return !std::isfinite(x); });
        if (const auto place = static_cast<std::size_t>(wrong - values.data()); place < values.size()) {
            const std::string text = std::string(name) + " contains a number that is not finite";
            throw WrongRow(text, place / (values.size() / sums.size()));
        }
    }
}

template <class T>
Array<T> basis(const Array<T>& directions, int order, int threads, const py::object& target) {
    const auto d = vectors("directions", directions);
    Array<T> out = rows<T>(target, d.size(), order);
    T* data = out.mutable_data();
    const Output output = output_of(static_cast<std::size_t>(out.nbytes()));
    in_chunks(d.size(), threads, [&](std::size_t first, std::size_t count) {
        sh_basis(d.subspan(first, count), order, slice(data, order, first, count), output);
    });
    return out;
}

template <class T>
Array<T> evaluated(const Array<T>& coefficients, const Array<T>& directions, int order, int threads) {
    const auto d = vectors("directions", directions);
    const auto c = values(coefficients);
    Array<T> out(static_cast<py::ssize_t>(d.size()));
    T* data = out.mutable_data();
    in_chunks(d.size(), threads, [&](std::size_t first, std::size_t count) {
        shlight::evaluate(slice(c.data(), order, first, count), d.subspan(first, count), order,
                          std::span<T>(data + first, count));
    });
    check_sums<T>({data, d.size()}, {{"coefficients", c}});
    return out;
}

template <class T>
Array<T> spheres(const Array<T>& centers, const Array<T>& radii, int order, bool clip, int threads,
                 const py::object& target) {
    const auto c = vectors("centers", centers);
    const auto r = values(radii);
    Array<T> out = rows<T>(target, c.size(), order);
    T* data = out.mutable_data();
    const Output output = output_of(static_cast<std::size_t>(out.nbytes()));
    in_chunks(c.size(), threads, [&](std::size_t first, std::size_t count) {
        sphere_coefficients(c.subspan(first, count), r.subspan(first, count), order, clip,
                            slice(data, order, first, count), output);
    });
    return out;
}

template <class T>
Array<T> caps(const Array<T>& axes, const Array<T>& half_angles, int order, bool clip, int threads,
              const py::object& target) {
    const auto a = vectors("axes", axes);
    const auto h = values(half_angles);
    Array<T> out = rows<T>(target, a.size(), order);
    T* data = out.mutable_data();
    const Output output = output_of(static_cast<std::size_t>(out.nbytes()));
    in_chunks(a.size(), threads, [&](std::size_t first, std::size_t count) {
        cap_coefficients(a.subspan(first, count), h.subspan(first, count), order, clip,
                         slice(data, order, first, count), output);
    });
    return out;
}

template <class T>
Array<T> polygons(const Array<T>& vertices, int order, bool clip, int threads, const py::object& target) {
    const auto v = vectors("vertices", vertices);
    const auto k = static_cast<std::size_t>(vertices.shape(1));
    const auto total = static_cast<std::size_t>(vertices.shape(0));
    Array<T> out = rows<T>(target, total, order);
    T* data = out.mutable_data();
    in_chunks(total, threads, [&](std::size_t first, std::size_t count) {
        polygon_coefficients(v.subspan(first * k, count * k), static_cast<int>(k), order, clip,
                             slice(data, order, first, count));
    });
    return out;
}

template <class T>
Array<T> disks(const Array<T>& centers, const Array<T>& half_axes_u, const Array<T>& half_axes_v, int order, bool clip,
               int threads, const py::object& target) {
    const auto c = vectors("centers", centers);
    const auto u = vectors("half_axes_u", half_axes_u);
    const auto v = vectors("half_axes_v", half_axes_v);
    Array<T> out = rows<T>(target, c.size(), order);
    T* data = out.mutable_data();
    in_chunks(c.size(), threads, [&](std::size_t first, std::size_t count) {
        disk_coefficients(c.subspan(first, count), u.subspan(first, count), v.subspan(first, count), order, clip,
                          slice(data, order, first, count));
    });
    return out;
}

template <class T>
Array<T> contracted(const Array<T>& light, const Array<T>& material, int order, int threads) {
    const auto total = static_cast<std::size_t>(light.shape(0));
    Array<T> out(static_cast<py::ssize_t>(total));
    T* data = out.mutable_data();
    in_chunks(total, threads, [&](std::size_t first, std::size_t count) {
        shade(slice(light.data(), order, first, count), slice(material.data(), order, first, count), order,
              std::span<T>(data + first, count));
    });
    check_sums<T>({data, total}, {{"light", values(light)}, {"material", values(material)}});
    return out;
}

template <class T>
void bind_coefficients_for(py::module_& m) {
    m.def("sh_basis", &basis<T>, py::arg("directions").noconvert(), py::arg("order"), py::arg("threads"),
          py::arg("out") = py::none());
    m.def("evaluate", &evaluated<T>, py::arg("coefficients").noconvert(), py::arg("directions").noconvert(),
          py::arg("order"), py::arg("threads"));
    m.def("sphere_coefficients", &spheres<T>, py::arg("centers").noconvert(), py::arg("radii").noconvert(),
          py::arg("order"), py::arg("clip"), py::arg("threads"), py::arg("out") = py::none());
    m.def("cap_coefficients", &caps<T>, py::arg("axes").noconvert(), py::arg("half_angles").noconvert(),
          py::arg("order"), py::arg("clip"), py::arg("threads"), py::arg("out") = py::none());
    m.def("polygon_coefficients", &polygons<T>, py::arg("vertices").noconvert(), py::arg("order"), py::arg("clip"),
          py::arg("threads"), py::arg("out") = py::none());
    m.def("disk_coefficients", &disks<T>, py::arg("centers").noconvert(), py::arg("half_axes_u").noconvert(),
          py::arg("half_axes_v").noconvert(), py::arg("order"), py::arg("clip"), py::arg("threads"),
          py::arg("out") = py::none());
    m.def("contract", &contracted<T>, py::arg("light").noconvert(), py::arg("material").noconvert(), py::arg("order"),
          py::arg("threads"));
}

}  // namespace

void bind_coefficients(py::module_& m) {
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(std::move(thrown));
        } catch (const WrongRow& error) {
            PyErr_SetObject(PyExc_ValueError, py::make_tuple(error.what(), error.row()).ptr());
        }
    });
    bind_coefficients_for<float>(m);
    bind_coefficients_for<double>(m);
}

}  // namespace shlight::python
