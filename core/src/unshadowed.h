// SPDX-License-Identifier: MIT
//
// Eq. 5 for many hits and lights: outgoing radiance per lobe for lights of unit radiance that nothing blocks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hits.h"
#include "material_orders.h"
#include "shlight/light.h"
#include "shlight/render.h"

namespace shlight {

/// Hits sorted by material and then by the largest order among their lobes, so that a run is one batch of like work.
class HitGroups {
  public:
    struct Group {
        std::uint32_t material;
        int order;                 ///< the largest of the lobes
        std::size_t first, count;  ///< in sorted()
    };

    /// lobe_stride: at least the number of lobes of any material. Adds to the report what the hits take.
    void assign(const Hits& hits, std::span<const OrderedMaterial> materials, std::size_t lobe_stride,
                RenderReport& report);

    const std::vector<Group>& groups() const { return groups_; }
    const std::vector<std::uint32_t>& sorted() const { return sorted_; }
    /// The order of one lobe of a hit; 0: black.
    int order(std::size_t hit, std::size_t lobe) const { return orders_[hit * lobe_stride_ + lobe]; }

  private:
    std::size_t lobe_stride_ = 1;
    std::vector<std::uint8_t> orders_;         // hits × lobe_stride
    std::vector<std::uint8_t> largest_order_;  // hits
    std::vector<std::uint32_t> sorted_;
    std::vector<Group> groups_;
};

/// Radiance per light, lobe and hit: value (light · lobe_stride + lobe) · hits + hit.
class Unshadowed {
  public:
    explicit Unshadowed(std::size_t lobe_stride) : lobe_stride_(lobe_stride) {}

    void compute(const Hits& hits, const HitGroups& groups, std::span<const OrderedMaterial> materials,
                 std::span<const Light> lights);
    /// The values of one light, lobe_stride × hits.
    std::span<const float> light(std::size_t index) const {
        return std::span(values_).subspan(index * lobe_stride_ * hit_count_, lobe_stride_ * hit_count_);
    }

  private:
    void compute_batch(const Hits& hits, const HitGroups& groups, const OrderedMaterial& material, int order,
                       std::span<const std::uint32_t> batch, std::span<const Light> lights);
    /// Coefficients of a light at one hit; false where it is not seen.
    bool coefficients(const Light& light, const Hits& hits, std::size_t hit, int order, float* result);

    std::size_t lobe_stride_;
    std::size_t hit_count_ = 0;
    std::vector<float> values_;
    std::vector<float> cosine_terms_;        // batch × lobes × cosine_count(order)
    std::vector<float> light_coefficients_;  // order²
    std::vector<Vec3f> vertices_;
};

}  // namespace shlight
