// SPDX-License-Identifier: MIT
//
// shlight.Scene as Python holds it.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shlight/camera.h"
#include "shlight/light.h"
#include "shlight/scene.h"

namespace shlight::python {

/// A lamp as Python has described it, from which the scene's is made.
struct LampRecord {
    const char* kind;           ///< "sphere" …
    const char* strength_name;  ///< "radiance" …
    Rgb strength;
    LightTraits traits;
    /// Throws std::invalid_argument naming the argument that is wrong.
    std::function<Light(const LampRecord&)> make;
    glm::dmat4 to_world{1};  ///< from the frame of the arguments
};

/// A scene, its camera, and what the last render compiled of it, until something changes. Guarded by the GIL.
struct SceneObject {
    Scene scene;
    std::optional<Camera> camera;
    std::shared_ptr<const CompiledScene> compiled;
    std::shared_ptr<const CompiledScene> before;  ///< what was compiled last, of which the next one shares what it can
    std::uint64_t revision = 0;
    std::map<Scene::LampNumber, LampRecord> lamps;
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
/// The name of LightTraits::group, or None.
pybind11::object group_name(const SceneObject& scene, std::uint32_t group);
/// RenderPass::number of an AOV, which may become known.
std::uint32_t aov_number(SceneObject& scene, const std::string& name, bool is_color);

/// Scene.add_sphere_light and its like.
void bind_cameras(pybind11::class_<SceneObject>& scene);
void bind_lights(pybind11::module_& m, pybind11::class_<SceneObject>& scene);
/// Scene.intersect and its like.
void bind_queries(pybind11::class_<SceneObject>& scene);
/// Scene.view.
void bind_views(pybind11::module_& m, pybind11::class_<SceneObject>& scene);

}  // namespace shlight::python
