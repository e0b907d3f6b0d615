// SPDX-License-Identifier: MIT
//
// A picture in passes: the first over all pixels or a grid of them, later ones over those that need more camera rays.
// What a pixel gets does not depend on when it is rendered, so that a picture after some passes is that of a render
// which ends there.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <shared_mutex>
#include <span>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "render/pass_image.h"
#include "render/pixel_batch.h"
#include "render/pixel_order.h"
#include "render/refinement.h"
#include "shlight/render.h"

namespace shlight {

/// Of each camera ray that is added, where the settings allow as many. With fewer the ratio of a glossy lobe, whose
/// peak may then be among none of them, is far too large where the peak is hidden.
inline constexpr std::uint32_t kLeastShadowRays = 4;
/// Camera rays and shadow rays of a light that a pixel has in a batch, at most.
inline constexpr std::int64_t kMostRaysPerPixel = 1 << 22;

/// One render: the first pass, over all pixels or a grid of them, and passes over those that need more rays.
class Passes {
  public:
    /// passes: see render().
    Passes(const Picture& picture, Refinement refinement, std::span<float> image, std::span<float> passes,
           const RenderWatch& watch)
        : picture_(&picture),
          image_(image),
          pass_image_(picture.layout, passes),
          watch_(&watch),
          batch_samples_(picture.batch_samples()),
          refinement_(std::move(refinement)),
          batches_([&picture] { return PixelBatch(picture); }) {}

    void run();
    /// Of all batches; not while one is rendered.
    RenderReport report() const;

  private:
    /// Rays of a pass, which are spread over its tasks.
    struct Pass {
        double rays;
        std::size_t tasks;
        std::function<void(std::size_t)> task;
    };

    /// Passes of the rays through pixels' middles.
    void write_middles();
    bool first_pass();
    Pass pass_of(const Grid& grid);
    Pass pass_of(const RefinementGroup& group);
    void render(std::span<const Pixel> pixels, int from, int to, bool calm);
    std::uint32_t shadow_rays_at(int level) const;
    std::uint32_t points_before(int level) const;
    /// False if the watch asks to leave the picture as it is.
    bool run_pass(const Pass& pass);
    bool show();
    /// Of what brings the picture no further.
    Progress waiting() const;
    bool fits(std::span<const Pass> passes) const;
    double seconds_left(double rays) const;
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    using Clock = std::chrono::steady_clock;

    const Picture* picture_;
    std::span<float> image_;
    PassImage pass_image_;
    const RenderWatch* watch_;
    std::uint32_t batch_samples_;
    Clock::time_point start_ = Clock::now();
    double share_ = 0;  // of the work, as reported
    double rays_before_round_ = 0;
    double rays_done_ = 0;       // by passes that have ended
    RenderReport shown_;         // with each picture
    double show_seconds_ = 0;    // that the last took
    std::shared_mutex merging_;  // shared by those that write pixels
    std::vector<float> snapshot_;
    Refinement refinement_;
    tbb::enumerable_thread_specific<PixelBatch> batches_;
};

}  // namespace shlight
