// SPDX-License-Identifier: MIT
#include "caps/cap_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "caps/sound_spheres.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

template <class T>
bool sound(const Vec3<T>* centers, const T* radii, std::size_t count) {
    const Lanes<T> d;
    constexpr std::size_t kLanes = kLaneCount<Lanes<T>>;
    auto fine = hn::Eq(hn::Zero(d), hn::Zero(d));
    const auto check = [&](const T* c, const T* radius) HWY_ATTR {
        V<Lanes<T>> x, y, z;
        hn::LoadInterleaved3(d, c, x, y, z);
        const auto r = hn::LoadU(d, radius);
        const auto square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
        // NaN and infinity fail one of these; squares that underflow or that are near to r² are left to the exact test.
        fine = hn::And(fine, hn::Gt(r, hn::Zero(d)));
        fine = hn::And(fine, hn::Gt(square, hn::Set(d, std::numeric_limits<T>::min() * T(1e6))));
        fine = hn::And(fine, hn::Lt(square, hn::Set(d, std::numeric_limits<T>::max())));
        fine = hn::And(fine, hn::Ge(square, hn::Mul(hn::Mul(r, r), all(d, 1 + 1e-6))));
    };
    std::size_t first = 0;
    for (; first + kLanes <= count; first += kLanes) {
        check(&centers[first].x, radii + first);
    }
    if (first < count) {
        std::array<Vec3<T>, kLanes> c;
        std::array<T, kLanes> r;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            c[lane] = centers[std::min(first + lane, count - 1)];
            r[lane] = radii[std::min(first + lane, count - 1)];
        }
        check(&c[0].x, r.data());
    }
    return hn::AllTrue(d, fine);
}

bool sound_float(const Vec3<float>* centers, const float* radii, std::size_t count) {
    return sound(centers, radii, count);
}
bool sound_double(const Vec3<double>* centers, const double* radii, std::size_t count) {
    return sound(centers, radii, count);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(sound_float);
HWY_EXPORT(sound_double);

bool spheres_are_sound(const Vec3<float>* centers, const float* radii, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(sound_float)(centers, radii, count);
}
bool spheres_are_sound(const Vec3<double>* centers, const double* radii, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(sound_double)(centers, radii, count);
}

}  // namespace shlight
#endif
