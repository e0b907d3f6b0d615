// SPDX-License-Identifier: MIT
//
// Harmonics of one order in the lobe's warp, and the library's own choice of the cheapest way.
#include "lobe_view.h"
#include "method.h"

namespace shlight::methods {
namespace {

class LibraryLobe : public LobeIntegrator {
  public:
    LibraryLobe(const LobeShape& shape, double cos_theta_o, int order, double tolerance)
        : fit_(warped_fit(shape, order)), lobe_(shape, fit_.get(), cos_theta_o, tolerance, order == 0) {}
    Reflected radiance(const Circle& cap, std::uint32_t /*seed*/) const override { return reflected(cap); }
    Reflected radiance(const SphericalPolygon<double>& polygon, std::uint32_t /*seed*/) const override {
        return reflected(polygon);
    }

  private:
    template <class Region>
    Reflected reflected(const Region& region) const {
        const LobeRadiance r = lobe_.radiance(region);
        return {r.value, r.points};
    }

    std::shared_ptr<const WarpedFit> fit_;
    LobeAtView lobe_;
};

std::unique_ptr<LobeIntegrator> make(const LobeShape& shape, double cos_theta_o, const Options& options) {
    constexpr double kAnyTolerance = 1;
    return std::make_unique<LibraryLobe>(shape, cos_theta_o, options.order, kAnyTolerance);
}

}  // namespace

ShadingMethod warped_harmonics() {
    return {"warped_harmonics", "docs/algorithms.md, Glossy lobes", true, false, false, false, &make};
}

}  // namespace shlight::methods
