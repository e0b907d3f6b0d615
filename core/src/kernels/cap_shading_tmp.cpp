// SPDX-License-Identifier: MIT
// Stands in for cap_shading.cpp until it is here.
#include <cmath>
#include <memory>
#include <vector>
#include "kernels/cap_shading.h"
#include "shlight/cap.h"
#include "shlight/horizon.h"
#include "shlight/warped_fit.h"
namespace shlight {
namespace {
Warp warp_of(const WarpArrays& w, std::size_t i) {
    // narrowness from one_minus_speed = n²/(1+r²), r = 1-n
    const double q = w.one_minus_speed[i];
    // n² = q (1 + (1-n)²) → n²(1-q) + 2qn - 2q = 0
    const double n = (-q + std::sqrt(q * q + 2 * q * (1 - q))) / (1 - q);
    return Warp(std::atan2(w.sin_tilt[i], w.cos_tilt[i]), n);
}
}  // namespace
template <class T>
void circles(std::span<const Vec3<T>> centers, const T* radii, const CircleOutput& out) {
    for (std::size_t i = 0; i < centers.size(); ++i) {
        const Circle c = circle_of_sphere(Vec3d(centers[i]), static_cast<double>(radii[i]));
        out.x[i] = c.axis.x;
        out.y[i] = c.axis.y;
        out.z[i] = c.axis.z;
        out.cosine[i] = c.cosine;
        out.sine[i] = c.sine;
    }
}
void circles_of_spheres(std::span<const Vec3<float>> centers, const float* radii, const CircleOutput& out) {
    circles(centers, radii, out);
}
void circles_of_spheres(std::span<const Vec3<double>> centers, const double* radii, const CircleOutput& out) {
    circles(centers, radii, out);
}
void shade_caps(const CircleArrays& c, std::span<const std::uint32_t> circle_of, const LobeArrays& lobe,
                std::span<const std::uint32_t> view_of, std::span<float> values) {
    static thread_local std::unique_ptr<Horizon<float>> horizon;
    std::size_t last = static_cast<std::size_t>(-1);
    Warp warp;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t v = view_of[i], k = circle_of[i];
        if (last != v) {
            if (lobe.warped) warp = warp_of(lobe.warps, v);
            horizon = std::make_unique<Horizon<float>>(warp, lobe.order);
            last = v;
        }
        const Circle circle{{c.x[k], c.y[k], c.z[k]}, c.cosine[k], c.sine[k]};
        values[i] = shade_cap(Cap<float>::inside(circle, warp), *horizon, lobe.terms + v * lobe.stride, lobe.order);
    }
}
}  // namespace shlight
