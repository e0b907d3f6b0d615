// SPDX-License-Identifier: MIT
//
// What a render delivers beside the picture: what the camera sees as numbers, and parts of the light. Passes are those
// that Blender's render engine Cycles has, by its names, units and values where the camera sees nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace shlight {

enum class Pass : std::uint8_t {
    // What the ray through a pixel's middle meets first that is opaque enough, see PassSettings::alpha_threshold:
    depth,           ///< along the view axis [m]; 1e10 where nothing is
    position,        ///< in the world [m]; 0 where nothing is
    object_index,    ///< Label::index of the object
    material_index,  ///< likewise, of the material
    // Means over the pixel filter, as the picture is; 0 where nothing is:
    normal,              ///< unit vectors in the world, turned to the viewer
    uv,                  ///< of the mesh's Mesh::uv; the third channel is 1 where there is one
    mist,                ///< 0 … 1, 1 where nothing is; see MistRange
    emission,            ///< radiance of surfaces and lamps that the camera sees
    environment,         ///< likewise, of the environment, also where it is hidden from the camera
    diffuse_direct,      ///< what diffuse lobes reflect ÷ diffuse_color
    diffuse_color,       ///< albedo of diffuse lobes
    glossy_direct,       ///< what glossy lobes reflect ÷ glossy_color
    glossy_color,        ///< albedo of glossy lobes
    denoising_normal,    ///< in the camera's frame, z forward, without mirror-like surfaces
    denoising_albedo,    ///< of all that is not mirror-like, and radiance of what shines
    denoising_depth,     ///< along camera rays [m]
    aov_value,           ///< numbers of shader programs
    aov_color,           ///< RGBA
    light_group,         ///< the part of the picture's RGB that lights of one group give
    cryptomatte_object,  ///< levels × (identity, share), those of larger share first
    cryptomatte_material,
    cryptomatte_asset
};

struct RenderPass {
    Pass kind;
    std::uint32_t number = 0;  ///< of an AOV or a light group

    bool operator==(const RenderPass&) const = default;
};

/// MurmurHash3_x86_32 with the seed 0, by which Cryptomatte (github.com/Psyop/Cryptomatte) knows a name.
std::uint32_t cryptomatte_hash(std::string_view name);
/// The same as the bits of a float that is finite and not 0.
float cryptomatte_id(std::string_view name);

/// How far the mist pass reaches: its distance from the camera, less start, ÷ depth, to the power of falloff.
struct MistRange {
    double start = 5, depth = 25;  ///< [m]
    double falloff = 2;
};

struct PassSettings {
    std::vector<RenderPass> passes;
    double alpha_threshold = 0.5;  ///< a surface that lets more than 1 - this through is not the first; 0: it is
    MistRange mist;
    int cryptomatte_levels = 6;  ///< identities that a pixel has, rounded up to an even number
};

/// Where the passes of a pixel are among its floats. Those that others are divided by have a place of their own even if
/// they are not asked for.
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
    /// Floats of a pixel.
    std::size_t stride() const { return stride_; }
    /// In the order of the settings, then what others need.
    std::span<const Place> places() const { return places_; }
    /// Null: there is no such pass.
    const Place* find(const RenderPass& pass) const;
    const Place* find(Pass kind) const { return find({kind, 0}); }

  private:
    void add(const RenderPass& pass, int levels);

    std::vector<Place> places_;
    std::size_t stride_ = 0;
};

}  // namespace shlight
