// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <utility>

namespace shlight {

/// Values that are costly to make, each made once and shared by all who ask for the same key; the last ones asked for
/// are kept. Thread-safe.
template <class Key, class Value>
class RecentValues {
  public:
    /// room: values that are kept.
    explicit RecentValues(std::size_t room) : room_(room) {}

    /// make(): the value, as a std::shared_ptr.
    template <class Make>
    std::shared_ptr<const Value> get(const Key& key, const Make& make) {
        const std::scoped_lock lock(mutex_);
        const auto known =
            std::find_if(recent_.begin(), recent_.end(), [&](const auto& entry) { return entry.first == key; });
        std::shared_ptr<const Value> value = known != recent_.end() ? known->second : make();
        if (known != recent_.end()) {
            recent_.erase(known);
        }
        recent_.emplace_front(key, value);
        if (recent_.size() > room_) {
            recent_.pop_back();
        }
        return value;
    }

  private:
    std::size_t room_;
    std::mutex mutex_;
    std::deque<std::pair<Key, std::shared_ptr<const Value>>> recent_;  // the last one asked for in front
};

}  // namespace shlight
