// SPDX-License-Identifier: MIT
//
// The share of a query that is done, as its threads tell it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>

#include "shlight/parallel.h"

namespace shlight {

class QueryProgress {
  public:
    /// progress: may be empty; from, to: its shares at the beginning and the end. Both must outlive this.
    explicit QueryProgress(const Progress& progress, double from = 0, double to = 1)
        : progress_(&progress), from_(from), to_(to) {}

    /// parts: of the work that follows.
    void start(std::size_t parts) {
        parts_ = parts;
        done_ = 0;
    }
    /// Tells that so many parts more are done. Throws RenderCancelled if the work is to end. Any thread may call it.
    void add(std::size_t done) {
        const std::size_t all = done_ += done;
        const double share = parts_ == 0 ? 0.0 : std::min(1.0, static_cast<double>(all) / static_cast<double>(parts_));
        if (*progress_ && !(*progress_)(from_ + (to_ - from_) * share)) {
            throw RenderCancelled();
        }
    }
    /// Whether the work is to end.
    Stopped stopped() {
        return [this] {
            add(0);
            return false;
        };
    }
    /// The share of the whole at a share of this.
    Progress within() {
        return [this](double share) { return !*progress_ || (*progress_)(from_ + (to_ - from_) * share); };
    }

  private:
    const Progress* progress_;
    double from_, to_;
    std::size_t parts_ = 0;
    std::atomic<std::size_t> done_ = 0;
};

}  // namespace shlight
