// SPDX-License-Identifier: MIT
//
// Rows of coefficients come out the same whichever way they reach memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "random_input.h"
#include "shlight/basis.h"
#include "shlight/cap.h"
#include "shlight/sphere_gradient.h"
#include "simd/targets.h"

namespace shlight {
namespace {

using testing::RandomInput;

constexpr std::size_t kLights = 37;  // no whole number of vectors

/// Numbers that begin `offset` of them after the beginning of a cache line, with others on both sides.
template <class T>
class Memory {
  public:
    Memory(std::size_t count, std::size_t offset) : all_(count + 2 * kLine + offset, kUnwritten) {
        void* first = all_.data() + 1;
        std::size_t space = (all_.size() - 1) * sizeof(T);
        values_ = {static_cast<T*>(std::align(64, count * sizeof(T), first, space)) + offset, count};
    }
    std::span<T> values() const { return values_; }
    /// How many of those around it were written to.
    std::size_t spoilt() const {
        std::size_t count = 0;
        for (const T& value : all_) {
            const bool is_inside = &value >= values_.data() && &value < values_.data() + values_.size();
            count += !is_inside && value != kUnwritten ? 1 : 0;
        }
        return count;
    }

  private:
    static constexpr std::size_t kLine = 64 / sizeof(T);
    static constexpr T kUnwritten = -12345;
    std::vector<T> all_;
    std::span<T> values_;
};

template <class T>
class Rows : public ::testing::Test {};
using Types = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Rows, Types);

template <class T>
void expect_same_however_written(int order, const std::function<void(std::span<T>, Output)>& compute) {
    const std::size_t count = kLights * static_cast<std::size_t>(coefficient_count(order));
    std::vector<T> cached(count, std::numeric_limits<T>::quiet_NaN());
    compute(cached, Output::cached);
    for (const std::size_t offset : {0, 1}) {
        const Memory<T> memory(count, offset);
        compute(memory.values(), Output::streamed);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < count; ++i) {
            wrong += memory.values()[i] == cached[i] ? 0 : 1;  // a NaN is wrong
        }
        EXPECT_EQ(wrong, 0U) << "order " << order << ", offset " << offset;
        EXPECT_EQ(memory.spoilt(), 0U) << "order " << order << ", offset " << offset;
    }
}

TYPED_TEST(Rows, AreTheSameCachedAndStreamed) {
    using T = TypeParam;
    RandomInput random(1);
    std::vector<Vec3<T>> directions;
    std::vector<T> radii;
    for (std::size_t i = 0; i < kLights; ++i) {
        directions.emplace_back(i % 6 == 0 ? random.at_tilt(1e-4) : random.direction());
        radii.push_back(static_cast<T>(random.log_uniform(1e-3, 0.99)));
    }
    for (const std::string& target : kernel_targets()) {
        SCOPED_TRACE(target);
        const ForcedKernelTarget forced(target);
        for (const int order : {1, 3, 4, 8, 12, 16, 20, 31, 32, 33, 36, 48, 60, 64}) {
            expect_same_however_written<T>(
                order, [&](std::span<T> out, Output output) { sh_basis<T>(directions, order, out, output); });
            for (const bool clip : {true, false}) {
                expect_same_however_written<T>(order, [&](std::span<T> out, Output output) {
                    sphere_coefficients<T>(directions, radii, order, clip, out, output);
                });
            }
        }
    }
}

TYPED_TEST(Rows, AreThoseOfLightsAlone) {
    using T = TypeParam;
    constexpr std::size_t kMany = 5000;  // more than the core works on at once
    constexpr int kOrder = 3;
    constexpr std::size_t kRow = coefficient_count(kOrder);
    RandomInput random(2);
    std::vector<Vec3<T>> centers;
    for (std::size_t i = 0; i < kMany; ++i) {
        centers.emplace_back(random.direction());
    }
    const std::vector<T> radii(kMany, T{0.5});
    std::vector<T> all(kMany * kRow);
    sphere_coefficients<T>(centers, radii, kOrder, true, all);
    std::vector<T> same(all.size());
    std::vector<T> by_center(3 * all.size());
    std::vector<T> by_radius(all.size());
    sphere_coefficients_gradient<T>(centers, radii, kOrder, true, same, by_center, by_radius);
    EXPECT_EQ(all, same);
    const auto expect_row = [&](std::span<const T> alone, std::span<const T> rows, std::size_t light) {
        EXPECT_TRUE(std::ranges::equal(alone, rows.subspan(light * alone.size(), alone.size()))) << light;
    };
    for (std::size_t i = 0; i < kMany; i += 77) {
        const auto center = std::span(centers).subspan(i, 1);
        const auto radius = std::span(radii).first(1);
        std::array<T, kRow> alone;
        std::array<T, 3 * kRow> own_by_center;
        std::array<T, kRow> own_by_radius;
        sphere_coefficients<T>(center, radius, kOrder, true, alone);
        expect_row(alone, all, i);
        sphere_coefficients_gradient<T>(center, radius, kOrder, true, alone, own_by_center, own_by_radius);
        expect_row(own_by_center, by_center, i);
        expect_row(own_by_radius, by_radius, i);
    }
}

}  // namespace
}  // namespace shlight
