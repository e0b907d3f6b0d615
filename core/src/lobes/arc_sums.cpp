// SPDX-License-Identifier: MIT
#include "lobes/arc_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include "lobes/boundary_kernel.h"
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
    using Values = ArcSums;

    DirectionSums(std::span<const WeightedLobe> lobes, double cos_theta_o, const Arc<double>& arc,
                  const std::array<double, 3>& weights)
        : lobes_(lobes), cos_o_(cos_theta_o), arc_(arc), weights_(weights) {}

    void densities(const ArcPath& path, std::span<const double> parameters, std::span<Values> values) const {
        const Vec3d u = arc_.sine * arc_.middle;
        const DirectionPath directions = {arc_.cosine * arc_.axis, u, glm::cross(arc_.axis, u), path.frame(),
                                          path.columns().flatness};
        direction_densities(lobes_, cos_o_, directions, parameters, values);
    }
    double size(const Values& sum) const {
        double largest = 0;
        for (std::size_t k = 0; k < sum.size(); ++k) {
            largest = std::max(largest, weights_[k % 3] * std::abs(sum[k]));
        }
        return largest;
    }
    double scale(const Values& sum) const { return size(sum) + std::numeric_limits<double>::min(); }
    double tolerance(const Values& sum) const {
        const double whole = std::max({std::abs(sum[0]), std::abs(sum[3]), std::abs(sum[6])});
        return kRelativeError * size(sum) + kRounding * whole;
    }

  private:
    std::span<const WeightedLobe> lobes_;
    double cos_o_;
    Arc<double> arc_;
    std::array<double, 3> weights_;
};

/// The parameter of an arc, as of a view that is at least a tenth of the lobe's width apart from the arc's plane, or
/// cone: where the circle passes opposite of the view, half vectors vanish, and evening them out would bring the
/// parameter there alone.
ArcPath path_of(const Arc<double>& arc, const Vec3d& view, double width) {
    const double apart = arc.cosine + glm::dot(arc.axis, view);
    const double least = std::copysign(0.1 * width, apart);
    return {arc, view + (std::abs(apart) < std::abs(least) ? least - apart : 0.0) * arc.axis, glm::dvec2(width)};
}

bool is_lambert(const WeightedLobe& lobe) {
    return std::holds_alternative<LambertShape>(lobe.shape);
}

/// f·cos = z/π is a linear function of cos ψ and sin ψ.
std::array<double, 3> lambert_sums(const Arc<double>& arc) {
    const double h = arc.half;
    const double sine = std::sin(h);
    const double product = sine * std::cos(h);
    const double square = h < 1e-3 ? 2.0 / 3 * h * h * h * (1 - h * h / 5) : h - product;  // ∫ sin² ψ dψ
    const double level = arc.cosine * arc.axis.z;
    const double cosine = arc.sine * arc.middle.z;
    const double across = arc.sine * glm::cross(arc.axis, arc.middle).z;
    return {2 * (level * h + cosine * sine) / std::numbers::pi,
            (2 * level * sine + cosine * (h + product)) / std::numbers::pi, across * square / std::numbers::pi};
}

}  // namespace

ArcSums arc_sums(std::span<const WeightedLobe> lobes, double cos_theta_o, const Arc<double>& arc,
                 const std::array<double, 3>& weights) {
    if (std::all_of(lobes.begin(), lobes.end(), is_lambert)) {
        const std::array<double, 3> own = lambert_sums(arc);
        ArcSums sums{};
        for (const WeightedLobe& lobe : lobes) {
            for (std::size_t k = 0; k < sums.size(); ++k) {
                sums[k] += lobe.weight[k / 3] * own[k % 3];
            }
        }
        return sums;
    }
    const Vec3d view = resolved_view(cos_theta_o);
    BoundaryQuadrature<DirectionSums> sums(DirectionSums(lobes, view.z, arc, weights));
    sums.add(path_of(arc, view, lobe_width(lobes[0].shape)), 1);
    sums.refine();
    return sums.sum();
}

}  // namespace shlight
