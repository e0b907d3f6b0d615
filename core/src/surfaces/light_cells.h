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

namespace shlight {

class LightCells {
  public:
    struct Key {
        std::uint64_t place;  ///< the cell's size and, in an order in which neighbours are near, its place
        std::uint32_t kind;   ///< of the surface

        bool operator==(const Key&) const = default;
    };
    /// Lobes this wide, or wider, need no sharper picture of what they reflect.
    static constexpr double kLeastWidth = 0.05;

    /// parts: that light is told apart by, see StoredLight.
    LightCells(const CompiledScene& scene, std::span<const MaterialLobes> materials, std::size_t parts);

    /// The cell that a ray of some length ends in. Mirrors and what light passes through look different from
    /// everywhere: false.
    bool find(const SurfacePoint& end, const Vec3f& direction, double length, Key& key) const;
    /// light: of `weight` rays on average, by parts.
    void add(const Key& key, std::span<const Rgb> light, float weight);
    /// The sum of the weights that were added.
    float weight(const Key& key) const;
    /// The light, until some is added; empty if none is known.
    std::span<const Rgb> look_up(const Key& key) const;

  private:
    enum class Look : std::uint8_t { everywhere_alike, by_view, sharp };
    struct Hash {
        std::size_t operator()(const Key& key) const;
    };
    struct Cell {
        std::size_t first;  // in light_
        float weight;
    };

    std::size_t parts_;
    std::vector<Look> looks_;  // of materials
    std::unordered_map<Key, Cell, Hash> cells_;
    std::vector<Rgb> light_;
};

}  // namespace shlight
