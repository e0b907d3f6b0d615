// SPDX-License-Identifier: MIT
//
// Shadow rays that many lights of a pixel share: each asks for one light from one hit, both drawn in proportion to what
// they add, and the share of the light that comes through is taken to be the same of all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "shlight/ray_tracer.h"
#include "shlight/types.h"
#include "tracing/light_parts.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory; one per thread.
class SharedRays {
  public:
    /// Of the light of a pixel in each colour channel: what comes through, and the variance of that estimate.
    struct Share {
        Rgb seen{0}, variance{0};
        bool obstructed = false;  ///< whether any ray met anything
    };

    /// Questions of a pixel: those numbered begin … end - 1.
    struct Asked {
        std::size_t pixel, begin, end;
    };

    explicit SharedRays(ShadowTracer& tracer) : tracer_(&tracer) {}

    void start();
    /// value: what the question stands for if nothing blocks, ≥ 0; group: see LightTraits.
    void ask(const Rgb& value, std::uint32_t group, const Ray& ray);
    /// Likewise, of a light that nothing blocks.
    void know(const Rgb& value, std::uint32_t group) { questions_.push_back({value, group, kNoRay}); }
    /// Questions so far.
    std::size_t count() const { return questions_.size(); }
    void trace();
    /// What those numbered begin … end - 1 tell; nothing is seen if none of them has a value.
    Share share(std::size_t begin, std::size_t end) const;
    /// Adds to the parts of a pixel what comes through of these that are `unblocked`: of each group as the questions
    /// for it tell, but together share.seen of all.
    void keep_apart(const Asked& asked, const Share& share, std::span<const Rgb> unblocked, KeptApart& apart);

  private:
    static constexpr std::uint32_t kNoRay = std::numeric_limits<std::uint32_t>::max();
    struct Question {
        Rgb value;
        std::uint32_t group, ray;
    };

    Rgb visible(const Question& question) const { return question.ray == kNoRay ? Rgb(1) : visible_[question.ray]; }

    ShadowTracer* tracer_;
    std::vector<Question> questions_;
    std::vector<Ray> rays_;
    std::vector<Rgb> visible_;
    std::vector<Rgb> seen_, asked_of_;  // of groups
};

}  // namespace shlight
