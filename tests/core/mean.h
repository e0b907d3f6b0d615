// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

namespace shlight::testing {

/// The mean of values, and its standard error.
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

  private:
    int count_ = 0;
    double mean_ = 0, squares_ = 0;
};

}  // namespace shlight::testing
