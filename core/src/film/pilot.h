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

namespace shlight {

/// Pixels spread evenly over a picture. least_step: from one to the next; most: of a row or column, about.
std::vector<Pixel> spread_pixels(const Picture& picture, int least_step, int most);

/// Picture::pixel_points: the same for every level but that of the preview, or the most even ones where there is one
/// level.
std::vector<glm::dvec2> pixel_points(const Refinement& refinement, std::uint32_t seed);

/// Shades a few of the picture's pixels, and sets by them how wrong each light may be and where the environment is
/// open.
void look_ahead(Picture& picture, const Stopped& stopped);

}  // namespace shlight
