// SPDX-License-Identifier: MIT
//
// The true f·cos along the light's outline, in the plane of half vectors.
#include "method.h"
#include "shading/light_outline.h"

namespace shlight::methods {
namespace {

constexpr double kDefaultTolerance = 1e-7;

class OutlineLobe : public LobeIntegrator {
  public:
    OutlineLobe(const LobeShape& shape, double cos_theta_o, double tolerance)
        : shape_(shape), cos_theta_o_(cos_theta_o), tolerance_(tolerance) {}
    Reflected radiance(const Circle& cap, std::uint32_t /*seed*/) const override {
        return reflected(CapOutline(cap).arcs());
    }
    Reflected radiance(const SeenPolygon& polygon, std::uint32_t /*seed*/) const override {
        return reflected(polygon_outline(polygon.kept));
    }

  private:
    Reflected reflected(std::span<const OutlineArc> outline) const {
        const OutlineIntegral integral = outline_integral(shape_, cos_theta_o_, outline, tolerance_);
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
