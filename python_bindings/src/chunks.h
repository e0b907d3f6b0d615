// SPDX-License-Identifier: MIT
//
// Batches distributed over threads.
#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstddef>

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

/// work(first, count) over chunks of 0 … total-1, without the GIL.
template <class Work>
void in_chunks(std::size_t total, int threads, const Work& work) {
    const pybind11::gil_scoped_release release;
    const std::size_t size = chunk_of(total);
    const std::size_t chunks = (total + size - 1) / size;
    parallel_for(chunks, threads, [&](std::size_t chunk) {
        const std::size_t first = chunk * size;
        work(first, std::min(size, total - first));
    });
}

}  // namespace shlight::python
