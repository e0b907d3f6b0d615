// SPDX-License-Identifier: MIT
//
// Batches distributed over threads.
#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

#include "gil.h"
#include "shlight/parallel.h"
#include "shlight/types.h"

namespace shlight::python {

/// Number of lights per task: enough to hide the cost of a task and to sort lights, few enough to balance threads.
inline std::size_t chunk_of(std::size_t total) {
    return std::clamp<std::size_t>(total / 32, 256, 2048);
}

/// The faster way to write a result of this size: one larger than a core's cache bypasses the caches.
inline Output output_of(std::size_t bytes) {
    return bytes > (std::size_t{2} << 20) ? Output::streamed : Output::cached;
}

/// An argument's wrong row of a batch, counted in the flat arrays; in Python a ValueError of the text and the row,
/// which shlight/_arrays.py turns into one with the index.
class WrongRow : public std::invalid_argument {
  public:
    WrongRow(const std::string& text, std::size_t row) : std::invalid_argument(text), row_(row) {}
    std::size_t row() const { return row_; }

  private:
    std::size_t row_;
};

/// The first wrong row of a batch that several threads look through.
class FirstWrongRow {
  public:
    /// Whether all rows from this one on can be left out.
    bool is_before(std::size_t row) const { return row_ <= row; }

    /// Runs work(first, count), and finds the row where it throws std::invalid_argument.
    template <class Work>
    void look(std::size_t first, std::size_t count, const Work& work) {
        try {
            work(first, count);
        } catch (const std::invalid_argument& error) {
            if (count == 1) {
                note(first, error.what());
                return;
            }
            for (std::size_t row = first; row < first + count && !is_before(row); ++row) {
                look(row, 1, work);
            }
        }
    }

    void rethrow() const {
        if (!text_.empty()) {
            throw WrongRow(text_, row_);
        }
    }

  private:
    void note(std::size_t row, const char* text) {
        const std::lock_guard lock(mutex_);
        if (row < row_) {
            row_ = row;
            text_ = text;
        }
    }

    std::mutex mutex_;
    std::atomic<std::size_t> row_ = std::numeric_limits<std::size_t>::max();
    std::string text_;
};

/// Throws what a signal's handler raises, such as KeyboardInterrupt.
inline void check_signals() {
    throw_at_end();
    const pybind11::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) {
        throw pybind11::error_already_set();
    }
}

/// Looks for signals now and then, from the one thread that Python lets do so: that which called, as it works too.
class SignalWatch {
  public:
    void look() {
        if (is_due()) {
            check_signals();
        }
    }
    /// Whether the thread that called asks, and did not just before.
    bool is_due() {
        if (std::this_thread::get_id() != caller_) {
            return false;
        }
        const Clock::time_point now = Clock::now();
        const bool is_late = now - last_ >= kBetweenLooks;
        last_ = is_late ? now : last_;
        return is_late;
    }

  private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds kBetweenLooks{20};

    std::thread::id caller_ = std::this_thread::get_id();
    Clock::time_point last_ = Clock::now();
};

/// work(first, count) over chunks of 0 … total-1, without the GIL. Ctrl-C ends it between chunks. Throws WrongRow for
/// the first row that work throws std::invalid_argument for. size: of chunks; 0: chunk_of(total).
template <class Work>
void in_chunks(std::size_t total, int threads, const Work& work, std::size_t size = 0) {
    const GilReleased release;
    size = size > 0 ? size : chunk_of(total);
    FirstWrongRow wrong;
    SignalWatch signals;
    parallel_for((total + size - 1) / size, threads, [&](std::size_t chunk) {
        signals.look();
        const std::size_t first = chunk * size;
        if (!wrong.is_before(first)) {
            wrong.look(first, std::min(size, total - first), work);
        }
    });
    wrong.rethrow();
}

}  // namespace shlight::python
