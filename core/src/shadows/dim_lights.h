// SPDX-License-Identifier: MIT
//
// Shadows of lights with extent that add little to a pixel. A scene may have thousands of them.
//
// Few hits of the pixel are asked, by one ray each, and all are shaded with the share of the light that these see. They
// are drawn in proportion to what hits reflect of the light; hits of one material answer for each other only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shading/light_brightness.h"
#include "shading/shading_points.h"
#include "shadows/shadow_rays.h"
#include "shlight/light.h"
#include "tracing/hits.h"

namespace shlight {

/// Keeps its memory from light to light; one per thread.
class DimLights {
  public:
    /// Refers to the brightness, which knows the same points.
    DimLights(const LightBrightness& brightness, std::size_t lobe_stride)
        : brightness_(&brightness), lobe_stride_(lobe_stride) {}

    /// To be called before the first light of other points, which stay as they are until finish().
    void start(const ShadingPoints& points);
    /// Adds a light to the hits of a pixel. unshadowed: see DirectLight::light; brightness: of the light over the
    /// pixel; phase: the batch's, of any number of rays; questions: about how many hits to ask; seed: of the pixel and
    /// light.
    void add(const Light& light, const LightRadiance& unshadowed, std::size_t pixel, float brightness,
             const RayPhase& phase, std::size_t questions, std::uint32_t seed, const Hits& hits, ShadowRays& rays);
    /// Adds all that was added to the hits' radiance.
    void finish(Hits& hits) const;

  private:
    struct Member {
        std::size_t point;
        float brightness;
    };

    /// Points of a pixel from the first on that have its material: their brightness.
    float gather(const LightRadiance& unshadowed, std::size_t first, std::size_t last);
    /// Draws hits of the members: asked_ are those that see the light.
    void draw(const Light& light, const LightRadiance& unshadowed, float brightness, std::size_t questions,
              std::uint32_t seed, const Hits& hits);
    /// Of the light that the asked hits see, by lobe; false if rays tell nothing of some lobe.
    bool find_shares(const Hits& hits, const ShadowRays& rays);
    void shade(const LightRadiance& unshadowed);

    const LightBrightness* brightness_;
    std::size_t lobe_stride_;
    const ShadingPoints* points_ = nullptr;
    std::vector<Rgb> radiance_;  // by point, of each of its hits
    // Of a light, a pixel and a material:
    std::vector<Member> members_;
    LitHits asked_;
    std::vector<Rgb> shares_;      // by lobe
    std::vector<double> density_;  // of asked_: brightness of the hit
};

}  // namespace shlight
