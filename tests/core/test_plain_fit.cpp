// SPDX-License-Identifier: MIT
#include "shlight/plain_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lobe_truth.h"
#include "quadrature.h"
#include "random_input.h"
#include "shlight/basis.h"

namespace shlight {
namespace {

using testing::expansion;
using testing::RandomInput;
using testing::Sample;
using testing::view_direction;

std::vector<float> cosine_terms(const PlainFit& fit, double cos_theta_o, int order) {
    std::vector<float> terms(cosine_count(order));
    fit.coefficients(cos_theta_o, order, terms.data());
    return terms;
}

/// The basis in every sample, computed once for all fits.
struct Grid {
    std::vector<Sample> samples = testing::mirrored_hemisphere(100, 120);
    std::vector<std::vector<double>> basis;

    Grid() {
        for (const Sample& sample : samples) {
            basis.emplace_back(coefficient_count(kMaxOrder));
            sh_basis(sample.direction, kMaxOrder, basis.back().data());
        }
    }
};

const Grid& grid() {
    static const Grid instance;
    return instance;
}

/// L2 norm of f·cos and of its difference from the expansions, on this file's own grid.
double measured_norm(const LobeShape& shape, double cos_theta_o) {
    return std::sqrt(testing::integral(grid().samples, [&](const Vec3d& wi) {
        return std::pow(lobe_value(shape, wi, view_direction(cos_theta_o)), 2);
    }));
}

double measured_residual(const LobeShape& shape, const PlainFit& fit, double cos_theta_o, int order) {
    const std::vector<float> terms = cosine_terms(fit, cos_theta_o, order);
    double sum = 0;
    for (std::size_t i = 0; i < grid().samples.size(); ++i) {
        const Sample& sample = grid().samples[i];
        const double exact = lobe_value(shape, sample.direction, view_direction(cos_theta_o));
        sum += sample.weight * std::pow(expansion(terms, order, grid().basis[i]) - exact, 2);
    }
    return std::sqrt(sum) / measured_norm(shape, cos_theta_o);
}

TEST(PlainFit, LambertIsExactFromOrderTwo) {
    const LobeShape shape = LambertShape{};
    const PlainFit fit(shape);
    for (const int order : {2, 3, 7, 64}) {
        const std::vector<float> terms = cosine_terms(fit, 0.3, order);
        for (int k = 0; k < cosine_count(order); ++k) {
            const double expected = k == cosine_index(1, 0) ? std::sqrt(4 / (3 * std::numbers::pi)) : 0;  // z/π
            EXPECT_NEAR(terms[static_cast<std::size_t>(k)], expected, 1e-7) << "order " << order << ", term " << k;
        }
        EXPECT_LE(fit.residual(0.3, order), 1e-7);
    }
    EXPECT_NEAR(fit.norm(0.5), std::sqrt(2 / (3 * std::numbers::pi)), 1e-12);
    EXPECT_NEAR(measured_residual(shape, fit, 0.3, 1), fit.residual(0.3, 1), 1e-3);
}

/// The fit's norm and residual agree with measured ones, also between tabulated view angles.
TEST(PlainFit, ResidualIsTheMeasuredError) {
    RandomInput random(60);
    for (const double alpha : {0.2, 0.5, 1.0}) {
        for (const Fresnel fresnel : {Fresnel::one, Fresnel::schlick, Fresnel::dielectric}) {
            const LobeShape shape = GgxShape{alpha, fresnel, 1.5};
            const PlainFit fit(shape);
            for (int i = 0; i < 2; ++i) {
                const double cos_theta_o = i == 0 ? 1 : random.uniform(0.15, 1);
                const double norm = measured_norm(shape, cos_theta_o);
                EXPECT_NEAR(fit.norm(cos_theta_o), norm, 2e-3 * norm + 1e-5);
                for (const int order : {1, 4, 5, 11, 16, 32, 40}) {
                    const double claimed = fit.residual(cos_theta_o, order);
                    const double measured = measured_residual(shape, fit, cos_theta_o, order);
                    EXPECT_NEAR(measured, claimed, 0.05 * claimed + 2e-5)
                        << "alpha " << alpha << ", fresnel " << static_cast<int>(fresnel) << ", cosθ_o " << cos_theta_o
                        << ", order " << order;
                }
            }
        }
    }
}

/// Published with the method: relative L2 errors of hemisphere fits.
TEST(PlainFit, ConvergesAsExpected) {
    struct Row {
        double alpha, cos_theta_o, at_order_4, at_order_16;
    };
    for (const Row& row : {Row{0.6, 0.95, 0.009, 5e-5},
                           {0.6, 0.5, 0.10, 4e-4},
                           {0.3, 0.95, 0.18, 2e-4},
                           {0.3, 0.5, 0.46, 0.025},
                           {0.3, 0.2, 0.63, 0.17},
                           {0.1, 0.95, 0.74, 0.12}}) {
        const PlainFit fit{GgxShape{row.alpha}};
        EXPECT_LE(fit.residual(row.cos_theta_o, 4), 1.15 * row.at_order_4) << row.alpha << ' ' << row.cos_theta_o;
        EXPECT_LE(fit.residual(row.cos_theta_o, 16), 1.15 * row.at_order_16) << row.alpha << ' ' << row.cos_theta_o;
    }
}

}  // namespace
}  // namespace shlight
