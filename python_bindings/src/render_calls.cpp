// SPDX-License-Identifier: MIT
#include "render_calls.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

#include "arguments.h"
#include "chunks.h"
#include "gil.h"

namespace shlight::python {

namespace py = pybind11;

namespace {

constexpr std::array<std::string_view, 3> kFilters = {"box", "gaussian", "blackman_harris"};  // by PixelFilter::Kind

}  // namespace

bool is_false(const py::object& value) {
    return (PyBool_Check(value.ptr()) != 0 || py::isinstance(value, py::module_::import("numpy").attr("bool_"))) &&
           !value.cast<bool>();
}

void check_callable(const char* name, const py::object& callback) {
    if (!callback.is_none() && PyCallable_Check(callback.ptr()) == 0) {
        throw std::invalid_argument(std::string(name) + " must be callable or None");
    }
}

Progress progress_from(const py::object& callback) {
    check_callable("progress", callback);
    return [&callback](double share) {
        throw_at_end();
        const py::gil_scoped_acquire acquire;
        check_signals();
        return callback.is_none() || !is_false(callback(share));
    };
}

int order_from(const py::object& order) {
    if (py::isinstance<py::str>(order) && order.cast<std::string>() == "auto") {
        return 0;
    }
    return static_cast<int>(integer_from("order", order, 1, kMaxOrder));
}

int samples_from(const char* name, const py::object& samples) {
    return static_cast<int>(integer_from(name, samples, 1, kMostPixelSamples));
}

int bounces_from(const char* name, const py::object& bounces) {
    return bounces.is_none() ? kMostBounces : int_from(name, bounces);
}

std::uint32_t seed_from(const py::object& seed) {
    return static_cast<std::uint32_t>(integer_from("seed", seed, 0, std::numeric_limits<std::uint32_t>::max()));
}

PixelFilter filter_from(const py::object& pixel_filter, const py::object& filter_width) {
    const auto name = py::isinstance<py::str>(pixel_filter) ? pixel_filter.cast<std::string>() : std::string();
    const auto* known = std::find(kFilters.begin(), kFilters.end(), name);
    if (known == kFilters.end()) {
        throw std::invalid_argument(R"(pixel_filter must be "box", "gaussian" or "blackman_harris")");
    }
    return {static_cast<PixelFilter::Kind>(known - kFilters.begin()), real_from("filter_width", filter_width)};
}

const Camera& camera_of(const SceneObject& scene) {
    if (!scene.camera) {
        throw std::invalid_argument("scene has no camera: call set_camera() or set_camera_window()");
    }
    return *scene.camera;
}

std::pair<std::shared_ptr<const CompiledScene>, double> compiled(SceneObject& object, int threads,
                                                                 const Progress& progress) {
    if (object.compiled) {
        return {object.compiled, 0.0};
    }
    // A copy, since other Python threads may change the object meanwhile.
    const Scene scene = object.scene;
    const std::shared_ptr<const CompiledScene> before = object.before;
    const std::uint64_t revision = object.revision;
    const auto start = std::chrono::steady_clock::now();
    std::shared_ptr<const CompiledScene> result;
    {
        const GilReleased release;
        result = scene.compile(threads, progress, before.get());
    }
    if (object.revision == revision) {
        object.compiled = result;
        object.before.reset();
    }
    return {result, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
}

}  // namespace shlight::python
