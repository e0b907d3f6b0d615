// SPDX-License-Identifier: MIT
//
// Derivatives of batch functions on flat arrays; shlight/coefficients.py and shlight/shading.py broadcast their
// arguments.
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "chunks.h"
#include "result_memory.h"
#include "shaded.h"
#include "shlight/gradient_shader.h"
#include "shlight/sphere_gradient.h"

namespace shlight::python {
namespace {

/// An array whose first axis counts lights, and its numbers of some of them.
template <class T>
class LightRows {
  public:
    LightRows(std::size_t count, std::vector<py::ssize_t> axes) {
        for (const py::ssize_t size : axes) {
            row_ *= static_cast<std::size_t>(size);
        }
        axes.insert(axes.begin(), static_cast<py::ssize_t>(count));
        array_ = uninitialized<T>(axes);
        data_ = array_.mutable_data();
    }
    explicit LightRows(Array<T> array) : array_(std::move(array)), data_(array_.mutable_data()) {
        row_ = static_cast<std::size_t>(array_.shape(1));
    }

    std::span<T> of(std::size_t first, std::size_t count) const { return {data_ + first * row_, count * row_}; }
    const Array<T>& array() const { return array_; }

  private:
    Array<T> array_;
    T* data_ = nullptr;
    std::size_t row_ = 1;
};

template <class T>
py::tuple sphere_coefficients_with_gradient(const Array<T>& centers, const Array<T>& radii, int order, bool clip,
                                            int threads, const py::object& out) {
    check_order(order);
    const auto c = vectors("centers", centers);
    const auto r = values(radii);
    const auto row = static_cast<py::ssize_t>(coefficient_count(order));
    const LightRows<T> coefficients = out.is_none() ? LightRows<T>(c.size(), {row}) : LightRows<T>(Array<T>(out));
    const LightRows<T> by_center(c.size(), {row, 3});
    const LightRows<T> by_radius(c.size(), {row});
    in_chunks(c.size(), threads, [&](std::size_t first, std::size_t count) {
        sphere_coefficients_gradient(c.subspan(first, count), r.subspan(first, count), order, clip,
                                     coefficients.of(first, count), by_center.of(first, count),
                                     by_radius.of(first, count));
    });
    return py::make_tuple(coefficients.array(), by_center.array(), by_radius.array());
}

template <class T>
py::tuple sphere_gradients(const Array<T>& centers, const Array<T>& radii, const Bsdf& bsdf,
                           const Array<double>& cos_theta_o, const Array<double>& azimuth, bool with_roughness,
                           int threads) {
    const auto c = vectors("centers", centers);
    const auto r = values(radii);
    const auto views = values(cos_theta_o);
    const auto turns = values(azimuth);
    const LightRows<T> by_center(c.size(), {3, 3});
    const LightRows<T> by_radius(c.size(), {3});
    const LightRows<T> by_roughness(c.size(), {with_roughness ? 3 : 0});
    const GradientShader shader(bsdf);
    in_chunks(c.size(), threads, [&](std::size_t first, std::size_t count) {
        shader.spheres(c.subspan(first, count), r.subspan(first, count), part_of(views, first, count),
                       by_center.of(first, count), by_radius.of(first, count), by_roughness.of(first, count),
                       part_of(turns, first, count));
    });
    return py::make_tuple(by_center.array(), by_radius.array(), by_roughness.array());
}

template <class T>
py::tuple polygon_gradients(const Array<T>& vertices, const Bsdf& bsdf, const Array<double>& cos_theta_o,
                            const Array<double>& azimuth, bool with_roughness, int threads) {
    const auto v = vectors("vertices", vertices);
    const auto k = static_cast<std::size_t>(vertices.shape(1));
    const auto views = values(cos_theta_o);
    const auto turns = values(azimuth);
    const LightRows<T> by_vertices(v.size() / k, {3, vertices.shape(1), 3});
    const LightRows<T> by_roughness(v.size() / k, {with_roughness ? 3 : 0});
    const GradientShader shader(bsdf);
    in_chunks(v.size() / k, threads, [&](std::size_t first, std::size_t count) {
        shader.polygons(v.subspan(first * k, count * k), static_cast<int>(k), part_of(views, first, count),
                        by_vertices.of(first, count), by_roughness.of(first, count), part_of(turns, first, count));
    });
    return py::make_tuple(by_vertices.array(), by_roughness.array());
}

template <class T>
void bind_gradients_for(py::module_& m) {
    m.def("sphere_coefficients_gradient", &sphere_coefficients_with_gradient<T>, py::arg("centers").noconvert(),
          py::arg("radii").noconvert(), py::arg("order"), py::arg("clip"), py::arg("threads"),
          py::arg("out") = py::none());
    m.def("shade_spheres_gradient", &sphere_gradients<T>, py::arg("centers").noconvert(), py::arg("radii").noconvert(),
          py::arg("bsdf"), py::arg("cos_theta_o").noconvert(), py::arg("azimuth").noconvert(),
          py::arg("with_roughness"), py::arg("threads"));
    m.def("shade_polygons_gradient", &polygon_gradients<T>, py::arg("vertices").noconvert(), py::arg("bsdf"),
          py::arg("cos_theta_o").noconvert(), py::arg("azimuth").noconvert(), py::arg("with_roughness"),
          py::arg("threads"));
}

}  // namespace

void bind_gradients(py::module_& m) {
    bind_gradients_for<float>(m);
    bind_gradients_for<double>(m);
}

}  // namespace shlight::python
