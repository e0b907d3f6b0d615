// SPDX-License-Identifier: MIT
//
// Harmonics without a boost: Eq. 5 of Zhou & Wei 2020 with the hemisphere fit of f·cos.
#include "base/aligned_floats.h"
#include "harmonic_lobe.h"
#include "shlight/plain_fit.h"

namespace shlight::methods {
namespace {

class PlainHarmonics : public HarmonicLobe {
  public:
    PlainHarmonics(const LobeShape& shape, double cos_theta_o, int order) {
        terms_.grow(static_cast<std::size_t>(cosine_count(order)));
        plain_fit(shape)->coefficients(cos_theta_o, order, terms_.data());
        set({false, {}, terms_.data(), 0, order});
    }

  private:
    AlignedFloats terms_;
};

std::unique_ptr<LobeIntegrator> make(const LobeShape& shape, double cos_theta_o, const Options& options) {
    return std::make_unique<PlainHarmonics>(shape, cos_theta_o, options.order);
}

}  // namespace

ShadingMethod plain_harmonics() {
    return {"plain_harmonics", "Zhou & Wei 2020, Eq. 5; hemisphere fit", true, false, false, false, &make};
}

}  // namespace shlight::methods
