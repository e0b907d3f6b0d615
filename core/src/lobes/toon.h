// SPDX-License-Identifier: MIT
//
// Toon lobes in the polar coordinates of their axis, in which they do not depend on the azimuth.
#pragma once

#include <glm/mat3x3.hpp>
#include <span>

#include "lobes/boundary_integral.h"
#include "regions/arcs.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// f·cos = peak up to the angle `inner` from the axis, from where it falls with a slope of peak ÷ fade; 0 beyond
/// `outer`.
struct ToonCone {
    double inner, outer, fade, peak;

    explicit ToonCone(const ToonShape& shape);
    /// f·cos ÷ peak.
    double intensity(double angle) const;
    /// ∫ intensity sinθ dθ up to the angle.
    double flux(double angle) const;
};

/// Axes of a toon lobe, the third its own, in the xz-plane of the view.
glm::dmat3 toon_frame(const ToonShape& shape, const Vec3d& wo);

/// The same as boundary_integral() finds: by Green's theorem ∮ flux(θ) dφ, whose path is cut where the intensity has
/// kinks.
BoundaryIntegral toon_boundary_integral(const ToonShape& shape, double cos_theta_o, std::span<const Arc<double>> arcs,
                                        double tolerance);

}  // namespace shlight
