// SPDX-License-Identifier: MIT
//
// The opening of a camera's lens: what lies at another distance than the one in focus is blurred by its shape.
#pragma once

#include <glm/vec2.hpp>

namespace shlight {

/// As Cycles defines it: a disk, or a regular polygon in that circle. The camera frame's x and y lie in it; where a
/// panorama looks in one direction, the two axes across that.
struct Aperture {
    double size = 0;             ///< radius [m], half the focal length ÷ f-stop; 0: a pinhole, everything is in focus
    double focus_distance = 10;  ///< [m] along the view axis, of a panorama along the ray; may be infinite
    int blades = 0;              ///< corners of the polygon; below 3: a disk
    double rotation = 0;         ///< of the polygon, anticlockwise [rad]; at 0 a side is at right angles to x
    double ratio = 1;            ///< height ÷ width: the width is divided by it

    /// The point that one of the unit square is moved to, [m] from the middle. Areas keep their shares.
    glm::dvec2 point(const glm::dvec2& square) const;
};

/// Throws std::invalid_argument naming the argument: aperture_size, focus_distance, aperture_blades, aperture_rotation
/// or aperture_ratio.
void check_aperture(const Aperture& aperture);

}  // namespace shlight
