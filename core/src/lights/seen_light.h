// SPDX-License-Identifier: MIT
//
// Lights as a hit sees them: in its shading frame, with what lies on their dark side or below the horizon sorted out.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "shlight/disk.h"
#include "shlight/light.h"
#include "shlight/types.h"
#include "shlight/warp.h"
#include "tracing/hits.h"

namespace shlight {

/// A sphere light. Within the sphere the whole hemisphere is lit: the limit of a point that touches it.
/// infinite: a sun; center is then a unit vector, and radius the sine of its half angle.
struct CapView {
    enum class Kind { sphere, facing_disk, inside, infinite };

    Kind kind;
    Vec3d center;
    double radius;
};

/// Nothing for a cap that lies below the horizon.
std::optional<CapView> view(const SphereLight& light, const ShadingFrame& frame);
std::optional<CapView> view(const SunLight& light, const ShadingFrame& frame);
/// The same of lights that are one of these, and nothing for others.
std::optional<CapView> cap_view(const Light& light, const ShadingFrame& frame);

/// A source without extent.
struct DeltaView {
    Vec3d direction;    ///< unit, in the shading frame
    double distance;    ///< may be infinite
    double irradiance;  ///< on a surface at right angles, of a source of strength 1
};

/// Nothing for a source below the horizon, one that does not shine this way, or one within `error` of the hit.
/// Precondition: is_delta(light).
std::optional<DeltaView> delta_view(const Light& light, const ShadingFrame& frame, double error);

/// Whether a hit lies off the plane of a planar light, on a side that the light shines to. height: over that plane.
template <class PlanarLight>
bool is_lit_side(const PlanarLight& light, double height, double error) {
    return (light.two_sided ? std::abs(height) : height) > 2 * (error + light.error);
}

/// A light's emission profile as a hit sees it. Refers to the light.
class ProfileView {
  public:
    ProfileView() = default;  ///< of an even light
    ProfileView(const Light& light, const ShadingFrame& frame);

    /// Bounds of the factor over the light.
    const ProfileRange& range() const { return range_; }
    /// Of a unit direction towards the light, in the shading frame.
    double factor(const Vec3d& direction) const {
        return profile_ == nullptr ? 1.0 : profile_factor(*profile_, -(to_world_ * direction));
    }

  private:
    const EmissionProfile* profile_ = nullptr;  // null: 1
    glm::dmat3 to_world_{1};
    ProfileRange range_ = {1, 1};
};

/// A light with extent in a hit's frame: found once, then read by shading, by profiles and by shadow rays. Refers to
/// the light and the frame. Keeps its memory from one to the next.
class SeenLight {
  public:
    /// Whether the light's bright side is seen at all: the hit lies off a polygon's or disk's plane, on a side that it
    /// shines to, some of it is above the horizon, and its profile shines this way. A hit in the plane, within its
    /// error, gets nothing: a polygon is dark edge-on, and a surface on which a light lies flat is not lit at random.
    bool look(const Light& light, const ShadingFrame& frame, double error);

    const Light& light() const { return *light_; }
    const ShadingFrame& frame() const { return *frame_; }
    const ProfileView& profile() const { return profile_; }
    /// Of a sphere or a sun.
    const std::optional<CapView>& cap() const { return cap_; }
    /// In the shading frame, of a polygon, or of what of a light's spread shines on the hit: the smallest
    /// rectangle with edges along the light's own that holds it, or a convex polygon.
    std::span<const Vec3d> corners() const { return corners_; }
    /// Whether the corners are those of a part, which is convex.
    bool is_part() const { return is_part_; }
    /// Of a disk without corners, in the shading frame.
    const Ellipse<double>& ellipse() const { return ellipse_; }

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
    Ellipse<double> ellipse_{};
};

/// SeenLight::look, or delta_view, where nothing else is asked for.
bool is_seen(const Light& light, const ShadingFrame& frame, double error);

/// At least this far away lies every point of the light; 0 where that is not known.
double least_distance(const Light& light, const Vec3d& position);
/// A distance over which the light of the hit changes as little as it does over the least distance for an even light.
double changing_distance(const Light& light, const Vec3d& position);

/// The directions to the light.
Circle circle_of(const CapView& cap);

}  // namespace shlight
