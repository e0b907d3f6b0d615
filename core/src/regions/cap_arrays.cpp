// SPDX-License-Identifier: MIT
#include "regions/cap_arrays.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "regions/cap_arrays.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "regions/cap_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr std::size_t kLanes = kLaneCount<Doubles>;

/// Writes whole vectors, to arrays that lie `stride` apart.
template <class T>
void caps_of(const Vec3<T>* centers, const T* radii, std::size_t count, double* members, std::size_t stride) {
    const Doubles d;
    const hn::Rebind<T, Doubles> own;
    const auto widened = [&](V<decltype(own)> v) HWY_ATTR {
        if constexpr (sizeof(T) == 4) {
            return hn::PromoteTo(d, v);
        } else {
            return v;
        }
    };
    for (std::size_t first = 0; first < count; first += kLanes) {
        const Vec3<T>* c = centers + first;
        const T* r = radii + first;
        std::array<Vec3<T>, kLanes> last_centers;
        std::array<T, kLanes> last_radii;
        if (first + kLanes > count) {
            std::fill(std::copy(c, centers + count, last_centers.begin()), last_centers.end(), *c);
            std::fill(std::copy(r, radii + count, last_radii.begin()), last_radii.end(), *r);
            c = last_centers.data();
            r = last_radii.data();
        }
        V<decltype(own)> x, y, z;
        hn::LoadInterleaved3(own, &c->x, x, y, z);
        const auto circle = cap_of_sphere_in_lanes<T>(widened(x), widened(y), widened(z), widened(hn::LoadU(own, r)));
        const auto store = [&](std::size_t k, V<Doubles> v)
                               HWY_ATTR { hn::StoreU(v, d, members + k * stride + first); };
        store(0, circle.x);
        store(1, circle.y);
        store(2, circle.z);
        store(3, circle.cosine);
        store(4, circle.sine);
        store(5, circle.crossing_squared);
    }
}

/// The number of spheres, from the first on, that check_sphere accepts beyond doubt.
template <class T>
std::size_t sound(const Vec3<T>* centers, const T* radii, std::size_t count) {
    const Lanes<T> d;
    std::size_t first = 0;
    for (; first + kLaneCount<Lanes<T>> <= count; first += kLaneCount<Lanes<T>>) {
        V<Lanes<T>> x, y, z;
        hn::LoadInterleaved3(d, &centers[first].x, x, y, z);
        const auto r = hn::LoadU(d, radii + first);
        const auto square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
        const auto rest = hn::NegMulAdd(hn::Mul(r, r), all(d, 1 + 1e-6), square);
        // NaN and infinity fail one of these, and so do squares that underflow or that are near to r².
        const auto outside = hn::And(hn::Gt(rest, hn::Set(d, std::numeric_limits<T>::min() * T(1e6))),
                                     hn::Le(rest, hn::Set(d, std::numeric_limits<T>::max())));
        if (!hn::AllTrue(d, hn::And(outside, hn::Gt(r, hn::Zero(d))))) {
            break;
        }
    }
    return first;
}

std::size_t sound_float(const Vec3<float>* centers, const float* radii, std::size_t count) {
    return sound(centers, radii, count);
}
std::size_t sound_double(const Vec3<double>* centers, const double* radii, std::size_t count) {
    return sound(centers, radii, count);
}
void caps_of_float(const Vec3<float>* centers, const float* radii, std::size_t count, double* members,
                   std::size_t stride) {
    caps_of(centers, radii, count, members, stride);
}
void caps_of_double(const Vec3<double>* centers, const double* radii, std::size_t count, double* members,
                    std::size_t stride) {
    caps_of(centers, radii, count, members, stride);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(sound_float);
HWY_EXPORT(sound_double);
HWY_EXPORT(caps_of_float);
HWY_EXPORT(caps_of_double);

std::size_t sound_spheres(const Vec3<float>* centers, const float* radii, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(sound_float)(centers, radii, count);
}
std::size_t sound_spheres(const Vec3<double>* centers, const double* radii, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(sound_double)(centers, radii, count);
}

void CapBatch::set_spheres(std::span<const Vec3<float>> centers, const float* radii) {
    resize(centers.size());
    HWY_DYNAMIC_DISPATCH(caps_of_float)(centers.data(), radii, centers.size(), members_.data(), stride_);
}
void CapBatch::set_spheres(std::span<const Vec3<double>> centers, const double* radii) {
    resize(centers.size());
    HWY_DYNAMIC_DISPATCH(caps_of_double)(centers.data(), radii, centers.size(), members_.data(), stride_);
}

}  // namespace shlight
#endif
