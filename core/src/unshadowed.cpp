// SPDX-License-Identifier: MIT
#include "unshadowed.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "light_view.h"
#include "shlight/shading.h"

namespace shlight {
namespace {

/// Points whose lobe coefficients are held at a time: at order 64, 130 kB a lobe.
constexpr std::size_t kBatch = 16;

}  // namespace

void Unshadowed::group(const ShadingPoints& points) {
    point_count_ = points.size();
    largest_orders_.resize(point_count_);
    for (std::size_t point = 0; point < point_count_; ++point) {
        largest_orders_[point] = static_cast<std::uint8_t>(points.largest_order(point));
    }
    const auto key = [&](std::uint32_t point) {
        return std::tuple(points.material[point], largest_orders_[point], point);
    };
    sorted_.resize(point_count_);
    std::iota(sorted_.begin(), sorted_.end(), 0U);
    std::sort(sorted_.begin(), sorted_.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    groups_.clear();
    for (std::size_t i = 0; i < sorted_.size(); ++i) {
        const std::uint32_t material = points.material[sorted_[i]];
        const int order = largest_orders_[sorted_[i]];
        if (groups_.empty() || groups_.back().material != material || groups_.back().order != order) {
            groups_.push_back({material, order, i, 0});
        }
        ++groups_.back().count;
    }
}

void Unshadowed::compute(const ShadingPoints& points, std::span<const OrderedMaterial> materials,
                         std::span<const Light> lights) {
    values_.assign(lights.size() * lobe_stride_ * point_count_, 0.0F);
    for (const Group& group : groups_) {
        if (group.order == 0) continue;
        const auto members = std::span(sorted_).subspan(group.first, group.count);
        for (std::size_t first = 0; first < members.size(); first += kBatch) {
            const auto batch = members.subspan(first, std::min(kBatch, members.size() - first));
            compute_batch(points, materials[group.material], group.order, batch, lights);
        }
    }
}

void Unshadowed::compute_batch(const ShadingPoints& points, const OrderedMaterial& material, int order,
                               std::span<const std::uint32_t> batch, std::span<const Light> lights) {
    const std::size_t lobe_count = material.lobes().size();
    const auto row = static_cast<std::size_t>(cosine_count(order));
    cosine_terms_.resize(std::max(cosine_terms_.size(), batch.size() * lobe_count * row));
    light_coefficients_.resize(
        std::max(light_coefficients_.size(), static_cast<std::size_t>(coefficient_count(order))));
    const auto terms = [&](std::size_t i, std::size_t lobe) { return &cosine_terms_[(i * lobe_count + lobe) * row]; };
    for (std::size_t i = 0; i < batch.size(); ++i) {
        for (std::size_t lobe = 0; lobe < lobe_count; ++lobe) {
            if (const int lobe_order = points.order(batch[i], lobe); lobe_order > 0) {
                material.lobes()[lobe].coefficients(lobe_order, points.cos_theta_o[batch[i]], terms(i, lobe));
            }
        }
    }
    for (std::size_t light = 0; light < lights.size(); ++light) {
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const std::size_t point = batch[i];
            if (!coefficients(lights[light], points, point, order, light_coefficients_.data())) continue;
            for (std::size_t lobe = 0; lobe < lobe_count; ++lobe) {
                if (const int lobe_order = points.order(point, lobe); lobe_order > 0) {
                    // What rings below zero is no light.
                    values_[(light * lobe_stride_ + lobe) * point_count_ + point] =
                        std::max(0.0F, shade_cosine(light_coefficients_.data(), terms(i, lobe), lobe_order));
                }
            }
        }
    }
}

bool Unshadowed::coefficients(const Light& light, const ShadingPoints& points, std::size_t point, int order,
                              float* result) {
    const ShadingFrame& frame = points.frame[point];
    if (const auto* sphere = std::get_if<SphereLight>(&light)) {
        const auto cap = view(*sphere, frame);
        if (cap) {
            light_coefficients(*cap, order, result);
        }
        return cap.has_value();
    }
    const auto& polygon = std::get<PolygonLight>(light);
    if (!is_seen(polygon, frame, points.error[point])) {
        return false;
    }
    light_coefficients(polygon, frame, order, vertices_, result);
    return true;
}

}  // namespace shlight
