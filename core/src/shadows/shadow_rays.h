// SPDX-License-Identifier: MIT
//
// Shadow rays from the hits of a pixel to one light: spread over the light, and spread as each glossy lobe reflects.
//
// Both sets serve a glossy lobe, weighted by the balance heuristic (Veach & Guibas 1995): a sample of direction ω that
// either way could have drawn counts f·cos / (n (p_light + p_lobe)). A lobe much wider than the light lives on the
// former, one much narrower on the latter, with no switch between them. A mirror has one ray. Weights hold the
// light's emission profile.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lights/light_sampling.h"
#include "lights/seen_light.h"
#include "lobes/material_lobes.h"
#include "shadows/ray_sums.h"
#include "shadows/shadow_policy.h"
#include "shlight/light.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// The hits of a pixel that a light reaches if nothing is between.
struct LitHits {
    void clear() {
        hit.clear();
        shines.clear();
    }
    /// Adds a hit, unless it does not see the light itself: it may see less of it than the point that it shares.
    bool add(const Light& light, const Hits& hits, std::size_t which) {
        if (seen.size() == hit.size()) {
            seen.emplace_back();
        }
        if (!seen[hit.size()].look(light, hits.frame[which], hits.error[which])) {
            return false;
        }
        hit.push_back(which);
        return true;
    }

    std::vector<std::size_t> hit;
    std::vector<SeenLight> seen;       ///< by each of them; may be longer
    std::vector<std::uint8_t> shines;  ///< hit.size() × lobe_stride: whether the lobe reflects any of it
};

/// Keeps its memory from light to light; one per thread.
class ShadowRays {
  public:
    ShadowRays(const ShadowTracer& tracer, std::span<const MaterialLobes> materials, std::size_t lobe_stride);

    /// seed: of the pixel and light, whose phases differ in nothing else.
    void trace(const Light& light, const Hits& hits, const LitHits& lit, const RayPhase& phase, std::uint32_t seed);

    /// Since the last first phase.
    std::size_t count() const { return visible_.size(); }
    std::size_t blocked_count() const;
    /// Whether nothing takes light away from any of them.
    bool all_free() const;
    /// Of all phases; lit_index: of LitHits.
    RaySums sum(const Hits& hits, const LitHits& lit, std::size_t lit_index, std::size_t lobe) const;
    std::uint64_t rays_traced() const { return rays_traced_; }

  private:
    /// Lobes of a material whose directions are spread alike share their rays.
    struct Material {
        std::vector<std::size_t> lobes;          // of each set of rays one
        std::vector<std::uint32_t> set_of_lobe;  // index of lobes, kLightOnly for diffuse lobes
    };
    /// The rays of one set of a hit.
    struct Run {
        std::size_t begin, end;
    };
    class Drawing;

    void draw(const Drawing& drawing, const LitHits& lit, std::size_t lit_index);
    void follow(const MeshLight& light, std::size_t before);
    /// The radiance of the faces that the rays of the phase would meet if nothing else were there.
    void find_colors(const FaceRadiance& faces);
    void draw_lobes(const Drawing& drawing, std::size_t lit_index, std::size_t set, const LobeShape& shape);
    /// layers: of the light, one behind the other, each of which the unshadowed radiance counts.
    void push(const Drawing& drawing, const Vec3d& direction, double distance, double weight, int layers);
    /// Whose directions a set has at a hit.
    LobeShape set_shape(const Drawing& drawing, std::size_t set) const;
    bool shines(const LitHits& lit, std::size_t lit_index, const Material& material, std::uint32_t set) const;

    const ShadowTracer* tracer_;
    std::size_t lobe_stride_;
    std::vector<Material> materials_;
    std::span<const MaterialLobes> lobes_;
    std::size_t set_stride_ = 1;  // sets of rays of any hit: the light's, then one per shape
    LightSampler light_sampler_;
    std::uint64_t rays_traced_ = 0;

    std::vector<RayHit> met_;
    std::vector<std::uint8_t> hidden_layers_;  // 1: behind another layer of the light
    std::vector<Ray> rays_;                    // of the phase
    std::vector<Vec3f> directions_;
    std::vector<float> weights_;
    std::vector<Rgb> colors_;  // factors of the weights; empty: 1
    std::vector<Rgb> visible_;
    std::vector<Run> runs_;             // phases × lit hits × set_stride
    std::vector<double> solid_angles_;  // lit hits × set_stride: the light's where the set's rays are drawn, else 0
};

}  // namespace shlight
