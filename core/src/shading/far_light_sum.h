// SPDX-License-Identifier: MIT
//
// The dimmest lights of a group of shading points, summed up as one light from all around: its harmonics at the corners
// of a box about the points, and between these linearly.
//
// As many lights are taken as keep within the tolerance, of the light that reaches a point. What a sum is off by has
// two parts. One comes of the box: a light's irradiance and direction are not linear in the place; the second
// difference bounds it, and these bounds are added. The other comes of the bands that are left out: as for pictures of
// all directions (EnvironmentShading), it is the root mean square over all turns of the sum.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>

#include "lobes/material_lobes.h"
#include "lobes/rotated_lobe.h"
#include "shading/far_lights.h"
#include "shading/shading_points.h"

namespace shlight {

/// Keeps its memory; one per thread.
class FarLightSum {
  public:
    /// tolerance: of RenderSettings.
    FarLightSum(const FarLights& far, std::span<const MaterialLobes> materials, double tolerance);

    /// Chooses the lights, perhaps none, and sums them up. points: stay as they are until the next call.
    void choose(const ShadingPoints& points);
    bool empty() const { return summed_.empty(); }
    /// Whether a light, by FarLight::index, is in the sum.
    bool holds(std::size_t index) const {
        return !summed_.empty() && index < is_summed_.size() && is_summed_[index] != 0;
    }

    std::size_t size() const { return summed_.size(); }
    const FarLight& light(std::size_t i) const { return far_->lights()[summed_[i].light]; }
    /// A light in proportion to how bright it is from the middle of the box. random: 0 … 1.
    std::size_t find(double random) const;
    /// Up to a factor, how probable that one is.
    double density(std::size_t i) const {
        return summed_[i].brightness_up_to - (i > 0 ? summed_[i - 1].brightness_up_to : 0.0);
    }
    /// What a point reflects of the sum if nothing blocks it.
    const Rgb& radiance(std::size_t point) const { return radiance_[point]; }

  private:
    struct Candidate {
        std::size_t light;
        double brightness;  // no point gets more, facing it
        double curvature;   // of the box, and of what the light's extent blurs: (size ÷ distance)²
    };
    struct SummedLight {
        std::size_t light;
        double brightness_up_to;
    };
    /// Errors of the worst point, ÷ the light that reaches it.
    struct Limits {
        double curved;  // of a candidate: per brightness · curvature
        double left;    // of a sum: per root of the power of each band that is left out
    };
    bool set_box();
    void find_candidates();
    void estimate_brightness();
    Limits find_limits();
    std::size_t count_within(const Limits& limits);
    /// Of the first so many candidates, as seen from a place.
    void add_up(const Vec3d& place, std::size_t count, int order, ColorHarmonics& sum);
    static double last_power(const ColorHarmonics& sum);
    void take(std::size_t count);
    void reflect();
    glm::dmat3 frame_of(std::size_t point) const;
    /// For interpolation in the box.
    std::array<float, 8> corner_weights(std::size_t point) const;

    const FarLights* far_;
    std::span<const MaterialLobes> materials_;
    double tolerance_;
    const ShadingPoints* points_ = nullptr;
    Vec3d low_{0}, size_{0};  // the box
    std::vector<Candidate> candidates_;
    std::vector<double> brightness_;  // by point, of the candidates together
    std::array<ColorHarmonics, 8> corners_;
    std::vector<SummedLight> summed_;
    std::vector<std::uint8_t> is_summed_;  // by FarLight::index
    std::vector<Rgb> radiance_;            // by point
    std::vector<Vec3f> directions_;
    std::vector<float> basis_;
};

}  // namespace shlight
