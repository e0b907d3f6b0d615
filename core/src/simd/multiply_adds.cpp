// SPDX-License-Identifier: MIT
#include "simd/multiply_adds.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/multiply_adds.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// More sums than a multiply-add's latency × the number of units that do them; fewer than there are registers.
std::size_t multiply_adds_in_lanes(std::size_t rounds) {
    constexpr std::size_t kSums = 10;
    const Floats d;
    const auto half = all(d, 0.5);
    // Different from the start, or the compiler makes one of them.
    auto a = all(d, 0), b = all(d, 1), c = all(d, 2), e = all(d, 3), f = all(d, 4);
    auto g = all(d, 5), h = all(d, 6), i = all(d, 7), j = all(d, 8), k = all(d, 9);
    for (std::size_t round = 0; round < rounds; ++round) {
        a = hn::MulAdd(a, half, half);
        b = hn::MulAdd(b, half, half);
        c = hn::MulAdd(c, half, half);
        e = hn::MulAdd(e, half, half);
        f = hn::MulAdd(f, half, half);
        g = hn::MulAdd(g, half, half);
        h = hn::MulAdd(h, half, half);
        i = hn::MulAdd(i, half, half);
        j = hn::MulAdd(j, half, half);
        k = hn::MulAdd(k, half, half);
    }
    // All sums tend to 1. That their sum is looked at keeps the compiler from leaving them out.
    const auto sum =
        hn::Add(hn::Add(hn::Add(a, b), hn::Add(c, e)), hn::Add(hn::Add(hn::Add(f, g), hn::Add(h, i)), hn::Add(j, k)));
    const bool finite = hn::GetLane(hn::SumOfLanes(d, sum)) >= 0;
    return finite ? rounds * kSums * hn::Lanes(d) : 0;
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(multiply_adds_in_lanes);

std::size_t multiply_adds(std::size_t rounds) {
    return HWY_DYNAMIC_DISPATCH(multiply_adds_in_lanes)(rounds);
}

}  // namespace shlight
#endif
