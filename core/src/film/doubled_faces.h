// SPDX-License-Identifier: MIT
//
// Faces that lie on others. Rays that begin on one of them in float meet the other or miss it, as rounding has it.
#pragma once

#include <vector>

#include "film/pixel_batch.h"
#include "shlight/parallel.h"
#include "shlight/render_report.h"

namespace shlight {

/// RenderReport::doubled, from camera rays through a grid of pixels.
std::vector<MeshInstance> find_doubled(const Picture& picture, const Stopped& stopped);

}  // namespace shlight
