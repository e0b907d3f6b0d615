// SPDX-License-Identifier: MIT
#include "lobes/arc_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobes/boundary_path.h"
#include "lobes/boundary_quadrature.h"

namespace shlight {
namespace {

constexpr double kRelativeError = 1e-8;
/// Roundings of f·cos, as a part of it.
constexpr double kRounding = 1e-14;

/// f·cos, times 1, cos ψ and sin ψ, at points of an arc.
class DirectionSums {
  public:
    using Values = ArcDensity;

    DirectionSums(const LobeShape& shape, double cos_theta_o, const Arc<double>& arc, const ArcDensity& weights)
        : shape_(&shape), cos_o_(cos_theta_o), arc_(arc), weights_(weights) {}

    void densities(const ArcPath& path, std::span<const double> parameters, std::span<Values> values) const {
        const Vec3d u = arc_.sine * arc_.middle;
        const DirectionPath directions = {arc_.cosine * arc_.axis, u, glm::cross(arc_.axis, u), path.frame(),
                                          path.columns().flatness};
        direction_densities(*shape_, cos_o_, directions, parameters, values);
    }
    double size(const Values& sum) const {
        return std::max(
            {weights_[0] * std::abs(sum[0]), weights_[1] * std::abs(sum[1]), weights_[2] * std::abs(sum[2])});
    }
    double scale(const Values& sum) const { return size(sum) + std::numeric_limits<double>::min(); }
    double tolerance(const Values& sum) const { return kRelativeError * size(sum) + kRounding * std::abs(sum[0]); }

  private:
    const LobeShape* shape_;
    double cos_o_;
    Arc<double> arc_;
    ArcDensity weights_;
};

}  // namespace

ArcDensity arc_sums(const LobeShape& shape, double cos_theta_o, const Arc<double>& arc, const ArcDensity& weights) {
    const Vec3d view = resolved_view(cos_theta_o);
    BoundaryQuadrature<DirectionSums> sums(DirectionSums(shape, view.z, arc, weights));
    sums.add(ArcPath(arc, view, lobe_width(shape)), 1);
    sums.refine();
    return sums.sum();
}

}  // namespace shlight
