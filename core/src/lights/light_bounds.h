// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "shlight/light.h"
#include "tracing/occluder_boxes.h"

namespace shlight {

/// A box around a light; none for a mesh, whose faces are among the surfaces that may block it.
std::optional<LightBounds> bounds_of(const Light& light);

}  // namespace shlight
