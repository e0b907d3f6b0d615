// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>

#include "shlight/render_report.h"

namespace shlight {

/// Times stages that follow each other.
class StageClock {
  public:
    explicit StageClock(RenderReport& report) : report_(&report), since_(Clock::now()) {}

    /// The time since the stage before counts as this one's.
    void end(RenderStage stage) {
        const auto now = Clock::now();
        report_->stage_seconds[static_cast<std::size_t>(stage)] += std::chrono::duration<double>(now - since_).count();
        since_ = now;
    }

  private:
    using Clock = std::chrono::steady_clock;

    RenderReport* report_;
    Clock::time_point since_;
};

}  // namespace shlight
