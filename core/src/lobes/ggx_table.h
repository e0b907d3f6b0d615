// SPDX-License-Identifier: MIT
//
// The fits that all GGX lobes interpolate in, tabulated over roughness and view: of Fresnel factors without a
// parameter.
#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <optional>

#include "lobes/fit_table.h"
#include "shlight/lobe_shape.h"

namespace shlight {

/// A row of one roughness is fitted when a shape first needs it. Thread-safe.
class GgxTable {
  public:
    static GgxTable& get();

    /// Of the orders kWarpedOrders. Precondition: not Fresnel::dielectric, not a mirror.
    FitTable fits(const GgxShape& shape);
    /// Fits what is still missing; returns the size of all in bytes.
    std::size_t build();

  private:
    static constexpr int kRows = 32;
    struct Row {
        std::once_flag once;
        std::optional<FitTable> fits;
    };

    const FitTable& row(Fresnel fresnel, int index);

    std::array<Row, kRows> one_, schlick_;
};

}  // namespace shlight
