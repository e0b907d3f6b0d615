// SPDX-License-Identifier: MIT
//
// Pictures looked up at texture coordinates, filtered by the distance of these to the neighbouring camera rays'.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "shaders/texture_pixels.h"

namespace shlight {

/// Differences of texture coordinates between a camera ray and its neighbours.
struct TextureFootprint {
    glm::vec2 right{0}, below{0};
};

class ImageTexture {
  public:
    struct Tile {
        std::int64_t u, v;  ///< covers u … u + 1
        std::shared_ptr<const TexturePixels> pixels;
    };
    /// tiles: one at (0, 0) that `extension` continues, or several tiles with magenta between them. unassociate:
    /// whether to divide colours by alpha.
    ImageTexture(std::vector<Tile> tiles, TextureInterpolation interpolation, TextureExtension extension,
                 bool unassociate, bool tiled);

    const TexturePixels& pixels() const { return *tiles_.front().pixels; }
    /// A prepared look-up, whose texels are being prefetched.
    struct Lookup {
        const TexturePixels* pixels;  ///< null: the place is between tiles
        glm::vec2 place;              ///< 0 … 1 over the picture
        float level;
        int probes;      ///< look-ups along the footprint's longest side; 0: that is shorter than a texel
        glm::vec2 step;  ///< from probe to probe
    };
    Lookup look(const glm::vec2& place, const TextureFootprint& footprint) const;
    /// Linear RGBA. With a footprint below a texel the picture is interpolated as TextureInterpolation says.
    glm::vec4 read(const Lookup& lookup) const;
    glm::vec4 sample(const glm::vec2& place, const TextureFootprint& footprint) const {
        return read(look(place, footprint));
    }

  private:
    class Reader;
    glm::vec2 varies_along(const glm::vec2& place, const TextureFootprint& footprint) const;
    glm::vec4 finished(const glm::vec4& stored, TexelEncoding encoding) const;

    std::vector<Tile> tiles_;
    TextureInterpolation interpolation_;
    TextureExtension extension_;
    bool unassociate_, tiled_;
};

}  // namespace shlight
