// SPDX-License-Identifier: MIT
//
// Outputs of a render beside the picture: surface data and parts of the light. Names, units and background values are
// those of Blender's render engine Cycles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace shlight {

enum class Pass : std::uint8_t {
    // Data of the first surface on the ray through a pixel's middle that is opaque enough
    // (PassSettings::alpha_threshold):
    depth,           ///< along the view axis [m]; 1e10 where nothing is
    position,        ///< in the world [m]; 0 where nothing is
    object_index,    ///< Label::index of the object
    material_index,  ///< likewise, of the material
    // Means over the pixel filter; 0 where nothing is:
    normal,               ///< unit vectors in the world, turned to the viewer
    uv,                   ///< attribute Mesh::uv; the third channel is 1 where the mesh has one
    mist,                 ///< 0 … 1, 1 where nothing is; see MistRange
    emission,             ///< radiance of surfaces and lamps that the camera sees
    environment,          ///< radiance of the environment, even if it is hidden from the camera
    diffuse_direct,       ///< light reflected by diffuse lobes ÷ diffuse_color
    diffuse_indirect,     ///< light that has bounced before, by paths that a diffuse lobe reflected first, ÷ likewise
    diffuse_color,        ///< albedo of diffuse lobes
    glossy_direct,        ///< light reflected by glossy lobes ÷ glossy_color
    glossy_indirect,      ///< likewise, a glossy lobe, ÷ glossy_color
    glossy_color,         ///< albedo of glossy lobes
    transmission_direct,  ///< lamps and the background behind one interface ÷ transmission_color
    transmission_indirect,  ///< other light that the first surface lets through an interface, ÷ likewise
    transmission_color,     ///< share of light from behind that interfaces let through
    denoising_normal,       ///< in the camera's frame, z forward, without mirror-like surfaces
    denoising_albedo,       ///< albedo of all but mirror-like lobes, plus emission
    denoising_depth,        ///< along camera rays [m]
    aov_value,              ///< numbers of shader programs
    aov_color,              ///< RGBA
    light_group,            ///< the part of the picture's RGB from lights of one group
    cryptomatte_object,     ///< levels × (identity, share), by decreasing share
    cryptomatte_material,
    cryptomatte_asset
};

struct RenderPass {
    Pass kind;
    std::uint32_t number = 0;  ///< of an AOV or a light group

    bool operator==(const RenderPass&) const = default;
};

/// MurmurHash3_x86_32 with seed 0, which identifies a name in Cryptomatte (github.com/Psyop/Cryptomatte).
std::uint32_t cryptomatte_hash(std::string_view name);
/// The hash as the bits of a float, adjusted to be finite and not 0.
float cryptomatte_id(std::string_view name);

/// The mist pass: ((distance from the camera - start) ÷ depth)^falloff, clamped to 0 … 1.
struct MistRange {
    double start = 5, depth = 25;  ///< [m]
    double falloff = 2;
};

struct PassSettings {
    std::vector<RenderPass> passes;
    double alpha_threshold = 0.5;  ///< opacity below which a surface is not the first; 0: every surface is
    MistRange mist;
    int cryptomatte_levels = 6;  ///< identities per pixel, rounded up to an even number
};

/// The layout of the passes among the floats of a pixel. Passes that divide others have a place even if they are not
/// requested.
class PassLayout {
  public:
    PassLayout() = default;
    /// Throws std::invalid_argument naming the member: a pass twice, an alpha_threshold outside 0 … 1, a mist range
    /// that is not finite or of a depth or falloff < 0, cryptomatte_levels outside 2 … 16.
    explicit PassLayout(const PassSettings& settings);

    struct Place {
        RenderPass pass;
        std::size_t first, size;
    };

    bool empty() const { return places_.empty(); }
    /// Number of floats of a pixel.
    std::size_t stride() const { return stride_; }
    /// Requested passes in the order of the settings, then those that others need.
    std::span<const Place> places() const { return places_; }
    /// The place of a pass; null if there is none.
    const Place* find(const RenderPass& pass) const;
    const Place* find(Pass kind) const { return find({kind, 0}); }

  private:
    void add(const RenderPass& pass, int levels);

    std::vector<Place> places_;
    std::size_t stride_ = 0;
};

}  // namespace shlight
