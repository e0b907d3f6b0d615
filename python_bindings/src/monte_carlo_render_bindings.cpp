// SPDX-License-Identifier: MIT
#include "monte_carlo_render.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>

#include "bindings.h"
#include "render_calls.h"

namespace shlight::python {

namespace py = pybind11;

namespace {

py::array_t<float> render(SceneObject& scene, std::int64_t width, std::int64_t height, std::int64_t samples,
                          std::uint32_t seed, std::int64_t threads, const py::object& progress) {
    const methods::MonteCarloSettings settings = {clamp_to_int(samples), seed, clamp_to_int(threads)};
    const int columns = clamp_to_int(width);
    const int rows = clamp_to_int(height);
    methods::check_monte_carlo(settings, columns, rows);
    const Progress report_progress = progress_from(progress);
    const Camera camera = camera_of(scene);
    const auto compiled_scene = compiled(scene, settings.threads).first;
    py::array_t<float> image({rows, columns, 4});
    const std::span<float> pixels(image.mutable_data(), static_cast<std::size_t>(image.size()));
    {
        const py::gil_scoped_release release;
        methods::render_monte_carlo(*compiled_scene, camera, columns, rows, settings, pixels, report_progress);
    }
    return image;
}

}  // namespace

void bind_monte_carlo_render(py::module_& m) {
    m.def("render_monte_carlo", &render, py::arg("scene"), py::arg("width"), py::arg("height"), py::arg("samples"),
          py::arg("seed"), py::arg("threads"), py::arg("progress"));
}

}  // namespace shlight::python
