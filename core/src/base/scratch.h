// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace shlight {

/// An array that grows without initialising its elements: after clear() they keep their old values.
template <class T>
class Scratch {
  public:
    void clear() { size_ = 0; }
    std::size_t size() const { return size_; }
    /// Appends `count` elements, which the caller must overwrite.
    std::span<T> extend(std::size_t count) {
        if (size_ + count > elements_.size()) {
            elements_.resize(2 * (size_ + count));
        }
        size_ += count;
        return std::span(elements_).subspan(size_ - count, count);
    }
    T& operator[](std::size_t i) { return elements_[i]; }
    const T& operator[](std::size_t i) const { return elements_[i]; }
    std::span<T> all() { return std::span(elements_).first(size_); }
    std::span<const T> all() const { return std::span(elements_).first(size_); }

  private:
    std::vector<T> elements_;
    std::size_t size_ = 0;
};

}  // namespace shlight
