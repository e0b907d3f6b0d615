// SPDX-License-Identifier: MIT
//
// Work spread over cores, with progress, cancellation and exceptions that reach the caller.
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>

namespace shlight {

/// Thrown where a progress callback asked to stop.
class RenderCancelled : public std::runtime_error {
  public:
    RenderCancelled() : std::runtime_error("the render was cancelled") {}
};

/// Is told the finished share, 0 … 1, never falling; returns false to cancel.
using Progress = std::function<bool(double)>;

/// Asked by long work, from any thread: whether it is to end early. Empty: never.
using Stopped = std::function<bool()>;

/// Throws RenderCancelled if the work is to end.
void end_if(const Stopped& stopped);

/// Runs `work` where parallel calls use at most `threads` threads, 0: all cores.
/// Throws std::invalid_argument for threads < 0, and what work throws.
void run_in_arena(int threads, const std::function<void()>& work);

/// The same for long work of unknown length. With `progress` the calling thread waits and calls it with 0, about every
/// 10 ms and at the end; once it has returned false or thrown, `work` is told so by what it is given.
/// Throws as parallel_for does.
void run_watched(int threads, const std::function<void(const Stopped&)>& work, const Progress& progress);

/// Runs body(i) once for each i < count, in any order, on at most `threads` threads, 0: all cores.
/// With `progress` the calling thread waits and calls it about every 10 ms and once at the end; work goes on meanwhile.
/// Without, it takes part.
/// Throws RenderCancelled after progress has returned false, and what body or progress throw; by then no body runs.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body,
                  const Progress& progress = {});

}  // namespace shlight
