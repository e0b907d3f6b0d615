// SPDX-License-Identifier: MIT
//
// Albedos of lobes of any width at any view, between even steps of √width and cosine.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "shlight/lobe_shape.h"

namespace shlight {

/// Immutable; any number of threads may read it.
class AlbedoTable {
  public:
    /// Of all shapes that differ from this one in width.
    explicit AlbedoTable(const LobeShape& shape);
    double albedo(double width, double cos_theta_o) const;

  private:
    std::size_t widths_;
    std::vector<float> values_;
};

/// The same table for the same shape, whatever its width.
std::shared_ptr<const AlbedoTable> albedo_table(const LobeShape& shape);

}  // namespace shlight
