// SPDX-License-Identifier: MIT
//
// Functions that all renders share.
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

/// A Progress that runs in the calling thread, which releases the GIL while it waits, checks signals and calls the
/// callback.
/// Throws std::invalid_argument naming `progress` unless it is callable or None; keeps a reference to the argument.
Progress progress_from(const pybind11::object& callback);

/// Throws std::invalid_argument naming `scene` if it has no camera.
const Camera& camera_of(const SceneObject& scene);

/// Compiles the scene in its present state, and returns the seconds that this took. Throws as Scene::compile.
std::pair<std::shared_ptr<const CompiledScene>, double> compiled(SceneObject& object, int threads,
                                                                 const Progress& progress);

}  // namespace shlight::python
