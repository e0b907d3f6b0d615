// SPDX-License-Identifier: MIT
#include "gil.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "shlight/parallel.h"

namespace shlight::python {

namespace py = pybind11;

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kLongestEnd{5};  // what a callback that does not return may cost
constexpr std::chrono::milliseconds kBetweenCounts{5};

// Changed by threads that hold the GIL, so that none begins a call unseen by the one that ends Python.
std::atomic<int> running_calls = 0;
std::atomic<std::thread::id> ending_thread;

bool is_stranded() {
    const std::thread::id ending = ending_thread;
    return ending != std::thread::id() && ending != std::this_thread::get_id();
}

[[noreturn]] void stay() {
    --running_calls;
    while (true) {
        std::this_thread::sleep_for(std::chrono::hours(1));
    }
}

void end_calls() {
    ending_thread = std::this_thread::get_id();
    const py::gil_scoped_release release;
    const Clock::time_point latest = Clock::now() + kLongestEnd;
    while (running_calls > 0 && Clock::now() < latest) {
        std::this_thread::sleep_for(kBetweenCounts);
    }
}

}  // namespace

GilReleased::GilReleased() {
    ++running_calls;
    state_ = PyEval_SaveThread();
    if (is_stranded()) {
        stay();
    }
}

GilReleased::~GilReleased() {
    if (is_stranded()) {
        stay();
    }
    PyEval_RestoreThread(state_);
    --running_calls;
}

void throw_at_end() {
    if (is_stranded()) {
        throw RenderCancelled();
    }
}

void wait_at_end() {
    py::module_::import("atexit").attr("register")(py::cpp_function(&end_calls));
}

}  // namespace shlight::python
