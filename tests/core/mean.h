// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

namespace shlight::testing {

/// The mean of values, and its distance from a truth in standard errors.
class Mean {
  public:
    void add(double value) {
        ++count_;
        const double step = value - mean_;
        mean_ += step / count_;
        squares_ += step * (value - mean_);
    }
    double mean() const { return mean_; }
    double error() const { return std::sqrt(squares_ / (count_ * (count_ - 1.0))); }
    /// Deviation from a truth that is known to within `slack`, in standard errors.
    double deviation(double truth, double slack = 1e-12) const {
        return std::max(0.0, std::abs(mean_ - truth) - slack) / std::max(error(), 1e-300);
    }

  private:
    int count_ = 0;
    double mean_ = 0, squares_ = 0;
};

constexpr double kFewSigma = 5;

}  // namespace shlight::testing
