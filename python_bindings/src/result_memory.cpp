// SPDX-License-Identifier: MIT
#include "result_memory.h"

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>

namespace shlight::python {
namespace {

/// Results of this size are kept; numpy itself reuses the memory of smaller ones, and larger ones are given back.
constexpr std::size_t kLeastSize = std::size_t{4} << 20;
constexpr std::size_t kLargestSize = std::size_t{128} << 20;

struct alignas(64) CacheLine {
    std::array<std::byte, 64> bytes;
};

struct Block {
    std::unique_ptr<CacheLine[]> memory;  // NOLINT(modernize-avoid-c-arrays): a vector would write it beforehand
    std::size_t size = 0;                 // in bytes
};

/// The memory of the last result that died.
class LastBlock {
  public:
    /// Never destroyed: arrays may die after everything else.
    static LastBlock& get() {
        static LastBlock& last = *new LastBlock;
        return last;
    }

    Block take(std::size_t bytes) {
        {
            const std::scoped_lock lock(mutex_);
            if (block_.size >= bytes && block_.size / 2 <= bytes) {
                return std::exchange(block_, Block());
            }
        }
        const std::size_t lines = (bytes + sizeof(CacheLine) - 1) / sizeof(CacheLine);
        return {std::make_unique_for_overwrite<CacheLine[]>(lines), bytes};  // NOLINT(modernize-avoid-c-arrays)
    }

    void give_back(Block block) {
        if (block.size <= kLargestSize) {
            const std::scoped_lock lock(mutex_);
            std::swap(block_, block);
        }
    }

  private:
    std::mutex mutex_;
    Block block_;
};

}  // namespace

template <class T>
Array<T> uninitialized(const std::vector<py::ssize_t>& shape) {
    const auto count = std::accumulate(shape.begin(), shape.end(), py::ssize_t{1}, std::multiplies<>());
    const std::size_t bytes = static_cast<std::size_t>(count) * sizeof(T);
    if (bytes < kLeastSize) {
        return Array<T>(shape);
    }
    auto block = std::make_unique<Block>(LastBlock::get().take(bytes));
    const auto* values = reinterpret_cast<const T*>(block->memory.get());
    const py::capsule owner(block.get(), [](void* p) {
        const std::unique_ptr<Block> own(static_cast<Block*>(p));
        LastBlock::get().give_back(std::move(*own));
    });
    static_cast<void>(block.release());  // the capsule has it
    return Array<T>(shape, values, owner);
}

template Array<float> uninitialized(const std::vector<py::ssize_t>& shape);
template Array<double> uninitialized(const std::vector<py::ssize_t>& shape);

}  // namespace shlight::python
