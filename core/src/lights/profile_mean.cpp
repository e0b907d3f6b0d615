// SPDX-License-Identifier: MIT
#include "lights/profile_mean.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "lobes/material_lobes.h"
#include "math/gauss_legendre.h"

namespace shlight {
namespace {

/// Numbers of nodes along each axis, tried in turn.
constexpr std::array kPoints = {4, 6, 9, 13, 19, 28, 42, kMaxGaussPoints};
/// Consecutive rules that must agree within the tolerance. Two rules may agree by chance if a rim of the profile
/// crosses a patch.
constexpr int kAgreements = 2;
constexpr int kAgreementsOfRings = 1;
/// A table has kinks between all its texels, so that rules converge slowly: the most points for one, and the least
/// tolerance ÷ the largest factor.
constexpr int kMostForTables = 19;
constexpr double kToleranceOfTables = 1e-3;
/// A lobe gets additional nodes if its density may exceed the light's by this factor.
constexpr double kNarrowLobe = 8;
/// A lobe narrower than this [rad] gets additional nodes even if rings exist: few are needed for a lobe within the
/// light. Wider lobes are often cut by the light's edge, where pieces of rings fitted to the lobe need fewer nodes.
constexpr double kLeastFocus = 0.01;

/// Nodes of a rule in √ of each coordinate, since samplers take roots at the middle of a cap and in a corner of a
/// triangle.
template <class Visit>
void for_nodes(const GaussRule& rule, const Visit& visit) {
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
            const double x = rule.nodes[i];
            const double y = rule.nodes[j];
            visit(glm::dvec2(x * x, y * y), 4 * x * y * rule.weights[i] * rule.weights[j]);
        }
    }
}

}  // namespace

void ProfileMean::reset(const Light& light, const ShadingFrame& frame) {
    seen_.look(light, frame, 0);
    if (range().high > range().low) {
        sampler_.reset(seen_);
        has_rings_ = rings_.reset(seen_);
    }
}

template <class Visit>
void ProfileMean::for_light_nodes(int points, const Visit& visit) {
    if (has_rings_) {
        rings_.for_nodes(
            points, [&](const Vec3d& direction) { return seen_.profile().factor(direction); }, visit);
        return;
    }
    const GaussRule& rule = gauss_rule(points);
    for (std::size_t patch = 0; patch < sampler_.patch_count(); ++patch) {
        for_nodes(rule, [&](const glm::dvec2& point, double share) {
            const LightSample sample = sampler_.sample_patch(patch, point);
            visit(sample.direction, share * sample.weight, seen_.profile().factor(sample.direction));
        });
    }
}

void ProfileMean::add(const Reflection& reflection, const Vec3d& direction, double weight, double factor,
                      Sums& sums) const {
    double value = weight * lobe_value(*reflection.shape, direction, reflection.view);
    if (reflection.narrow) {
        // Balance heuristic; the light's density is taken as one over its solid angle.
        value /= 1 + sampler_.solid_angle() * lobe_density(*reflection.shape, reflection.view, direction);
    }
    sums.even += value;
    sums.lit += value * factor;
}

ProfileMean::Sums ProfileMean::sums(const Reflection& reflection, int points) {
    Sums sums;
    for_light_nodes(points, [&](const Vec3d& direction, double weight, double factor) {
        add(reflection, direction, weight, factor, sums);
    });
    if (reflection.narrow) {
        for_nodes(gauss_rule(points), [&](const glm::dvec2& point, double share) {
            const Vec3d direction = sample_lobe(*reflection.shape, reflection.view, point);
            if (direction.z > 0 && sampler_.meets(direction)) {
                add(reflection, direction, share * sampler_.solid_angle(), seen_.profile().factor(direction), sums);
            }
        });
    }
    return sums;
}

double ProfileMean::mean(const LobeShape& lobe, double cos_theta_o, double tolerance) {
    if (!(range().high - range().low > tolerance)) {
        return (range().low + range().high) / 2;
    }
    const bool has_table = std::holds_alternative<TableProfile>(traits_of(seen_.light()).profile);
    tolerance = has_table ? std::max(tolerance, kToleranceOfTables * range().high) : tolerance;
    const Vec3d view(std::sqrt(1 - cos_theta_o * cos_theta_o), 0, cos_theta_o);
    const bool narrow = sampler_.solid_angle() * largest_lobe_density(lobe, view) > kNarrowLobe;
    const double width = narrowest(lobe, cos_theta_o);
    const bool focused = narrow && has_rings_ && width > kLeastFocus;
    if (focused) {
        rings_.focus(mirrored(view), width);
    }
    const Reflection reflection{&lobe, view, narrow && !focused};
    double mean = range().low;
    int agreements = -1;  // the first rule has nothing to be compared with
    for (const int points : kPoints) {
        const Sums sums = this->sums(reflection, points);
        const double before = mean;
        mean = sums.even > 0 ? sums.lit / sums.even : range().low;
        agreements = agreements < 0 || !(std::abs(mean - before) <= tolerance) ? 0 : agreements + 1;
        if (agreements == (has_rings_ && !reflection.narrow ? kAgreementsOfRings : kAgreements) ||
            (has_table && points >= kMostForTables)) {
            break;
        }
    }
    return mean;
}

}  // namespace shlight
