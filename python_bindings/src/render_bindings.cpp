// SPDX-License-Identifier: MIT
#include "shlight/render.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <tuple>

#include "arguments.h"
#include "bindings.h"
#include "render_calls.h"
#include "whole_objects.h"

using namespace pybind11::literals;

namespace shlight::python {
namespace {

constexpr const char* kRenderDoc = R"(Render the direct light of a scene.

scene: a Scene with a camera.
width, height: pixels.
order: 1 ... 64: harmonics of this order for every light, or "auto": for each lobe, view and light the cheapest of
    harmonics in the lobe's warp and cubature that meets the tolerance.
tolerance: error of what a point reflects / that, or / a tenth of the picture's mean where that is larger; > 0.
pixel_samples: camera rays per pixel, over a box of one pixel; rounded up to a power of two if adaptive.
adaptive: take up to 16 times as many where they disagree, as at edges, unless pixel_samples is 1.
shadow_rays: per camera ray and light, at most, and again for each roughness of the material's glossy lobes; a quarter
    of them where light and shadow are plain. 0: no shadows.
transparent_bounces: surfaces that let light through which a shadow ray passes, at most, 0 ... 1024; a camera ray
    passes one more.
threads: at most; 0: all cores. The image does not depend on it.
progress: is called with the finished share, 0 ... 1, about every 50 ms; returning False cancels. What it raises ends
    the render and is raised here.
return_report: return (image, RenderReport).

Returns (height, width, 4) float32, linear, row 0 on top, RGB premultiplied; alpha is the share of
what is not empty: a surface, or an environment that the camera sees.
Raises ValueError naming the argument, RenderCancelled.)";

/// A report with what only Python's side knows.
struct Report {
    RenderReport core;
    double build_seconds;

    double share(std::uint64_t count) const {
        const std::uint64_t harmonics =
            std::accumulate(core.order_counts.begin(), core.order_counts.end(), std::uint64_t{0});
        const std::uint64_t all = harmonics + core.cubature_count + core.mirror_count;
        return all == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(all);
    }
    std::map<int, double> order_shares() const {
        std::map<int, double> shares;
        for (std::size_t order = 0; order < core.order_counts.size(); ++order) {
            if (core.order_counts[order] > 0) {
                shares[static_cast<int>(order)] = share(core.order_counts[order]);
            }
        }
        return shares;
    }
    double cubature_share() const { return share(core.cubature_count); }
    double mirror_share() const { return share(core.mirror_count); }
    double over_tolerance() const { return share(core.over_tolerance); }
    double summed_lights() const {
        return core.hits == 0 ? 0.0 : static_cast<double>(core.summed_count) / static_cast<double>(core.hits);
    }
    py::dict stage_seconds() const {
        py::dict seconds;
        for (std::size_t stage = 0; stage < kRenderStages.size(); ++stage) {
            seconds[kRenderStages[stage]] = core.stage_seconds[stage];
        }
        return seconds;
    }
    std::string repr() const {
        return "RenderReport(hits=" + std::to_string(core.hits) + ", shadow_rays=" + std::to_string(core.shadow_rays) +
               ", over_tolerance=" + std::to_string(over_tolerance()) +
               ", build_seconds=" + std::to_string(build_seconds) + ", render_seconds=" + std::to_string(core.seconds) +
               ")";
    }
};

using ReportState = std::tuple<std::array<std::uint64_t, kMaxOrder + 1>, std::array<std::uint64_t, 6>, double,
                               std::array<double, kRenderStages.size()>, double>;

ReportState report_state(const Report& report) {
    const RenderReport& core = report.core;
    return {
        core.order_counts,
        {core.cubature_count, core.mirror_count, core.over_tolerance, core.summed_count, core.hits, core.shadow_rays},
        core.seconds,
        core.stage_seconds,
        report.build_seconds};
}

Report report_from(const ReportState& state) {
    const auto& [order_counts, counts, seconds, stage_seconds, build_seconds] = state;
    const auto& [cubature, mirror, over_tolerance, summed, hits, shadow_rays] = counts;
    return {{order_counts, cubature, mirror, over_tolerance, summed, hits, shadow_rays, seconds, stage_seconds},
            build_seconds};
}

int order_from(const py::object& order) {
    if (py::isinstance<py::str>(order) && order.cast<std::string>() == "auto") {
        return 0;
    }
    return static_cast<int>(integer_from("order", order, 1, kMaxOrder));
}

py::object render_scene(const py::object& scene_object, const py::object& width, const py::object& height,
                        const py::object& order, const py::object& tolerance, const py::object& pixel_samples,
                        const py::object& shadow_rays, const py::object& transparent_bounces, const py::object& threads,
                        const py::object& progress, const py::object& adaptive, const py::object& return_report) {
    auto& scene = object_from<SceneObject>("scene", scene_object, "Scene");
    const RenderSettings settings = {order_from(order),
                                     real_from("tolerance", tolerance),
                                     int_from("pixel_samples", pixel_samples),
                                     int_from("shadow_rays", shadow_rays),
                                     int_from("threads", threads),
                                     flag_from("adaptive", adaptive),
                                     int_from("transparent_bounces", transparent_bounces)};
    const int columns = int_from("width", width);
    const int rows = int_from("height", height);
    const bool with_report = flag_from("return_report", return_report);
    check_render(settings, columns, rows);
    const Progress report_progress = progress_from(progress);
    const Camera camera = camera_of(scene);
    const auto [compiled_scene, build_seconds] = compiled(scene, settings.threads);
    py::array_t<float> image({rows, columns, 4});
    const std::span<float> pixels(image.mutable_data(), static_cast<std::size_t>(image.size()));
    RenderReport report;
    {
        const py::gil_scoped_release release;
        report = render(*compiled_scene, camera, columns, rows, settings, pixels, report_progress);
    }
    if (with_report) {
        return py::make_tuple(image, Report{report, build_seconds});
    }
    return image;
}

}  // namespace

void bind_render(py::module_& m) {
    py::register_exception<RenderCancelled>(m, "RenderCancelled", PyExc_RuntimeError);
    py::class_<Report> report_type(m, "RenderReport", "What a picture took.", without_constructor());
    define_pickling(report_type, &report_state, &report_from);
    report_type
        .def_property_readonly("order_shares", &Report::order_shares,
                               "Shares of what was shaded by harmonics, by their order. Once is a lobe of a camera hit "
                               "under a light that it sees.")
        .def_property_readonly("cubature_share", &Report::cubature_share, "Share of what was shaded by cubature.")
        .def_property_readonly("mirror_share", &Report::mirror_share, "Share of what showed a light's own image.")
        .def_property_readonly("over_tolerance", &Report::over_tolerance,
                               "Share whose estimated error exceeds the tolerance.")
        .def_property_readonly("summed_lights", &Report::summed_lights,
                               "Lights that a hit had summed up from afar in place of being shaded one by one, on "
                               "average; not part of the shares.")
        .def_property_readonly(
            "hits", [](const Report& r) { return r.core.hits; }, "Camera rays that met a surface.")
        .def_property_readonly(
            "shadow_rays", [](const Report& r) { return r.core.shadow_rays; }, "Shadow rays traced.")
        .def_readonly("build_seconds", &Report::build_seconds, "Time for building what rays are traced in; 0 if kept.")
        .def_property_readonly(
            "render_seconds", [](const Report& r) { return r.core.seconds; }, "Time for rendering.")
        .def_property_readonly("stage_seconds", &Report::stage_seconds,
                               "Time for each stage, summed over threads: camera rays; views, of the materials there; "
                               "light, without shadows; shadows; pixels, adding up.")
        .def("__repr__", &Report::repr);
    m.def("render", &render_scene, kRenderDoc, "scene"_a, "width"_a, "height"_a, py::kw_only(), "order"_a = "auto",
          "tolerance"_a = kDefaultTolerance, "pixel_samples"_a = 16, "shadow_rays"_a = 16, "transparent_bounces"_a = 8,
          "threads"_a = 0, "progress"_a = py::none(), "adaptive"_a = true, "return_report"_a = false);
}

}  // namespace shlight::python
