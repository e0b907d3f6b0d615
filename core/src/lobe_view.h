// SPDX-License-Identifier: MIT
//
// One lobe at one view, ready to be shone at: everything that all lights at a hit share. Each light is integrated in
// the cheapest way that meets the tolerance: as a mirror image, by a few values of f·cos where it is small beside the
// lobe, by spherical harmonics in the lobe's warp, or along its outline.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "shlight/horizon.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"
#include "shlight/warped_fit.h"
#include "spherical_polygon.h"

namespace shlight {

/// Radiance for a light of unit radiance, and what it took.
struct LobeRadiance {
    float value;
    int order;   ///< of the harmonics, or 0
    int points;  ///< of the cubature, or 0; both 0: hidden, or a mirror's image
    bool met;    ///< the tolerance, by what the method estimates
};

class LobeAtView {
  public:
    /// fit: null for a mirror, kept by reference. tolerance: of the radiance ÷ albedo, for auto_order; otherwise the
    /// fit's only order is taken for whatever light.
    LobeAtView(const LobeShape& shape, const WarpedFit* fit, double cos_theta_o, double tolerance, bool auto_order);

    /// A cap in the shading frame, clipped by the horizon.
    LobeRadiance radiance(const Circle& cap) const;
    /// A polygon that was clipped by the horizon.
    LobeRadiance radiance(const SphericalPolygon<double>& polygon) const;

    /// The order for lights that are not small; 0: their outline is integrated, or the lobe is a mirror.
    int order() const { return order_; }

  private:
    const GgxShape& ggx() const { return std::get<GgxShape>(shape_); }
    bool reflects_into(const SphericalPolygon<double>& polygon) const;
    float mirrored() const;

    LobeShape shape_;
    Vec3d view_;
    double tolerance_ = 0;  // of the radiance ÷ albedo
    double albedo_ = 0;
    bool choose_;
    int order_ = 0;
    bool met_ = true;  // by the order
    Warp warp_;
    std::optional<Horizon<float>> horizon_;
    std::vector<float> terms_;
};

}  // namespace shlight
