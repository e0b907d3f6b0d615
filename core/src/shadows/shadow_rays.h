// SPDX-License-Identifier: MIT
//
// Shadow rays from hits to one light: spread over the light, and spread as each glossy lobe reflects. Those of many
// pixels are drawn before they are traced, so that Embree's packets are full and alike.
//
// Both sets serve a glossy lobe, weighted by the balance heuristic (Veach & Guibas 1995): a sample of direction ω that
// either way could have drawn counts f·cos / (n (p_light + p_lobe)). A lobe much wider than the light lives on the
// former, one much narrower on the latter, with no switch between them. A mirror has one ray. Weights hold the
// light's emission profile.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/scratch.h"
#include "lights/light_sampling.h"
#include "lights/seen_light.h"
#include "lights/whole_rectangle.h"
#include "lobes/material_lobes.h"
#include "shadows/pixel_points.h"
#include "shadows/ray_sums.h"
#include "shadows/shadow_policy.h"
#include "shadows/weighed_rays.h"
#include "shlight/light.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Hits that a light reaches if nothing is between.
struct LitHits {
    void clear() {
        hit.clear();
        whole.clear();
        shines.clear();
    }
    /// Adds a hit, unless it does not see the light itself: it may see less of it than the point that it shares.
    bool add(const Light& light, const Hits& hits, std::size_t which) {
        if (seen.size() == hit.size()) {
            seen.emplace_back();
        }
        const std::optional<WholeRectangle> rectangle =
            WholeRectangle::see(light, hits.frame[which], hits.error[which]);
        if (!rectangle && !seen[hit.size()].look(light, hits.frame[which], hits.error[which])) {
            return false;
        }
        hit.push_back(which);
        whole.push_back(rectangle);
        return true;
    }

    std::vector<std::size_t> hit;
    std::vector<std::optional<WholeRectangle>> whole;  ///< as each of them sees it, or else …
    std::vector<SeenLight> seen;                       ///< … the light; may be longer
    std::vector<std::uint8_t> shines;  ///< hit.size() × lobe_stride: whether the lobe reflects any of it
};

/// Keeps its memory from light to light; one per thread.
class ShadowRays {
  public:
    ShadowRays(ShadowTracer& tracer, std::span<const MaterialLobes> materials, std::size_t lobe_stride);

    /// Forgets all rays. hits and lit stay as they are until the next call.
    void start(const Light& light, const Hits& hits, const LitHits& lit);
    /// Draws the rays of a pixel's hits among lit. samples.shadow_rays: of each set; seed: see PixelPoints.
    void draw(const LitRange& pixel, const SampleRange& samples, std::uint32_t seed);
    /// Traces all rays that were drawn.
    void trace();

    /// Whether anything takes light away from any ray of a pixel.
    bool any_occluded(const LitRange& pixel) const;
    /// lit_index: of LitHits.
    RaySums sum(std::size_t lit_index, std::size_t lobe);

  private:
    /// Lobes of a material whose directions are spread alike share their rays.
    struct Material {
        std::vector<std::size_t> lobes;          // of each set of rays one
        std::vector<std::uint32_t> set_of_lobe;  // index of lobes, kLightOnly for diffuse lobes
    };
    /// The rays of one set of a hit.
    struct Run {
        std::size_t begin = 0, end = 0;
    };
    struct Drawn {
        Vec3f way;  // from the hit, in the world; of any length
        float weight;
        float light_spread;  // one over the density of the light's set there
        bool hidden_layer;   // behind another layer of the light
    };
    class Drawing;

    void draw_hit(const Drawing& drawing, std::size_t lit_index);
    void draw_light(const Drawing& drawing, std::size_t lit_index);
    void draw_lobes(const Drawing& drawing, std::size_t lit_index, std::size_t set, const LobeShape& shape);
    void follow(const MeshLight& light);
    /// The radiance of the faces that the rays would meet if nothing else were there.
    void find_colors(const FaceRadiance& faces);
    /// To points of a whole rectangle; those without weight are left out.
    void push(const Drawing& drawing, const LightPointArrays& points, std::size_t count);
    /// layers: of the light, one behind the other, each of which the unshadowed radiance counts.
    void push(const Drawing& drawing, const Vec3d& direction, double distance, double weight, int layers);
    /// The shape from which a set's directions are drawn at a hit.
    LobeShape set_shape(const Drawing& drawing, std::size_t set) const;
    bool shines(std::size_t lit_index, const Material& material, std::uint32_t set) const;
    Run& run(std::size_t lit_index, std::size_t set) { return runs_[lit_index * set_stride_ + set]; }
    const Run& run(std::size_t lit_index, std::size_t set) const { return runs_[lit_index * set_stride_ + set]; }

    ShadowTracer* tracer_;
    std::size_t lobe_stride_;
    std::vector<Material> materials_;
    std::span<const MaterialLobes> lobes_;
    std::size_t set_stride_ = 1;  // sets of rays of any hit: the light's, then one per shape
    LightSampler light_sampler_;

    const Light* light_ = nullptr;
    const Hits* hits_ = nullptr;
    const LitHits* lit_ = nullptr;
    PixelPoints points_;
    Scratch<Drawn> drawn_;
    Scratch<Ray> rays_;                 // as drawn_
    std::vector<RayHit> met_;           // by these
    std::vector<Rgb> colors_;           // factors of the weights; empty: 1
    std::vector<Rgb> visible_;          // once traced
    std::vector<Run> runs_;             // lit hits × set_stride
    std::vector<std::uint8_t> shared_;  // likewise: whether the set's rays share the light's work
    WeighedRays weighed_;
};

}  // namespace shlight
