// SPDX-License-Identifier: MIT
#include "result_memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <mutex>
#include <new>
#include <numeric>

namespace shlight::python {
namespace {

/// Results from this size on are kept; smaller ones are numpy's own affair, which reuses them anyway.
constexpr std::size_t kLeastSize = std::size_t{4} << 20;
constexpr std::size_t kHugePage = std::size_t{2} << 20;

struct Block {
    void* memory;
    std::size_t size;
    bool is_free_to_take = false;  // by the system, which may or may not have done so
};

Block fresh_block(std::size_t bytes) {
    const std::size_t size = (bytes + kHugePage - 1) / kHugePage * kHugePage;
    void* memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        throw std::bad_alloc();
    }
    madvise(memory, size, MADV_HUGEPAGE);  // where the system has none, small pages do
    return {memory, size};
}

std::size_t machine_memory() {
    const auto pages = static_cast<std::size_t>(std::max(0L, sysconf(_SC_PHYS_PAGES)));
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// Blocks of dead results, the last one returned in front.
class Waiting {
  public:
    /// Never destroyed: arrays may die after everything else.
    static Waiting& get() {
        static Waiting& waiting = *new Waiting;
        return waiting;
    }

    Block take(std::size_t bytes) {
        const std::scoped_lock lock(mutex_);
        const auto found = std::find_if(blocks_.begin(), blocks_.end(), [&](const Block& block) {
            return block.size >= bytes && block.size / 2 <= std::max(bytes, kHugePage);
        });
        if (found == blocks_.end()) {
            return fresh_block(bytes);
        }
        const Block block{found->memory, found->size};
        size_ -= block.size;
        blocks_.erase(found);
        return block;
    }

    void give_back(const Block& block) {
        const std::scoped_lock lock(mutex_);
        blocks_.insert(blocks_.begin(), block);
        size_ += block.size;
        while (size_ > most_waiting_) {
            size_ -= blocks_.back().size;
            munmap(blocks_.back().memory, blocks_.back().size);
            blocks_.pop_back();
        }
        free_all_but_latest();
    }

  private:
    /// Not the latest: each time the other cores must forget where the pages were, and come back to them slowly.
    void free_all_but_latest() {
        std::size_t latest = 0;
        for (Block& block : blocks_) {
            latest += block.size;
            if (latest > most_kept_ && !block.is_free_to_take) {
                madvise(block.memory, block.size, MADV_FREE);
                block.is_free_to_take = true;
            }
        }
    }

    std::mutex mutex_;
    std::vector<Block> blocks_;
    std::size_t size_ = 0;
    std::size_t most_waiting_ = machine_memory() / 8;
    std::size_t most_kept_ = machine_memory() / 32;
};

}  // namespace

template <class T>
Array<T> uninitialized(const std::vector<py::ssize_t>& shape) {
    const auto count = std::accumulate(shape.begin(), shape.end(), py::ssize_t{1}, std::multiplies<>());
    const std::size_t bytes = static_cast<std::size_t>(count) * sizeof(T);
    if (bytes < kLeastSize) {
        return Array<T>(shape);
    }
    const Block block = Waiting::get().take(bytes);
    const py::capsule owner(new Block(block), [](void* p) {
        const auto* own = static_cast<Block*>(p);
        Waiting::get().give_back(*own);
        delete own;
    });
    return Array<T>(shape, static_cast<const T*>(block.memory), owner);
}

template Array<float> uninitialized(const std::vector<py::ssize_t>& shape);
template Array<double> uninitialized(const std::vector<py::ssize_t>& shape);

}  // namespace shlight::python
