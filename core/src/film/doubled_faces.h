// SPDX-License-Identifier: MIT
//
// The faces of a picture that lie on others, see surfaces/doubled_faces.h.
#pragma once

#include <vector>

#include "film/pixel_batch.h"
#include "shlight/parallel.h"
#include "shlight/render_report.h"

namespace shlight {

/// A flag for each placement of the scene: some of its faces lie on others where camera rays through a grid of pixels
/// meet them. Empty if none do.
std::vector<bool> find_doubled(const Picture& picture, const Stopped& stopped);

/// The same placements as RenderReport::doubled lists them.
std::vector<MeshInstance> instances_of(const CompiledScene& scene, const std::vector<bool>& placements);

}  // namespace shlight
