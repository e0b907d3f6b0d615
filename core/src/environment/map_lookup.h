// SPDX-License-Identifier: MIT
//
// What a picture of all directions shows in many of them: in lanes, one for each direction.
#pragma once

#include <array>
#include <cstddef>

#include "environment/environment_map.h"

namespace shlight {

/// Arrays are read and written up to the next multiple of this many values.
inline constexpr std::size_t kLookupLanes = 16;

/// Unit vectors of the picture's own frame.
struct MapDirections {
    const float *x, *y, *z;
};

struct MapValues {
    std::array<float*, 3> smooth;  ///< radiance without the spots, see EnvironmentMap
    std::array<float*, 3> spots;   ///< what these add
    float* density;                ///< of EnvironmentMap::sampler
};

void look_up(const EnvironmentMap& map, const MapDirections& directions, std::size_t count, const MapValues& values);

/// The picture in each direction, with or without the spots, blurred over about so large a solid angle.
void look_up_blurred(const EnvironmentMap& map, bool with_spots, const MapDirections& directions,
                     const float* solid_angles, std::size_t count, const std::array<float*, 3>& radiance);

}  // namespace shlight
