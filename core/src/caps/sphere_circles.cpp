// SPDX-License-Identifier: MIT
#include "caps/cap_shading.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "caps/sphere_circles.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "caps/cap_spheres-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr std::size_t kHalf = kLaneCount<Doubles>;

template <class T>
struct SphereLanes {
    V<Doubles> x, y, z, r;
};

/// kHalf spheres.
template <class T>
HWY_INLINE SphereLanes<T> load_spheres(const Vec3<T>* centers, const T* radii) {
    const Doubles d;
    const hn::Rebind<T, Doubles> own;
    V<decltype(own)> x, y, z;
    hn::LoadInterleaved3(own, &centers->x, x, y, z);
    const auto r = hn::LoadU(own, radii);
    if constexpr (sizeof(T) == 4) {
        return {hn::PromoteTo(d, x), hn::PromoteTo(d, y), hn::PromoteTo(d, z), hn::PromoteTo(d, r)};
    } else {
        return {x, y, z, r};
    }
}

template <class T>
HWY_INLINE CircleLanes<Doubles> circle_of(const SphereLanes<T>& sphere) {
    if constexpr (sizeof(T) == 4) {
        return circle_of_floats(sphere.x, sphere.y, sphere.z, sphere.r);
    } else {
        return circle_of_sphere_in_lanes(Doubles(), sphere.x, sphere.y, sphere.z, sphere.r);
    }
}

template <class T>
void circles_in_lanes(const Vec3<T>* centers, const T* radii, std::size_t count, const CircleOutput& out) {
    const Doubles d;
    const auto write = [&](const CircleLanes<Doubles>& circle, const CircleOutput& o) HWY_ATTR {
        hn::StoreU(circle.x, d, o.x);
        hn::StoreU(circle.y, d, o.y);
        hn::StoreU(circle.z, d, o.z);
        hn::StoreU(circle.cosine, d, o.cosine);
        hn::StoreU(circle.sine, d, o.sine);
    };
    std::size_t first = 0;
    for (; first + kHalf <= count; first += kHalf) {
        write(circle_of<T>(load_spheres(centers + first, radii + first)),
              {out.x + first, out.y + first, out.z + first, out.cosine + first, out.sine + first});
    }
    if (first == count) {
        return;
    }
    std::array<Vec3<T>, kHalf> last_centers;
    std::array<T, kHalf> last_radii;
    std::fill(std::copy(centers + first, centers + count, last_centers.begin()), last_centers.end(), centers[first]);
    std::fill(std::copy(radii + first, radii + count, last_radii.begin()), last_radii.end(), radii[first]);
    std::array<std::array<double, kHalf>, 5> fields;
    write(circle_of<T>(load_spheres(last_centers.data(), last_radii.data())),
          {fields[0].data(), fields[1].data(), fields[2].data(), fields[3].data(), fields[4].data()});
    const std::array<double*, 5> arrays = {out.x, out.y, out.z, out.cosine, out.sine};
    for (std::size_t k = 0; k < arrays.size(); ++k) {
        std::copy_n(fields[k].begin(), count - first, arrays[k] + first);
    }
}

void circles_of_float(const Vec3<float>* centers, const float* radii, std::size_t count, const CircleOutput& out) {
    circles_in_lanes(centers, radii, count, out);
}
void circles_of_double(const Vec3<double>* centers, const double* radii, std::size_t count, const CircleOutput& out) {
    circles_in_lanes(centers, radii, count, out);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(circles_of_float);
HWY_EXPORT(circles_of_double);

void circles_of_spheres(std::span<const Vec3<float>> centers, const float* radii, const CircleOutput& circles) {
    HWY_DYNAMIC_DISPATCH(circles_of_float)(centers.data(), radii, centers.size(), circles);
}
void circles_of_spheres(std::span<const Vec3<double>> centers, const double* radii, const CircleOutput& circles) {
    HWY_DYNAMIC_DISPATCH(circles_of_double)(centers.data(), radii, centers.size(), circles);
}

}  // namespace shlight
#endif
