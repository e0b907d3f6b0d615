// SPDX-License-Identifier: MIT
//
// Arcs of circles in the plane of the half vector's slopes (boundary_integral.h), with a parameter whose equal steps
// are about equal steps past the lobe.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <numbers>

#include "lobes/boundary_kernel.h"
#include "regions/arcs.h"
#include "shlight/types.h"

namespace shlight {

/// A lower view mirrors itself in the horizon so closely that half vectors there lose their digits; what it sees
/// differs by less than 1e-6 ÷ the lobe's width.
inline constexpr double kLeastViewCosine = 1e-6;

/// ω_o, no lower than that.
Vec3d resolved_view(double cos_theta_o);

/// Half vectors along a circle, up to their length: middle + cosine cos τ + sine sin τ. Any parameter that is a Möbius
/// map of the angle has this form; one of them makes the three columns orthogonal in (h_x/α, h_y/α, h_z), in which the
/// slope distribution is round. The curve there is an ellipse's cone. If it is long and narrow, as for a circle much
/// larger than the lobe, τ passes the lobe in a very short interval at ±π/2; t with (cos τ, sin τ) ~ (f cos t, sin t)
/// does not.
class ArcPath {
  public:
    /// alpha: of the lobe, along x and y.
    ArcPath(const Arc<double>& arc, const Vec3d& view, const glm::dvec2& alpha);

    bool is_closed() const { return closed_; }
    double start() const { return start_; }
    double length() const { return length_; }

    /// The path as the kernel reads it.
    const BoundaryPath& columns() const { return path_; }
    /// (1, cos ψ, sin ψ) at the angle ψ from the arc's middle is, up to a factor, frame (r, f cos t, sin t) with the r
    /// and f of BoundaryPath.
    const std::array<std::array<double, 3>, 3>& frame() const { return frame_; }

  private:
    using Triple = std::array<double, 3>;

    void even_out();
    /// A boost of columns 0 and `axis` by half the rapidity atanh(speed).
    void boost_by_half(int axis, double speed);
    /// A turn of columns 1 and 2 by half the angle of the point (x, y).
    void turn_by_half(double x, double y);
    void turn(double c, double s) { mix(1, 2, c, s, -s, c); }
    /// New columns i and j: (ii, ij) and (ji, jj) times the old ones.
    void mix(int i, int j, double ii, double ij, double ji, double jj);
    /// t of the point at (cos, sin) of the circle's own angle.
    double parameter(double cosine, double sine) const;

    std::array<Vec3d, 3> columns_;  // x and y over α
    std::array<Triple, 3> frame_ = {Triple{1, 0, 0}, Triple{0, 1, 0}, Triple{0, 0, 1}};
    double flatness_ = 1;
    bool closed_;
    double start_ = 0;
    double length_ = 2 * std::numbers::pi;
    BoundaryPath path_{};
};

}  // namespace shlight
