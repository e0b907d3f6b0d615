// SPDX-License-Identifier: MIT
#include "unshadowed.h"

#include <algorithm>
#include <numeric>

#include "light_view.h"

namespace shlight {
namespace {

/// Points that are shaded at a time, as many as fit the cache with what is known of their views.
constexpr std::size_t kChunk = 1024;

void count(Way way, int order, std::uint32_t hits, RenderReport& report) {
    switch (way) {
        case Way::nothing:
            break;
        case Way::mirror:
            report.mirror_count += hits;
            break;
        case Way::harmonics:
            report.order_counts[static_cast<std::size_t>(order)] += hits;
            break;
        case Way::cubature:
            report.cubature_count += hits;
            break;
    }
}

}  // namespace

void Unshadowed::compute(const ShadingPoints& points, std::span<const MaterialLobes> materials,
                         std::span<const Light> lights, RenderReport& report) {
    point_count_ = points.size();
    values_.assign(lights.size() * lobe_stride_ * point_count_, 0.0F);
    by_material_.resize(point_count_);
    std::iota(by_material_.begin(), by_material_.end(), 0U);
    std::stable_sort(by_material_.begin(), by_material_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return points.material[a] < points.material[b]; });
    const std::span<const std::uint32_t> sorted(by_material_);
    for (std::size_t first = 0; first < point_count_;) {
        const std::uint32_t material = points.material[sorted[first]];
        std::size_t last = first + 1;
        while (last < point_count_ && last < first + kChunk && points.material[sorted[last]] == material) {
            ++last;
        }
        shade(points, sorted.subspan(first, last - first), materials[material], lights, report);
        first = last;
    }
}

void Unshadowed::shade(const ShadingPoints& points, std::span<const std::uint32_t> some, const MaterialLobes& material,
                       std::span<const Light> lights, RenderReport& report) {
    cosines_.resize(some.size());
    std::transform(some.begin(), some.end(), cosines_.begin(),
                   [&](std::uint32_t point) { return double{points.cos_theta_o[point]}; });
    views_.assign(material, cosines_, true);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        integrate(points, some, lights[i], i, report);
    }
}

void Unshadowed::see(const SphereLight& light, const ShadingPoints& points, std::span<const std::uint32_t> some) {
    circles_.resize(some.size());
    for (std::size_t i = 0; i < some.size(); ++i) {
        if (const std::optional<CapView> cap = view(light, points.frame[some[i]])) {
            circles_.set(seen_by_.size(), circle_of(*cap));
            seen_by_.push_back(static_cast<std::uint32_t>(i));
        }
    }
}

void Unshadowed::see(const PolygonLight& light, const ShadingPoints& points, std::span<const std::uint32_t> some) {
    polygons_.clear(light.vertices.size());
    for (std::size_t i = 0; i < some.size(); ++i) {
        const ShadingFrame& frame = points.frame[some[i]];
        if (is_seen(light, frame, points.error[some[i]])) {
            for (const Vec3d& v : light.vertices) {
                polygons_.push_back(frame.point_to_local(v));
            }
            seen_by_.push_back(static_cast<std::uint32_t>(i));
        }
    }
}

void Unshadowed::integrate(const ShadingPoints& points, std::span<const std::uint32_t> some, const Light& light,
                           std::size_t light_index, RenderReport& report) {
    seen_by_.clear();
    std::visit([&](const auto& shape) { see(shape, points, some); }, light);
    if (seen_by_.empty()) {
        return;
    }
    for (std::size_t lobe = 0; lobe < views_.lobe_count(); ++lobe) {
        if (std::holds_alternative<PolygonLight>(light)) {
            batch_.shade(views_.lobe(lobe), polygons_, seen_by_, true);
        } else {
            batch_.shade(views_.lobe(lobe), circles_.arrays(), seen_by_, true);
        }
        float* values = &values_[(light_index * lobe_stride_ + lobe) * point_count_];
        for (std::size_t k = 0; k < seen_by_.size(); ++k) {
            const std::uint32_t point = some[seen_by_[k]];
            values[point] = batch_.values()[k];
            count(batch_.way(k), batch_.efforts()[k], points.hit_count(point), report);
            report.over_tolerance += batch_.met(views_.lobe(lobe), k, seen_by_[k]) ? 0 : points.hit_count(point);
        }
    }
}

}  // namespace shlight
