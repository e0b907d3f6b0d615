// SPDX-License-Identifier: MIT
#include "base/shading_frame.h"

#include <algorithm>

#include "base/perpendicular.h"

namespace shlight {
namespace {

constexpr double kSmallestViewCosine = 1e-4;

}  // namespace

ShadingFrame shading_frame(const Vec3d& position, const Vec3d& normal, const Vec3d& towards_viewer) {
    const Vec3d across = glm::cross(normal, towards_viewer);
    const double length = glm::length(across);
    // Seen along the normal any azimuth will do, since every lobe is rotationally symmetric there.
    const Vec3d y = length > 1e-12 ? across / length : perpendicular(normal);
    return {position, glm::cross(y, normal), y, normal};
}

float view_cosine(const Vec3d& normal, const Vec3d& towards_viewer) {
    return static_cast<float>(std::clamp(glm::dot(normal, towards_viewer), kSmallestViewCosine, 1.0));
}

}  // namespace shlight
