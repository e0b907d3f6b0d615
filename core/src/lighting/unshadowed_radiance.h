// SPDX-License-Identifier: MIT
//
// Eq. 5 for many shading points and lights: outgoing radiance per lobe for lights of unit strength that nothing blocks.
//
// Lights whose emission profile changes over them as a point sees them are multiplied with its mean.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lighting/face_shading.h"
#include "lighting/lobe_integrator.h"
#include "lighting/local_lights.h"
#include "lighting/shading_points.h"
#include "lights/profile_mean.h"
#include "lobes/material_lobes.h"
#include "lobes/material_views.h"
#include "shlight/light.h"
#include "shlight/render_report.h"

namespace shlight {

/// Unshadowed radiance of one light for each lobe and shading point, at index lobe · points + point.
struct LightRadiance {
    std::span<const float> values;  ///< for unit strength; empty: 1
    Rgb strength{1};
    std::span<const Rgb> strengths;  ///< in its place, of a light whose parts differ; otherwise empty

    Rgb operator[](std::size_t i) const {
        return (values.empty() ? 1.0F : values[i]) * (strengths.empty() ? strength : strengths[i]);
    }
};

/// Radiance per light, lobe and shading point.
class UnshadowedRadiance {
  public:
    explicit UnshadowedRadiance(std::size_t lobe_stride) : lobe_stride_(lobe_stride) {}

    /// Adds to the report what the points' hits take. allowed_error: of the radiance of a lobe under one light; 0: the
    /// materials' tolerance of that light's own radiance × albedo. face_tolerance: least relative error of what is
    /// summed up over faces. Precondition: no light is_delta().
    void compute(const ShadingPoints& points, std::span<const MaterialLobes> materials, std::span<const Light> lights,
                 double allowed_error, double face_tolerance, RenderReport& report);
    LightRadiance light(std::size_t index) const;

  private:
    void sort_by_material(const ShadingPoints& points, std::size_t materials);
    /// Some points of one material, under all lights.
    void shade(const ShadingPoints& points, std::span<const std::uint32_t> some, const MaterialLobes& material,
               std::span<const Light> lights, RenderReport& report);
    void integrate(const ShadingPoints& points, std::span<const std::uint32_t> some, const Light& light,
                   std::size_t light_index, RenderReport& report);
    /// Adds what the batch found of one lobe at some[numbers[k]].
    void add(const ShadingPoints& points, std::span<const std::uint32_t> some, std::span<const std::uint32_t> numbers,
             const Light& light, std::size_t light_index, std::size_t lobe, RenderReport& report);
    /// A mesh by the sum over its faces.
    void sum_faces(const ShadingPoints& points, std::span<const std::uint32_t> some, const MeshLight& light,
                   std::size_t light_index, RenderReport& report);
    /// Multiplies the value of a lobe at a view with the mean of the light's profile.
    void apply_profile(std::size_t lobe, std::size_t view, const ShadingPoints& points, std::uint32_t point,
                       const Light& light, float& value);
    /// The place at which the radiance of a light is kept.
    struct Place {
        bool differs;       // among the light's parts: in own_strengths_, or else in values_
        std::size_t begin;  // of lobe_stride · points
    };

    std::size_t lobe_stride_;
    std::size_t point_count_ = 0;
    std::vector<Place> places_;   // by light
    std::vector<Rgb> strengths_;  // likewise
    std::vector<float> values_;   // for unit strength
    std::vector<Rgb> own_strengths_;
    double face_tolerance_ = 0;

    std::vector<std::uint32_t> by_material_, next_of_material_;
    std::vector<double> cosines_;
    std::vector<Rgb> weights_;
    std::vector<LobeForm> forms_;
    MaterialViews views_;  // of some points
    LobeIntegrator batch_;
    LocalLights seen_;
    double tolerance_ = 0, allowed_error_ = 0;
    ProfileMean profile_;
    FaceShading face_shading_;
};

}  // namespace shlight
