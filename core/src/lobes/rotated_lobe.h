// SPDX-License-Identifier: MIT
//
// A lobe's harmonics, rotated into the frame of the light: one rotation serves three colour channels.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <glm/mat3x3.hpp>

#include "lobes/sh_projection.h"
#include "math/band_rotation.h"
#include "shlight/types.h"

namespace shlight {

/// Harmonics of a light in three colour channels.
using ColorHarmonics = std::array<std::vector<float>, 3>;

/// Lobes at one shading point.
class RotatedLobe {
  public:
    /// frame: a rotation, whose columns are the axes of the shading frame in the frame of the light.
    explicit RotatedLobe(const glm::dmat3& frame) : frame_(frame) {}

    /// The order² coefficients of f·cos in the frame of the light; valid until the next call.
    const float* coefficients(const ShProjection& lobe, float cos_theta_o, int order);
    /// Eq. 5 of the paper: Σ lobe · light over the bands below `order`; the light has at least as many coefficients.
    static Rgb reflected(const ColorHarmonics& light, const float* lobe, int order);

  private:
    void set_zonal(int order);
    void set_turned(int order);

    glm::dmat3 frame_;
    std::optional<BandRotation> rotation_;
    std::array<float, cosine_count(kMaxOrder)> terms_;
    std::array<float, coefficient_count(kMaxOrder)> coefficients_;
};

}  // namespace shlight
