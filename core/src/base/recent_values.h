// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace shlight {

/// Values at numbers 0 … count - 1, each made when it is first asked for. Thread-safe.
template <class Value>
class ValuesByNumber {
  public:
    explicit ValuesByNumber(std::size_t count) : entries_(std::make_unique<std::vector<Entry>>(count)) {}

    /// make(): the value at this number, which must not depend on who asks.
    template <class Make>
    const Value& get(std::size_t number, const Make& make) const {
        Entry& entry = (*entries_)[number];
        std::call_once(entry.once, [&] { entry.value.emplace(make()); });
        return *entry.value;
    }

  private:
    struct Entry {
        std::once_flag once;
        std::optional<Value> value;
    };
    std::unique_ptr<std::vector<Entry>> entries_;
};

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
        const std::shared_ptr<Entry> entry = entry_of(key);
        // Outside the mutex: who asks for other keys does not wait.
        std::call_once(entry->once, [&] { entry->value = make(); });
        return entry->value;
    }

  private:
    struct Entry {
        explicit Entry(Key wanted) : key(std::move(wanted)) {}
        Key key;
        std::once_flag once;
        std::shared_ptr<const Value> value;
    };

    std::shared_ptr<Entry> entry_of(const Key& key) {
        const std::scoped_lock lock(mutex_);
        auto known = std::find_if(recent_.begin(), recent_.end(), [&](const auto& entry) { return entry->key == key; });
        if (known == recent_.end()) {
            if (recent_.size() == room_) {
                recent_.pop_back();
            }
            known = recent_.insert(recent_.end(), std::make_shared<Entry>(key));
        }
        std::rotate(recent_.begin(), known, known + 1);
        return recent_.front();
    }

    std::size_t room_;
    std::mutex mutex_;
    std::vector<std::shared_ptr<Entry>> recent_;  // the last one asked for in front
};

}  // namespace shlight
