// SPDX-License-Identifier: MIT
//
// The aperture of a camera's lens, whose shape blurs objects that are out of focus.
#pragma once

#include <glm/vec2.hpp>

namespace shlight {

/// Cycles' aperture: a disk, or a regular polygon inscribed in it, in the xy-plane of the camera frame; for a panorama
/// in the plane perpendicular to the ray.
struct Aperture {
    double size = 0;             ///< radius [m]: focal length ÷ (2 f-stop); 0: a pinhole, everything is in focus
    double focus_distance = 10;  ///< [m] along the view axis, or along the ray of a panorama; may be infinite
    int blades = 0;              ///< corners of the polygon; below 3: a disk
    double rotation = 0;         ///< of the polygon, anticlockwise [rad]; at 0 one side is perpendicular to x
    double ratio = 1;            ///< height ÷ width; it divides the width

    /// Maps a point of the unit square to the aperture [m from the middle], preserving ratios of areas.
    glm::dvec2 point(const glm::dvec2& square) const;
    /// Largest coordinate of a point [m].
    double reach() const { return size * (ratio < 1 ? 1 / ratio : 1); }
};

/// Throws std::invalid_argument naming the argument: aperture_size, focus_distance, aperture_blades, aperture_rotation
/// or aperture_ratio.
void check_aperture(const Aperture& aperture);

}  // namespace shlight
