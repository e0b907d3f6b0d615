// SPDX-License-Identifier: MIT
//
// Flat batch functions; shlight/shading.py broadcasts in front of them.
#include "arrays.h"
#include "bindings.h"
#include "chunks.h"
#include "shlight/light_shading.h"

namespace shlight::python {
namespace {

/// Radiance (count, 3) and effort (count), as they are returned and as they are filled.
struct Shaded {
    Array<float> radiance;
    Array<std::int32_t> effort;
    std::span<Rgb> colors;
    std::span<std::int32_t> efforts;

    explicit Shaded(std::size_t count)
        : radiance({static_cast<py::ssize_t>(count), py::ssize_t{3}}), effort(static_cast<py::ssize_t>(count)) {
        static_assert(sizeof(Rgb) == 3 * sizeof(float));
        colors = {reinterpret_cast<Rgb*>(radiance.mutable_data()), count};
        efforts = {effort.mutable_data(), count};
    }

    py::tuple result() const { return py::make_tuple(radiance, effort); }
};

py::tuple spheres(const Array<double>& centers, const Array<double>& radii, const Bsdf& bsdf,
                  const Array<double>& cos_theta_o, int order, double tolerance, int threads) {
    const auto c = vectors("centers", centers);
    const auto r = values(radii);
    const auto views = values(cos_theta_o);
    const Shaded out(c.size());
    in_chunks(c.size(), threads, [&](std::size_t first, std::size_t count) {
        shade_spheres(c.subspan(first, count), r.subspan(first, count), bsdf, views.subspan(first, count),
                      {order, tolerance}, out.colors.subspan(first, count), out.efforts.subspan(first, count));
    });
    return out.result();
}

py::tuple polygons(const Array<double>& vertices, const Bsdf& bsdf, const Array<double>& cos_theta_o, int order,
                   double tolerance, int threads) {
    const auto v = vectors("vertices", vertices);
    const auto k = static_cast<std::size_t>(vertices.shape(1));
    const auto views = values(cos_theta_o);
    const Shaded out(views.size());
    in_chunks(views.size(), threads, [&](std::size_t first, std::size_t count) {
        shade_polygons(v.subspan(first * k, count * k), static_cast<int>(k), bsdf, views.subspan(first, count),
                       {order, tolerance}, out.colors.subspan(first, count), out.efforts.subspan(first, count));
    });
    return out.result();
}

}  // namespace

void bind_shading(py::module_& m) {
    m.def("shade_spheres", &spheres, py::arg("centers").noconvert(), py::arg("radii").noconvert(), py::arg("bsdf"),
          py::arg("cos_theta_o").noconvert(), py::arg("order"), py::arg("tolerance"), py::arg("threads"));
    m.def("shade_polygons", &polygons, py::arg("vertices").noconvert(), py::arg("bsdf"),
          py::arg("cos_theta_o").noconvert(), py::arg("order"), py::arg("tolerance"), py::arg("threads"));
}

}  // namespace shlight::python
