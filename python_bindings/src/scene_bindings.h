// SPDX-License-Identifier: MIT
//
// shlight.Scene as Python holds it.
#pragma once

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

}  // namespace shlight::python
