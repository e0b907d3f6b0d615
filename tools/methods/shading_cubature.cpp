// SPDX-License-Identifier: MIT
//
// Reflected radiance from a given number of evaluations of the true f·cos: rings about the axis of a cap above the
// horizon, product rules on the patches of other regions. Sums are scaled to the light's exact solid angle.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "base/perpendicular.h"
#include "kept_region.h"
#include "lighting/cubature_kernel.h"
#include "math/gauss_legendre.h"
#include "method.h"
#include "shlight/cap.h"

namespace shlight::methods {
namespace {

/// The library's rules for caps, by number of points.
constexpr std::array kLibraryRules = {1, 4, 7, 24};

/// Rings about a cap's axis, by Gauss's rule in area, with even steps around. Calls visit(direction, weight).
template <class Visit>
void visit_rings(const SphericalCap& cap, int points, const Visit& visit) {
    const int count = std::clamp(static_cast<int>(std::lround(std::sqrt(points / 2.0))), 1, kMaxGaussPoints);
    const int spokes = points / count;
    const Vec3d x = perpendicular(cap.axis);
    const Vec3d y = glm::cross(cap.axis, x);
    const double area = cap.sine * cap.sine / (1 + cap.cosine);  // 1 - cosσ
    const GaussRule& rule = gauss_rule(count);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double drop = area * rule.nodes[i];
        const double across = std::sqrt(drop * (2 - drop));
        for (int j = 0; j < spokes; ++j) {
            const double azimuth = 2 * std::numbers::pi * (j + 0.5 * static_cast<double>(i % 2)) / spokes;
            visit((1 - drop) * cap.axis + across * (std::cos(azimuth) * x + std::sin(azimuth) * y),
                  rule.weights[i] / spokes);
        }
    }
}

class CubatureLobe : public LobeIntegrator {
  public:
    CubatureLobe(LobeShape shape, double cos_theta_o, int points)
        : shape_(std::move(shape)),
          view_(std::sqrt((1 - cos_theta_o) * (1 + cos_theta_o)), 0, cos_theta_o),
          points_(points) {}

    Reflected radiance(const SphericalCap& cap, std::uint32_t /*seed*/) const override {
        if (cap.axis.z <= -cap.sine) {
            return {0, 1};
        }
        const bool whole = cap.axis.z >= cap.sine;
        if (whole && points_ <= kLibraryRules.back()) {
            const auto rules = std::count_if(kLibraryRules.begin(), kLibraryRules.end(),
                                             [&](int points) { return points <= points_; });
            return by_library_rule(cap, static_cast<int>(rules));
        }
        const double solid_angle = clipped_solid_angle(cap);
        if (!whole) {
            return over_patches(KeptRegion::of_cap(cap, true), solid_angle);
        }
        if (points_ < 4) {
            return {solid_angle * reflected(cap.axis), 1};
        }
        Sum sum;
        visit_rings(cap, points_, [&](const Vec3d& at, double weight) { sum.add(weight, reflected(at)); });
        return sum.scaled_to(solid_angle);
    }

    Reflected radiance(const SeenPolygon& polygon, std::uint32_t /*seed*/) const override {
        if (polygon.kept.empty()) {
            return {0, 1};
        }
        return over_patches(KeptRegion::of_polygon(polygon.kept), polygon.kept.solid_angle());
    }

  private:
    Reflected by_library_rule(const SphericalCap& cap, int rule) const {
        constexpr std::uint32_t kOnly = 0;
        const auto width = static_cast<float>(lobe_width(shape_));
        float value = 0;
        integrate_caps(shape_, &width, {&cap.axis.x, &cap.axis.y, &cap.axis.z, &cap.cosine, &cap.sine}, {&kOnly, 1},
                       {&view_.x, &view_.z, true}, {&kOnly, 1}, rule, {&value, 1});
        return {value, cap_rule_points(rule)};
    }

    struct Sum {
        double values = 0, weights = 0;
        int points = 0;
        void add(double weight, double value) {
            values += weight * value;
            weights += weight;
            ++points;
        }
        Reflected scaled_to(double solid_angle) const {
            return {weights > 0 ? values * (solid_angle / weights) : 0.0, points};
        }
    };

    Reflected over_patches(const KeptRegion& region, double solid_angle) const {
        const std::vector<Patch> patches = region.patches();
        const int each = points_ / static_cast<int>(patches.size());
        if (each < 1) {
            return {solid_angle * reflected(region.middle()), 1};
        }
        const int along = std::clamp(static_cast<int>(std::sqrt(each)), 1, kMaxGaussPoints);
        const GaussRule& from_hub = gauss_rule(along);
        const GaussRule& edge = gauss_rule(std::min(each / along, kMaxGaussPoints));
        Sum sum;
        for (const Patch& patch : patches) {
            for (std::size_t j = 0; j < edge.nodes.size(); ++j) {
                const Spoke spoke = patch.spoke(edge.nodes[j]);
                for (std::size_t i = 0; i < from_hub.nodes.size(); ++i) {
                    const WeightedDirection at = patch.at(spoke, from_hub.nodes[i]);
                    sum.add(at.weight * edge.weights[j] * from_hub.weights[i], reflected(at.direction));
                }
            }
        }
        return sum.scaled_to(solid_angle);
    }

    double reflected(const Vec3d& direction) const { return lobe_value(shape_, direction, view_); }

    LobeShape shape_;
    Vec3d view_;
    int points_;
};

std::unique_ptr<LobeIntegrator> make(const LobeShape& shape, double cos_theta_o, const Options& options) {
    return std::make_unique<CubatureLobe>(shape, cos_theta_o, options.samples);
}

}  // namespace

ShadingMethod cubature() {
    return {"cubature", "Gauss × trapezoid rules on the true f·cos over the light", false, false, true, false, &make};
}

}  // namespace shlight::methods
