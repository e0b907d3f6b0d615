// SPDX-License-Identifier: MIT
//
// Batch functions on flat arrays; shlight/shading.py broadcasts their arguments.
#include <tbb/enumerable_thread_specific.h>

#include "arrays.h"
#include "bindings.h"
#include "chunks.h"
#include "gil.h"
#include "shaded.h"
#include "shlight/light_shading.h"

namespace shlight::python {
namespace {

/// Calls work(shader, first, count) for parts of 0 … total-1, without the GIL, with one shader per thread.
template <class Work>
void shade_parts(std::size_t total, const Bsdf& bsdf, const ShadeSettings& settings, int threads, const Work& work) {
    tbb::enumerable_thread_specific<LightShader> shaders([&] { return LightShader(bsdf, settings); });
    {
        const GilReleased release;
        shaders.local();  // checks the settings even if there are no lights
    }
    in_chunks(total, threads, [&](std::size_t first, std::size_t count) { work(shaders.local(), first, count); });
}

/// Arrays of shlight.Bsdfs, colours (lights, lobes, 3) and alphas (lights, lobes), are empty for a Bsdf.
struct OwnLobes {
    Array<float> colors, alphas;

    LightLobes of(std::size_t first, std::size_t count) const {
        return {part(vectors("colors", colors), colors, first, count), part(values(alphas), alphas, first, count)};
    }

  private:
    template <class Span>
    static Span part(const Span& all, const Array<float>& array, std::size_t first, std::size_t count) {
        const std::size_t lobes = all.empty() ? 0 : static_cast<std::size_t>(array.shape(1));
        return all.subspan(first * lobes, count * lobes);
    }
};

/// cos_theta_o, azimuth: one for each light, or one for all.
template <class T>
py::tuple spheres(const Array<T>& centers, const Array<T>& radii, const Bsdf& bsdf, const Array<double>& cos_theta_o,
                  const Array<double>& azimuth, const Array<float>& colors, const Array<float>& alphas, int order,
                  double tolerance, int threads, bool with_effort) {
    const auto c = vectors("centers", centers);
    const auto r = values(radii);
    const auto views = values(cos_theta_o);
    const auto turns = values(azimuth);
    const OwnLobes own = {colors, alphas};
    const Shaded out(c.size(), with_effort);
    shade_parts(c.size(), bsdf, {order, tolerance}, threads,
                [&](LightShader& shader, std::size_t first, std::size_t count) {
                    shader.spheres(c.subspan(first, count), r.subspan(first, count), part_of(views, first, count),
                                   out.colors.subspan(first, count), out.effort_of(first, count),
                                   part_of(turns, first, count), own.of(first, count));
                });
    return out.result();
}

template <class T>
py::tuple polygons(const Array<T>& vertices, const Bsdf& bsdf, const Array<double>& cos_theta_o,
                   const Array<double>& azimuth, const Array<float>& colors, const Array<float>& alphas, int order,
                   double tolerance, int threads, bool with_effort) {
    const auto v = vectors("vertices", vertices);
    const auto k = static_cast<std::size_t>(vertices.shape(1));
    const auto views = values(cos_theta_o);
    const auto turns = values(azimuth);
    const OwnLobes own = {colors, alphas};
    const Shaded out(v.size() / k, with_effort);
    shade_parts(v.size() / k, bsdf, {order, tolerance}, threads,
                [&](LightShader& shader, std::size_t first, std::size_t count) {
                    shader.polygons(v.subspan(first * k, count * k), static_cast<int>(k), part_of(views, first, count),
                                    out.colors.subspan(first, count), out.effort_of(first, count),
                                    part_of(turns, first, count), own.of(first, count));
                });
    return out.result();
}

template <class T>
py::tuple disks(const Array<T>& centers, const Array<T>& half_axes_u, const Array<T>& half_axes_v, const Bsdf& bsdf,
                const Array<double>& cos_theta_o, const Array<double>& azimuth, const Array<float>& colors,
                const Array<float>& alphas, int order, double tolerance, int threads, bool with_effort) {
    const auto c = vectors("centers", centers);
    const auto u = vectors("half_axes_u", half_axes_u);
    const auto v = vectors("half_axes_v", half_axes_v);
    const auto views = values(cos_theta_o);
    const auto turns = values(azimuth);
    const OwnLobes own = {colors, alphas};
    const Shaded out(c.size(), with_effort);
    shade_parts(c.size(), bsdf, {order, tolerance}, threads,
                [&](LightShader& shader, std::size_t first, std::size_t count) {
                    shader.disks(c.subspan(first, count), u.subspan(first, count), v.subspan(first, count),
                                 part_of(views, first, count), out.colors.subspan(first, count),
                                 out.effort_of(first, count), part_of(turns, first, count), own.of(first, count));
                });
    return out.result();
}

template <class T>
void bind(py::module_& m) {
    m.def("shade_spheres", &spheres<T>, py::arg("centers").noconvert(), py::arg("radii").noconvert(), py::arg("bsdf"),
          py::arg("cos_theta_o").noconvert(), py::arg("azimuth").noconvert(), py::arg("colors").noconvert(),
          py::arg("alphas").noconvert(), py::arg("order"), py::arg("tolerance"), py::arg("threads"),
          py::arg("with_effort"));
    m.def("shade_polygons", &polygons<T>, py::arg("vertices").noconvert(), py::arg("bsdf"),
          py::arg("cos_theta_o").noconvert(), py::arg("azimuth").noconvert(), py::arg("colors").noconvert(),
          py::arg("alphas").noconvert(), py::arg("order"), py::arg("tolerance"), py::arg("threads"),
          py::arg("with_effort"));
    m.def("shade_disks", &disks<T>, py::arg("centers").noconvert(), py::arg("half_axes_u").noconvert(),
          py::arg("half_axes_v").noconvert(), py::arg("bsdf"), py::arg("cos_theta_o").noconvert(),
          py::arg("azimuth").noconvert(), py::arg("colors").noconvert(), py::arg("alphas").noconvert(),
          py::arg("order"), py::arg("tolerance"), py::arg("threads"), py::arg("with_effort"));
}

}  // namespace

void bind_shading(py::module_& m) {
    bind<float>(m);
    bind<double>(m);
}

}  // namespace shlight::python
