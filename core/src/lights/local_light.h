// SPDX-License-Identifier: MIT
//
// Lights in the shading frame of a hit, without parts that do not face the hit or lie below its horizon.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "shlight/cap.h"
#include "shlight/disk.h"
#include "shlight/light.h"
#include "shlight/types.h"
#include "tracing/hits.h"

namespace shlight {

/// A sphere light or sun seen from a point. inside: the point is within the sphere, and the whole hemisphere is lit,
/// which is the limit of a point that touches it. infinite: a sun, with `center` a unit vector and `radius` the sine of
/// its half angle.
struct CapView {
    enum class Kind { sphere, facing_disk, inside, infinite };

    Kind kind;
    Vec3d center;
    double radius;
};

/// The cap of a light; nothing if it lies below the horizon.
std::optional<CapView> view_facing_disk(const SphereLight& light, const ShadingFrame& frame);
inline std::optional<CapView> view(const SphereLight& light, const ShadingFrame& frame) {
    if (light.facing_disk) {
        return view_facing_disk(light, frame);
    }
    const Vec3d center = frame.point_to_local(light.center);
    const bool inside = glm::length(center) <= light.radius;
    if (!inside && !(center.z + light.radius > 0)) {
        return std::nullopt;
    }
    return CapView{inside ? CapView::Kind::inside : CapView::Kind::sphere, center, light.radius};
}
std::optional<CapView> view(const SunLight& light, const ShadingFrame& frame);
/// The cap of a sphere light or sun; nothing for other lights.
std::optional<CapView> cap_view(const Light& light, const ShadingFrame& frame);

/// Whether a hit lies off the plane of a planar light, on a side that the light shines to. height: over that plane.
template <class PlanarLight>
bool is_lit_side(const PlanarLight& light, double height, double error) {
    return (light.two_sided ? std::abs(height) : height) > 2 * (error + light.error);
}

/// A light's emission profile for one hit. Keeps a pointer to the light.
class ProfileView {
  public:
    ProfileView() = default;  ///< a constant factor 1
    ProfileView(const Light& light, const ShadingFrame& frame);

    /// Bounds of the factor over the light.
    const ProfileRange& range() const { return range_; }
    /// Factor for a unit direction towards the light, in the shading frame.
    double factor(const Vec3d& direction) const {
        return profile_ == nullptr ? 1.0 : profile_factor(*profile_, -(to_world_ * direction));
    }

  private:
    const EmissionProfile* profile_ = nullptr;  // null: the factor is 1
    glm::dmat3 to_world_{1};
    ProfileRange range_ = {1, 1};
};

/// A light with extent in the frame of a hit: computed once, then read by shading, profiles and shadow rays. Keeps
/// pointers to the light and the frame. Memory is reused from light to light.
class LocalLight {
  public:
    /// Returns whether the light shines on the hit: the hit lies off a polygon's or disk's plane on an emitting side,
    /// some of the light is above the horizon, and its profile is not 0 here. A hit in the plane, within its error, is
    /// dark: a polygon has no area edge-on, and a surface on which a light lies flat must not be lit at random.
    bool look(const Light& light, const ShadingFrame& frame, double error);

    const Light& light() const { return *light_; }
    const ShadingFrame& frame() const { return *frame_; }
    const ProfileView& profile() const { return profile_; }
    /// The cap of a sphere or a sun.
    const std::optional<CapView>& cap() const { return cap_; }
    /// Corners in the shading frame of a polygon light, or of the part that shines on the hit through a spread: the
    /// smallest rectangle along the light's edges that contains it, or a convex polygon.
    std::span<const Vec3d> corners() const { return corners_; }
    /// Whether the corners are those of a part of the light, which is convex.
    bool is_part() const { return is_part_; }
    /// A disk light without corners, in the shading frame.
    const Ellipse& ellipse() const { return ellipse_; }

  private:
    bool look_at(const PolygonLight& light);
    bool look_at(const DiskLight& light);

    const Light* light_ = nullptr;
    const ShadingFrame* frame_ = nullptr;
    double error_ = 0;
    ProfileView profile_;
    std::optional<CapView> cap_;
    std::vector<Vec3d> corners_;
    bool is_part_ = false;
    Ellipse ellipse_{};
};

/// A lower bound of the distance to the light's points; 0 if none is known.
double least_distance(const Light& light, const Vec3d& position);
/// A distance over which the light on the hit changes as little as an even light's does over its least distance.
double changing_distance(const Light& light, const Vec3d& position);

/// The cap of directions to the light.
SphericalCap circle_of(const CapView& cap);

}  // namespace shlight
