// SPDX-License-Identifier: MIT
//
// What lights bring to the pixels of a picture, kept apart by light, or by some lights together where there are many.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shlight/light.h"
#include "shlight/scene.h"
#include "shlight/types.h"

namespace shlight {

/// The light of some lights, all with extent or all without, or of the environment.
struct LightLayer {
    std::vector<Light> lights;  ///< none: the environment
    bool extended = true;
    Rgb gain{1};                          ///< what the light has become by, since `radiance` was found
    double light_error = 0;               ///< LightingScene::light_error with which it was found
    std::vector<Rgb> radiance, variance;  ///< by pixel, of its mean; variance: empty, or by shadow rays
    std::vector<std::uint32_t> rays;      ///< by batch: shadow rays of a camera ray and light; 0: nothing is known

    bool is_environment() const { return lights.empty(); }
    /// Whether anything is known of it.
    bool is_known() const { return !radiance.empty(); }
};

/// The layers of a scene's lights, of which nothing is known but what layers of `before` know: those of the same
/// lights, found with an error near light_error. Takes these out of `before`. same_environment: the environment is the
/// one before.
std::vector<LightLayer> layers_of(const CompiledScene& scene, double light_error, bool same_environment,
                                  std::vector<LightLayer>& before);

}  // namespace shlight
