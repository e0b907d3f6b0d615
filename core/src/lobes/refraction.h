// SPDX-License-Identifier: MIT
//
// Light that goes on through a rough or smooth interface of two transparent bodies, by drawn directions (Walter et al.
// 2007, "Microfacet Models for Refraction through Rough Surfaces").
#pragma once

#include <cstdint>

#include <glm/vec2.hpp>

#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// Unpolarised Fresnel reflectance of an interface. ior: index on the other side ÷ that on the viewer's; 1 where all
/// light is reflected.
double interface_reflectance(double cosine, double ior);

struct InterfaceRay {
    Vec3d way{0};       ///< unit, in the shading frame
    double weight = 0;  ///< light that the viewer gets ÷ light from there; 0: none
    bool reflected = false;
};

/// Whether an interface's reflection takes its share of drawn rays, is brought by others, or there is none.
enum class InterfaceReflection : std::uint8_t { drawn, apart, none };

struct InterfaceValue {
    double value = 0;    ///< f·cos
    double density = 0;  ///< of sample_interface() [1/sr]
};

/// Microfacets between two bodies.
struct RoughInterface {
    double alpha;
    double ior;  ///< of the body beyond, relative to that of the viewer
    InterfaceReflection reflection;
    Microfacets distribution = Microfacets::ggx;  ///< or Beckmann's
};

/// way: unit, in the shading frame; ior: not 1. As in Cycles, light is let through, too, by half vectors that no
/// microfacet has, since it would be seen from behind: their density is 0.
InterfaceValue interface_value(const RoughInterface& interface, const Vec3d& view, const Vec3d& way);

/// A direction through the interface, at a normal that the point draws of GGX's visible ones, whatever the
/// distribution. view: unit, in the xz-plane, above the horizon; choice: of reflection where it is drawn.
InterfaceRay sample_interface(const RoughInterface& interface, const Vec3d& view, const glm::dvec2& point,
                              double choice);

}  // namespace shlight
