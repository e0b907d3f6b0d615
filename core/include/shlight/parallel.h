// SPDX-License-Identifier: MIT
//
// Work spread over cores, with progress, cancellation and exceptions that reach the caller.
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>

namespace shlight {

/// Thrown where a callback asked to stop.
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

/// Long work's line to the thread that waits for it.
struct Watch {
    Stopped stopped;
    std::function<void()> look;  ///< has the waiting thread look at once, and returns when it has; may be empty
};

/// Runs long work on a thread of its own, as run_in_arena does. The calling thread calls `look` first, then every 10 ms
/// and when the work asks for it, until the work ends. Without `look` the work runs on the calling thread. Throws what
/// work and look throw, and RenderCancelled after look has returned false; the work has ended by then.
void run_watched(int threads, const std::function<void(const Watch&)>& work, const std::function<bool()>& look);

/// Runs body(i) once for each i < count, in any order, on at most `threads` threads, 0: all cores. The calling thread
/// takes part.
/// Throws std::invalid_argument for threads < 0, and what body throws; by then no body runs.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

}  // namespace shlight
