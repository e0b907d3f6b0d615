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

/// The rectangle that the image shows: on the plane z = -1 of the camera frame, in its units for an orthographic
/// camera, or as shares of a panorama, whose whole is 0 … 1. Lens shift, sensor fit, pixel aspect and render borders
/// all come down to it.
struct Window {
    double left, right, bottom, top;
};

enum class Projection { perspective, orthographic };

/// Distances along the view axis, of a panorama along the ray, between which surfaces are seen.
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

    /// What an image of this size shows.
    Window window(int width, int height) const;
    /// Whether rays through different points of the aperture differ.
    bool has_depth_of_field() const { return aperture_.size > 0; }
    /// The ray through a point of the window, and through the point of the aperture that one of the unit square is
    /// moved to, none: its middle; its direction is a unit vector. Empty outside a panorama's image.
    Ray ray(double x, double y, const std::optional<glm::dvec2>& square = {}) const;
    /// Along the view axis, from the camera's place to a point; of a panorama the distance.
    double depth(const Vec3d& point) const;
    /// From the camera's place to a point; of an orthographic camera |depth|.
    double distance(const Vec3d& point) const;
    /// A world direction in the camera's frame, whose axes count as if they had length 1.
    Vec3d turned_to_frame(const Vec3d& direction) const;

  private:
    void check() const;
    Ray from_lens(const Vec3d& origin, const Vec3d& per_depth) const;

    glm::dmat4 to_world_;
    std::optional<Window> window_;  // none: from the field of view
    double half_width_ = 0;
    Projection projection_ = Projection::perspective;
    std::optional<Panorama> panorama_;  // in place of a projection
    ClipRange clip_;
    Aperture aperture_;
};

}  // namespace shlight
