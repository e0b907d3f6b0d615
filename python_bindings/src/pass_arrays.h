// SPDX-License-Identifier: MIT
//
// Passes of a render: the arguments that request them and the arrays that return them.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "scene_bindings.h"
#include "shlight/render_passes.h"

namespace shlight::python {

/// Arguments of shlight.render about passes.
struct PassArguments {
    pybind11::object passes, groups, aovs, alpha_threshold, mist, cryptomatte_levels;
};

/// The passes with fixed names. Throws as arguments.h does.
PassSettings pass_settings_from(const PassArguments& arguments);
/// Adds the requested light groups and AOVs of the scene.
void add_named_passes(const PassArguments& arguments, const SceneObject& scene, const CompiledScene& compiled,
                      PassSettings& settings);

/// Multiplies some channels of all pixels (height, width, channels).
void expose(pybind11::array_t<float>& pixels, std::size_t first, std::size_t count, float factor);
/// Multiplies the light among the passes' values (height, width, stride); colours and places stay.
void expose_light(const PassSettings& settings, pybind11::array_t<float>& values, float factor);

/// "combined" and each pass by its name, as views of the values (height, width, stride).
pybind11::dict pass_dict(const PassSettings& settings, const SceneObject& scene, const pybind11::array& image,
                         const pybind11::array& values);

}  // namespace shlight::python
