// SPDX-License-Identifier: MIT
//
// Errors of many inputs: their median and maximum, printed and recorded with the test's result.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace shlight::testing {

class ErrorRecord {
  public:
    explicit ErrorRecord(std::size_t count) : errors_(count, 0.0) {}

    double& operator[](std::size_t i) { return errors_[i]; }  ///< one writer for each index: no lock is needed

    /// NaN counts as infinite.
    double largest() const { return *std::max_element(errors_.begin(), errors_.end(), below); }
    std::size_t worst() const {
        return static_cast<std::size_t>(std::max_element(errors_.begin(), errors_.end(), below) - errors_.begin());
    }
    double median() const {
        std::vector<double> sorted = errors_;
        std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end(),
                         below);
        return sorted[sorted.size() / 2];
    }
    /// Prints one line and keeps it in the test's XML report.
    void publish(const std::string& name) const {
        std::array<char, 120> text{};
        std::snprintf(text.data(), text.size(), "%5zu inputs, median %.1e, largest %.1e", errors_.size(), median(),
                      largest());
        std::printf("%-44s %s\n", name.c_str(), text.data());
        ::testing::Test::RecordProperty(name, text.data());
    }

  private:
    static double key(double error) { return std::isnan(error) ? std::numeric_limits<double>::infinity() : error; }
    static bool below(double a, double b) { return key(a) < key(b); }

    std::vector<double> errors_;
};

/// work(i) for 0 ≤ i < count on two threads. `work` must not throw or use GoogleTest's assertions.
inline void on_two_threads(std::size_t count, const std::function<void(std::size_t)>& work) {
    std::atomic<std::size_t> next = 0;
    const auto run = [&] {
        for (std::size_t i = next++; i < count; i = next++) {
            work(i);
        }
    };
    std::thread other(run);
    run();
    other.join();
}

/// Whether the long versions of the tests are wanted: SHLIGHT_ALL=1.
inline bool all_tests() {
    const char* value = std::getenv("SHLIGHT_ALL");
    return value != nullptr && std::string(value) == "1";
}

}  // namespace shlight::testing
