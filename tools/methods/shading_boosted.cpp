// SPDX-License-Identifier: MIT
//
// Harmonics of one order in the lobe's boost.
#include "harmonic_lobe.h"
#include "lobes/material_views.h"

namespace shlight::methods {
namespace {

class BoostedHarmonics : public HarmonicLobe {
  public:
    BoostedHarmonics(const LobeShape& shape, double cos_theta_o, int order)
        : material_(std::array{Lobe{shape, nullptr, Rgb(1), nullptr}}, order, 1) {
        constexpr std::uint32_t kOnly = 0;
        std::vector<Rgb> weights;
        views_.assign(material_, {&cos_theta_o, 1}, material_.weights({&cos_theta_o, 1}, weights), {}, false);
        set(views_.lobe(0).arrays(order, {&kOnly, 1}));
    }

  private:
    MaterialLobes material_;
    MaterialViews views_;
};

std::unique_ptr<LobeIntegrator> make(const LobeShape& shape, double cos_theta_o, const Options& options) {
    return std::make_unique<BoostedHarmonics>(shape, cos_theta_o, options.order);
}

}  // namespace

ShadingMethod warped_harmonics() {
    return {"warped_harmonics", "docs/theory.md, 6", true, false, false, false, &make};
}

}  // namespace shlight::methods
