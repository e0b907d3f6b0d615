// SPDX-License-Identifier: MIT
#pragma once

#include "surfaces/light_cells.h"
#include "surfaces/light_records.h"

namespace shlight {

/// Light that bounces, as far as it is known.
struct StoredLight {
    LightRecords records;  ///< that reaches surfaces
    LightCells cells;      ///< that surfaces send to others
};

}  // namespace shlight
