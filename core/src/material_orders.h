// SPDX-License-Identifier: MIT
//
// "Model no more than a scene needs": which order each lobe of a material takes at each view.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "shlight/bsdf.h"
#include "shlight/lobe_fit.h"
#include "shlight/render.h"
#include "shlight/types.h"

namespace shlight {

/// A lobe of a material with the tables that a render may ask for.
class OrderedLobe {
  public:
    /// order: the only one, or 0 for all of the ladder.
    OrderedLobe(const Lobe& lobe, int order);

    const Lobe& lobe() const { return lobe_; }
    /// Writes cosine_count(order) cosine terms.
    void coefficients(int order, float cos_theta_o, float* cosine_terms) const;

  private:
    Lobe lobe_;
    std::vector<std::shared_ptr<const LobeTable>> tables_;
};

class OrderedMaterial {
  public:
    OrderedMaterial(const Bsdf& bsdf, const RenderSettings& settings);

    const std::vector<OrderedLobe>& lobes() const { return lobes_; }
    /// Writes one order per lobe, 0 for one that is black at this view. Returns whether all meet the tolerance.
    ///
    /// A lobe may be wrong by tolerance × the norm of the material's whole f·cos, in each colour channel. Lobes are
    /// nowhere negative, so that norm is at least the root of the sum of the squares of theirs.
    bool choose_orders(float cos_theta_o, std::span<std::uint8_t> orders) const;

  private:
    std::vector<OrderedLobe> lobes_;
    int order_;
    double tolerance_;
};

}  // namespace shlight
