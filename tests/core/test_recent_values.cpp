// SPDX-License-Identifier: MIT
//
// Values that threads share: each is made once, no other waits for it, and the last ones asked for are kept.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "base/recent_values.h"

namespace shlight {
namespace {

TEST(RecentValues, OneKeyDoesNotWaitForAnother) {
    RecentValues<int, int> recent(4);
    std::promise<void> other_made;
    std::future_status status = std::future_status::deferred;
    std::thread first([&] {
        recent.get(1, [&] {
            std::thread other([&] {
                recent.get(2, [&] {
                    other_made.set_value();
                    return std::make_shared<const int>(2);
                });
            });
            status = other_made.get_future().wait_for(std::chrono::seconds(10));
            other.detach();
            return std::make_shared<const int>(1);
        });
    });
    first.join();
    EXPECT_EQ(status, std::future_status::ready);
    EXPECT_EQ(*recent.get(2, [] { return std::make_shared<const int>(3); }), 2);
}

TEST(RecentValues, AreMadeOnceForAllThreads) {
    RecentValues<int, int> recent(4);
    std::atomic<int> made = 0;
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
        threads.emplace_back([&] {
            for (int key = 0; key < 4; ++key) {
                EXPECT_EQ(*recent.get(key,
                                      [&] {
                                          ++made;
                                          return std::make_shared<const int>(key);
                                      }),
                          key);
            }
        });
    }
    for (std::thread& thread : threads) {
        thread.join();
    }
    EXPECT_EQ(made, 4);
}

TEST(RecentValues, KeepTheLastOnesAskedFor) {
    RecentValues<int, int> recent(2);
    int made = 0;
    const auto ask = [&](int key) { recent.get(key, [&] { return std::make_shared<const int>(++made); }); };
    for (const int key : {1, 2, 1, 3, 1}) {
        ask(key);
    }
    EXPECT_EQ(made, 3);
    ask(2);
    EXPECT_EQ(made, 4);
    ask(3);
    ask(2);
    EXPECT_EQ(made, 5);
}

TEST(RecentValues, AreMadeAgainAfterAnException) {
#ifdef __SANITIZE_THREAD__
    GTEST_SKIP() << "the sanitizer's pthread_once waits for ever after an exception";
#endif
    RecentValues<int, int> recent(2);
    EXPECT_THROW(recent.get(1, []() -> std::shared_ptr<const int> { throw std::runtime_error("none"); }),
                 std::runtime_error);
    EXPECT_EQ(*recent.get(1, [] { return std::make_shared<const int>(5); }), 5);
}

}  // namespace
}  // namespace shlight
