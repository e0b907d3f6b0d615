// SPDX-License-Identifier: MIT
#include "shadows/shadow_rays.h"

#include <algorithm>
#include <array>
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

/// Of a light.
constexpr std::uint32_t kPointsAtOnce = 64;
static_assert(kPointsAtOnce % kLightPointLanes == 0);

const ProfileView kEven;

}  // namespace

/// What the rays of one hit have in common.
class ShadowRays::Drawing {
  public:
    Drawing(const Light& light, const ProfileView& light_profile, const Hits& hits, std::size_t hit,
            const RayPhase& phase, std::span<const SobolSequence> sequences)
        : hit_material(hits.material[hit]),
          widths(hits.widths(hit)),
          view(hits.view(hit)),
          frame(&hits.frame[hit]),
          profile(&light_profile),
          start(hits.frame[hit], hits.shadow_origin[hit], clearance(light, hits.frame[hit])),
          rays(phase.rays_per_hit),
          first_phase(phase.first),
          first_point(phase.first_point + (hits.sample[hit] - phase.first_sample) * phase.rays_per_hit),
          sequences_(sequences) {}

    /// Of one set of rays.
    glm::dvec2 point(std::size_t set, std::uint32_t ray) const { return sequences_[set].point(first_point + ray); }

    std::uint32_t hit_material;
    std::span<const float> widths;
    Vec3d view;
    const ShadingFrame* frame;
    const ProfileView* profile;
    RayStart start;
    std::uint32_t rays;  // of each set, but mirrors have one in the first phase
    bool first_phase;
    std::uint32_t first_point;  // of the hit

  private:
    std::span<const SobolSequence> sequences_;
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

void ShadowRays::start(const Light& light, const Hits& hits, const LitHits& lit) {
    light_ = &light;
    hits_ = &hits;
    lit_ = &lit;
    drawn_.clear();
    rays_.clear();
    colors_.clear();
    visible_.clear();
    runs_.assign(lit.hit.size() * 2 * set_stride_, {});
    solid_angles_.assign(lit.hit.size() * set_stride_, 0.0);
}

void ShadowRays::draw(const LitRange& pixel, const RayPhase& phase, std::uint32_t seed) {
    sequences_.clear();
    for (std::uint32_t set = 0; set < set_stride_; ++set) {
        sequences_.emplace_back(set == 0 ? seed : hash(seed, 2 + set));
    }
    draw_square(pixel, phase);
    for (std::size_t i = pixel.begin; i < pixel.end; ++i) {
        const ProfileView* profile = &kEven;
        if (!lit_->whole[i]) {
            profile = &lit_->seen[i].profile();
            if (i == pixel.begin) {
                light_sampler_.reset(lit_->seen[i]);
            } else {
                light_sampler_.move(lit_->seen[i]);
            }
        }
        draw_hit(Drawing(*light_, *profile, *hits_, lit_->hit[i], phase, sequences_), i);
    }
}

/// The points of all hits of a pixel are neighbours in their sequence.
void ShadowRays::draw_square(const LitRange& pixel, const RayPhase& phase) {
    const std::uint32_t first = hits_->sample[lit_->hit[pixel.begin]];
    const std::uint32_t last = hits_->sample[lit_->hit[pixel.end - 1]];
    const std::size_t count = std::size_t{last - first + 1} * phase.rays_per_hit;
    first_point_ = phase.first_point + (first - phase.first_sample) * phase.rays_per_hit;
    u_.resize(count + kLightPointLanes);
    v_.resize(count + kLightPointLanes);
    const auto own = std::span(lit_->whole).subspan(pixel.begin, pixel.size());
    if (std::any_of(own.begin(), own.end(), [](const auto& rectangle) { return rectangle.has_value(); })) {
        draw_square_points(sequences_[0], first_point_, count, u_.data(), v_.data());
    }
}

void ShadowRays::trace() {
    const std::size_t before = visible_.size();
    visible_.resize(drawn_.size());
    if (const auto* mesh = std::get_if<MeshLight>(light_)) {
        if (mesh->faces != nullptr) {
            find_colors(*mesh->faces);
        }
        follow(*mesh);
    } else {
        tracer_->visibility(rays_.all(), std::span(visible_).subspan(before));
    }
    rays_traced_ += rays_.size();
    rays_.clear();
}

/// What a ray meets first is the light, or in its way; what lies behind that is hidden. A ray that passes by a mesh
/// whose outline is known no better was not stopped. Rays are shortened to what they meet.
void ShadowRays::follow(const MeshLight& light) {
    const std::size_t before = drawn_.size() - rays_.size();
    met_.resize(rays_.size());
    tracer_->intersect_opaque(rays_.all(), met_);
    for (std::size_t i = 0; i < met_.size(); ++i) {
        const bool seen = !drawn_[before + i].hidden_layer && (met_[i].missed() || light.holds(met_[i]));
        visible_[before + i] = Rgb(seen ? 1 : 0);
        rays_[i].t_max = met_[i].missed() ? rays_[i].t_max : met_[i].distance;
    }
    tracer_->transmittance(rays_.all(), std::span(visible_).subspan(before));
}

void ShadowRays::find_colors(const FaceRadiance& faces) {
    const std::size_t before = colors_.size();
    faces.along(rays_.all(), colors_);
    for (std::size_t i = before; i < colors_.size(); ++i) {
        // What lies behind the first layer is not known.
        colors_[i] = drawn_[i].hidden_layer ? faces.mean() : colors_[i];
    }
}

bool ShadowRays::shines(std::size_t lit_index, const Material& material, std::uint32_t set) const {
    for (std::size_t lobe = 0; lobe < material.set_of_lobe.size(); ++lobe) {
        if (material.set_of_lobe[lobe] == set && lit_->shines[lit_index * lobe_stride_ + lobe] != 0) {
            return true;
        }
    }
    return false;
}

void ShadowRays::draw_hit(const Drawing& drawing, std::size_t lit_index) {
    const Material& material = materials_[drawing.hit_material];
    bool mirrors_only = !shines(lit_index, material, kLightOnly);
    for (std::uint32_t set = 0; set < material.lobes.size(); ++set) {
        mirrors_only = mirrors_only && (is_mirror(set_shape(drawing, set)) || !shines(lit_index, material, set));
    }
    run(lit_index, drawing.first_phase, 0).begin = drawn_.size();
    if (!mirrors_only) {
        draw_light(drawing, lit_index);
    }
    run(lit_index, drawing.first_phase, 0).end = drawn_.size();
    for (std::uint32_t set = 0; set + 1 < set_stride_; ++set) {
        run(lit_index, drawing.first_phase, 1 + set).begin = drawn_.size();
        if (set < material.lobes.size() && shines(lit_index, material, set)) {
            draw_lobes(drawing, lit_index, set, set_shape(drawing, set));
        }
        run(lit_index, drawing.first_phase, 1 + set).end = drawn_.size();
    }
}

void ShadowRays::draw_light(const Drawing& drawing, std::size_t lit_index) {
    if (!lit_->whole[lit_index]) {
        for (std::uint32_t ray = 0; ray < drawing.rays; ++ray) {
            const LightSample sample = light_sampler_.sample(drawing.point(0, ray));
            push(drawing, sample.direction, sample.distance, sample.weight, light_sampler_.layers(sample.direction));
        }
        return;
    }
    const std::size_t before = drawing.first_point - first_point_;
    alignas(64) std::array<float, kPointsAtOnce> x, y, z, weight;  // all are written before they are read
    for (std::uint32_t first = 0; first < drawing.rays; first += kPointsAtOnce) {
        const std::uint32_t count = std::min(drawing.rays - first, kPointsAtOnce);
        place_points(*lit_->whole[lit_index], &u_[before + first], &v_[before + first], count,
                     {x.data(), y.data(), z.data(), weight.data()});
        const std::span<Drawn> drawn = drawn_.extend(count);
        const std::span<Ray> rays = rays_.extend(count);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3f way(x[i], y[i], z[i]);
            drawn[i].way = way;
            drawn[i].weight = weight[i];
            drawn[i].hidden_layer = false;
            drawing.start.to_end_of(way, rays[i]);
        }
    }
}

void ShadowRays::look(std::size_t lit_index) {
    const std::size_t hit = lit_->hit[lit_index];
    seen_.look(*light_, hits_->frame[hit], hits_->error[hit]);
    light_sampler_.reset(seen_);
}

LobeShape ShadowRays::set_shape(const Drawing& drawing, std::size_t set) const {
    const std::size_t lobe = materials_[drawing.hit_material].lobes[set];
    return sampled_shape(lobes_[drawing.hit_material].shape(lobe, drawing.widths[lobe]));
}

void ShadowRays::draw_lobes(const Drawing& drawing, std::size_t lit_index, std::size_t set, const LobeShape& shape) {
    const bool mirror = is_mirror(shape);
    const double most_density = mirror ? 0.0 : largest_lobe_density(shape, drawing.view);
    if (const auto& rectangle = lit_->whole[lit_index]) {
        if (!mirror && !(rectangle->most_weight * most_density > kLeastShare)) {
            return;
        }
        look(lit_index);
    }
    const double whole = light_sampler_.solid_angle();
    if (!mirror && !(whole * most_density > kLeastShare)) {
        return;
    }
    solid_angle(lit_index, 1 + set) = whole;
    const std::uint32_t mirror_rays = drawing.first_phase ? 1 : 0;
    const std::uint32_t rays = mirror ? mirror_rays : drawing.rays;
    for (std::uint32_t ray = 0; ray < rays; ++ray) {
        const Vec3d direction = sample_lobe(shape, drawing.view, drawing.point(1 + set, ray));
        const std::optional<double> distance = direction.z > 0 ? light_sampler_.meets(direction) : std::nullopt;
        if (distance) {
            push(drawing, direction, *distance, whole, mirror ? 1 : light_sampler_.layers(direction));
        }
    }
}

void ShadowRays::push(const Drawing& drawing, const Vec3d& direction, double distance, double weight, int layers) {
    const double factor = drawing.profile->factor(direction);
    for (int layer = 0; weight * factor > 0 && layer < layers; ++layer) {
        drawn_.extend(1)[0] = {Vec3f(drawing.frame->to_world(direction)), static_cast<float>(weight * factor),
                               layer > 0};
        rays_.extend(1)[0] = drawing.start.towards(direction, distance);
    }
}

ShadowRays::Verdict ShadowRays::verdict(const LitRange& pixel) const {
    const std::size_t begin = run(pixel.begin, true, 0).begin;
    const std::size_t end = run(pixel.end - 1, true, set_stride_ - 1).end;
    const auto own = std::span(visible_).subspan(begin, end - begin);
    if (std::all_of(own.begin(), own.end(), [](const Rgb& visible) { return visible == Rgb(1); })) {
        return Verdict::free;
    }
    const bool hidden = std::all_of(own.begin(), own.end(), [](const Rgb& visible) { return visible == Rgb(0); });
    return hidden ? Verdict::hidden : Verdict::mixed;
}

RaySums ShadowRays::sum(std::size_t lit_index, std::size_t lobe) const {
    const std::size_t hit = lit_->hit[lit_index];
    const LobeShape shape = lobes_[hits_->material[hit]].shape(lobe, hits_->widths(hit)[lobe]);
    const std::uint32_t set = materials_[hits_->material[hit]].set_of_lobe[lobe];
    const Vec3d view = hits_->view(hit);
    const bool mirror = is_mirror(shape);
    const double solid_angle = set == kLightOnly ? 0.0 : solid_angles_[lit_index * set_stride_ + 1 + set];
    RaySums sums;
    const auto add = [&](const Run& run) {
        for (std::size_t i = run.begin; i < run.end; ++i) {
            const Vec3d direction = glm::normalize(hits_->frame[hit].to_local(Vec3d(drawn_[i].way)));
            double value = mirror ? 1.0 : drawn_[i].weight * lobe_value(shape, direction, view);
            if (!mirror && solid_angle > 0) {
                // The weights are those of points even in solid angle; so p_light is one over that.
                value /= 1 + solid_angle * lobe_density(shape, view, direction);
            }
            const Vec3d color = colors_.empty() || mirror ? Vec3d(1) : Vec3d(colors_[i]);
            sums.add(value * color, visible_[i]);
        }
    };
    for (const bool first_phase : {true, false}) {
        if (!mirror) {
            add(run(lit_index, first_phase, 0));
        }
        if (set != kLightOnly) {
            add(run(lit_index, first_phase, 1 + set));
        }
    }
    return sums;
}

}  // namespace shlight
