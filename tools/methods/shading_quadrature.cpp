// SPDX-License-Identifier: MIT
//
// Reflected radiance by adaptive cubature of the true f·cos, the reference for other methods.
//
// With polar coordinates about the mirror direction, magnified by the inverse of the lobe's width, f·cos is broad; a
// light that is small in these coordinates is integrated about its middle.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "adaptive_cubature.h"
#include "method.h"

namespace shlight::methods {
namespace {

/// Least tolerance: pieces about the mirror direction may be larger than their sum.
constexpr double kLeastTolerance = 1e-10;
constexpr std::size_t kMostPoints = std::size_t{1} << 22;
/// Albedo that replaces smaller ones in the tolerance.
constexpr double kSmallestAlbedo = 1e-5;
constexpr int kSmallestSide = 8;
constexpr int kLargestSide = 27;

struct LobeValue {
    LobeShape shape;
    Vec3d view;
    void operator()(const Vec3d& direction, double* value) const { *value = lobe_value(shape, direction, view); }
};

class QuadratureLobe : public LobeIntegrator {
  public:
    QuadratureLobe(const LobeShape& shape, double cos_theta_o, double tolerance)
        : lobe_{shape, Vec3d(std::sqrt((1 - cos_theta_o) * (1 + cos_theta_o)), 0, cos_theta_o)},
          middle_(is_glossy(shape) ? mirrored(lobe_.view) : Vec3d(0, 0, 1)),
          magnification_(std::max(1.0, 1 / (2 * lobe_width(shape)))) {
        const SphericalCap hemisphere = {Vec3d(0, 0, 1), 0, 1};
        tolerance_ = kSmallestAlbedo;
        const double albedo = over(KeptRegion::of_cap(hemisphere, true)).value;
        tolerance_ = tolerance * std::max(albedo, kSmallestAlbedo);
    }

    Reflected radiance(const SphericalCap& cap, std::uint32_t /*seed*/) const override {
        return over(KeptRegion::of_cap(cap, true));
    }
    Reflected radiance(const SeenPolygon& polygon, std::uint32_t /*seed*/) const override {
        return over(KeptRegion::of_polygon(polygon.kept));
    }

  private:
    Reflected over(const KeptRegion& region) const {
        if (region.empty()) {
            return {0, 1};
        }
        const double distance = std::acos(std::clamp(glm::dot(region.middle(), middle_), -1.0, 1.0));
        const bool apart = distance > 2 * region.extent();
        const std::vector<Patch> patches = apart ? region.patches() : region.patches_about(middle_, magnification_);
        const double rounding = 16 * std::numeric_limits<double>::epsilon();
        AdaptiveCubature<double, LobeValue> cubature(lobe_, 1,
                                                     {tolerance_, rounding, kSmallestSide, kLargestSide, kMostPoints});
        double sum = 0;
        cubature.add(patches, &sum);
        return {sum, static_cast<int>(std::max<std::size_t>(1, cubature.points()))};
    }

    LobeValue lobe_;
    Vec3d middle_;
    double magnification_;
    double tolerance_ = 0;  // absolute
};

std::unique_ptr<LobeIntegrator> make(const LobeShape& shape, double cos_theta_o, const Options& options) {
    return std::make_unique<QuadratureLobe>(shape, cos_theta_o, std::max(options.tolerance, kLeastTolerance));
}

}  // namespace

ShadingMethod quadrature_shading() {
    return {"quadrature", "adaptive Gauss cubature of f·cos over the light", false, true, false, false, &make};
}

}  // namespace shlight::methods
