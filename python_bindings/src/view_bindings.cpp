// SPDX-License-Identifier: MIT
//
// Scene.view: pictures that are lit again and again.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <limits>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>

#include "arguments.h"
#include "gil.h"
#include "render_calls.h"
#include "scene_bindings.h"
#include "shlight/fixed_view.h"
#include "whole_objects.h"

using namespace pybind11::literals;

namespace shlight::python {
namespace {

constexpr const char* kViewDoc = R"(Keep what the camera sees, to light it again and again.

The View that is returned has the scene's camera as it is now. Its relight() makes the picture of the scene as it is
then, of direct light: camera rays are traced once, and what each light brings is kept, so that a change of one light
costs that light alone.

width, height: pixels. pixel_samples: camera rays of each pixel.
shadow_rays: per camera ray and light in one pass, at most; 0 ... 16384.
order, tolerance, pixel_filter, filter_width, shadows, transparent_bounces, seed: see shlight.render.
threads: of each relight(), at most; 0: all cores. The picture does not depend on it.

Raises ValueError naming the argument.)";

constexpr const char* kViewTypeDoc = R"(A picture of a Scene that is lit again and again, as Scene.view returns it.

It belongs to that scene alone, of which it sees all changes but that of the camera. It holds some 600 bytes for each
camera ray, and for each light 24 for each pixel, 12 without shadows; where there are many lights, up to 32 and 32 of
no size take as much as one.

>>> scene = shlight.Scene()
>>> floor = scene.add_mesh([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], [[0, 1, 2], [0, 2, 3]])
>>> lamp = scene.add_sphere_light((0, 0, 1), 0.2, radiance=10)
>>> scene.set_camera(shlight.look_at((0, -3, 2), (0, 0, 0)), fov_x=0.8)
>>> view = scene.view(32, 24)
>>> bright = view.relight()
>>> lamp.radiance = 5
>>> float((view.relight()[12, 16, 0] / bright[12, 16, 0]).round(3))
0.5)";

constexpr const char* kRelightDoc = R"(Make the picture of the scene as it is now.

Lights that have changed since the last call are found anew, by one pass of shadow rays; one that has only been dimmed,
switched, or made up to twice as bright is scaled. Camera rays are traced again if a mesh or the environment has
changed, or a light that camera rays see, themselves or in mirrors.
noise_threshold: passes go on, each with as many shadow rays as those before, over parts of the picture and their lights
    until report.noise is not above it, 0 < noise_threshold <= 1, or a camera ray has sent 16384 to a light. None: there
    is one pass.
progress: is called with 0 about every 10 ms; returning False cancels.

Returns a RenderResult, as shlight.render does of the same settings with max_bounces=0 and max_samples=pixel_samples, but
for the noise of shadow rays, and errors within the tolerance. Its report is of this call; report.noise
is that of the whole picture by shadow rays.
Raises ValueError naming the argument, RenderCancelled, and RuntimeError while another call lights the view.)";

/// A view of a scene; it keeps the scene alive.
struct ViewHandle {
    py::object owner;
    std::unique_ptr<FixedView> view;
    std::unique_ptr<std::mutex> relighting;
    int threads;

    SceneObject& scene() const { return owner.cast<SceneObject&>(); }
};

ViewHandle view_of(const py::object& self, const py::object& width, const py::object& height, const py::object& order,
                   const py::object& tolerance, const py::object& pixel_samples, const py::object& pixel_filter,
                   const py::object& filter_width, const py::object& shadows, const py::object& shadow_rays,
                   const py::object& transparent_bounces, const py::object& threads, const py::object& seed) {
    RenderSettings settings;
    settings.order = order_from(order);
    settings.tolerance = real_from("tolerance", tolerance);
    settings.sampling = PixelSampling::fixed(samples_from("pixel_samples", pixel_samples));
    settings.filter = filter_from(pixel_filter, filter_width);
    const int most_shadow_rays = int_from("shadow_rays", shadow_rays);
    settings.shadow_rays = flag_from("shadows", shadows) ? most_shadow_rays : 0;
    settings.transparent_bounces = int_from("transparent_bounces", transparent_bounces);
    settings.threads = int_from("threads", threads);
    settings.seed = seed_from(seed);
    const int columns = int_from("width", width);
    const int rows = int_from("height", height);
    const Camera& camera = camera_of(self.cast<SceneObject&>());
    return {self, std::make_unique<FixedView>(camera, columns, rows, settings), std::make_unique<std::mutex>(),
            settings.threads};
}

double threshold_from(const py::object& noise_threshold) {
    if (noise_threshold.is_none()) {
        return std::numeric_limits<double>::infinity();
    }
    const double threshold = real_from("noise_threshold", noise_threshold);
    if (!(threshold > 0 && threshold <= 1)) {
        throw std::invalid_argument("noise_threshold must be above 0 and at most 1, or None");
    }
    return threshold;
}

py::object relight(ViewHandle& self, const py::object& noise_threshold, const py::object& progress) {
    const double threshold = threshold_from(noise_threshold);
    const Progress report_progress = progress_from(progress);
    const auto [scene, build_seconds] = compiled(self.scene(), self.threads, report_progress);
    py::array_t<float> image({self.view->height(), self.view->width(), 4});
    const std::span<float> pixels(image.mutable_data(), static_cast<std::size_t>(image.size()));
    RenderReport report;
    {
        const GilReleased release;
        const std::unique_lock lock(*self.relighting, std::try_to_lock);
        if (!lock.owns_lock()) {
            throw std::runtime_error("the view is being lit by another call");
        }
        report = self.view->relight(scene, threshold, pixels, report_progress);
    }
    py::dict layers;
    layers["combined"] = image;
    return py::module_::import("shlight.rendering")
        .attr("RenderResult")(layers, report_of(report, build_seconds, *scene, pixels));
}

}  // namespace

void bind_views(py::module_& m, py::class_<SceneObject>& scene) {
    py::class_<ViewHandle>(m, "View", kViewTypeDoc, without_constructor())
        .def("relight", &relight, kRelightDoc, py::kw_only(), "noise_threshold"_a = py::none(),
             "progress"_a = py::none())
        .def_property_readonly(
            "width", [](const ViewHandle& self) { return self.view->width(); }, "Pixels.")
        .def_property_readonly(
            "height", [](const ViewHandle& self) { return self.view->height(); }, "Pixels.")
        .def("__repr__", [](const ViewHandle& self) {
            return "View(" + std::to_string(self.view->width()) + " x " + std::to_string(self.view->height()) + ")";
        });
    scene.def("view", &view_of, kViewDoc, "width"_a, "height"_a, py::kw_only(), "order"_a = "auto",
              "tolerance"_a = kDefaultTolerance, "pixel_samples"_a = 1, "pixel_filter"_a = "box",
              "filter_width"_a = PixelFilter().width, "shadows"_a = true, "shadow_rays"_a = 4,
              "transparent_bounces"_a = 8, "threads"_a = 0, "seed"_a = 0);
}

}  // namespace shlight::python
