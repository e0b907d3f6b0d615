// SPDX-License-Identifier: MIT
//
// Coefficients of many caps at once, and of single ones by the same means.
#pragma once

#include <cstddef>

#include "shlight/cap.h"
#include "shlight/types.h"
#include "shlight/warp.h"

namespace shlight {

/// Whether all spheres are certainly what check_sphere accepts; a few that it accepts may be doubted.
bool spheres_are_sound(const Vec3<float>* centers, const float* radii, std::size_t count);
bool spheres_are_sound(const Vec3<double>* centers, const double* radii, std::size_t count);

/// order² coefficients of sphere i at rows + i · order². Precondition: check_sphere accepts them.
void sphere_rows(const Vec3<float>* centers, const float* radii, std::size_t count, int order, bool clip, float* rows,
                 Output output);
void sphere_rows(const Vec3<double>* centers, const double* radii, std::size_t count, int order, bool clip,
                 double* rows, Output output);

/// Coefficients of the caps inside circles.
void circle_rows(const Circle* circles, std::size_t count, int order, bool clip, float* rows, Output output);
void circle_rows(const Circle* circles, std::size_t count, int order, bool clip, double* rows, Output output);

/// The cap inside a circle, seen against the image of the plane z = 0. crossing_squared: sin²σ - L_z² before the warp.
Cap<double> cap_inside(const Circle& circle, double crossing_squared, const Warp& warp);
/// The same, where sin²σ - L_z² is as exact as the circle.
Cap<double> cap_inside(const Circle& circle, const Warp& warp);

/// The circles of a light and of a horizon at `height`, and the triangle of their poles and a point where they cross.
/// Each pair (chord, cosine) is the product of two sides' sines times the (sine, cosine) of the angle between those
/// sides; chord is 0 where the circles do not cross.
struct Contact {
    Circle light;
    double height, sine;
    double chord;
    double corner;  ///< cosθ - cosσ z_0: at the crossing
    double arc;     ///< cosσ - z_0 cosθ: at the horizon's pole
    double edge;    ///< z_0 - cosσ cosθ: at the light's pole
};
Cap<double> cap_in_contact(const Contact& contact);

/// The bands of one cap, as clipped_cap_terms, shade_cap and cap_coefficients have them.
void terms_of_cap(const Cap<float>& cap, int order, float* cosine_terms);
void terms_of_cap(const Cap<double>& cap, int order, double* cosine_terms);
float shade_one_cap(const Cap<float>& cap, const float* lobe_terms, int order);
double shade_one_cap(const Cap<double>& cap, const double* lobe_terms, int order);
void row_of_cap(const Cap<float>& cap, int order, float* row);
void row_of_cap(const Cap<double>& cap, int order, double* row);

}  // namespace shlight
