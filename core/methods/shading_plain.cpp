// SPDX-License-Identifier: MIT
//
// Harmonics without a warp: Eq. 5 of Zhou & Wei 2020 with the hemisphere fit of f·cos.
#include <vector>

#include "method.h"
#include "polygon_shading.h"
#include "shlight/cap.h"
#include "shlight/lobe_fit.h"

namespace shlight::methods {
namespace {

class PlainHarmonics : public LobeIntegrator {
  public:
    PlainHarmonics(const LobeShape& shape, double cos_theta_o, int order)
        : order_(order), terms_(static_cast<std::size_t>(cosine_count(order))) {
        fitted(shape)->table(order)->coefficients(static_cast<float>(cos_theta_o), terms_.data());
    }
    Reflected radiance(const Circle& cap, std::uint32_t /*seed*/) const override {
        return {shade_cap(Cap<float>::inside(cap), Horizon<float>::plane(), terms_.data(), order_), 0};
    }
    Reflected radiance(const SphericalPolygon<double>& polygon, std::uint32_t /*seed*/) const override {
        return {polygon.empty() ? 0.0F : shade_polygon(polygon, Warp(), terms_.data(), order_), 0};
    }

  private:
    int order_;
    std::vector<float> terms_;
};

std::unique_ptr<LobeIntegrator> make(const LobeShape& shape, double cos_theta_o, const Options& options) {
    return std::make_unique<PlainHarmonics>(shape, cos_theta_o, options.order);
}

}  // namespace

ShadingMethod plain_harmonics() {
    return {"plain_harmonics", "Zhou & Wei 2020, Eq. 5; hemisphere fit", true, false, false, false, &make};
}

}  // namespace shlight::methods
