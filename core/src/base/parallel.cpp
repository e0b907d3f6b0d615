// SPDX-License-Identifier: MIT
#include "shlight/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <thread>

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

namespace shlight {
namespace {

constexpr auto kInterval = std::chrono::milliseconds(10);

void check_threads(int threads) {
    if (threads < 0) {
        throw std::invalid_argument("threads must not be negative");
    }
}

/// The work of one parallel_for, on a thread of its own so that the caller is free to report.
class Work {
  public:
    Work(std::size_t count, int threads, const std::function<void(std::size_t)>& body)
        : count_(count), thread_([this, threads, &body] { run(threads, body); }) {}
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;
    ~Work() {
        cancel();
        thread_.join();
    }

    /// Whether the work has ended within the interval.
    bool wait() {
        std::unique_lock lock(mutex_);
        return ended_.wait_for(lock, kInterval, [this] { return over_; });
    }

    void cancel() { cancelled_ = true; }
    double share() const { return static_cast<double>(done_) / static_cast<double>(count_); }
    void rethrow() const {
        if (error_) {
            std::rethrow_exception(error_);
        }
    }

  private:
    void run(int threads, const std::function<void(std::size_t)>& body) {
        std::exception_ptr error;
        try {
            run_in_arena(threads, [&] {
                const auto step = [&](std::size_t i) {
                    if (!cancelled_) {
                        body(i);
                        ++done_;
                    }
                };
                tbb::parallel_for(std::size_t{0}, count_, step, tbb::simple_partitioner());
            });
        } catch (...) {
            error = std::current_exception();
        }
        const std::lock_guard lock(mutex_);
        error_ = error;
        over_ = true;
        ended_.notify_all();
    }

    const std::size_t count_;
    std::atomic<std::size_t> done_ = 0;
    std::atomic<bool> cancelled_ = false;
    std::mutex mutex_;
    std::condition_variable ended_;
    bool over_ = false;
    std::exception_ptr error_;
    std::thread thread_;  // last: it uses all the others
};

/// The calling thread's own for so many threads. It is kept: workers find the way to a fresh one as slowly as they
/// wake.
tbb::task_arena& arena_of(int threads) {
    thread_local std::map<int, tbb::task_arena> arenas;
    return arenas.try_emplace(threads, threads).first->second;
}

/// Without anything to report the caller takes part, and what one thread does needs no scheduler: small batches of
/// lights take less time than a thread takes to start.
void run_unwatched(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
    if (count > 1 && threads != 1) {
        run_in_arena(threads, [&] { tbb::parallel_for(std::size_t{0}, count, body, tbb::simple_partitioner()); });
        return;
    }
    check_threads(threads);
    for (std::size_t i = 0; i < count; ++i) {
        body(i);
    }
}

}  // namespace

void run_in_arena(int threads, const std::function<void()>& work) {
    check_threads(threads);
    // Limited to the machine's cores, because oneTBB warns about more threads.
    const int cores = tbb::info::default_concurrency();
    arena_of(threads == 0 ? cores : std::min(threads, cores)).execute(work);
}

void end_if(const Stopped& stopped) {
    if (stopped && stopped()) {
        throw RenderCancelled();
    }
}

void run_watched(int threads, const std::function<void(const Stopped&)>& work, const Progress& progress) {
    if (!progress) {
        run_in_arena(threads, [&] { work({}); });
        return;
    }
    std::atomic<bool> stopped = false;
    const auto ask = [&](double) {
        try {
            stopped = !progress(0);
        } catch (...) {
            stopped = true;
            throw;
        }
        return !stopped;
    };
    parallel_for(
        1, threads, [&](std::size_t) { work([&] { return stopped.load(); }); }, ask);
}

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body,
                  const Progress& progress) {
    if (!progress) {
        run_unwatched(count, threads, body);
        return;
    }
    if (count > 0) {
        Work work(count, threads, body);
        while (!work.wait()) {
            if (!progress(work.share())) {
                throw RenderCancelled();
            }
        }
        work.rethrow();
    }
    if (!progress(1.0)) {
        throw RenderCancelled();
    }
}

}  // namespace shlight
