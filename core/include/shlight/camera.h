// SPDX-License-Identifier: MIT
//
// Perspective, orthographic and panoramic cameras, with a pinhole or a lens. The camera frame looks along -z, y is up,
// x to the right.
#pragma once

#include <limits>
#include <optional>

#include "shlight/aperture.h"
#include "shlight/panorama.h"
#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// The rectangle that the image shows: on the plane z = -1 of the camera frame; for an orthographic camera in units of
/// its frame; for a panorama as shares 0 … 1 of the whole. It expresses lens shift, sensor fit, pixel aspect and render
/// borders.
struct Window {
    double left, right, bottom, top;
};

enum class Projection { perspective, orthographic };

/// Range of distances [m] in which surfaces are visible, along the view axis or along the ray of a panorama.
struct ClipRange {
    double start = 0;
    double end = std::numeric_limits<double>::infinity();
};

class Camera {
  public:
    /// fov_x: horizontal field of view [rad], 0 < fov_x < π; pixels are square.
    /// Throws std::invalid_argument naming the argument, as check_aperture does.
    Camera(const glm::dmat4& to_world, double fov_x, const Aperture& aperture = {});
    /// Throws std::invalid_argument naming the argument: a transform that is not affine and invertible, an empty
    /// window, a clip range that is negative or empty, and as check_aperture and check_panorama do.
    Camera(const glm::dmat4& to_world, const Window& window, Projection projection, const ClipRange& clip = {},
           const Aperture& aperture = {});
    Camera(const glm::dmat4& to_world, const Panorama& panorama, const Window& window = {0, 1, 0, 1},
           const ClipRange& clip = {}, const Aperture& aperture = {});

    Camera moved(const Vec3d& way) const;
    /// The window of an image of this size.
    Window window(int width, int height) const;
    /// Whether rays through different points of the aperture differ.
    bool has_depth_of_field() const { return aperture_.size > 0; }
    /// The ray through a point of the window and a point of the aperture, given as a point of the unit square (default:
    /// the aperture's middle). The direction is a unit vector. The ray is empty outside a panorama's image.
    Ray ray(double x, double y, const std::optional<glm::dvec2>& square = {}) const;
    /// Distance of a point from the camera along the view axis; for a panorama the distance itself.
    double depth(const Vec3d& point) const;
    /// Distance of a point from the camera; for an orthographic camera |depth|.
    double distance(const Vec3d& point) const;
    /// A world direction in the camera frame, ignoring the lengths of that frame's axes.
    Vec3d turned_to_frame(const Vec3d& direction) const;

  private:
    void check() const;
    Ray from_lens(const Vec3d& origin, const Vec3d& per_depth) const;

    glm::dmat4 to_world_;
    std::optional<Window> window_;  // none: the field of view determines it
    double half_width_ = 0;
    Projection projection_ = Projection::perspective;
    std::optional<Panorama> panorama_;  // replaces the projection
    ClipRange clip_;
    Aperture aperture_;
};

}  // namespace shlight
