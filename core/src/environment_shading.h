// SPDX-License-Identifier: MIT
//
// Outgoing radiance per lobe under an environment that nothing blocks.
#pragma once

#include <span>
#include <vector>

#include "material_lobes.h"
#include "shading_points.h"
#include "shlight/environment.h"
#include "shlight/render.h"

namespace shlight {

class EnvironmentShading {
  public:
    EnvironmentShading(const Environment& environment, std::span<const MaterialLobes> materials,
                       std::size_t lobe_stride);

    /// values: lobe_stride × points; adds to the report what the points' hits take.
    void shade(const ShadingPoints& points, std::vector<Rgb>& values, RenderReport& report) const;

  private:
    const Environment* environment_;
    std::span<const MaterialLobes> materials_;
    std::size_t lobe_stride_;
};

}  // namespace shlight
