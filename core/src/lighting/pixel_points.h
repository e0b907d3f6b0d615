// SPDX-License-Identifier: MIT
//
// Points of the unit square for the shadow rays of a pixel: a sequence for each set of rays, in which the points of all
// hits are neighbours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lighting/shadow_policy.h"
#include "lighting/shadow_targets.h"
#include "lights/whole_rectangle.h"
#include "shlight/sampling.h"

namespace shlight {

/// Keeps its memory from pixel to pixel.
class PixelPoints {
  public:
    /// So many that a whole number of kRaysAtOnce may be read.
    struct Square {
        const float *u, *v;
    };

    explicit PixelPoints(std::size_t set_count) : sets_(set_count, {SobolSequence(0), {}, {}, false}) {}

    /// samples.shadow_rays: points of each camera ray; first, last: the camera rays that have hits; seed: of the pixel
    /// and light.
    void start(const SampleRange& samples, std::uint32_t first, std::uint32_t last, std::uint32_t seed) {
        samples_ = samples;
        first_ = first;
        count_ = std::size_t{last - first + 1} * samples.shadow_rays;
        for (std::uint32_t set = 0; set < sets_.size(); ++set) {
            sets_[set].sequence = SobolSequence(hash(seed, set));
            sets_[set].drawn = false;
        }
    }

    /// The points of one of these camera rays, if each takes so many. A set's are drawn where they are asked for first.
    Square of(std::size_t set, std::uint32_t sample, std::uint32_t rays) {
        Set& own = sets_[set];
        if (!own.drawn) {
            own.u.resize(count_ + kRaysAtOnce);
            own.v.resize(count_ + kRaysAtOnce);
            draw_square_points(own.sequence, samples_.first_point + (first_ - samples_.first) * samples_.shadow_rays,
                               count_, own.u.data(), own.v.data());
            own.drawn = true;
        }
        const std::size_t before = std::size_t{sample - first_} * rays;
        return {&own.u[before], &own.v[before]};
    }

  private:
    struct Set {
        SobolSequence sequence;
        std::vector<float> u, v;
        bool drawn;
    };

    std::vector<Set> sets_;
    SampleRange samples_{};
    std::uint32_t first_ = 0;
    std::size_t count_ = 0;
};

}  // namespace shlight
