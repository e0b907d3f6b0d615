// SPDX-License-Identifier: MIT
//
// A picture in passes: the first over all pixels or a grid of them, later ones over those that need more camera rays.
// The picture is complete from the first grid on, whenever it stops: pixels without a ray are interpolated.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <shared_mutex>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "film/pass_image.h"
#include "film/pixel_batch.h"
#include "film/pixel_order.h"
#include "film/refinement.h"
#include "film/time_left.h"
#include "shlight/parallel.h"
#include "shlight/render.h"
#include "surfaces/stored_light.h"

namespace shlight {

/// Shadow rays of each camera ray that is added, where the settings allow as many. A camera ray with its hit costs as
/// much as some ten of them, so that fewer save little of the time. With fewer than four the ratio of a glossy lobe,
/// whose peak may then be among none of them, is far too large where the peak is hidden.
inline constexpr std::uint32_t kLeastShadowRays = 8;
/// Likewise, of a ray that later ones replace.
inline constexpr std::uint32_t kPreviewShadowRays = 4;
/// Camera rays × shadow rays of a light that a pixel has in a batch, at most.
inline constexpr std::int64_t kMostRaysPerPixel = 1 << 22;

/// One render. Its work and its caller's callbacks run on two threads.
class ProgressiveRenderer {
  public:
    using Clock = std::chrono::steady_clock;

    /// passes: see render(); stored: light that is known already, or none; start: when the time limit begins.
    ProgressiveRenderer(const Picture& picture, Refinement refinement, StoredLight& stored, std::span<float> image,
                        std::span<float> passes, const RenderWatch& watch, Clock::time_point start);

    /// Renders until every pixel has enough rays, the time is over, or on_update wants the picture as it is. Throws
    /// RenderCancelled once the caller stops it.
    void run(const Watch& caller);
    /// The caller's part meanwhile: it calls progress and on_update. False: the render is cancelled.
    bool look();
    RenderReport report() const;

  private:
    /// Camera rays spread over tasks.
    struct Job {
        double rays;
        std::size_t tasks;
        std::function<void(std::size_t)> task;
    };

    void write_middles(const Stopped& stopped);
    /// Draws direct light by few rays, by which errors are judged until the picture has rays of its own.
    void find_brightness(const Stopped& stopped);
    bool first_pass(const Watch& caller, double latest);
    int widest_step() const;
    /// Makes records, and lets light bounce from now on. has_bounced: light of records that were there is in the
    /// image.
    void add_bounces(bool has_bounced, const Watch& caller);
    void follow_records();
    /// Interpolates between the pixels of a grid, and has the caller show the picture.
    void show_grid(int step, const Watch& caller);
    /// Finds the pixels that need more rays, and the picture's noise, if that is known by now. is_last: no rays come
    /// after it.
    std::vector<RefinementGroup> judge(const Stopped& stopped, bool is_last);
    /// Refines some pixels; false: there is nothing left to do, or no time.
    bool refine(const Watch& caller);
    Job job_of(const Grid& grid);
    Job job_of(const RefinementGroup& group);
    void render(std::span<const Pixel> pixels, int from, int to);
    std::uint32_t shadow_rays_at(int level) const;
    std::uint32_t points_before(int level) const;
    /// Begins no task after the second `until`; false if that left any out, or on_update did.
    bool run_job(const Job& job, double until, const Stopped& stopped);
    /// Has the caller show the picture now.
    void show_now(const Watch& caller);
    bool show();
    void fill_unrendered();
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    double time_limit() const;
    double seconds_left() const;

    const Picture* picture_;
    std::span<float> image_;
    PassImage pass_image_;
    const RenderWatch* watch_;
    std::uint32_t batch_samples_;
    Clock::time_point start_;
    double seconds_per_first_ray_ = 0;
    double judge_seconds_ = 0;  // of the last round
    int grid_step_ = 1;         // of the finest grid whose pixels all have rays
    Refinement refinement_;
    TimeLeft time_left_;
    StoredLight* stored_;
    std::vector<float> before_;  // the image without the records, whose detail wide grids of pixels with them keep
    tbb::enumerable_thread_specific<PixelBatch> batches_;
    std::atomic<bool> bounces_ = false;  // whether light does, by now
    int passes_ = 0;                     // that are whole
    double record_error_ = 0;            // by records, as RenderReport::noise

    std::shared_mutex merging_;   // shared by those that write pixels
    mutable std::mutex telling_;  // guards told_
    RenderReport told_;
    std::atomic<bool> is_complete_ = false;  // whether there is a picture to show
    std::atomic<bool> wants_show_ = false;
    std::atomic<bool> is_left_ = false;  // by on_update

    // The caller's own:
    double share_ = 0;  // of the work, as told
    std::atomic<double> shown_at_ = 0;
    double show_seconds_ = 0;
    std::vector<float> snapshot_;
};

}  // namespace shlight
