// SPDX-License-Identifier: MIT
//
// Lights as a hit sees them: in its shading frame, with what lies on their dark side or below the horizon sorted out.
#pragma once

#include <optional>
#include <vector>

#include "hits.h"
#include "shlight/light.h"
#include "shlight/types.h"
#include "shlight/warp.h"

namespace shlight {

/// A sphere light. Within the sphere the whole hemisphere is lit: the limit of a point that touches it.
struct CapView {
    enum class Kind { sphere, facing_disk, inside };

    Kind kind;
    Vec3d center;
    double radius;
};

/// Nothing for a cap that lies below the horizon.
std::optional<CapView> view(const SphereLight& light, const ShadingFrame& frame);

/// Whether the light's bright side is seen at all: the hit lies off the polygon's plane, on a side that it shines to,
/// and some vertex is above the horizon. A hit in the plane, within rounding, gets nothing: a polygon is dark edge-on,
/// and a surface on which a light lies flat is not lit at random.
bool is_seen(const PolygonLight& light, const ShadingFrame& frame, double error);
/// The same for any light.
bool is_seen(const Light& light, const ShadingFrame& frame, double error);

/// At least this far away lies every point of the light; 0 where that is not known.
double least_distance(const Light& light, const Vec3d& position);

/// The directions to the light.
Circle circle_of(const CapView& cap);

}  // namespace shlight
