// SPDX-License-Identifier: MIT
#include "lobes/boundary_integral.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lobes/boundary_kernel.h"
#include "lobes/boundary_path.h"
#include "lobes/boundary_quadrature.h"
#include "math/gauss_legendre.h"

namespace shlight {
namespace {

/// Floats suffice for tolerances, over the albedo, from this one on.
constexpr double kLeastTolerance32 = 1e-6;

/// A lobe of a smaller albedo gets all of it from the rise towards grazing angles, which varies fast: the rule along a
/// radius then errs by a share of this one.
constexpr double kLeastAlbedo = 0.02;

/// Derivatives by α take so many points along a radius, and may err by such a part of themselves, or of the floor ÷ α.
constexpr int kDerivativePoints = 24;
constexpr double kDerivativeError = 1e-7, kDerivativeFloor = 1e-5;

/// Number of points along a radius; the factors of the slope distribution vary slowly, but a table may hold anything.
/// tolerance: ÷ albedo.
int points_for(const LobeShape& shape, double tolerance) {
    return std::holds_alternative<TableShape>(shape) ? 24
           : tolerance > 4e-3                        ? 4
           : tolerance > 2e-4                        ? 6
           : tolerance > 1e-5                        ? 12
                                                     : 24;
}

/// A lobe, summed along radii, at points of a boundary.
class RadialSums {
  public:
    using Values = std::array<double, 1>;

    RadialSums(const LobeShape& shape, double cos_theta_o, double tolerance, double albedo)
        : slope_ndf_{shape, cos_theta_o, &gauss_rule(points_for(shape, tolerance / std::max(albedo, kLeastAlbedo)))},
          tolerance_(tolerance),
          f32_(tolerance >= kLeastTolerance32 * albedo) {}
    /// The derivative by α.
    RadialSums(const GgxShape& shape, double cos_theta_o)
        : slope_ndf_{shape, cos_theta_o, &gauss_rule(kDerivativePoints), true},
          tolerance_(kDerivativeError * kDerivativeFloor / shape.alpha),
          relative_(kDerivativeError),
          f32_(false) {}

    void densities(const ArcPath& path, std::span<const double> parameters, std::span<Values> values) const {
        std::array<double, kBoundaryPoints> numbers;
        boundary_densities(slope_ndf_, path.columns(), f32_, parameters, std::span(numbers).first(parameters.size()));
        std::transform(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(values.size()), values.begin(),
                       [](double number) { return Values{number}; });
    }
    static double scale(const Values& /*sum*/) { return 1; }
    static double size(const Values& error) { return std::abs(error[0]); }
    double tolerance(const Values& sum) const { return tolerance_ + relative_ * std::abs(sum[0]); }
    std::size_t points() const { return slope_ndf_.rule->nodes.size(); }

  private:
    SlopeNdf slope_ndf_;
    double tolerance_, relative_ = 0;
    bool f32_;  // whether floats will do
};

BoundaryIntegral integrate(const RadialSums& radial, const Vec3d& view, double alpha,
                           std::span<const Arc<double>> arcs) {
    BoundaryQuadrature<RadialSums> boundary(radial);
    for (const Arc<double>& arc : arcs) {
        boundary.add(ArcPath(arc, view, alpha), 1.0 / static_cast<double>(arcs.size()));
    }
    boundary.refine();
    return {boundary.sum()[0], boundary.error(), boundary.points() * static_cast<int>(radial.points())};
}

}  // namespace

BoundaryIntegral boundary_integral(const LobeShape& shape, double cos_theta_o, std::span<const Arc<double>> arcs,
                                   double tolerance, double albedo) {
    if (!(cos_theta_o > 0)) {
        return {0, 0, 0};
    }
    const Vec3d view = resolved_view(cos_theta_o);
    return integrate({shape, view.z, tolerance, albedo}, view, lobe_width(shape), arcs);
}

BoundaryIntegral boundary_integral_by_alpha(const GgxShape& shape, double cos_theta_o,
                                            std::span<const Arc<double>> arcs) {
    const Vec3d view = resolved_view(cos_theta_o);
    return integrate({shape, view.z}, view, shape.alpha, arcs);
}

}  // namespace shlight
