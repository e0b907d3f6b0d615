// SPDX-License-Identifier: MIT
//
// Pinhole and orthographic cameras. The camera frame looks along -z, y is up, x to the right.
#pragma once

#include <limits>
#include <optional>

#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// The rectangle that the image shows: on the plane z = -1 of the camera frame, or in its units for an orthographic
/// camera. Lens shift, sensor fit, pixel aspect and render borders all come down to it.
struct Window {
    double left, right, bottom, top;
};

enum class Projection { perspective, orthographic };

/// Distances along the view axis between which surfaces are seen.
struct ClipRange {
    double start = 0;
    double end = std::numeric_limits<double>::infinity();
};

class Camera {
  public:
    /// fov_x: horizontal field of view [rad], 0 < fov_x < π; pixels are square.
    /// Throws std::invalid_argument naming the argument.
    Camera(const glm::dmat4& to_world, double fov_x);
    /// Throws std::invalid_argument naming the argument: a transform that is not affine and invertible, an empty
    /// window, a clip range that is negative or empty.
    Camera(const glm::dmat4& to_world, const Window& window, Projection projection, const ClipRange& clip = {});

    /// What an image of this size shows.
    Window window(int width, int height) const;
    /// The ray through a point of the window; its direction is a unit vector.
    Ray ray(double x, double y) const;
    /// Along the view axis, from the camera's place to a point.
    double depth(const Vec3d& point) const;
    /// From the camera's place to a point; of an orthographic camera |depth|.
    double distance(const Vec3d& point) const;
    /// A world direction in the camera's frame, whose axes count as if they had length 1.
    Vec3d turned_to_frame(const Vec3d& direction) const;

  private:
    glm::dmat4 to_world_;
    std::optional<Window> window_;  // none: from the field of view
    double half_width_ = 0;
    Projection projection_ = Projection::perspective;
    ClipRange clip_;
};

}  // namespace shlight
