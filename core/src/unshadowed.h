// SPDX-License-Identifier: MIT
//
// Eq. 5 for many shading points and lights: outgoing radiance per lobe for lights of unit radiance that nothing blocks.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "material_lobes.h"
#include "shading_points.h"
#include "shlight/light.h"
#include "shlight/render.h"

namespace shlight {

/// Radiance per light, lobe and shading point: value (light · lobe_stride + lobe) · points + point.
class Unshadowed {
  public:
    explicit Unshadowed(std::size_t lobe_stride) : lobe_stride_(lobe_stride) {}

    /// Adds to the report what the points' hits take.
    void compute(const ShadingPoints& points, std::span<const MaterialLobes> materials, std::span<const Light> lights,
                 RenderReport& report);
    /// The values of one light, lobe_stride × points.
    std::span<const float> light(std::size_t index) const {
        return std::span(values_).subspan(index * lobe_stride_ * point_count_, lobe_stride_ * point_count_);
    }

  private:
    /// The lobes of one point under one light.
    template <class Region>
    void shade(const Region& region, std::size_t light, std::size_t point, std::uint32_t hits, RenderReport& report);

    std::size_t lobe_stride_;
    std::size_t point_count_ = 0;
    std::vector<std::optional<LobeAtView>> lobes_;  // of the point at hand
    std::vector<float> values_;
    std::vector<Vec3d> vertices_;
};

}  // namespace shlight
