// SPDX-License-Identifier: MIT
//
// The encoding of sRGB (IEC 61966-2-1).
#pragma once

#include <glm/vec3.hpp>

namespace shlight {

float linear_from_srgb(float encoded);

/// linear_from_srgb from a table of the means of up to four bytes, 0 … 1.
glm::vec3 linear_from_srgb_near(const glm::vec3& encoded);

}  // namespace shlight
