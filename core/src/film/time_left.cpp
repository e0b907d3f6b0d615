// SPDX-License-Identifier: MIT
#include "film/time_left.h"

#include <algorithm>
#include <array>
#include <bit>

namespace shlight {
namespace {

/// Shares of the time for records, after each grid, that were measured in pictures of several scenes.
constexpr std::array kSharesMade = {0.1, 0.26, 0.46, 0.88, 1.0};
constexpr unsigned kWidestStep = 32;

}  // namespace

void TimeLeft::end_grid(int step, double now) {
    const auto grid = static_cast<std::size_t>(std::bit_width(kWidestStep / static_cast<unsigned>(step)) - 1);
    records_seconds_ = now - records_start_;
    share_made_ = kSharesMade.at(grid);
    share_begun_ = kSharesMade.at(std::min(grid + 1, kSharesMade.size() - 1));
}

void TimeLeft::add_rays(double count) {
    rays_done_ += count;
    rays_left_ -= count;
}

void TimeLeft::end_job(double now) {
    job_seconds_ += now - job_start_;
    job_start_ = kNever;
}

void TimeLeft::change_rays(double times, double later_share, double now) {
    supposed_ = seconds_per_ray(now) * times * later_share_ / later_share;
    later_share_ = later_share;
    job_seconds_ = 0;
    rays_done_ = 0;
}

double TimeLeft::seconds_per_ray(double now) const {
    const double start = job_start_;
    const double seconds = job_seconds_ + (start == kNever ? 0 : now - start);
    // The most urgent rays come first, which are not those that take the usual time.
    const double supposed = supposed_ > 0 ? std::max(rays_left_.load(), 0.0) : 0.0;
    const double rays = rays_done_ + supposed;
    return rays > 0 ? (seconds + supposed_ * supposed) / rays : 0.0;
}

double TimeLeft::records_left(double now) const {
    const double all = records_seconds_ / share_made_;
    // A grid that takes longer than was supposed tells nothing of those after it.
    return std::max(all - (now - records_start_), all * (1 - share_begun_));
}

double TimeLeft::at(double now) const {
    const bool makes_records = records_start_ != kNever;
    if (makes_records && share_made_ == 0) {
        return 0;
    }
    const double rays = std::max(rays_left_.load(), 0.0);
    return rays * later_share_ * seconds_per_ray(now) + (makes_records ? records_left(now) : 0.0);
}

}  // namespace shlight
