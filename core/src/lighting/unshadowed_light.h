// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "lighting/environment_shading.h"
#include "lighting/unshadowed_radiance.h"

namespace shlight {

/// A light with extent or the environment, as it would be reflected if nothing blocked it.
struct UnshadowedLight {
    LightRadiance smooth, spots;  ///< see UnshadowedParts
    std::uint32_t group = 0;      ///< see LightTraits
    bool casts_shadows = true;
    const EnvironmentShading* environment = nullptr;  ///< whose spots are apart; null: there are none

    Rgb operator[](std::size_t i) const { return environment != nullptr ? smooth[i] + spots[i] : smooth[i]; }
    /// Whether the spots are apart for a lobe of this form.
    bool splits(std::size_t material, std::size_t lobe, const LobeForm& form) const {
        return environment != nullptr && environment->splits(material, lobe, form);
    }
};

}  // namespace shlight
