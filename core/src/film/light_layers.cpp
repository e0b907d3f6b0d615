// SPDX-License-Identifier: MIT
#include "film/light_layers.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

namespace shlight {
namespace {

/// Lights with extent, and likewise those without, are kept in so many layers, at most.
constexpr std::size_t kMostLayers = 32;
/// A light that becomes brighter by more is found anew, since its error grows with it; likewise one that was found with
/// an error that is so many times larger than what is allowed now.
constexpr float kMostGain = 2;

/// See strength_of().
struct StrengthOf {
    Rgb& operator()(PointSource& light) const { return light.intensity; }
    Rgb& operator()(ParallelSource& light) const { return light.irradiance; }
    template <class AreaLight>
    Rgb& operator()(AreaLight& light) const {
        return light.radiance;
    }
};

/// The factor by which the strength of one is that of the other, if they are the same otherwise.
std::optional<Rgb> gain_of(const Light& now, const Light& before) {
    if (now == before) {
        return Rgb(1);
    }
    if (now.index() != before.index()) {
        return std::nullopt;
    }
    Light scaled = before;
    std::visit(StrengthOf{}, scaled) = strength_of(now);
    const Rgb& old = strength_of(before);
    Rgb gain(0);
    for (int channel = 0; channel < 3; ++channel) {
        if (old[channel] != 0) {
            gain[channel] = strength_of(now)[channel] / old[channel];
        } else if (strength_of(now)[channel] != 0) {
            return std::nullopt;
        }
        if (!(gain[channel] >= 0 && gain[channel] <= kMostGain)) {
            return std::nullopt;
        }
    }
    return scaled == now ? std::optional(gain) : std::nullopt;
}

/// The gain with which a layer serves for these lights.
std::optional<Rgb> gain_of(std::span<const Light> now, const LightLayer& before) {
    if (now.size() != before.lights.size() || now.empty()) {
        return std::nullopt;
    }
    if (now.size() == 1) {
        return gain_of(now.front(), before.lights.front());
    }
    return std::ranges::equal(now, before.lights) ? std::optional(Rgb(1)) : std::nullopt;
}

void add_layers(std::span<const Light> lights, bool extended, std::vector<LightLayer>& layers) {
    const std::size_t size = (lights.size() + kMostLayers - 1) / kMostLayers;
    for (std::size_t begin = 0; begin < lights.size(); begin += size) {
        const std::span<const Light> own = lights.subspan(begin, std::min(size, lights.size() - begin));
        LightLayer layer;
        layer.lights.assign(own.begin(), own.end());
        layer.extended = extended;
        layers.push_back(std::move(layer));
    }
}

/// Takes the light of the layer before that serves for this one.
void fill(LightLayer& layer, double light_error, bool same_environment, std::vector<LightLayer>& before) {
    for (LightLayer& old : before) {
        const bool is_near = old.light_error <= kMostGain * light_error;
        if (!old.is_known() || !is_near) {
            continue;
        }
        const std::optional<Rgb> gain =
            layer.is_environment() ? (same_environment && old.is_environment() ? std::optional(Rgb(1)) : std::nullopt)
                                   : gain_of(layer.lights, old);
        if (gain) {
            std::vector<Light> lights = std::move(old.lights);  // with whose strength it was found
            layer = std::exchange(old, LightLayer());
            layer.lights = std::move(lights);
            layer.gain = *gain;
            return;
        }
    }
}

}  // namespace

std::vector<LightLayer> layers_of(const CompiledScene& scene, double light_error, bool same_environment,
                                  std::vector<LightLayer>& before) {
    std::vector<LightLayer> layers;
    add_layers(scene.lights().first(scene.extended_light_count()), true, layers);
    add_layers(scene.lights().subspan(scene.extended_light_count()), false, layers);
    if (!scene.environment().is_black()) {
        layers.emplace_back();
    }
    for (LightLayer& layer : layers) {
        fill(layer, light_error, same_environment, before);
    }
    return layers;
}

}  // namespace shlight
