// SPDX-License-Identifier: MIT
//
// Albedos of one lobe shape, tabulated over even steps of √width and of cosθ_o.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "shlight/lobe_shape.h"

namespace shlight {

/// Immutable; any number of threads may read it.
class AlbedoTable {
  public:
    /// Tabulates every width of the shape; its present width does not matter.
    explicit AlbedoTable(const LobeShape& shape);
    double albedo(double width, double cos_theta_o) const;

  private:
    std::size_t widths_;
    std::vector<float> values_;
};

/// The table of a shape, shared by all shapes that differ only in width.
std::shared_ptr<const AlbedoTable> albedo_table(const LobeShape& shape);

}  // namespace shlight
