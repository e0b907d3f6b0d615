// SPDX-License-Identifier: MIT
#include "render/passes.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <mutex>
#include <numeric>
#include <utility>

namespace shlight {
namespace {

/// Each round takes some pixels to the next level, or follows something thin by one pixel more.
constexpr int kMostRounds = 256;
/// The first pixels are those of a grid of this step.
constexpr int kWidestGrid = 16;
/// Rays through middles of pixels that are traced together.
constexpr std::size_t kMiddlesAtOnce = 1024;
constexpr double kLeastBetweenGrids = 0.05;  // seconds
constexpr double kSoon = 0.2;                // likewise
constexpr double kMostUnfinished = 0.999;    // share of the work
/// Of the time before, between updates; seconds; times what showing the picture took.
constexpr double kUpdateShare = 0.25;
constexpr double kLeastUpdateInterval = 0.05;
constexpr double kMostUpdateInterval = 0.25;
constexpr double kShowTimes = 10;

void add(RenderReport& sum, const RenderReport& part) {
    std::transform(sum.order_counts.begin(), sum.order_counts.end(), part.order_counts.begin(),
                   sum.order_counts.begin(), std::plus<>());
    sum.cubature_count += part.cubature_count;
    sum.mirror_count += part.mirror_count;
    sum.hits += part.hits;
    sum.over_tolerance += part.over_tolerance;
    sum.shadow_rays += part.shadow_rays;
    std::transform(sum.stage_seconds.begin(), sum.stage_seconds.end(), part.stage_seconds.begin(),
                   sum.stage_seconds.begin(), std::plus<>());
}

}  // namespace

void Passes::run() {
    write_middles();
    bool goes_on = first_pass();
    for (int round = 0; goes_on && round < kMostRounds; ++round) {
        const auto groups = most_urgent(refinement_.next_round(image_, picture_->settings.threads, waiting()));
        rays_before_round_ = rays_done_;
        shown_.noise = refinement_.noise();
        shown_.seconds_left = seconds_left(refinement_.rays_left());
        std::vector<Pass> passes;
        std::transform(groups.begin(), groups.end(), std::back_inserter(passes),
                       [this](const RefinementGroup& group) { return pass_of(group); });
        goes_on = show() && !passes.empty();
        if (goes_on && !fits(passes)) {
            run_pass(pass_of(refinement_.unrendered()));
            goes_on = false;
        }
        for (const Pass& pass : passes) {
            goes_on = goes_on && run_pass(pass);
        }
        shown_.passes += goes_on ? 1 : 0;
    }
    pass_image_.finish(picture_->settings.threads);
    if (watch_->progress && !watch_->progress(1.0)) {
        throw RenderCancelled();
    }
}

void Passes::write_middles() {
    const auto columns = static_cast<std::size_t>(picture_->width);
    const std::size_t count = (columns + kMiddlesAtOnce - 1) / kMiddlesAtOnce;
    const auto write = [&](std::size_t task) {
        const std::size_t first = task % count * kMiddlesAtOnce;
        std::vector<Pixel> pixels;
        for (std::size_t column = first; column < std::min(first + kMiddlesAtOnce, columns); ++column) {
            pixels.push_back({static_cast<int>(column), static_cast<int>(task / count)});
        }
        batches_.local().write_middles(pixels, pass_image_.pixels(task / count * columns + first, pixels.size()));
    };
    const bool any = std::any_of(picture_->layout.places().begin(), picture_->layout.places().end(),
                                 [](const PassLayout::Place& place) { return is_of_middle(place.pass.kind); });
    parallel_for(any ? count * static_cast<std::size_t>(picture_->height) : 0, picture_->settings.threads, write,
                 waiting());
}

/// All pixels that it takes; if somebody watches and it takes a while, those of wide grids come first, and what lies
/// between is shown as they are.
bool Passes::first_pass() {
    const int last = refinement_.first_step();
    const double pixels = 1.0 * picture_->width * picture_->height;
    bool goes_on = true;
    for (Grid grid = {watch_->on_update ? kWidestGrid : last, 0}; goes_on && grid.step >= last;) {
        goes_on = run_pass(pass_of(grid));
        const double rest = pixels * (1.0 / (last * last) - 1.0 / (grid.step * grid.step)) * refinement_.samples(0);
        const bool soon = seconds_left(rest) < kSoon;
        if (goes_on && grid.step > 1 && (grid.step == last || !soon)) {
            fill_between(grid.step, picture_->width, picture_->height, image_);
            const bool is_due = shown_.seconds == 0 || seconds() - shown_.seconds >= kLeastBetweenGrids;
            goes_on = grid.step == last || !is_due || show();
        }
        grid = {soon && grid.step > last ? last : grid.step / 2, grid.step};
    }
    shown_.passes = goes_on ? 1 : 0;
    return goes_on;
}

Passes::Pass Passes::pass_of(const Grid& grid) {
    const auto tiles = tiles_of(picture_->width, picture_->height, grid, refinement_.samples(0), batch_samples_);
    const double share = 1.0 / (grid.step * grid.step) - (grid.wider > 0 ? 1.0 / (grid.wider * grid.wider) : 0.0);
    const double rays = share * refinement_.samples(0) * picture_->width * picture_->height;
    return {rays, tiles.size(),
            [this, tiles, grid](std::size_t i) { render(pixels_of(tiles[i], grid), -1, 0, false); }};
}

Passes::Pass Passes::pass_of(const RefinementGroup& group) {
    const auto rays = static_cast<std::size_t>(group.rays);
    const std::size_t count = batch_samples_ / std::clamp<std::size_t>(rays, 1, batch_samples_);
    const auto task = [this, count, pixels = group.pixels, from = group.from, to = group.to,
                       calm = group.calm](std::size_t i) {
        const std::size_t first = i * count;
        render(std::span(pixels).subspan(first, std::min(count, pixels.size() - first)), from, to, calm);
    };
    return {static_cast<double>(rays * group.pixels.size()), (group.pixels.size() + count - 1) / count, task};
}

/// What is known of a pass before it ends is how long those before it took for their rays.
double Passes::seconds_left(double rays) const {
    return rays_done_ > 0 ? seconds() * rays / rays_done_ : 0.0;
}

bool Passes::fits(std::span<const Pass> passes) const {
    const double limit = picture_->settings.sampling.time_limit;
    const double rays = std::accumulate(passes.begin(), passes.end(), 0.0,
                                        [](double sum, const Pass& pass) { return sum + pass.rays; });
    return !(limit > 0) || seconds() + seconds_left(rays) <= limit;
}

bool Passes::run_pass(const Pass& pass) {
    const double rays_after = std::max(refinement_.rays_left() - (rays_done_ - rays_before_round_) - pass.rays, 0.0);
    bool goes_on = true;
    double last = seconds();
    const auto is_due = [&] {
        const double usual = std::clamp(kUpdateShare * last, kLeastUpdateInterval, kMostUpdateInterval);
        return seconds() - last > std::max(usual, kShowTimes * show_seconds_);
    };
    const auto tell = [&](double share) {
        const double done = share * pass.rays;
        const double all = rays_done_ + pass.rays + rays_after;
        share_ = std::max(share_, std::min((rays_done_ + done) / all, kMostUnfinished));
        if (watch_->on_update && is_due() && share < 1) {
            shown_.seconds_left =
                done > 0 || rays_done_ > 0 ? seconds() * (all - rays_done_ - done) / (rays_done_ + done) : 0.0;
            goes_on = show();
            last = seconds();
        }
        return goes_on && (!watch_->progress || watch_->progress(share_));
    };
    const bool watched = watch_->progress || watch_->on_update;
    try {
        std::atomic<std::size_t> next = 0;  // tasks begin in their order, whatever the scheduler prefers
        parallel_for(
            pass.tasks, picture_->settings.threads, [&](std::size_t) { pass.task(next++); },
            watched ? Progress(tell) : Progress());
    } catch (const RenderCancelled&) {
        if (goes_on) {
            throw;
        }
        return false;
    }
    rays_done_ += pass.rays;
    return true;
}

Progress Passes::waiting() const {
    if (!watch_->progress) {
        return {};
    }
    return [this](double) { return watch_->progress(share_); };
}

/// Shows the picture and what is known of it.
bool Passes::show() {
    if (!watch_->on_update) {
        return true;
    }
    {
        const std::unique_lock lock(merging_);
        snapshot_.assign(image_.begin(), image_.end());
    }
    shown_.seconds = seconds();
    const bool goes_on = watch_->on_update(snapshot_, shown_);
    show_seconds_ = seconds() - shown_.seconds;
    return goes_on;
}

/// For each camera ray and light.
std::uint32_t Passes::shadow_rays_at(int level) const {
    const auto most = static_cast<std::uint32_t>(picture_->settings.shadow_rays);
    if (level == 0 && refinement_.has_preview()) {
        return std::min(most, kLeastShadowRays);
    }
    // A pixel's many rays share the work of resolving its penumbrae.
    return std::max(std::min(most, kLeastShadowRays), most >> (2 * level));
}

/// Of all rays at lower levels: so the points of all are one sequence.
std::uint32_t Passes::points_before(int level) const {
    std::uint32_t points = 0;
    for (int l = 0; l < level; ++l) {
        points += (refinement_.kept_samples(l) - refinement_.kept_samples(l - 1)) * shadow_rays_at(l);
    }
    return points;
}

void Passes::render(std::span<const Pixel> pixels, int from, int to, bool calm) {
    const std::uint32_t shadow_rays = shadow_rays_at(to);
    const std::uint32_t own_rays = calm ? std::min(shadow_rays, 1U) : shadow_rays;
    const std::uint32_t most = std::max<std::uint32_t>(
        refinement_.samples(0), std::min<std::uint32_t>(batch_samples_, kMostRaysPerPixel / std::max(shadow_rays, 1U)));
    std::vector<PixelSums> sums(pixels.size());
    std::vector<double> pass_sums(pixels.size() * pass_image_.stride());
    std::uint32_t first_point = points_before(to);
    for (std::uint32_t first = refinement_.kept_samples(from); first < refinement_.samples(to);) {
        const std::uint32_t count = std::min(most, refinement_.samples(to) - first);
        const std::uint32_t number = to == 0 ? first : first + picture_->previews;
        batches_.local().add(pixels, {number, count, own_rays, first_point}, sums, pass_sums);
        first_point += count * shadow_rays;
        first += count;
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

RenderReport Passes::report() const {
    RenderReport report = shown_;
    for (const PixelBatch& batch : batches_) {
        add(report, batch.report());
    }
    report.seconds = seconds();
    report.seconds_left = 0;
    return report;
}

}  // namespace shlight
