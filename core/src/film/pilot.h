// SPDX-License-Identifier: MIT
//
// What is settled before a picture is rendered: where its camera rays go, and how exactly its light is found.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "film/pixel_batch.h"
#include "film/refinement.h"
#include "shlight/parallel.h"
#include "shlight/render_report.h"

namespace shlight {

/// Picture::pixel_points: the same for every level but that of the preview, or the most even ones where there is one
/// level.
std::vector<glm::dvec2> pixel_points(const Refinement& refinement, std::uint32_t seed);

/// Shades a few of the picture's pixels, and sets by them how wrong each light may be and where the environment is
/// open.
void look_ahead(Picture& picture, const Stopped& stopped);

/// RenderReport::doubled.
std::vector<MeshInstance> find_doubled(const Picture& picture, const Stopped& stopped);

}  // namespace shlight
