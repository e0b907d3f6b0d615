// SPDX-License-Identifier: MIT
//
// A material whose numbers vary: a program that finds, at each hit, what its lobes weigh and how wide they are.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "shlight/bsdf.h"
#include "shlight/lobe_shape.h"
#include "shlight/shader_program.h"

namespace shlight {

/// Numbers of results of the program; of colours and vectors that of the first of three.
struct ShadedLobe {
    LobeShape shape;
    std::uint32_t weight;                 ///< colour; what is not finite counts as 0
    std::optional<std::uint32_t> alpha;   ///< takes the place of that of a GgxShape; clamped to 0 … 1
    std::optional<std::uint32_t> normal;  ///< world vector of any length; none, or without a direction: the smooth one
    bool several_bounces = false;         ///< the weight makes up for what microfacets lose to each other
};

/// A number or colour that a program finds for a pass of its own.
struct ShadedAov {
    std::uint32_t value;  ///< as of ShadedLobe
    bool is_color;
};

struct SurfaceShader {
    ShaderProgram program;
    std::vector<ShadedLobe> lobes;
    std::optional<std::uint32_t> emission;      ///< radiance towards the viewer
    std::optional<std::uint32_t> transparency;  ///< share of the light that goes on straight through; none: opaque
    ShaderProgram shadow_program;               ///< the same for shadow rays, its three results
    std::vector<ShadedAov> aovs;
};

/// As lobes of a Bsdf, of colour 1: what they weigh is found at each hit.
std::vector<Lobe> lobes_of(const SurfaceShader& shader);

/// Throws std::invalid_argument where a number is that of no result.
void check_surface_shader(const SurfaceShader& shader);

}  // namespace shlight
