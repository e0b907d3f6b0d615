// SPDX-License-Identifier: MIT
#include "film/progressive_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "film/record_placement.h"

namespace shlight {
namespace {

/// Each round takes some pixels to the next level, or follows something thin by one pixel more.
constexpr int kMostRounds = 256;
/// Pixels across the cells of records.
constexpr int kWidestRecordStep = 32;
constexpr int kLeastRecordStep = 2;
/// Step of the finest grid whose pixels are shown before the next one has records; those of finer ones take longer.
constexpr int kLeastShownStep = 4;
/// Bounces get this share of the time there is.
constexpr double kShareOfBounces = 0.25;
/// Direct light alone, which is shown before, gets this one.
constexpr double kShareOfPreview = 0.03;
/// Pixels of the first grid, at least.
constexpr double kFirstPixels = 1024;
/// Rays through middles of pixels that are traced together.
constexpr std::size_t kMiddlesAtOnce = 1024;
constexpr double kLeastBetweenGrids = 0.05;  // seconds
constexpr double kMostUnfinished = 0.999;    // share of the work
/// Between updates: share of the time before; least and most seconds; times the seconds that showing the picture took.
constexpr double kUpdateShare = 0.25;
constexpr double kLeastUpdateInterval = 0.05;
constexpr double kMostUpdateInterval = 0.25;
constexpr double kShowTimes = 10;
/// Seconds per ray of those that refine a pixel ÷ those per ray of the first pass, where that has one ray for each.
constexpr double kLaterShare = 0.5;
/// Seconds per ray with light that bounces ÷ those without, and rays ÷ the least number of them, as is usual.
constexpr double kBounceTimes = 2;
constexpr double kUsualRays = 2;
/// Share of the pixels that have no rays yet but ones that others replace, above which little is known of their noise.
constexpr double kUnknownShare = 0.5;
/// Rows and columns between the pixels from which the brightness of a picture without a preview is known beforehand.
constexpr int kBrightnessStep = 2;

}  // namespace

ProgressiveRenderer::ProgressiveRenderer(const Picture& picture, Refinement refinement, StoredLight& stored,
                                         std::span<float> image, std::span<float> passes, const RenderWatch& watch,
                                         Clock::time_point start)
    : picture_(&picture),
      image_(image),
      pass_image_(picture.layout, passes),
      watch_(&watch),
      batch_samples_(picture.lighting.batch_size()),
      start_(start),
      refinement_(std::move(refinement)),
      time_left_(kUsualRays * refinement_.rays_left(), refinement_.has_preview() ? kLaterShare : 1),
      stored_(&stored),
      batches_([this] { return PixelBatch(*picture_, picture_->paths(bounces_ ? stored_ : nullptr)); }) {}

void ProgressiveRenderer::run(const Watch& caller) {
    write_middles(caller.stopped);
    const bool bounces = picture_->settings.max_bounces > 0;
    const bool has_first = !bounces || refinement_.has_preview();
    const bool has_bounced = bounces && has_first && !stored_->records.all().empty();
    if (has_bounced) {
        follow_records();
    }
    if (!refinement_.has_preview() && (bounces || refinement_.samples(0) > 1)) {
        find_brightness(caller.stopped);
    }
    const double share = bounces ? kShareOfPreview : 1;
    bool goes_on = has_first && first_pass(caller, share * time_limit());
    if (bounces && !is_left_) {
        add_bounces(has_bounced, caller);
        goes_on = first_pass(caller, time_limit());
    }
    time_left_.change_rays(1, 1, seconds());
    for (int round = 0; goes_on && round < kMostRounds; ++round) {
        goes_on = refine(caller);
    }
    if (seconds() >= time_limit() - judge_seconds_ || is_left_) {
        judge(caller.stopped, true);  // rays that came after the last round's judgement count too
    }
    fill_unrendered();
    pass_image_.finish(picture_->settings.threads);
}

void ProgressiveRenderer::find_brightness(const Stopped& stopped) {
    const Grid grid = {kBrightnessStep, 0};
    const auto tiles = tiles_of(picture_->width, picture_->height, grid, 1, batch_samples_);
    const auto task = [&](std::size_t i) {
        const std::vector<Pixel> pixels = pixels_of(tiles[i], grid);
        std::vector<PixelSums> sums(pixels.size());
        std::vector<double> pass_sums(pixels.size() * pass_image_.stride());
        PixelBatch& batch = batches_.local();
        batch.add(pixels, {0, 1, kPreviewShadowRays, 0}, 1, sums, pass_sums);
        batch.take_report();  // which is not of the picture's rays
        for (std::size_t p = 0; p < pixels.size(); ++p) {
            const auto row = static_cast<std::size_t>(pixels[p].row) * static_cast<std::size_t>(picture_->width);
            const std::span<float> color = image_.subspan(4 * (row + static_cast<std::size_t>(pixels[p].column)), 3);
            for (int channel = 0; channel < 3; ++channel) {
                color[static_cast<std::size_t>(channel)] = static_cast<float>(sums[p].radiance[channel]);
            }
        }
    };
    run_job({0, tiles.size(), task}, std::numeric_limits<double>::infinity(), stopped);
    fill_between(grid.step, picture_->width, picture_->height, picture_->settings.threads, {}, image_);
    refinement_.set_mean(image_);
}

void ProgressiveRenderer::add_bounces(bool has_bounced, const Watch& caller) {
    const double start = seconds();
    before_.assign(image_.begin(), image_.end());
    RecordPlacement placement(*picture_, before_, has_bounced, *stored_);
    const double until = start + kShareOfBounces * (time_limit() - start);
    const auto seconds_left = [&] { return until - seconds(); };
    refinement_.begin_again();
    time_left_.change_rays(kBounceTimes, refinement_.has_preview() ? kLaterShare : 1, start);
    time_left_.begin_records(start);
    for (int step = kWidestRecordStep; step >= kLeastRecordStep && seconds_left() > 0 && !is_left_; step /= 2) {
        const RenderReport report = placement.add_grid(step, caller.stopped, seconds_left);
        {
            const std::lock_guard lock(telling_);
            told_ += report;
        }
        follow_records();
        time_left_.end_grid(step, seconds());
        if (report.records > 0 && watch_->on_update && refinement_.has_preview() && step >= kLeastShownStep) {
            is_complete_ = false;  // pixels with bounces are not shown among others without
            run_job(job_of(Grid{step, 0}), std::numeric_limits<double>::infinity(), caller.stopped);
            show_grid(step, caller);
        }
    }
    record_error_ = placement.error();
    refinement_.limit_paths();
    follow_records();
    time_left_.end_records();
    time_left_.set_rays_left(kUsualRays * refinement_.rays_left());
}

void ProgressiveRenderer::follow_records() {
    bounces_ = true;
    for (PixelBatch& batch : batches_) {
        batch.follow(picture_->paths(stored_));
    }
}

void ProgressiveRenderer::show_grid(int step, const Watch& caller) {
    if (step > 1) {
        const std::unique_lock lock(merging_);
        fill_between(step, picture_->width, picture_->height, picture_->settings.threads, before_, image_);
    }
    const bool was_complete = is_complete_.exchange(true);
    if (!was_complete || seconds() - shown_at_ >= kLeastBetweenGrids) {
        show_now(caller);
    }
}

double ProgressiveRenderer::time_limit() const {
    const double limit = picture_->settings.sampling.time_limit;
    return limit > 0 ? limit : std::numeric_limits<double>::infinity();
}

void ProgressiveRenderer::write_middles(const Stopped& stopped) {
    const auto any = [&](bool (*is)(Pass)) {
        return std::ranges::any_of(picture_->layout.places(), [&](const auto& place) { return is(place.pass.kind); });
    };
    const bool guides = picture_->settings.sampling.time_limit > 0 && any(is_guide);
    const auto columns = static_cast<std::size_t>(picture_->width);
    const std::size_t count = (columns + kMiddlesAtOnce - 1) / kMiddlesAtOnce;
    const auto write = [&](std::size_t task) {
        end_if(stopped);
        const std::size_t first = task % count * kMiddlesAtOnce;
        std::vector<Pixel> pixels;
        for (std::size_t column = first; column < std::min(first + kMiddlesAtOnce, columns); ++column) {
            pixels.push_back({static_cast<int>(column), static_cast<int>(task / count)});
        }
        batches_.local().write_middles(pixels, guides,
                                       pass_image_.pixels(task / count * columns + first, pixels.size()));
    };
    parallel_for(guides || any(is_of_middle) ? count * static_cast<std::size_t>(picture_->height) : 0,
                 picture_->settings.threads, write);
}

/// Step of the first grid: it has few pixels if a picture must be shown soon.
int ProgressiveRenderer::widest_step() const {
    const double pixels = 1.0 * picture_->width * picture_->height;
    int step = refinement_.first_step();
    while ((watch_->on_update || picture_->settings.sampling.time_limit > 0) &&
           pixels / (4.0 * step * step) >= kFirstPixels) {
        step *= 2;
    }
    return step;
}

bool ProgressiveRenderer::first_pass(const Watch& caller, double latest) {
    const int last = refinement_.first_step();
    const double begin = seconds();
    const double done = time_left_.rays_done();
    double until = std::numeric_limits<double>::infinity();  // the first grid is always made
    bool goes_on = true;
    for (Grid grid = {widest_step(), 0}; goes_on && grid.step >= last; grid = {grid.step / 2, grid.step}) {
        goes_on = run_job(job_of(grid), until, caller.stopped);
        until = latest;
        if (goes_on) {
            grid_step_ = grid.step;
            show_grid(grid.step, caller);
        }
    }
    seconds_per_first_ray_ = (seconds() - begin) / std::max(time_left_.rays_done() - done, 1.0);
    passes_ = 1;
    return goes_on && !is_left_;
}

std::vector<RefinementGroup> ProgressiveRenderer::judge(const Stopped& stopped, bool is_last) {
    const double begin = seconds();
    auto groups = refinement_.next_round(image_, picture_->settings.threads, stopped);
    judge_seconds_ = seconds() - begin;
    double unknown = 0;  // number of pixels
    for (const RefinementGroup& group : groups) {
        unknown += group.from < 0 ? static_cast<double>(group.pixels.size()) : 0.0;
    }
    const bool is_known = unknown <= kUnknownShare * picture_->width * picture_->height;
    time_left_.set_rays_left((is_known ? 1 : kUsualRays) * refinement_.rays_left());
    const std::lock_guard lock(telling_);
    if (is_known || is_last) {
        told_.noise = std::hypot(refinement_.noise(), record_error_);
    }
    told_.passes = passes_;  // a pass is told of with its noise
    return groups;
}

bool ProgressiveRenderer::refine(const Watch& caller) {
    const auto groups = most_urgent(judge(caller.stopped, false));
    show_now(caller);
    if (is_left_ || groups.empty()) {
        return false;
    }
    // Time is kept for one ray of each pixel that has none, if there is enough for all of them.
    const double limit = time_limit() - judge_seconds_;
    const bool is_limited = picture_->settings.sampling.time_limit > 0;
    const RefinementGroup unrendered = is_limited ? refinement_.unrendered() : RefinementGroup{};
    const double reserve = static_cast<double>(unrendered.pixels.size()) * unrendered.rays * seconds_per_first_ray_;
    const double until = seconds() + reserve < limit ? limit - reserve : limit;
    const bool is_whole = std::all_of(groups.begin(), groups.end(), [&](const RefinementGroup& group) {
        return run_job(job_of(group), until, caller.stopped);
    });
    if (!is_whole && !is_left_) {
        run_job(job_of(refinement_.unrendered()), limit, caller.stopped);
    }
    passes_ += is_whole ? 1 : 0;
    return !is_left_ && seconds() < limit;
}

ProgressiveRenderer::Job ProgressiveRenderer::job_of(const Grid& grid) {
    const auto tiles = tiles_of(picture_->width, picture_->height, grid, refinement_.samples(0), batch_samples_);
    const double share = 1.0 / (grid.step * grid.step) - (grid.wider > 0 ? 1.0 / (grid.wider * grid.wider) : 0.0);
    const double rays = share * refinement_.samples(0) * picture_->width * picture_->height;
    return {rays, tiles.size(), [this, tiles, grid](std::size_t i) { render(pixels_of(tiles[i], grid), -1, 0); }};
}

ProgressiveRenderer::Job ProgressiveRenderer::job_of(const RefinementGroup& group) {
    const auto rays = static_cast<std::size_t>(group.rays);
    const std::size_t count = batch_samples_ / std::clamp<std::size_t>(rays, 1, batch_samples_);
    const auto task = [this, count, pixels = group.pixels, from = group.from, to = group.to](std::size_t i) {
        const std::size_t first = i * count;
        render(std::span(pixels).subspan(first, std::min(count, pixels.size() - first)), from, to);
    };
    return {static_cast<double>(rays * group.pixels.size()), (group.pixels.size() + count - 1) / count, task};
}

bool ProgressiveRenderer::run_job(const Job& job, double until, const Stopped& stopped) {
    const double left = std::max(time_left_.rays_left() - job.rays, 0.0);
    time_left_.set_rays_left(left + job.rays);
    time_left_.begin_job(seconds());
    const double rays_of_task = job.rays / static_cast<double>(std::max<std::size_t>(job.tasks, 1));
    std::atomic<std::size_t> next = 0;  // tasks begin in their order, whatever the scheduler prefers
    parallel_for(job.tasks, picture_->settings.threads, [&](std::size_t) {
        end_if(stopped);
        if (!is_left_ && seconds() <= until) {
            job.task(next++);
            time_left_.add_rays(rays_of_task);
        }
    });
    time_left_.end_job(seconds());
    time_left_.set_rays_left(left);
    return next == job.tasks;
}

void ProgressiveRenderer::fill_unrendered() {
    if (pass_image_.empty()) {
        return;  // the image is interpolated already
    }
    for (const Pixel& pixel : refinement_.unrendered().pixels) {
        const GridPlace place(pixel, grid_step_, picture_->width, picture_->height);
        pass_image_.fill(place);
        if (!picture_->parts.empty()) {  // the sum of what passes tell apart, which know nothing of `before_`
            place.fill(4, image_);
        }
    }
}

double ProgressiveRenderer::seconds_left() const {
    const double now = seconds();
    return std::clamp(time_limit() - now, 0.0, time_left_.at(now));
}

void ProgressiveRenderer::show_now(const Watch& caller) {
    if (watch_->on_update) {
        wants_show_ = true;
        caller.look();
    }
}

bool ProgressiveRenderer::look() {
    if (watch_->progress) {
        const double now = seconds();
        const double left = seconds_left();
        share_ = std::max(share_, left > 0 ? std::min(now / (now + left), kMostUnfinished) : 0.0);
        if (!watch_->progress(share_)) {
            return false;
        }
    }
    if (!watch_->on_update || !is_complete_ || is_left_) {
        return true;
    }
    const double usual = std::clamp(kUpdateShare * shown_at_.load(), kLeastUpdateInterval, kMostUpdateInterval);
    const bool is_due = seconds() - shown_at_ > std::max(usual, kShowTimes * show_seconds_);
    if (wants_show_.exchange(false) || is_due) {
        is_left_ = !show();
    }
    return true;
}

bool ProgressiveRenderer::show() {
    {
        const std::unique_lock lock(merging_);
        snapshot_.assign(image_.begin(), image_.end());
    }
    shown_at_ = seconds();
    const bool goes_on = watch_->on_update(snapshot_, report());
    show_seconds_ = seconds() - shown_at_;
    return goes_on;
}

std::uint32_t ProgressiveRenderer::shadow_rays_at(int level) const {
    const auto most = static_cast<std::uint32_t>(picture_->settings.shadow_rays);
    if (level == 0 && refinement_.has_preview()) {
        return std::min(most, kPreviewShadowRays);
    }
    // A pixel's many rays share the work of resolving its penumbrae.
    const std::uint32_t times = std::max(refinement_.samples(level) / std::max(refinement_.samples(0), 1U), 1U);
    return std::max(std::min(most, kLeastShadowRays), most / times);
}

/// Points of the lights that rays at lower levels take: so the points of all levels are one sequence.
std::uint32_t ProgressiveRenderer::points_before(int level) const {
    std::uint32_t points = 0;
    for (int l = 0; l < level; ++l) {
        points += (refinement_.kept_samples(l) - refinement_.kept_samples(l - 1)) * shadow_rays_at(l);
    }
    return points;
}

void ProgressiveRenderer::render(std::span<const Pixel> pixels, int from, int to) {
    const std::uint32_t shadow_rays = shadow_rays_at(to);
    const std::uint32_t most = std::max<std::uint32_t>(
        refinement_.samples(0), std::min<std::uint32_t>(batch_samples_, kMostRaysPerPixel / std::max(shadow_rays, 1U)));
    const std::uint32_t previews = to == 0 ? 0 : picture_->previews;
    PixelBatch& batch = batches_.local();
    std::vector<PixelSums> sums(pixels.size());
    std::vector<double> pass_sums(pixels.size() * pass_image_.stride());
    std::uint32_t first_point = points_before(to);
    for (std::uint32_t first = refinement_.kept_samples(from); first < refinement_.samples(to);) {
        const std::uint32_t count = std::min(most, refinement_.samples(to) - first);
        batch.add(pixels, {first + previews, count, shadow_rays, first_point}, refinement_.samples(to) / 2 + previews,
                  sums, pass_sums);
        first_point += count * shadow_rays;
        first += count;
    }
    {
        const std::lock_guard lock(telling_);
        told_ += batch.take_report();
    }
    const std::shared_lock lock(merging_);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        refinement_.merge(pixels[i], to, sums[i], image_);
        if (!pass_image_.empty()) {
            const std::size_t index =
                static_cast<std::size_t>(pixels[i].row) * static_cast<std::size_t>(picture_->width) +
                static_cast<std::size_t>(pixels[i].column);
            pass_image_.merge(index, refinement_.kept_samples(from), refinement_.samples(to),
                              std::span(pass_sums).subspan(i * pass_image_.stride(), pass_image_.stride()));
        }
    }
}

RenderReport ProgressiveRenderer::report() const {
    const double left = seconds_left();
    const std::lock_guard lock(telling_);
    RenderReport report = told_;
    report.seconds = seconds();
    report.seconds_left = left;
    return report;
}

}  // namespace shlight
