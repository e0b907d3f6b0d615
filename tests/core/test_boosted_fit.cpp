// SPDX-License-Identifier: MIT
#include "shlight/boosted_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lobe_truth.h"
#include "lobes/fit_table.h"
#include "random_input.h"
#include "shlight/basis.h"

namespace shlight {
namespace {

using testing::expansion;
using testing::lobe_over_cap;
using testing::RandomInput;
using testing::view_direction;

std::vector<float> terms_of(const BoostedFit& fit, double cosine, int order) {
    std::vector<float> terms(static_cast<std::size_t>(cosine_count(order)));
    fit.coefficients(cosine, order, terms.data());
    return terms;
}

/// L2 error over the boosted sphere ÷ albedo.
double measured_error(const BoostedFit& fit, double cosine, int order) {
    const Boost boost = lobe_boost(fit.shape(), cosine);
    const Vec3d view = view_direction(cosine);
    const std::vector<float> terms = terms_of(fit, cosine, order);
    const GaussRule& heights = gauss_rule(64);
    const double z0 = boost.horizon_height();
    std::vector<double> basis(static_cast<std::size_t>(coefficient_count(order)));
    double boosted = 0;
    double albedo = 0;
    constexpr int kAround = 96;
    for (std::size_t i = 0; i < heights.nodes.size(); ++i) {
        const double z = z0 + (1 - z0) * heights.nodes[i];
        const double s = std::sqrt((1 - z) * (1 + z));
        for (int j = 0; j < kAround; ++j) {
            const double phi = std::numbers::pi * (j + 0.5) / kAround;
            const Vec3d u(s * std::cos(phi), s * std::sin(phi), z);
            const double weight = (1 - z0) * heights.weights[i] * 2 * std::numbers::pi / kAround;
            const double density = boost.density(u);
            const double g = lobe_value(fit.shape(), boost.direction(u), view) * density;
            sh_basis(u, order, basis.data());
            const double error = expansion(terms, order, basis) - g;
            boosted += weight * error * error;
            albedo += weight * g;
        }
    }
    return std::sqrt(boosted) / albedo;
}

/// The root mean square, over caps in all directions, of the error of a cap's radiance ÷ albedo, as the table has it.
double shading_error(const BoostedFit& fit, double cosine, int order) {
    float error = 0;
    fit.table()->look_up(cosine, FitTable::kShadingErrors + fit.table()->which(order), {&error, 1});
    return error;
}

TEST(BoostedFit, FewBandsDescribeAnyRoughness) {
    for (const double alpha : {0.0025, 0.05, 0.3, 1.0}) {
        const BoostedFit fit(GgxShape{alpha});
        EXPECT_LE(shading_error(fit, 0.9, 8), 5e-4) << alpha;
        EXPECT_LE(shading_error(fit, 0.5, 12), 5e-4) << alpha;
        EXPECT_LE(shading_error(fit, 0.3, 16), 5e-4) << alpha;
    }
}

TEST(BoostedFit, ErrorsAreTheMeasuredOnes) {
    RandomInput random(31);
    for (const Fresnel fresnel : {Fresnel::one, Fresnel::schlick, Fresnel::dielectric}) {
        for (int i = 0; i < 8; ++i) {
            const BoostedFit fit(GgxShape{random.log_uniform(0.003, 1), fresnel, 1.5});
            const double cosine = random.uniform(0.3, 1);
            for (const int order : {4, 8, 16}) {
                const double bound = std::sqrt(2.0 / (order * order * order)) * measured_error(fit, cosine, order);
                // Errors are interpolated between views and roughnesses, like coefficients; 1e-5 is what that costs.
                EXPECT_LE(std::abs(shading_error(fit, cosine, order) - bound), 0.1 * bound + 2e-5);
            }
        }
    }
}

TEST(BoostedFit, TablesInterpolateAcrossRoughnessAndView) {
    // Against a fit made at this very roughness: a jump of the boost anywhere in the table would stand out.
    RandomInput random(32);
    for (int i = 0; i < 40; ++i) {
        const double alpha = random.log_uniform(0.001, 1);
        // Up to the normal: beyond it a view is the mirror image of one before it.
        const double cosine = i % 4 == 0 ? std::cos(random.uniform(0, 0.12)) : random.uniform(0.2, 1);
        const BoostedFit table(GgxShape{alpha});
        const double interpolated = measured_error(table, cosine, 8);
        const BoostedFit own(GgxShape{alpha}, 8);
        const double fitted = measured_error(own, cosine, 8);
        EXPECT_LE(interpolated, fitted + 3e-4) << "alpha " << alpha << " cos " << cosine;
    }
}

TEST(BoostedFit, AlbedoIsTheIntegral) {
    for (const double alpha : {0.01, 0.2, 1.0}) {
        for (const double cosine : {0.05, 0.3, 1.0}) {
            const double truth = lobe_over_cap({alpha}, cosine, {0, 0, 1}, std::numbers::pi / 2, 16);
            EXPECT_NEAR(BoostedFit(GgxShape{alpha}).albedo(cosine), truth, 2e-3) << alpha << " " << cosine;
        }
    }
}

}  // namespace
}  // namespace shlight
