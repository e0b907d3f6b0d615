// SPDX-License-Identifier: MIT
//
// Shader programs as Python builds them (shlight.nodes).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "shlight/surface_shader.h"

namespace shlight::python {

/// A material with a program, and the names of the attributes to which its inputs refer by index.
struct ShaderObject {
    std::shared_ptr<const SurfaceShader> shader;
    std::vector<std::string> attribute_names;
    std::vector<std::string> aov_names;
};

}  // namespace shlight::python
