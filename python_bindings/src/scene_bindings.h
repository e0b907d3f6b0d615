// SPDX-License-Identifier: MIT
//
// shlight.Scene as Python holds it.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shlight/camera.h"
#include "shlight/scene.h"

namespace shlight::python {

/// A scene, its camera, and what the last render compiled of it, until something changes. Guarded by the GIL.
struct SceneObject {
    Scene scene;
    std::optional<Camera> camera;
    std::shared_ptr<const CompiledScene> compiled;
    std::shared_ptr<const CompiledScene> before;  ///< what was compiled last, of which the next one shares what it can
    std::uint64_t revision = 0;
    std::vector<std::string> groups;                 ///< LightTraits::group of the first is 1
    std::vector<std::pair<std::string, bool>> aovs;  ///< by RenderPass::number; whether it is a colour

    void changed() {
        before = compiled ? std::exchange(compiled, nullptr) : before;
        ++revision;
    }
};

/// LightTraits::group for a name, or for None; a name that is not known becomes so. Throws std::invalid_argument naming
/// `group` for what is neither.
std::uint32_t group_from(SceneObject& scene, const pybind11::object& name);
/// RenderPass::number of an AOV, which may become known.
std::uint32_t aov_number(SceneObject& scene, const std::string& name, bool is_color);

/// Scene.add_sphere_light and its like.
void bind_cameras(pybind11::class_<SceneObject>& scene);
void bind_lights(pybind11::class_<SceneObject>& scene);
/// Scene.intersect and its like.
void bind_queries(pybind11::class_<SceneObject>& scene);

}  // namespace shlight::python
