// SPDX-License-Identifier: MIT
//
// Reflected radiance by plain Monte Carlo: random directions to the light, or as the lobe reflects, or half of both
// weighed by the balance heuristic: a direction counts f·cos / Σ (number · density) over the kinds (Veach & Guibas
// 1995).
#include <cmath>
#include <optional>
#include <utility>

#include "method.h"
#include "random_directions.h"
#include "random_numbers.h"

namespace shlight::methods {
namespace {

class MonteCarloLobe : public LobeIntegrator {
  public:
    MonteCarloLobe(LobeShape shape, double cos_theta_o, const Options& options)
        : shape_(std::move(shape)),
          view_(std::sqrt((1 - cos_theta_o) * (1 + cos_theta_o)), 0, cos_theta_o),
          samples_(options.samples),
          sampling_(options.sampling) {}

    Reflected radiance(const SphericalCap& cap, std::uint32_t seed) const override {
        if (sampling_ == Sampling::area) {
            return over_surface(SphereSurfaceSampler(cap), seed);
        }
        return combined(ConeSampler(cap), seed);
    }
    Reflected radiance(const SeenPolygon& polygon, std::uint32_t seed) const override {
        if (sampling_ == Sampling::area && !polygon.kept.empty()) {
            return over_surface(TriangleSampler(TriangleSampler::Uniform::in_area, polygon.vertices), seed);
        }
        const TriangleSampler sampler(TriangleSampler::Uniform::in_solid_angle, polygon.kept.directions());
        return sampler.empty() ? Reflected{0, samples_} : combined(sampler, seed);
    }

  private:
    double reflected(const Vec3d& direction) const { return lobe_value(shape_, direction, view_); }

    template <class Sampler>
    Reflected over_surface(const Sampler& sampler, std::uint32_t seed) const {
        RandomNumbers random(seed);
        double sum = 0;
        for (int i = 0; i < samples_; ++i) {
            const RandomDirection at = sampler.sample(random.point());
            sum += at.density > 0 ? reflected(at.direction) / at.density : 0;
        }
        return {sum / samples_, samples_};
    }

    template <class Sampler>
    Reflected combined(const Sampler& light, std::uint32_t seed) const {
        const int to_light = sampling_ == Sampling::bsdf  ? 0
                             : sampling_ == Sampling::mis ? (samples_ + 1) / 2
                                                          : samples_;
        const int as_reflected = samples_ - to_light;
        RandomNumbers random(seed);
        double sum = 0;
        const auto add = [&](const Vec3d& direction, double light_density) {
            const double own = as_reflected > 0 ? as_reflected * lobe_density(shape_, view_, direction) : 0;
            const double all = to_light * light_density + own;
            sum += light_density > 0 && all > 0 ? reflected(direction) / all : 0;
        };
        for (int i = 0; i < to_light; ++i) {
            const RandomDirection at = light.sample(random.point());
            add(at.direction, at.density);
        }
        for (int i = 0; i < as_reflected; ++i) {
            const Vec3d direction = sample_lobe(shape_, view_, random.point());
            add(direction, direction.z > 0 ? light.density(direction) : 0);
        }
        return {sum, samples_};
    }

    LobeShape shape_;
    Vec3d view_;
    int samples_;
    Sampling sampling_;
};

std::unique_ptr<LobeIntegrator> make(const LobeShape& shape, double cos_theta_o, const Options& options) {
    return std::make_unique<MonteCarloLobe>(shape, cos_theta_o, options);
}

}  // namespace

ShadingMethod monte_carlo_shading() {
    return {"monte_carlo",
            "directions to the light (Arvo 1995), of visible microfacets (Heitz 2018; Dupuy & Benyoub 2023), or both "
            "(Veach & Guibas 1995)",
            false,
            false,
            true,
            true,
            &make};
}

}  // namespace shlight::methods
