// SPDX-License-Identifier: MIT
//
// How long a render still takes, by what it took so far: a share of the records, and rays such as those that are left.
#pragma once

#include <atomic>

namespace shlight {

/// Written by the render, read by its caller's thread. Times are seconds since the render began.
class TimeLeft {
  public:
    /// rays_left, later_share: see below.
    TimeLeft(double rays_left, double later_share) : rays_left_(rays_left), later_share_(later_share) {}

    /// Records of light that bounces are made from now on.
    void begin_records(double now) { records_start_ = now; }
    /// The records of all cells of one width are made. step: pixels across such a cell, 32 at first and then half as
    /// many each time.
    void end_grid(int step, double now);
    void end_records() { records_start_ = kNever; }

    /// Rays are traced from now on until end_job().
    void begin_job(double now) { job_start_ = now; }
    void add_rays(double count);
    void end_job(double now);
    /// Other rays are traced from now on. times: seconds that are left ÷ those that would be left by the rays before;
    /// later_share: seconds per ray of those that are left ÷ those per ray of these.
    void change_rays(double times, double later_share, double now);
    void set_rays_left(double count) { rays_left_ = count; }
    double rays_left() const { return rays_left_; }
    /// Since they were changed.
    double rays_done() const { return rays_done_; }

    /// Seconds that are left; 0 until something is known of them.
    double at(double now) const;

  private:
    static constexpr double kNever = -1;

    double seconds_per_ray(double now) const;
    double records_left(double now) const;

    std::atomic<double> records_start_ = kNever, records_seconds_ = 0;  // the latter until the last grid's end
    std::atomic<double> share_made_ = 0, share_begun_ = 0;              // of the time that all records take
    std::atomic<double> job_start_ = kNever, job_seconds_ = 0;          // the latter of jobs that have ended
    std::atomic<double> rays_done_ = 0, rays_left_;                     // as far as they are known
    std::atomic<double> later_share_;
    std::atomic<double> supposed_ = 0;  // seconds per ray, while none is done
};

}  // namespace shlight
