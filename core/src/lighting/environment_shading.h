// SPDX-License-Identifier: MIT
//
// Outgoing radiance per lobe under an environment that nothing blocks.
//
// One radiance from everywhere: the lobe's albedo times it. A picture: its harmonics times the lobe's, turned to its
// frame, of the smallest order that meets the tolerance, and its bright spots one by one. For a lobe too narrow for 64
// bands, what they leave of the picture is summed over directions that the lobe reflects, blurred as far as these are
// apart.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/recent_values.h"
#include "lighting/environment_spots.h"
#include "lighting/shading_points.h"
#include "lobes/material_lobes.h"
#include "lobes/sh_projection.h"
#include "shlight/environment.h"
#include "shlight/render_report.h"

namespace shlight {

/// Radiance that each lobe reflects at each point, at index lobe · points + point, in parts with separate shadows: a
/// sun is hidden or not, independently of the sky.
struct UnshadowedParts {
    std::vector<Rgb> smooth, spots;
};

/// Immutable; any number of threads may read it.
class EnvironmentShading {
  public:
    /// order, tolerance: of RenderSettings.
    EnvironmentShading(const Environment& environment, std::span<const MaterialLobes> materials,
                       std::size_t lobe_stride, int order, double tolerance);

    /// Mirrors are left out. Adds to the report what the points' hits take.
    void shade(const ShadingPoints& points, UnshadowedParts& parts, RenderReport& report) const;
    /// Whether spots are a part of their own for a lobe of this form.
    bool splits(std::size_t material, std::size_t lobe, const LobeForm& form) const;

  private:
    struct Choice {
        int order;
        bool directions;  // in place of this order
        bool met;         // the tolerance, by the order
    };
    /// How a lobe is shaded under a picture.
    struct Plan {
        std::shared_ptr<const ShProjection> lobe;  // null: a mirror, or of two widths
        std::vector<Choice> choices;               // of each tabulated view
    };
    /// A lobe's plan, or the plans between which its width lies.
    struct PlanMix {
        const Plan* plans[2];  // NOLINT(modernize-avoid-c-arrays)
        float share;           // of the second
    };
    class Point;
    class Harmonics;

    Plan plan(const LobeShape& shape) const;
    /// Whether spots, too, have an extent beside the lobe.
    bool sees_texels(const LobeShape& shape) const;
    PlanMix plans(std::size_t material, std::size_t lobe, float width) const;
    void shade_constant(const ShadingPoints& points, std::span<Rgb> smooth, RenderReport& report) const;
    void shade_map(const ShadingPoints& points, UnshadowedParts& parts, RenderReport& report) const;
    /// function(point, lobe, its shape, Point, index in UnshadowedParts)
    template <class Function>
    void for_each_lobe(const ShadingPoints& points, const Function& function) const;
    static Choice choose(const Plan& plan, double cos_theta_o, double azimuth);
    /// shape: with the width that the mix stands for.
    Choice choose(const PlanMix& mix, const LobeShape& shape, double cos_theta_o, double azimuth) const;
    /// Returns what serves both.
    static Choice either(const Choice& a, const Choice& b);

    const Environment* environment_;
    std::span<const MaterialLobes> materials_;
    std::size_t lobe_stride_;
    int order_;
    double tolerance_;
    std::optional<EnvironmentSpots> spots_;
    std::vector<std::vector<Plan>> plans_;  // of each material's lobes; empty without a picture
    /// Plans of lobes whose width varies, at TabulatedWidths; null: the width is the same.
    std::vector<std::vector<std::unique_ptr<const ValuesByNumber<Plan>>>> width_plans_;
};

}  // namespace shlight
