// SPDX-License-Identifier: MIT
//
// Coefficients by plain Monte Carlo: the mean of the basis in random directions to the light, over their density.
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/checks.h"
#include "light_circle.h"
#include "method.h"
#include "random_directions.h"
#include "random_numbers.h"
#include "shlight/basis.h"

namespace shlight::methods {
namespace {

void check_options(const Options& options) {
    if (options.sampling != Sampling::solid_angle && options.sampling != Sampling::area) {
        reject("sampling must be 'solid_angle' or 'area' for coefficients");
    }
    if (options.samples < 1) {
        reject("samples must be at least 1");
    }
}

template <class T, class Sampler>
void average(const Sampler& sampler, int order, bool clip, const Options& options, T* coefficients) {
    const auto count = static_cast<std::size_t>(coefficient_count(order));
    std::vector<T> basis(count);
    RandomNumbers random(options.seed);
    for (int i = 0; i < options.samples; ++i) {
        const RandomDirection at = sampler.sample(random.point());
        if (at.density > 0 && !(clip && at.direction.z < 0)) {
            sh_basis(Vec3<T>(at.direction), order, basis.data());
            const T weight = static_cast<T>(1 / (at.density * options.samples));
            for (std::size_t k = 0; k < count; ++k) {
                coefficients[k] += weight * basis[k];
            }
        }
    }
}

template <class T>
void cap(const CapLight& light, int order, bool clip, const Options& options, T* coefficients) {
    check_options(options);
    std::fill_n(coefficients, coefficient_count(order), T(0));
    const SphericalCap circle = circle_of(light);
    if (options.sampling == Sampling::solid_angle) {
        average(ConeSampler(circle), order, clip, options, coefficients);
    } else if (light.kind == CapLight::Kind::sphere) {
        average(SphereSurfaceSampler(circle), order, clip, options, coefficients);
    } else if (circle.cosine > 0) {
        average(DiskSampler(circle), order, clip, options, coefficients);
    } else {
        reject("half_angles must be below π/2 for sampling 'area': no disk covers more");
    }
}

template <class T>
void polygon(std::span<const Vec3<T>> vertices, int order, bool clip, const Options& options, T* coefficients) {
    check_options(options);
    std::fill_n(coefficients, coefficient_count(order), T(0));
    const std::vector<Vec3d> given(vertices.begin(), vertices.end());
    const SphericalPolygon seen(given, clip);
    if (seen.empty()) {
        return;
    }
    using Uniform = TriangleSampler::Uniform;
    const TriangleSampler sampler = options.sampling == Sampling::area
                                        ? TriangleSampler(Uniform::in_area, given)
                                        : TriangleSampler(Uniform::in_solid_angle, seen.directions());
    if (!sampler.empty()) {
        average(sampler, order, clip, options, coefficients);
    }
}

}  // namespace

Method monte_carlo() {
    return {"monte_carlo",
            "independent random directions, uniform in solid angle (spherical triangles: Arvo 1995) or in area",
            kMaxOrder,
            false,
            true,
            {&cap<float>, &polygon<float>},
            {&cap<double>, &polygon<double>}};
}

}  // namespace shlight::methods
