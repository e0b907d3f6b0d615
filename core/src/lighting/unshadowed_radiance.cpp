// SPDX-License-Identifier: MIT
#include "lighting/unshadowed_radiance.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace shlight {
namespace {

/// Points that are shaded at a time, as many as fit the cache with what is known of their views.
constexpr std::size_t kPointsPerChunk = 1024;

void count(LobeMethod way, int order, std::uint32_t hits, RenderReport& report) {
    switch (way) {
        case LobeMethod::nothing:
        case LobeMethod::mirror:
            break;
        case LobeMethod::harmonics:
            report.order_counts[static_cast<std::size_t>(order)] += hits;
            break;
        case LobeMethod::cubature:
            report.cubature_count += hits;
            break;
    }
}

bool reflects(const LightTraits& traits, const LobeShape& shape) {
    return is_glossy(shape) ? traits.lights_glossy : traits.lights_diffuse;
}

}  // namespace

void UnshadowedRadiance::compute(const ShadingPoints& points, std::span<const MaterialLobes> materials,
                                 std::span<const Light> lights, double allowed_error, double face_tolerance,
                                 RenderReport& report) {
    allowed_error_ = allowed_error;
    face_tolerance_ = face_tolerance;
    point_count_ = points.size();
    strengths_.clear();
    places_.clear();
    std::size_t value_count = 0;
    std::size_t own_count = 0;
    for (const Light& light : lights) {
        const auto* mesh = std::get_if<MeshLight>(&light);
        const bool differs = mesh != nullptr && mesh->faces != nullptr;
        strengths_.push_back(strength_of(light));
        std::size_t& count = differs ? own_count : value_count;
        places_.push_back({differs, count});
        count += lobe_stride_ * point_count_;
    }
    values_.assign(value_count, 0.0F);
    own_strengths_.assign(own_count, Rgb(0));
    sort_by_material(points, materials.size());
    const std::span<const std::uint32_t> sorted(by_material_);
    for (std::size_t first = 0; first < point_count_;) {
        const std::uint32_t material = points.material[sorted[first]];
        std::size_t last = first + 1;
        while (last < point_count_ && last < first + kPointsPerChunk && points.material[sorted[last]] == material) {
            ++last;
        }
        shade(points, sorted.subspan(first, last - first), materials[material], lights, report);
        first = last;
    }
}

void UnshadowedRadiance::sort_by_material(const ShadingPoints& points, std::size_t materials) {
    next_of_material_.assign(materials + 1, 0);
    for (const std::uint32_t material : points.material) {
        ++next_of_material_[material + 1];
    }
    std::partial_sum(next_of_material_.begin(), next_of_material_.end(), next_of_material_.begin());
    by_material_.resize(points.size());
    for (std::uint32_t point = 0; point < points.size(); ++point) {
        by_material_[next_of_material_[points.material[point]]++] = point;
    }
}

void UnshadowedRadiance::shade(const ShadingPoints& points, std::span<const std::uint32_t> some,
                               const MaterialLobes& material, std::span<const Light> lights, RenderReport& report) {
    cosines_.resize(some.size());
    std::transform(some.begin(), some.end(), cosines_.begin(),
                   [&](std::uint32_t point) { return double{points.cos_theta_o[point]}; });
    weights_.clear();
    for (const std::uint32_t point : some) {
        const std::span<const Rgb> own = points.weights(point);
        weights_.insert(weights_.end(), own.begin(), own.end());
    }
    forms_.clear();
    for (const std::uint32_t point : material.varies() ? some : some.first(0)) {
        const std::span<const LobeForm> own = points.forms(point);
        forms_.insert(forms_.end(), own.begin(), own.end());
    }
    views_.assign(material, cosines_, {weights_, lobe_stride_}, {forms_, lobe_stride_}, true);
    tolerance_ = material.tolerance();
    if (views_.lobe_count() == 0) {
        return;
    }
    std::optional<Rgb> allowed_for;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (!traits_of(lights[i]).links.lights(material.light_set())) {
            continue;
        }
        // Profiles and sums over faces ask for a tolerance even if no lobe has a choice.
        const bool asks = views_.chooses() || places_[i].differs ||
                          !std::holds_alternative<EvenProfile>(traits_of(lights[i]).profile);
        if (asks && allowed_error_ > 0 && material.auto_order() && allowed_for != strengths_[i]) {
            allowed_for = strengths_[i];
            views_.allow_error(allowed_error_, strengths_[i]);
        }
        integrate(points, some, lights[i], i, report);
    }
}

void UnshadowedRadiance::integrate(const ShadingPoints& points, std::span<const std::uint32_t> some, const Light& light,
                                   std::size_t light_index, RenderReport& report) {
    if (places_[light_index].differs) {
        sum_faces(points, some, std::get<MeshLight>(light), light_index, report);
        return;
    }
    seen_.clear();
    seen_.look(light, points.frame, points.error, some, tolerance_);
    for (std::size_t lobe = 0; lobe < views_.lobe_count(); ++lobe) {
        if (!views_.lobe(lobe).is_black() && reflects(traits_of(light), views_.lobe(lobe).shape())) {
            seen_.shade(views_.lobe(lobe), views_.positions().all(), tolerance_, true, batch_,
                        [&](std::span<const std::uint32_t> numbers) {
                            add(points, some, numbers, light, light_index, lobe, report);
                        });
        }
    }
}

void UnshadowedRadiance::sum_faces(const ShadingPoints& points, std::span<const std::uint32_t> some,
                                   const MeshLight& light, std::size_t light_index, RenderReport& report) {
    const std::size_t size = lobe_stride_ * point_count_;
    face_shading_.shade(*light.faces, points, some, views_, std::max(face_tolerance_, tolerance_), tolerance_,
                        std::span(own_strengths_).subspan(places_[light_index].begin, size));
    for (const std::uint32_t point : some) {
        report.cubature_count += points.hit_count(point);
    }
}

LightRadiance UnshadowedRadiance::light(std::size_t index) const {
    const std::size_t size = lobe_stride_ * point_count_;
    const auto [differs, begin] = places_[index];
    if (differs) {
        return {{}, Rgb(1), std::span(own_strengths_).subspan(begin, size)};
    }
    return {std::span(values_).subspan(begin, size), strengths_[index], {}};
}

void UnshadowedRadiance::add(const ShadingPoints& points, std::span<const std::uint32_t> some,
                             std::span<const std::uint32_t> numbers, const Light& light, std::size_t light_index,
                             std::size_t lobe, RenderReport& report) {
    float* values = values_.data() + places_[light_index].begin + lobe * point_count_;
    const bool even = std::holds_alternative<EvenProfile>(traits_of(light).profile);
    if (const int order = batch_.only_order(); order > 0 && even) {
        std::uint64_t lit = 0;
        std::uint64_t missed = 0;
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            const std::uint32_t point = some[numbers[k]];
            values[point] += batch_.values()[k];
            const std::uint64_t hits = batch_.efforts()[k] > 0 ? points.hit_count(point) : 0;
            lit += hits;
            missed += views_.lobe(lobe).within_tolerance(numbers[k]) ? 0 : hits;
        }
        report.order_counts[static_cast<std::size_t>(order)] += lit;
        report.over_tolerance += missed;
        return;
    }
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        const std::uint32_t point = some[numbers[k]];
        values[point] += batch_.values()[k];
        const std::uint32_t hits = points.hit_count(point);
        count(batch_.method(k), batch_.efforts()[k], hits, report);
        report.over_tolerance += batch_.within_tolerance(views_.lobe(lobe), k, numbers[k]) ? 0 : hits;
        if (!even && values[point] > 0) {
            apply_profile(lobe, numbers[k], points, point, light, values[point]);
        }
    }
}

void UnshadowedRadiance::apply_profile(std::size_t lobe, std::size_t view, const ShadingPoints& points,
                                       std::uint32_t point, const Light& light, float& value) {
    const LobeViews& views = views_.lobe(lobe);
    profile_.reset(light, points.frame[point]);
    // A small light's radiance keeps within the tolerance whatever its profile, but a spot's rim should look right.
    const double tolerance =
        std::min(views.absolute_tolerance(view) / double{value}, tolerance_ * profile_.range().high);
    const double mean = profile_.mean(views.shape(view), points.cos_theta_o[point], tolerance);
    value = static_cast<float>(value * mean);
}

}  // namespace shlight
