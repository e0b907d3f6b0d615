// SPDX-License-Identifier: MIT
//
// Eq. 5 for many shading points and lights: outgoing radiance per lobe for lights of unit strength that nothing blocks.
//
// Lights whose emission profile changes over them as a point sees them are multiplied with its mean.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lights/profile_mean.h"
#include "lobes/material_lobes.h"
#include "lobes/material_views.h"
#include "shading/lobe_batch.h"
#include "shading/seen_lights.h"
#include "shading/shading_points.h"
#include "shlight/light.h"
#include "shlight/render_report.h"

namespace shlight {

/// Radiance per light, lobe and shading point: value (light · lobe_stride + lobe) · points + point.
class DirectLight {
  public:
    explicit DirectLight(std::size_t lobe_stride) : lobe_stride_(lobe_stride) {}

    /// Adds to the report what the points' hits take. Precondition: no light is_delta().
    void compute(const ShadingPoints& points, std::span<const MaterialLobes> materials,
                 std::span<const Light* const> lights, RenderReport& report);
    /// The values of one light, lobe_stride × points.
    std::span<const float> light(std::size_t index) const {
        return std::span(values_).subspan(index * lobe_stride_ * point_count_, lobe_stride_ * point_count_);
    }

  private:
    /// Some points of one material, under all lights.
    void shade(const ShadingPoints& points, std::span<const std::uint32_t> some, const MaterialLobes& material,
               std::span<const Light* const> lights, RenderReport& report);
    void integrate(const ShadingPoints& points, std::span<const std::uint32_t> some, const Light& light,
                   std::size_t light_index, RenderReport& report);
    /// Adds what the batch found of one lobe at some[numbers[k]].
    void add(const ShadingPoints& points, std::span<const std::uint32_t> some, std::span<const std::uint32_t> numbers,
             const Light& light, std::size_t light_index, std::size_t lobe, RenderReport& report);
    /// Multiplies the value of a lobe at a view with the mean of the light's profile.
    void apply_profile(std::size_t lobe, std::size_t view, const ShadingPoints& points, std::uint32_t point,
                       const Light& light, float& value);
    float* values_of(std::size_t light_index, std::size_t lobe) {
        return &values_[(light_index * lobe_stride_ + lobe) * point_count_];
    }

    std::size_t lobe_stride_;
    std::size_t point_count_ = 0;
    std::vector<float> values_;

    std::vector<std::uint32_t> by_material_;
    std::vector<double> cosines_;
    std::vector<Rgb> weights_;
    MaterialViews views_;  // of some points
    LobeBatch batch_;
    SeenLights seen_;
    double tolerance_ = 0;
    ProfileMean profile_;
};

}  // namespace shlight
