// SPDX-License-Identifier: MIT
#include "monte_carlo_render.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <limits>

#include "arguments.h"
#include "render_calls.h"
#include "tools_bindings.h"

namespace shlight::python {

namespace py = pybind11;

namespace {

py::array_t<float> render(const py::object& scene_object, const py::object& width, const py::object& height,
                          const py::object& samples, const py::object& seed, const py::object& threads,
                          const py::object& progress) {
    auto& scene = object_from<SceneObject>("scene", scene_object, "Scene");
    const auto checked_seed =
        static_cast<std::uint32_t>(integer_from("seed", seed, 0, std::numeric_limits<std::uint32_t>::max()));
    const methods::MonteCarloSettings settings = {int_from("samples", samples), checked_seed,
                                                  int_from("threads", threads)};
    const int columns = int_from("width", width);
    const int rows = int_from("height", height);
    methods::check_monte_carlo(settings, columns, rows);
    const Progress report_progress = progress_from(progress);
    const Camera camera = camera_of(scene);
    const auto compiled_scene = compiled(scene, settings.threads, report_progress).first;
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
