// SPDX-License-Identifier: MIT
#include "unshadowed.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "light_view.h"
#include "shlight/shading.h"

namespace shlight {
namespace {

/// Hits whose lobe coefficients are held at a time: at order 64, 130 kB a lobe.
constexpr std::size_t kBatch = 16;

}  // namespace

void HitGroups::assign(const Hits& hits, std::span<const OrderedMaterial> materials, std::size_t lobe_stride,
                       RenderReport& report) {
    lobe_stride_ = lobe_stride;
    orders_.assign(hits.size() * lobe_stride, 0);
    largest_order_.assign(hits.size(), 0);
    for (std::size_t hit = 0; hit < hits.size(); ++hit) {
        const OrderedMaterial& material = materials[hits.material[hit]];
        const auto orders = std::span(orders_).subspan(hit * lobe_stride, material.lobes().size());
        if (!material.choose_orders(hits.cos_theta_o[hit], orders)) {
            ++report.over_tolerance;
        }
        for (const std::uint8_t order : orders) {
            largest_order_[hit] = std::max(largest_order_[hit], order);
            report.order_counts[order] += order > 0 ? 1 : 0;
        }
    }
    const auto key = [&](std::uint32_t hit) { return std::tuple(hits.material[hit], largest_order_[hit], hit); };
    sorted_.resize(hits.size());
    std::iota(sorted_.begin(), sorted_.end(), 0U);
    std::sort(sorted_.begin(), sorted_.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    groups_.clear();
    for (std::size_t i = 0; i < sorted_.size(); ++i) {
        const std::uint32_t hit = sorted_[i];
        if (groups_.empty() || groups_.back().material != hits.material[hit] ||
            groups_.back().order != largest_order_[hit]) {
            groups_.push_back({hits.material[hit], largest_order_[hit], i, 0});
        }
        ++groups_.back().count;
    }
}

void Unshadowed::compute(const Hits& hits, const HitGroups& groups, std::span<const OrderedMaterial> materials,
                         std::span<const Light> lights) {
    hit_count_ = hits.size();
    values_.assign(lights.size() * lobe_stride_ * hit_count_, 0.0F);
    for (const HitGroups::Group& group : groups.groups()) {
        if (group.order == 0) continue;
        const auto members = std::span(groups.sorted()).subspan(group.first, group.count);
        for (std::size_t first = 0; first < members.size(); first += kBatch) {
            const auto batch = members.subspan(first, std::min(kBatch, members.size() - first));
            compute_batch(hits, groups, materials[group.material], group.order, batch, lights);
        }
    }
}

void Unshadowed::compute_batch(const Hits& hits, const HitGroups& groups, const OrderedMaterial& material, int order,
                               std::span<const std::uint32_t> batch, std::span<const Light> lights) {
    const std::size_t lobe_count = material.lobes().size();
    const auto row = static_cast<std::size_t>(cosine_count(order));
    cosine_terms_.resize(std::max(cosine_terms_.size(), batch.size() * lobe_count * row));
    light_coefficients_.resize(
        std::max(light_coefficients_.size(), static_cast<std::size_t>(coefficient_count(order))));
    const auto terms = [&](std::size_t i, std::size_t lobe) { return &cosine_terms_[(i * lobe_count + lobe) * row]; };
    for (std::size_t i = 0; i < batch.size(); ++i) {
        for (std::size_t lobe = 0; lobe < lobe_count; ++lobe) {
            if (const int lobe_order = groups.order(batch[i], lobe); lobe_order > 0) {
                material.lobes()[lobe].coefficients(lobe_order, hits.cos_theta_o[batch[i]], terms(i, lobe));
            }
        }
    }
    for (std::size_t light = 0; light < lights.size(); ++light) {
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const std::size_t hit = batch[i];
            if (!coefficients(lights[light], hits, hit, order, light_coefficients_.data())) continue;
            for (std::size_t lobe = 0; lobe < lobe_count; ++lobe) {
                if (const int lobe_order = groups.order(hit, lobe); lobe_order > 0) {
                    // What rings below zero is no light.
                    values_[(light * lobe_stride_ + lobe) * hit_count_ + hit] =
                        std::max(0.0F, shade_cosine(light_coefficients_.data(), terms(i, lobe), lobe_order));
                }
            }
        }
    }
}

bool Unshadowed::coefficients(const Light& light, const Hits& hits, std::size_t hit, int order, float* result) {
    const ShadingFrame& frame = hits.frame[hit];
    if (const auto* sphere = std::get_if<SphereLight>(&light)) {
        const auto cap = view(*sphere, frame);
        if (cap) {
            light_coefficients(*cap, order, result);
        }
        return cap.has_value();
    }
    const auto& polygon = std::get<PolygonLight>(light);
    if (!is_seen(polygon, frame, hits.error[hit])) {
        return false;
    }
    light_coefficients(polygon, frame, order, vertices_, result);
    return true;
}

}  // namespace shlight
