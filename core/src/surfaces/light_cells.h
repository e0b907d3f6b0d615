// SPDX-License-Identifier: MIT
//
// Light that surfaces send towards others, in cells of the world: the mean over those of its places and directions from
// which rays have come that were shaded. Rays that need no sharper picture of a surface take it from there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "lobes/material_lobes.h"
#include "shlight/scene.h"
#include "shlight/surface_point.h"
#include "shlight/types.h"
#include "surfaces/world_lattice.h"

namespace shlight {

/// Whether lobes of microfacets of a known width are narrower.
bool has_narrower(std::span<const Lobe> lobes, double width);

class LightCells {
  public:
    /// Lobes this wide, or wider, need no sharper picture of what they reflect.
    static constexpr double kLeastWidth = 0.05;

    /// scene: must outlive this; filtered_width: of the narrowest lobes that rays from diffuse surfaces meet; parts:
    /// that light is told apart by, see StoredLight.
    LightCells(const CompiledScene& scene, std::span<const MaterialLobes> materials, double filtered_width,
               std::size_t parts);

    /// The cell that a ray of some length ends in. Mirrors and what light passes through look different from
    /// everywhere: false.
    bool find(const SurfacePoint& end, const Vec3f& direction, double length, WorldCell& key) const;
    /// Whether rays from diffuse surfaces see a material otherwise than others do.
    bool is_filtered(std::uint32_t material) const { return is_filtered_[material] != 0; }
    /// How well a cell is known.
    struct Known {
        std::size_t samples = 0;  ///< of its light
        std::size_t rays = 0;     ///< that have ended there
    };

    /// light: the mean of further samples, by parts.
    void add(const WorldCell& key, std::span<const Rgb> light, const Known& further);
    Known known(const WorldCell& key) const;
    /// Memory of all, about.
    std::size_t bytes() const;
    void clear();
    /// The light, until some is added; empty if none is known.
    std::span<const Rgb> look_up(const WorldCell& key) const;

  private:
    enum class Look : std::uint8_t { everywhere_alike, by_view, sharp };
    struct Cell {
        std::size_t first;  // in light_
        Known known;
    };

    WorldLattice lattice_;
    std::size_t parts_;
    std::vector<Look> looks_;  // of materials, as rays from diffuse surfaces see them
    std::vector<std::uint8_t> is_filtered_;
    std::unordered_map<WorldCell, Cell, WorldCellHash> cells_;
    std::vector<Rgb> light_;
};

}  // namespace shlight
