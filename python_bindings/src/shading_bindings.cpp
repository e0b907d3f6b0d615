// SPDX-License-Identifier: MIT
//
// Flat batch functions; shlight/shading.py broadcasts in front of them.
#include "arrays.h"
#include "bindings.h"
#include "chunks.h"
#include "shaded.h"
#include "shlight/light_shading.h"

namespace shlight::python {
namespace {

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
