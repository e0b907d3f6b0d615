// SPDX-License-Identifier: MIT
#include "simd/dot_products.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/dot_products.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <array>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// Vectors run along the row. Several sums are kept, because an addition waits for the one before it.
template <class T>
HWY_INLINE T dot_product(const T* a, const T* b, std::size_t size) {
    constexpr std::size_t kSums = 4;
    const Lanes<T> d;
    constexpr std::size_t kStep = kLaneCount<Lanes<T>>;
    std::array<V<Lanes<T>>, kSums> sums = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    std::size_t k = 0;
    for (; k + kSums * kStep <= size; k += kSums * kStep) {
        for (std::size_t s = 0; s < kSums; ++s) {
            sums[s] = hn::MulAdd(hn::LoadU(d, a + k + s * kStep), hn::LoadU(d, b + k + s * kStep), sums[s]);
        }
    }
    for (; k + kStep <= size; k += kStep) {
        sums[0] = hn::MulAdd(hn::LoadU(d, a + k), hn::LoadU(d, b + k), sums[0]);
    }
    const auto pair = hn::Add(hn::Add(sums[0], sums[1]), hn::Add(sums[2], sums[3]));
    T sum = hn::GetLane(hn::SumOfLanes(d, pair));
    for (; k < size; ++k) {
        sum += a[k] * b[k];
    }
    return sum;
}

template <class T>
void dot_products_of(const T* a, const T* b, std::size_t size, std::size_t count, T* values) {
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = dot_product(a + i * size, b + i * size, size);
    }
}

void dot_products_float(const float* a, const float* b, std::size_t size, std::size_t count, float* values) {
    dot_products_of(a, b, size, count, values);
}

void dot_products_double(const double* a, const double* b, std::size_t size, std::size_t count, double* values) {
    dot_products_of(a, b, size, count, values);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(dot_products_float);
HWY_EXPORT(dot_products_double);

void dot_products(const float* a, const float* b, std::size_t size, std::size_t count, float* values) {
    HWY_DYNAMIC_DISPATCH(dot_products_float)(a, b, size, count, values);
}

void dot_products(const double* a, const double* b, std::size_t size, std::size_t count, double* values) {
    HWY_DYNAMIC_DISPATCH(dot_products_double)(a, b, size, count, values);
}

}  // namespace shlight
#endif
