// SPDX-License-Identifier: MIT
//
// Voronoi cells of points, one in each cell of a grid, as operations of shader programs.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shaders/operations.h"

namespace shlight {

/// What is looked for: distance, colour and place of the nearest point, the second nearest one, or a smooth mean of
/// all; the distance to the next edge between two cells; or half the distance from the nearest point to the one
/// nearest to it.
enum class VoronoiFeature : std::uint8_t { nearest, second, smooth, edge, radius };
/// Lengths of vectors: Σ (|x|^e)^(1/e) with e = 2, 1, ∞, or an argument of the operation.
enum class VoronoiMetric : std::uint8_t { euclidean, manhattan, chebychev, minkowski };
/// Versions of Cycles: until 3.x, whose distances end at 8; until 4.5, and since 5.0, which have another hash.
enum class VoronoiVersion : std::uint8_t { blender_3, blender_4, blender_5 };

struct VoronoiMode {
    VoronoiFeature feature;
    VoronoiMetric metric;
    VoronoiVersion version;
    bool normalized;  ///< whether distances and colours are divided by the largest that the octaves can sum up to

    /// number: feature + 5 (metric + 4 (version + 3 normalized)) < kVoronoiModes.
    static constexpr VoronoiMode numbered(std::uint32_t number) {
        return {static_cast<VoronoiFeature>(number % 5), static_cast<VoronoiMetric>(number / 5 % 4),
                static_cast<VoronoiVersion>(number / 20 % 3), number / 60 % 2 != 0};
    }
};
inline constexpr std::uint32_t kVoronoiModes = 5 * 4 * 3 * 2;

/// Octaves of cells in 1 … 4 dimensions (Worley 1996, A Cellular Texture Basis Function; smooth: Blender's manual).
/// Arguments: the coordinates, detail, roughness, lacunarity, smoothness, exponent, randomness; results: distance or
/// radius, red, green, blue, the coordinates of the point. What a feature does not have is 0.
template <std::size_t kDimensions>
void voronoi(const OperationLanes& lanes);

}  // namespace shlight
