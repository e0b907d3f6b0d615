// SPDX-License-Identifier: MIT
//
// Shadow rays of hits with a Terminator.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lighting/shadow_targets.h"
#include "lighting/weighed_rays.h"
#include "lobes/material_lobes.h"
#include "tracing/hits.h"

namespace shlight {

/// Keeps its memory from hit to hit; one per thread.
class TerminatorRays {
  public:
    explicit TerminatorRays(std::span<const MaterialLobes> materials) : materials_(materials) {}

    /// Moves the origins of a hit's rays, those from `begin` on, which are not traced yet. Cycles does so where it
    /// samples the light, not where it samples the material: a ray is moved with the probability that is the weight of
    /// the former in its power heuristic.
    void lift(const Hits& hits, std::size_t hit, ShadowTarget& target, std::size_t begin, DrawnRays& rays);

  private:
    /// Finds the density of the lobes together for each ray that may be moved.
    void find_densities(const Hits& hits, std::size_t hit, const DrawnRays& rays);

    std::span<const MaterialLobes> materials_;
    // The rays that may be moved:
    std::vector<std::size_t> number_;
    std::vector<double> share_, density_;
    WeighedRays weighed_;
};

}  // namespace shlight
