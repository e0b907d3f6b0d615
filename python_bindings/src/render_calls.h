// SPDX-License-Identifier: MIT
//
// What functions that render have in common.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <utility>

#include "scene_bindings.h"
#include "shlight/parallel.h"

namespace shlight::python {

/// Throws std::invalid_argument naming the argument unless it is callable or None.
void check_callable(const char* name, const pybind11::object& callback);
bool is_false(const pybind11::object& value);

/// Runs in the calling thread, which does not hold the GIL while it waits: signals are seen, and the callback called.
/// Throws std::invalid_argument naming `progress` unless it is callable or None; keeps a reference to the argument.
Progress progress_from(const pybind11::object& callback);

/// Throws std::invalid_argument naming `scene` if it has no camera.
const Camera& camera_of(const SceneObject& scene);

/// The compiled scene of the object as it is now, and the seconds that building it has taken. Throws as Scene::compile.
std::pair<std::shared_ptr<const CompiledScene>, double> compiled(SceneObject& object, int threads,
                                                                 const Progress& progress);

}  // namespace shlight::python
