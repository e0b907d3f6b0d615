// SPDX-License-Identifier: MIT
//
// Some of a hit's shadow rays, gathered from those of many hits, and what a lobe makes of each.
#pragma once

#include <cstddef>
#include <vector>

#include "lobes/lobe_rays.h"

namespace shlight {

/// Keeps its memory from hit to hit.
class WeighedRays {
  public:
    void clear() { count_ = 0; }
    /// Adds rays begin … end - 1 of all hits. way(number): vector in world axes.
    template <class Way>
    void add(std::size_t begin, std::size_t end, const Way& way) {
        grow(count_ + end - begin + kLobeRayLanes);
        for (std::size_t number = begin; number < end; ++number, ++count_) {
            const Vec3f& own = way(number);
            numbers_[count_] = number;
            x_[count_] = own.x;
            y_[count_] = own.y;
            z_[count_] = own.z;
        }
    }
    /// Weighs the rays by a lobe at the hit, see weigh_lobe_rays(). with_densities: whether to compute densities.
    void weigh(const LobeShape& shape, const ShadingFrame& frame, const Vec3d& view, bool with_densities) {
        weigh_lobe_rays(shape, frame, view, {x_.data(), y_.data(), z_.data()}, size(), values_.data(),
                        with_densities ? densities_.data() : nullptr);
    }

    std::size_t size() const { return count_; }
    std::size_t number(std::size_t i) const { return numbers_[i]; }
    float value(std::size_t i) const { return values_[i]; }
    float density(std::size_t i) const { return densities_[i]; }

  private:
    void grow(std::size_t size) {
        if (size > numbers_.size()) {
            numbers_.resize(2 * size);
            for (std::vector<float>* array : {&x_, &y_, &z_, &values_, &densities_}) {
                array->resize(2 * size);
            }
        }
    }

    std::size_t count_ = 0;
    std::vector<std::size_t> numbers_;
    std::vector<float> x_, y_, z_, values_, densities_;
};

}  // namespace shlight
