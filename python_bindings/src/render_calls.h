// SPDX-License-Identifier: MIT
//
// Functions that all renders share.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "scene_bindings.h"
#include "shlight/parallel.h"
#include "shlight/render.h"
#include "shlight/render_report.h"

namespace shlight::python {

/// Throws std::invalid_argument naming the argument unless it is callable or None.
void check_callable(const char* name, const pybind11::object& callback);
bool is_false(const pybind11::object& value);

/// A Progress that runs in the calling thread, which releases the GIL while it waits, checks signals and calls the
/// callback.
/// Throws std::invalid_argument naming `progress` unless it is callable or None; keeps a reference to the argument.
Progress progress_from(const pybind11::object& callback);

// Arguments of all renders. The functions throw std::invalid_argument naming the argument.

/// An order, or 0 for "auto".
int order_from(const pybind11::object& order);
int samples_from(const char* name, const pybind11::object& samples);
/// None: no limit.
int bounces_from(const char* name, const pybind11::object& bounces);
std::uint32_t seed_from(const pybind11::object& seed);
PixelFilter filter_from(const pybind11::object& pixel_filter, const pybind11::object& filter_width);

/// Throws std::invalid_argument naming `scene` if it has no camera.
const Camera& camera_of(const SceneObject& scene);

/// A Python RenderReport of a picture (RGBA), which says why that is black, if it is.
pybind11::object report_of(const RenderReport& report, double build_seconds, const CompiledScene& scene,
                           std::span<const float> pixels);

/// Compiles the scene in its present state, and returns the seconds that this took. Throws as Scene::compile.
std::pair<std::shared_ptr<const CompiledScene>, double> compiled(SceneObject& object, int threads,
                                                                 const Progress& progress);

}  // namespace shlight::python
