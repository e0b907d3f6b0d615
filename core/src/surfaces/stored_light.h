// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "surfaces/light_cells.h"
#include "surfaces/light_records.h"

namespace shlight {

/// Light that bounces, as far as it is known. By the number of bounces, and for each of them by parts: all of it, and
/// if light groups are told apart, that of each.
struct StoredLight {
    std::size_t parts;
    LightRecords records;  ///< that reaches surfaces
    LightCells cells;      ///< that surfaces send to others
};

}  // namespace shlight
