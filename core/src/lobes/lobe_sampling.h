// SPDX-License-Identifier: MIT
//
// Directions in which a GGX lobe reflects a viewer's ray, spread as its microfacets that the viewer sees: the normals'
// density is G₁ ⟨ω_o·h⟩ D / cosθ_o (Heitz 2018, "Sampling the GGX distribution of visible normals"; by spherical caps,
// Dupuy & Benyoub 2023). f·cos over the density is then F G₂/G₁, never large for any roughness and view.
#pragma once

#include <glm/vec2.hpp>

#include "shlight/types.h"

namespace shlight {

/// In the shading frame; alpha of 0 is a mirror, which has one direction and no density.
class LobeSampler {
  public:
    /// view: unit, above the horizon, in the xz-plane.
    LobeSampler(double alpha, const Vec3d& view);

    /// Unit; may lie below the horizon. Continuous in the point but for one line.
    Vec3d sample(const glm::dvec2& point) const;
    /// Per solid angle, of a unit direction above the horizon. Precondition: alpha > 0.
    double density(const Vec3d& direction) const;
    /// No density is greater. Precondition: alpha > 0.
    double largest_density() const;

  private:
    double alpha_;
    Vec3d view_;
    Vec3d stretched_view_;  // unit, where the microfacets are a hemisphere
    double factor_;         // G₁ / (4 cosθ_o)
};

}  // namespace shlight
