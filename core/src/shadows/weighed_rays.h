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
    void clear() {
        numbers_.clear();
        x_.clear();
        y_.clear();
        z_.clear();
    }
    /// number: among the rays of all hits; way: along the axes of the world.
    void add(std::size_t number, const Vec3f& way) {
        numbers_.push_back(number);
        x_.push_back(way.x);
        y_.push_back(way.y);
        z_.push_back(way.z);
    }
    /// By a lobe at the hit, see weigh_lobe_rays(). with_densities: or else these are not known.
    void weigh(const LobeShape& shape, const ShadingFrame& frame, const Vec3d& view, bool with_densities) {
        for (std::vector<float>* array : {&x_, &y_, &z_, &values_, &densities_}) {
            array->resize(size() + kLobeRayLanes);
        }
        weigh_lobe_rays(shape, frame, view, {x_.data(), y_.data(), z_.data()}, size(), values_.data(),
                        with_densities ? densities_.data() : nullptr);
    }

    std::size_t size() const { return numbers_.size(); }
    std::size_t number(std::size_t i) const { return numbers_[i]; }
    float value(std::size_t i) const { return values_[i]; }
    float density(std::size_t i) const { return densities_[i]; }

  private:
    std::vector<std::size_t> numbers_;
    std::vector<float> x_, y_, z_, values_, densities_;
};

}  // namespace shlight
