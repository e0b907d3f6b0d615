// SPDX-License-Identifier: MIT
//
// A material with a program that computes, at each hit, the weights and widths of its lobes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "shlight/bsdf.h"
#include "shlight/lobe_shape.h"
#include "shlight/shader_program.h"

namespace shlight {

/// This is how a path from the viewer gets below a surface.
enum class SubsurfaceEntry : std::uint8_t {
    refracted,  ///< by microfacets of GGX
    skin,       ///< one half by microfacets of width 1, the other as from a diffuse surface
    diffuse,
    disk,      ///< not at all: a probe finds places nearby, by the diffusion profile of Christensen & Burley 2015
    exit_only  ///< by the lobe before that has an entry; what comes out there has this lobe's part of that one's weight
};

/// Light that enters the mesh's body near by, and is scattered there to where the viewer's ray meets it. The lobe is
/// then the diffuse reflection by which it enters; the lobe's own weight counts where paths have met a diffuse lobe
/// before, and in channels without extinction.
struct ShadedSubsurface {
    /// The first of twelve results: extinction [1/m], albedo of single scattering, and gain, of which the weight is
    /// multiplied with the last, three each; alpha and index of the interface, and the mean cosine of scattering.
    /// With disk: the inverse of the profile's d in place of extinction, and no others.
    std::uint32_t numbers;
    SubsurfaceEntry entry;
};
inline constexpr std::uint32_t kSubsurfaceNumbers = 12;

/// A lobe whose numbers are results of the program, given by index; colours and vectors by the first of three.
struct ShadedLobe {
    LobeShape shape;
    std::uint32_t weight;  ///< colour; NaN and infinity count as 0
    /// Replaces GgxShape::alpha; clamped to 0 … 1. Of a stretched shape (is_stretched()) it is that along a tangent,
    /// and four results follow: alpha across the tangent, and the tangent, a world vector of any length. Of toon it is
    /// its size, and its smoothness follows.
    std::optional<std::uint32_t> alpha;
    std::optional<std::uint32_t> normal;  ///< world vector of any length; none or 0: the interpolated normal
    bool several_bounces = false;         ///< the weight compensates the energy lost between microfacets
    bool translucent = false;             ///< it reflects light from the other side than the viewer's, and is diffuse
    std::shared_ptr<const ViewWeight> view_weight;  ///< another factor; null: 1
    int only_order = 0;                             ///< see Lobe
    /// The normal that a bump leans from, likewise; by it shadow rays start on the smooth surface.
    std::optional<std::uint32_t> leans_from;
    std::optional<ShadedSubsurface> subsurface;  ///< the lobe is then Lambert's, or the one by which light enters
};

/// An interface to a transparent body that the mesh's front side bounds: light that bounces goes on through it, and
/// inside is reflected by it. What the front reflects is a matter of lobes. Members are as those of ShadedLobe.
struct ShadedRefraction {
    std::uint32_t weight;  ///< colour, of light from inside too
    std::uint32_t alpha;
    std::uint32_t ior;  ///< of the body, relative to what is around it; not positive: 1
    std::optional<std::uint32_t> normal;
    bool reflects = true;                         ///< false: all light goes through that can, and no other is met
    Microfacets distribution = Microfacets::ggx;  ///< or Beckmann's
};

/// A number or colour that a program computes for an AOV.
struct ShadedAov {
    std::uint32_t value;  ///< see ShadedLobe
    bool is_color;
};

struct SurfaceShader {
    ShaderProgram program;
    std::vector<ShadedLobe> lobes;
    std::optional<std::uint32_t> emission;      ///< radiance towards the viewer
    std::optional<std::uint32_t> transparency;  ///< share of light that passes straight through; none: opaque
    ShaderProgram shadow_program;               ///< its three results are the transparency for shadow rays
    std::vector<ShadedAov> aovs;
    std::vector<ShadedRefraction> refractions;
    bool blocks_shadow_rays = false;  ///< those do not pass, and other rays do
    /// [1/m], not negative, of the body that the mesh's front side bounds: of light, e^(-absorption · way) is left.
    Rgb absorption{0};
};

/// The lobes of a Bsdf with colour 1; their weights are computed at each hit.
std::vector<Lobe> lobes_of(const SurfaceShader& shader);

/// Throws std::invalid_argument if an index is not that of a result.
void check_surface_shader(const SurfaceShader& shader);

}  // namespace shlight
