// SPDX-License-Identifier: MIT
//
// shlight.Scene as Python holds it.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <optional>

#include "shlight/camera.h"
#include "shlight/scene.h"

namespace shlight::python {

/// A scene, its camera, and what the last render compiled of it, until something is added. Guarded by the GIL.
struct SceneObject {
    Scene scene;
    std::optional<Camera> camera;
    std::shared_ptr<const CompiledScene> compiled;
    std::uint64_t revision = 0;

    void changed() {
        compiled.reset();
        ++revision;
    }
};

/// Scene.add_sphere_light and its like.
void bind_lights(pybind11::class_<SceneObject>& scene);

}  // namespace shlight::python
