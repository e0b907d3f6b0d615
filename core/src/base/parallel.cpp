// SPDX-License-Identifier: MIT
#include "shlight/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
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

/// Watched work on its thread.
class WatchedWork {
  public:
    WatchedWork(int threads, const std::function<void(const Watch&)>& work)
        : thread_([this, threads, &work] { run(threads, work); }) {}
    WatchedWork(const WatchedWork&) = delete;
    WatchedWork& operator=(const WatchedWork&) = delete;
    ~WatchedWork() {
        {
            const std::lock_guard lock(mutex_);
            stopped_ = true;
        }
        changed_.notify_all();
        thread_.join();
    }

    /// Waits until there is something to look at; false: the work has ended.
    bool goes_on() {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, kInterval, [this] { return is_over_ || asked_ > answered_; });
        looked_at_ = asked_;
        return !is_over_;
    }
    void has_looked() {
        {
            const std::lock_guard lock(mutex_);
            answered_ = looked_at_;
        }
        changed_.notify_all();
    }
    void rethrow() const {
        if (error_) {
            std::rethrow_exception(error_);
        }
    }

  private:
    void run(int threads, const std::function<void(const Watch&)>& work) {
        const Watch watch = {[this] { return stopped_.load(); }, [this] { ask(); }};
        std::exception_ptr error;
        try {
            run_in_arena(threads, [&] { work(watch); });
        } catch (...) {
            error = std::current_exception();
        }
        const std::lock_guard lock(mutex_);
        error_ = error;
        is_over_ = true;
        changed_.notify_all();
    }
    void ask() {
        std::unique_lock lock(mutex_);
        const std::uint64_t number = ++asked_;
        changed_.notify_all();
        // A plain wait() is a function of libstdc++ 12, which Red Hat 9, the platform of studios, lacks.
        while (!changed_.wait_for(lock, kInterval, [&] { return answered_ >= number || stopped_; })) {
        }
    }

    std::atomic<bool> stopped_ = false;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::uint64_t asked_ = 0, looked_at_ = 0, answered_ = 0;
    bool is_over_ = false;
    std::exception_ptr error_;
    std::thread thread_;  // last: it uses all the others
};

/// The calling thread's arena for so many threads. It is kept, since workers find their way to a fresh one as slowly as
/// they wake.
tbb::task_arena& arena_of(int threads) {
    thread_local std::map<int, tbb::task_arena> arenas;
    return arenas.try_emplace(threads, threads).first->second;
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

void run_watched(int threads, const std::function<void(const Watch&)>& work, const std::function<bool()>& look) {
    if (!look) {
        run_in_arena(threads, [&] { work({}); });
        return;
    }
    const auto check = [&] {
        if (!look()) {
            throw RenderCancelled();
        }
    };
    check();
    WatchedWork watched(threads, work);
    while (watched.goes_on()) {
        check();
        watched.has_looked();
    }
    watched.rethrow();
}

/// One thread needs no scheduler: small batches of lights take less time than a thread takes to start.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
    if (count > 1 && threads != 1) {
        run_in_arena(threads, [&] { tbb::parallel_for(std::size_t{0}, count, body, tbb::simple_partitioner()); });
        return;
    }
    check_threads(threads);
    for (std::size_t i = 0; i < count; ++i) {
        body(i);
    }
}

}  // namespace shlight
