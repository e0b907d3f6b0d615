// SPDX-License-Identifier: MIT
//
// How bright lights with extent make shading points and pixels if nothing blocks them: what tells bright from dim
// lights.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shading/direct_light.h"
#include "shading/shading_points.h"
#include "shlight/light.h"

namespace shlight {

/// Brightness is the sum of the colours' absolute values, over all hits. Keeps its memory; one per thread.
class LightBrightness {
  public:
    explicit LightBrightness(std::size_t lobe_stride) : lobe_stride_(lobe_stride) {}

    /// Forgets all lights. points: stay as they are until the next call; others: brightness of each pixel by lights
    /// that are not expected.
    void start(const ShadingPoints& points, std::span<const float> others);
    /// Counts lights in. They are referred to by their index among those of the last call.
    void expect(std::span<const Light* const> lights, const DirectLight& unshadowed);

    float of_pixel(std::size_t light_index, std::size_t pixel) const { return own_[light_index * all_.size() + pixel]; }
    /// By all lights that were counted in, and by the others.
    float all(std::size_t pixel) const { return all_[pixel]; }
    std::span<const float> all() const { return all_; }
    /// Under one light.
    float of_point(const LightRadiance& unshadowed, std::size_t point) const {
        float sum = 0;
        for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
            sum +=
                glm::dot(glm::abs(unshadowed[lobe * points_->size() + point]), glm::abs(points_->weight(point, lobe)));
        }
        return sum * static_cast<float>(points_->hit_count(point));
    }

  private:
    std::size_t lobe_stride_;
    const ShadingPoints* points_ = nullptr;
    std::vector<float> all_;  // by pixel
    std::vector<float> own_;  // lights × pixels
};

}  // namespace shlight
