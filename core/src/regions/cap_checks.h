// SPDX-License-Identifier: MIT
//
// What may be passed as a sphere or a cap: checks that throw std::invalid_argument naming the argument.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// A positive radius, and a shading point that is not inside: contact within epsilon, the rounding of the inputs,
/// counts as contact.
void check_sphere(const Vec3d& center, double radius, double epsilon);
/// check_sphere of each of many, and of floats a distance that is a normal float.
template <class T>
void check_spheres(std::span<const Vec3<T>> centers, std::span<const T> radii, double epsilon);

/// An axis that is finite and not zero, a half angle in (0, π] with room for rounding.
void check_cap(const Vec3d& axis, double half_angle);

}  // namespace shlight
