// SPDX-License-Identifier: MIT
#include "shadows/shadow_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "emitters/face_radiance.h"
#include "shadows/shadow_ray_spawner.h"

namespace shlight {
namespace {

constexpr std::uint32_t kLightOnly = std::numeric_limits<std::uint32_t>::max();

/// A lobe takes rays of its own only where more than this share of them could meet the light.
constexpr double kLeastShare = 0.1;

/// Elements are written before they are read.
struct PointBuffer {
    alignas(64) std::array<float, kRaysAtOnce> x, y, z, weight;

    LightPointArrays arrays() { return {x.data(), y.data(), z.data(), weight.data()}; }
};

const ProfileView kEven;

}  // namespace

/// Data that all rays of one hit share.
class ShadowRays::Drawing {
  public:
    Drawing(const Light& light, const ProfileView& light_profile, const Hits& hits, std::size_t hit,
            std::uint32_t rays_per_set)
        : hit_material(hits.material[hit]),
          widths(hits.widths(hit)),
          view(hits.view(hit)),
          frame(&hits.frame[hit]),
          profile(&light_profile),
          start(hits.frame[hit], hits.shadow_origin[hit], target_offset(light, hits.frame[hit])),
          rays(rays_per_set),
          sample(hits.sample[hit]) {}

    std::uint32_t hit_material;
    std::span<const float> widths;
    Vec3d view;
    const ShadingFrame* frame;
    const ProfileView* profile;
    ShadowRaySpawner start;
    std::uint32_t rays;  // of each set, but mirrors have one
    std::uint32_t sample;
};

ShadowRays::ShadowRays(ShadowTracer& tracer, std::span<const MaterialLobes> materials, std::size_t lobe_stride)
    : tracer_(&tracer), lobe_stride_(lobe_stride), lobes_(materials), points_(0) {
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
    points_ = PixelPoints(set_stride_);
}

void ShadowRays::start(const Light& light, const Hits& hits, const LitHits& lit) {
    light_ = &light;
    hits_ = &hits;
    lit_ = &lit;
    drawn_.clear();
    rays_.clear();
    colors_.clear();
    visible_.clear();
    runs_.assign(lit.hit.size() * set_stride_, {});
    shared_.assign(lit.hit.size() * set_stride_, 0);
}

void ShadowRays::draw(const LitRange& pixel, const SampleRange& samples, std::uint32_t seed) {
    points_.start(samples, hits_->sample[lit_->hit[pixel.begin]], hits_->sample[lit_->hit[pixel.end - 1]], seed);
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
        draw_hit(Drawing(*light_, *profile, *hits_, lit_->hit[i], samples.shadow_rays), i);
    }
}

void ShadowRays::trace() {
    visible_.resize(drawn_.size());
    if (const auto* mesh = std::get_if<MeshLight>(light_)) {
        if (mesh->faces != nullptr) {
            find_colors(*mesh->faces);
        }
        follow(*mesh);
    } else {
        tracer_->visibility(rays_.all(), visible_);
    }
}

/// Traces rays to a mesh light. The first surface that a ray meets is the light or blocks it. A ray that misses a mesh
/// with an approximate outline is not blocked. Rays are shortened to their first hit.
void ShadowRays::follow(const MeshLight& light) {
    met_.resize(rays_.size());
    tracer_->intersect_opaque(rays_.all(), met_);
    for (std::size_t i = 0; i < met_.size(); ++i) {
        const bool seen = !drawn_[i].hidden_layer && (met_[i].missed() || light.holds(met_[i]));
        visible_[i] = Rgb(seen ? 1 : 0);
        rays_[i].t_max = met_[i].missed() ? rays_[i].t_max : met_[i].distance;
    }
    tracer_->transmittance(rays_.all(), visible_);
}

void ShadowRays::find_colors(const FaceRadiance& faces) {
    faces.along(rays_.all(), colors_);
    for (std::size_t i = 0; i < colors_.size(); ++i) {
        // Radiance behind the first layer is not known.
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
    run(lit_index, 0).begin = drawn_.size();
    if (!mirrors_only) {
        draw_light(drawing, lit_index);
    }
    run(lit_index, 0).end = drawn_.size();
    for (std::uint32_t set = 0; set + 1 < set_stride_; ++set) {
        run(lit_index, 1 + set).begin = drawn_.size();
        if (set < material.lobes.size() && shines(lit_index, material, set)) {
            draw_lobes(drawing, lit_index, set, set_shape(drawing, set));
        }
        run(lit_index, 1 + set).end = drawn_.size();
    }
}

void ShadowRays::draw_light(const Drawing& drawing, std::size_t lit_index) {
    const PixelPoints::Square square = points_.of(0, drawing.sample);
    if (!lit_->whole[lit_index]) {
        for (std::uint32_t i = 0; i < drawing.rays; ++i) {
            const LightSample sample = light_sampler_.sample({square.u[i], square.v[i]});
            push(drawing, sample.direction, sample.distance, sample.weight, light_sampler_.layers(sample.direction));
        }
        return;
    }
    PointBuffer buffer;
    for (std::uint32_t first = 0; first < drawing.rays; first += kRaysAtOnce) {
        const std::uint32_t count = std::min(drawing.rays - first, kRaysAtOnce);
        place_points(*lit_->whole[lit_index], square.u + first, square.v + first, count, buffer.arrays());
        push(drawing, buffer.arrays(), count);
    }
}

void ShadowRays::push(const Drawing& drawing, const LightPointArrays& points, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        if (!(points.weight[i] > 0)) {
            continue;
        }
        const Vec3f way(points.x[i], points.y[i], points.z[i]);
        Drawn& drawn = drawn_.extend(1)[0];
        drawn.way = way;
        drawn.weight = points.weight[i];
        drawn.light_spread = points.weight[i];
        drawn.hidden_layer = false;
        drawing.start.to_end_of(way, rays_.extend(1)[0]);
    }
}

LobeShape ShadowRays::set_shape(const Drawing& drawing, std::size_t set) const {
    const std::size_t lobe = materials_[drawing.hit_material].lobes[set];
    return sampled_shape(lobes_[drawing.hit_material].shape(lobe, drawing.widths[lobe]));
}

void ShadowRays::draw_lobes(const Drawing& drawing, std::size_t lit_index, std::size_t set, const LobeShape& shape) {
    const std::optional<WholeRectangle>& rectangle = lit_->whole[lit_index];
    const bool mirror = is_mirror(shape);
    const double whole = rectangle ? double{rectangle->most_weight} : light_sampler_.solid_angle();
    if (!mirror && !(whole * largest_lobe_density(shape, drawing.view) > kLeastShare)) {
        return;
    }
    shared_[lit_index * set_stride_ + 1 + set] = 1;
    const std::uint32_t rays = mirror ? 1 : drawing.rays;
    const PixelPoints::Square square = points_.of(1 + set, drawing.sample);
    PointBuffer buffer;
    for (std::uint32_t first = 0; first < rays; first += kRaysAtOnce) {
        const std::uint32_t count = std::min(rays - first, kRaysAtOnce);
        sample_lobe_rays(shape, drawing.view, square.u + first, square.v + first, count,
                         {buffer.x.data(), buffer.y.data(), buffer.z.data()});
        if (rectangle) {
            meet_rectangle(*rectangle, *drawing.frame, count, buffer.arrays());
            push(drawing, buffer.arrays(), count);
            continue;
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            const Vec3d direction(buffer.x[i], buffer.y[i], buffer.z[i]);
            const std::optional<double> distance = direction.z > 0 ? light_sampler_.meets(direction) : std::nullopt;
            if (distance) {
                push(drawing, direction, *distance, whole, mirror ? 1 : light_sampler_.layers(direction));
            }
        }
    }
}

void ShadowRays::push(const Drawing& drawing, const Vec3d& direction, double distance, double weight, int layers) {
    const double factor = drawing.profile->factor(direction);
    for (int layer = 0; weight * factor > 0 && layer < layers; ++layer) {
        // The light's points are even in solid angle.
        drawn_.extend(1)[0] = {Vec3f(drawing.frame->to_world(direction)), static_cast<float>(weight * factor),
                               static_cast<float>(light_sampler_.solid_angle()), layer > 0};
        rays_.extend(1)[0] = drawing.start.towards(direction, distance);
    }
}

bool ShadowRays::any_occluded(const LitRange& pixel) const {
    const std::size_t begin = run(pixel.begin, 0).begin;
    const auto own = std::span(visible_).subspan(begin, run(pixel.end - 1, set_stride_ - 1).end - begin);
    return std::any_of(own.begin(), own.end(), [](const Rgb& visible) { return visible != Rgb(1); });
}

RaySums ShadowRays::sum(std::size_t lit_index, std::size_t lobe) {
    const std::size_t hit = lit_->hit[lit_index];
    const LobeShape shape = lobes_[hits_->material[hit]].shape(lobe, hits_->widths(hit)[lobe]);
    const std::uint32_t set = materials_[hits_->material[hit]].set_of_lobe[lobe];
    const bool mirror = is_mirror(shape);
    weighed_.clear();
    const auto add = [&](const Run& run) {
        weighed_.add(run.begin, run.end, [&](std::size_t ray) -> const Vec3f& { return drawn_[ray].way; });
    };
    if (!mirror) {
        add(run(lit_index, 0));
    }
    if (set != kLightOnly) {
        add(run(lit_index, 1 + set));
    }
    const bool shared = set != kLightOnly && shared_[lit_index * set_stride_ + 1 + set] != 0;
    if (!mirror) {
        weighed_.weigh(shape, hits_->frame[hit], hits_->view(hit), shared);
    }
    const bool is_grey = colors_.empty() && tracer_->is_opaque();
    GreySums grey;
    RaySums sums;
    for (std::size_t i = 0; i < weighed_.size(); ++i) {
        const std::size_t ray = weighed_.number(i);
        if (mirror) {
            sums.add(Vec3d(1), visible_[ray]);
            continue;
        }
        const Drawn& drawn = drawn_[ray];
        const float weight = shared ? drawn.weight / (1 + drawn.light_spread * weighed_.density(i)) : drawn.weight;
        const double value{weight * weighed_.value(i)};
        if (is_grey) {
            grey.add(value, visible_[ray].x > 0);
        } else {
            sums.add(value * (colors_.empty() ? Vec3d(1) : Vec3d(colors_[ray])), visible_[ray]);
        }
    }
    return is_grey && !mirror ? RaySums(grey) : sums;
}

}  // namespace shlight
