// SPDX-License-Identifier: MIT
//
// What a bump's diffuse lobe reflects of a record's light.
#pragma once

#include <optional>

#include "shlight/lobe_shape.h"
#include "shlight/types.h"
#include "surfaces/light_records.h"

namespace shlight {

/// f·cos of a bump's lobe in harmonics, in the world frame; none for a shape that is not is_bumped().
/// normal, smooth: unit, those of the bump and of the surface.
///
/// The lobe is even about the plane of both normals, so that each band is a sum of functions that are symmetric about
/// axes in this plane. Such a function has the harmonics of its axis: no rotation is needed.
std::optional<RecordBasis> bumped_basis(const LobeShape& shape, const Vec3d& normal, const Vec3d& smooth);

}  // namespace shlight
