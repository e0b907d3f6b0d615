// SPDX-License-Identifier: MIT
//
// Eq. 5 for many shading points and lights: outgoing radiance per lobe for lights of unit radiance that nothing blocks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "material_orders.h"
#include "shading_points.h"
#include "shlight/light.h"

namespace shlight {

/// Radiance per light, lobe and shading point: value (light · lobe_stride + lobe) · points + point.
class Unshadowed {
  public:
    explicit Unshadowed(std::size_t lobe_stride) : lobe_stride_(lobe_stride) {}

    /// Sorts the points by material and then by their largest order, so that a run of them is one batch of like work.
    void group(const ShadingPoints& points);
    /// Points are those of the last call of group().
    void compute(const ShadingPoints& points, std::span<const OrderedMaterial> materials,
                 std::span<const Light> lights);
    /// The values of one light, lobe_stride × points.
    std::span<const float> light(std::size_t index) const {
        return std::span(values_).subspan(index * lobe_stride_ * point_count_, lobe_stride_ * point_count_);
    }

  private:
    struct Group {
        std::uint32_t material;
        int order;                 // the largest of the lobes
        std::size_t first, count;  // in sorted_
    };

    void compute_batch(const ShadingPoints& points, const OrderedMaterial& material, int order,
                       std::span<const std::uint32_t> batch, std::span<const Light> lights);
    /// Coefficients of a light at one point; false where it is not seen.
    bool coefficients(const Light& light, const ShadingPoints& points, std::size_t point, int order, float* result);

    std::size_t lobe_stride_;
    std::size_t point_count_ = 0;
    std::vector<std::uint32_t> sorted_;
    std::vector<std::uint8_t> largest_orders_;  // points
    std::vector<Group> groups_;
    std::vector<float> values_;
    std::vector<float> cosine_terms_;        // batch × lobes × cosine_count(order)
    std::vector<float> light_coefficients_;  // order²
    std::vector<Vec3f> vertices_;
};

}  // namespace shlight
