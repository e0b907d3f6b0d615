// SPDX-License-Identifier: MIT
#include "shadows/shadow_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "emitters/face_radiance.h"
#include "shadows/ray_start.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

constexpr std::uint32_t kLightOnly = std::numeric_limits<std::uint32_t>::max();

/// A lobe takes rays of its own only where more than this share of them could meet the light.
constexpr double kLeastShare = 0.1;

}  // namespace

/// What the rays of one hit have in common.
class ShadowRays::Drawing {
  public:
    Drawing(const SeenLight& seen, const Hits& hits, std::size_t hit, const RayPhase& phase, std::uint32_t seed)
        : hit_material(hits.material[hit]),
          widths(hits.widths(hit)),
          view(hits.view(hit)),
          profile(&seen.profile()),
          start(hits.frame[hit], hits.shadow_origin[hit], clearance(seen.light(), hits.frame[hit])),
          rays(phase.rays_per_hit),
          mirror_rays(phase.first ? 1 : 0),
          first_point_(phase.first_point + (hits.sample[hit] - phase.first_sample) * phase.rays_per_hit),
          seed_(seed) {}

    /// Of one set of rays; each has a sequence of its own.
    glm::dvec2 point(std::size_t set, std::uint32_t ray) const {
        const std::uint32_t seed = set == 0 ? seed_ : hash(seed_, 2 + static_cast<std::uint32_t>(set));
        return sobol(shuffled(first_point_ + ray, seed), seed);
    }

    std::uint32_t hit_material;
    std::span<const float> widths;
    Vec3d view;
    const ProfileView* profile;
    RayStart start;
    std::uint32_t rays;         // of each set, but …
    std::uint32_t mirror_rays;  // … for mirrors

  private:
    std::uint32_t first_point_, seed_;
};

ShadowRays::ShadowRays(const ShadowTracer& tracer, std::span<const MaterialLobes> materials, std::size_t lobe_stride)
    : tracer_(&tracer), lobe_stride_(lobe_stride), lobes_(materials) {
    for (const MaterialLobes& material : materials) {
        Material& sets = materials_.emplace_back();
        for (const Lobe& lobe : material.lobes()) {
            if (!is_glossy(lobe.shape)) {
                sets.set_of_lobe.push_back(kLightOnly);
                continue;
            }
            const auto alike = [&](std::size_t other) { return spread_alike(material.lobes()[other], lobe); };
            const auto known = std::find_if(sets.lobes.begin(), sets.lobes.end(), alike);
            sets.set_of_lobe.push_back(static_cast<std::uint32_t>(known - sets.lobes.begin()));
            if (known == sets.lobes.end()) {
                sets.lobes.push_back(sets.set_of_lobe.size() - 1);
            }
        }
        set_stride_ = std::max(set_stride_, 1 + sets.lobes.size());
    }
}

void ShadowRays::trace(const Light& light, const Hits& hits, const LitHits& lit, const RayPhase& phase,
                       std::uint32_t seed) {
    if (phase.first) {
        directions_.clear();
        weights_.clear();
        colors_.clear();
        hidden_layers_.clear();
        visible_.clear();
        runs_.clear();
        solid_angles_.assign(lit.hit.size() * set_stride_, 0.0);
    }
    rays_.clear();
    const std::size_t before = visible_.size();
    for (std::size_t i = 0; i < lit.hit.size(); ++i) {
        const std::size_t hit = lit.hit[i];
        const Drawing drawing(lit.seen[i], hits, hit, phase, seed);
        if (i == 0) {
            light_sampler_.reset(lit.seen[i]);
        } else {
            light_sampler_.move(lit.seen[i]);
        }
        draw(drawing, lit, i);
    }
    visible_.resize(directions_.size());
    if (const auto* mesh = std::get_if<MeshLight>(&light)) {
        if (mesh->faces != nullptr) {
            find_colors(*mesh->faces);
        }
        follow(*mesh, before);
    } else {
        tracer_->visibility(rays_, std::span(visible_).subspan(before));
    }
    rays_traced_ += rays_.size();
}

/// What a ray meets first is the light, or in its way; what lies behind that is hidden. A ray that passes by a mesh
/// whose outline is known no better was not stopped. Rays are shortened to what they meet.
void ShadowRays::follow(const MeshLight& light, std::size_t before) {
    met_.resize(rays_.size());
    tracer_->intersect_opaque(rays_, met_);
    for (std::size_t i = 0; i < met_.size(); ++i) {
        const bool seen = hidden_layers_[before + i] == 0 && (met_[i].missed() || light.holds(met_[i]));
        visible_[before + i] = Rgb(seen ? 1 : 0);
        rays_[i].t_max = met_[i].missed() ? rays_[i].t_max : met_[i].distance;
    }
    tracer_->transmittance(rays_, std::span(visible_).subspan(before));
}

void ShadowRays::find_colors(const FaceRadiance& faces) {
    const std::size_t before = colors_.size();
    faces.along(rays_, colors_);
    for (std::size_t i = before; i < colors_.size(); ++i) {
        // What lies behind the first layer is not known.
        colors_[i] = hidden_layers_[i] != 0 ? faces.mean() : colors_[i];
    }
}

bool ShadowRays::shines(const LitHits& lit, std::size_t lit_index, const Material& material, std::uint32_t set) const {
    for (std::size_t lobe = 0; lobe < material.set_of_lobe.size(); ++lobe) {
        if (material.set_of_lobe[lobe] == set && lit.shines[lit_index * lobe_stride_ + lobe] != 0) {
            return true;
        }
    }
    return false;
}

void ShadowRays::draw(const Drawing& drawing, const LitHits& lit, std::size_t lit_index) {
    const Material& material = materials_[drawing.hit_material];
    bool mirrors_only = !shines(lit, lit_index, material, kLightOnly);
    for (std::uint32_t set = 0; set < material.lobes.size(); ++set) {
        mirrors_only = mirrors_only && (is_mirror(set_shape(drawing, set)) || !shines(lit, lit_index, material, set));
    }
    std::size_t begin = directions_.size();
    const auto end_run = [&] {
        runs_.push_back({begin, directions_.size()});
        begin = directions_.size();
    };
    if (!mirrors_only) {
        for (std::uint32_t ray = 0; ray < drawing.rays; ++ray) {
            const LightSample sample = light_sampler_.sample(drawing.point(0, ray));
            push(drawing, sample.direction, sample.distance, sample.weight, light_sampler_.layers(sample.direction));
        }
    }
    end_run();
    for (std::uint32_t set = 0; set + 1 < set_stride_; ++set) {
        if (set < material.lobes.size() && shines(lit, lit_index, material, set)) {
            draw_lobes(drawing, lit_index, set, set_shape(drawing, set));
        }
        end_run();
    }
}

LobeShape ShadowRays::set_shape(const Drawing& drawing, std::size_t set) const {
    const std::size_t lobe = materials_[drawing.hit_material].lobes[set];
    return sampled_shape(lobes_[drawing.hit_material].shape(lobe, drawing.widths[lobe]));
}

void ShadowRays::draw_lobes(const Drawing& drawing, std::size_t lit_index, std::size_t set, const LobeShape& shape) {
    const bool mirror = is_mirror(shape);
    const double solid_angle = light_sampler_.solid_angle();
    if (!mirror && !(solid_angle * largest_lobe_density(shape, drawing.view) > kLeastShare)) {
        return;
    }
    solid_angles_[lit_index * set_stride_ + 1 + set] = solid_angle;
    const std::uint32_t rays = mirror ? drawing.mirror_rays : drawing.rays;
    for (std::uint32_t ray = 0; ray < rays; ++ray) {
        const Vec3d direction = sample_lobe(shape, drawing.view, drawing.point(1 + set, ray));
        const std::optional<double> distance = direction.z > 0 ? light_sampler_.meets(direction) : std::nullopt;
        if (distance) {
            push(drawing, direction, *distance, solid_angle, mirror ? 1 : light_sampler_.layers(direction));
        }
    }
}

void ShadowRays::push(const Drawing& drawing, const Vec3d& direction, double distance, double weight, int layers) {
    const double factor = drawing.profile->factor(direction);
    for (int layer = 0; weight * factor > 0 && layer < layers; ++layer) {
        directions_.emplace_back(direction);
        weights_.push_back(static_cast<float>(weight * factor));
        hidden_layers_.push_back(layer > 0 ? 1 : 0);
        rays_.push_back(drawing.start.towards(direction, distance));
    }
}

std::size_t ShadowRays::blocked_count() const {
    return static_cast<std::size_t>(std::count(visible_.begin(), visible_.end(), Rgb(0)));
}

bool ShadowRays::all_free() const {
    return std::all_of(visible_.begin(), visible_.end(), [](const Rgb& visible) { return visible == Rgb(1); });
}

RaySums ShadowRays::sum(const Hits& hits, const LitHits& lit, std::size_t lit_index, std::size_t lobe) const {
    const std::size_t hit = lit.hit[lit_index];
    const LobeShape shape = lobes_[hits.material[hit]].shape(lobe, hits.widths(hit)[lobe]);
    const Material& material = materials_[hits.material[hit]];
    const std::uint32_t set = material.set_of_lobe[lobe];
    const Vec3d view = hits.view(hit);
    const bool mirror = is_mirror(shape);
    const double solid_angle = set == kLightOnly ? 0.0 : solid_angles_[lit_index * set_stride_ + 1 + set];
    RaySums sums;
    const auto add = [&](const Run& run) {
        for (std::size_t i = run.begin; i < run.end; ++i) {
            const Vec3d direction(directions_[i]);
            double value = mirror ? 1.0 : weights_[i] * lobe_value(shape, direction, view);
            if (!mirror && solid_angle > 0) {
                // The weights are those of points even in solid angle; so p_light is one over that.
                value /= 1 + solid_angle * lobe_density(shape, view, direction);
            }
            const Vec3d color = colors_.empty() || mirror ? Vec3d(1) : Vec3d(colors_[i]);
            sums.add(value * color, visible_[i]);
        }
    };
    for (std::size_t base = lit_index * set_stride_; base < runs_.size(); base += solid_angles_.size()) {
        if (!mirror) {
            add(runs_[base]);
        }
        if (set != kLightOnly) {
            add(runs_[base + 1 + set]);
        }
    }
    return sums;
}

}  // namespace shlight
