// SPDX-License-Identifier: MIT
//
// Integrates the true f·cos along the light's contour, in the plane of half vectors.
#include <algorithm>
#include <cmath>
#include <utility>

#include "lobes/boundary_integral.h"
#include "method.h"
#include "regions/boundary.h"
#include "shlight/cap.h"

namespace shlight::methods {
namespace {

constexpr double kDefaultTolerance = 1e-7;

/// Sine of a half angle below which the circle's points round to its centre, where f·cos is evaluated instead.
constexpr double kSmallestCap = 1e-7;

class OutlineLobe : public LobeIntegrator {
  public:
    OutlineLobe(LobeShape shape, double cos_theta_o, double tolerance)
        : shape_(std::move(shape)), cos_theta_o_(cos_theta_o), tolerance_(tolerance) {}
    Reflected radiance(const SphericalCap& cap, std::uint32_t /*seed*/) const override {
        if (cap.sine < kSmallestCap) {
            const Vec3d above(cap.axis.x, cap.axis.y, std::max(cap.axis.z, 0.0));
            const Vec3d view(std::sqrt((1 - cos_theta_o_) * (1 + cos_theta_o_)), 0, cos_theta_o_);
            return {lobe_value(shape_, above, view) * clipped_solid_angle(cap), 1};
        }
        return reflected(CapBoundary(cap).arcs());
    }
    Reflected radiance(const SeenPolygon& polygon, std::uint32_t /*seed*/) const override {
        return reflected(polygon_boundary(polygon.kept));
    }

  private:
    Reflected reflected(std::span<const Arc<double>> outline) const {
        const BoundaryIntegral integral = boundary_integral(shape_, cos_theta_o_, outline, tolerance_);
        return {integral.value, integral.points};
    }

    LobeShape shape_;
    double cos_theta_o_, tolerance_;
};

std::unique_ptr<LobeIntegrator> make(const LobeShape& shape, double cos_theta_o, const Options& options) {
    const double tolerance = options.tolerance > 0 ? options.tolerance : kDefaultTolerance;
    return std::make_unique<OutlineLobe>(shape, cos_theta_o, tolerance);
}

}  // namespace

ShadingMethod outline() {
    return {"outline", "docs/theory.md, 6.5", false, true, false, false, &make};
}

}  // namespace shlight::methods
