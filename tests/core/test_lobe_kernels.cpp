// SPDX-License-Identifier: MIT
//
// What the batch kernels make of lobes and views, against the functions of one lobe and one view.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lobe_truth.h"
#include "lobes/material_views.h"
#include "lobes/view_kernel.h"
#include "random_input.h"
#include "shading/cubature_kernel.h"
#include "shlight/warped_fit.h"

namespace shlight {
namespace {

using testing::RandomInput;
using testing::view_direction;

constexpr std::uint32_t kOnly = 0;

TEST(LobeKernels, ValuesInLanesAreTheLobes) {
    // The rule of one point over a tiny cap is f·cos at its middle times the cap's area.
    RandomInput random(41);
    double largest = 0;
    for (int i = 0; i < 3000; ++i) {
        const GgxShape shape{random.log_uniform(1e-4, 1), static_cast<Fresnel>(i % 3), random.uniform(1.1, 2.5)};
        const Vec3d view = view_direction(random.uniform(0.05, 1));
        const Vec3d noise = random.direction();
        const double spread = random.chance(0.5) ? 4 * shape.alpha : 1.0;
        Vec3d axis = glm::normalize(Vec3d(-view.x, 0, view.z) + spread * noise);
        axis.z = std::abs(axis.z);
        if (axis.z < 1e-3) {
            continue;
        }
        const double sine = 1e-6 * shape.alpha;
        const double cosine = std::sqrt(1 - sine * sine);
        float value = 0;
        integrate_caps(shape, {&axis.x, &axis.y, &axis.z, &cosine, &sine}, {&kOnly, 1}, {&view.x, &view.z, true},
                       {&kOnly, 1}, 1, {&value, 1});
        const double area = 2 * std::numbers::pi * sine * sine / (1 + cosine);
        const double expected = lobe_value(shape, axis, view);
        // Fresnel's rise is a fifth power, or as good as one, of a difference that floats know to 1e-7.
        const double edge = 1 - glm::length(axis + view) / 2;
        const double rounding = shape.fresnel == Fresnel::one ? 2e-6 : 2e-6 + 2e-6 / edge;
        const double error = std::abs(static_cast<double>(value) / area - expected) / expected;
        largest = std::max(largest, error / rounding);
    }
    EXPECT_LE(largest, 1);
}

TEST(LobeKernels, WarpsOfManyViewsAreThoseOfOne) {
    RandomInput random(42);
    for (const double alpha : {1e-4, 0.003, 0.1, 0.5, 1.0}) {
        const Bsdf bsdf = Bsdf::ggx(static_cast<float>(std::sqrt(alpha)), Rgb(1));
        const MaterialLobes material(bsdf.lobes(), 8, 1e-3);
        std::vector<double> cosines = {0, 1e-9, 0.01, 0.02, 0.5, 1 - 1e-9, 1};
        for (int i = 0; i < 50; ++i) {
            cosines.push_back(random.uniform(0, 1));
        }
        MaterialViews views;
        std::vector<Rgb> weights;
        views.assign(material, cosines, material.weights(cosines, weights), false);
        const LobeArrays lobe = views.lobe(0).arrays(8, views.positions().all());
        for (std::size_t i = 0; i < cosines.size(); ++i) {
            const Warp warp = lobe_warp(bsdf.lobes()[0].shape, cosines[i]);
            const double sine = warp.horizon_sine();
            EXPECT_LE(std::abs(lobe.warps.horizon_sine[i] - sine), 1e-6 * sine);
            EXPECT_LE(std::abs(lobe.warps.horizon_height[i] - warp.horizon_height()), 1e-6);
            std::vector<float> terms(static_cast<std::size_t>(cosine_count(8)));
            warped_fit(bsdf.lobes()[0].shape, 8)->coefficients(cosines[i], 8, terms.data());
            for (std::size_t k = 0; k < terms.size(); ++k) {
                EXPECT_EQ(lobe.terms[i * lobe.stride + k], terms[k]);  // a view does not depend on its neighbours
            }
        }
    }
}

}  // namespace
}  // namespace shlight
