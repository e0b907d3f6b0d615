// SPDX-License-Identifier: MIT
//
// Coefficients by adaptive cubature of the basis over what the horizon keeps of the light. Shares with the other
// methods nothing but the basis.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>
#include <vector>

#include "adaptive_cubature.h"
#include "light_circle.h"
#include "method.h"
#include "shlight/basis.h"

namespace shlight::methods {
namespace {

constexpr std::size_t kMostPoints = std::size_t{1} << 18;

/// Relative error that results in T can have at best.
template <class T>
constexpr double kDefaultTolerance = std::is_same_v<T, float> ? 1e-6 : 1e-13;

template <class T>
struct Basis {
    int order;
    void operator()(const Vec3d& direction, T* values) const { sh_basis(Vec3<T>(direction), order, values); }
};

struct One {
    void operator()(const Vec3d& /*direction*/, double* value) const { *value = 1; }
};

/// Solid angle to about a tenth, the measure of errors.
double solid_angle(std::span<const Patch> patches) {
    constexpr CubaturePlan kPlan = {std::numeric_limits<double>::infinity(), 0, 4, 64, 1};
    const One one;
    double sum = 0;
    AdaptiveCubature<double, One>(one, 1, kPlan).add(patches, &sum);
    return sum;
}

template <class T>
void integrate(const KeptRegion& region, int order, const Options& options, T* coefficients) {
    std::fill_n(coefficients, coefficient_count(order), T(0));
    if (region.empty()) {
        return;
    }
    const std::vector<Patch> patches = region.patches();
    const double tolerance = options.tolerance > 0 ? options.tolerance : kDefaultTolerance<T>;
    const double whole = std::abs(solid_angle(patches)) * 0.5 * std::numbers::inv_sqrtpi;  // L_00
    // Gauss's rule starts to converge with half a point per radian and degree.
    const int smallest = 1 + static_cast<int>((order - 1) * std::min(region.extent(), 1.0) / 2);
    // Rounding errors of the basis grow with its degree.
    const double rounding = order * static_cast<double>(std::numeric_limits<T>::epsilon());
    const CubaturePlan plan = {tolerance * whole, rounding, smallest, std::max(20, 2 * smallest), kMostPoints};
    const Basis<T> basis{order};
    AdaptiveCubature<T, Basis<T>>(basis, static_cast<std::size_t>(coefficient_count(order)), plan)
        .add(patches, coefficients);
}

template <class T>
void cap(const CapLight& light, int order, bool clip, const Options& options, T* coefficients) {
    integrate(KeptRegion::of_cap(circle_of(light), clip), order, options, coefficients);
}

template <class T>
void polygon(std::span<const Vec3<T>> vertices, int order, bool clip, const Options& options, T* coefficients) {
    const std::vector<Vec3d> exact(vertices.begin(), vertices.end());
    const SphericalPolygon seen(exact, clip);
    integrate(KeptRegion::of_polygon(seen), order, options, coefficients);
}

}  // namespace

Method quadrature() {
    return {"quadrature",
            "adaptive Gauss cubature of the basis over the light",
            kMaxOrder,
            true,
            false,
            {&cap<float>, &polygon<float>},
            {&cap<double>, &polygon<double>}};
}

}  // namespace shlight::methods
