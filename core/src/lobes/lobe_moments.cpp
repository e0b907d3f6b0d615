// SPDX-License-Identifier: MIT
#include "lobes/lobe_moments.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lobes/view_grid.h"
#include "math/gauss_legendre.h"
#include "math/legendre.h"

namespace shlight {
namespace {

constexpr int kPanelPoints = 16;

/// Longest Gauss panel [rad]: it holds fewer than three waves of band 63, which sixteen points integrate to 1e-10.
constexpr double kLongestPanel = std::numbers::pi / 12;

/// A point near which a function varies over the length `scale`; far from it the length is one.
struct Feature {
    double position, scale;
};

/// Gauss panels over (from, to). The length of each is at most kLongestPanel, and at most half its distance from a
/// feature plus the feature's scale.
QuadratureRule graded_rule(double from, double to, const std::vector<Feature>& features, int panel_points) {
    QuadratureRule rule;
    const GaussRule& gauss = gauss_rule(panel_points);
    double start = from;
    while (start < to) {
        // The bound holds on the whole panel if it is evaluated at the end nearer to the feature.
        const auto allowed = [&](double x) {
            double length = kLongestPanel;
            for (const Feature& f : features) {
                length = std::min(length, f.scale + 0.7 * std::abs(x - f.position));
            }
            return length;
        };
        double length = allowed(start);
        length = std::min(length, 2 * allowed(start + length));
        if (to - start < 1.2 * length) {
            length = to - start;
        }
        for (std::size_t i = 0; i < gauss.nodes.size(); ++i) {
            rule.nodes.push_back(start + length * gauss.nodes[i]);
            rule.weights.push_back(length * gauss.weights[i]);
        }
        start += length;
    }
    return rule;
}

/// Azimuths 0 … π counted from the mirror direction of ω_o = (sinθ_o, 0, cosθ_o), which lies at φ = π.
struct Azimuths {
    std::vector<double> weights;
    std::vector<double> cosines, sines;  ///< cos mφ and sin mφ for m = 0 … 63, node by node

    explicit Azimuths(QuadratureRule rule)
        : weights(std::move(rule.weights)), cosines(weights.size() * kMaxOrder), sines(cosines.size()) {
        for (std::size_t j = 0; j < weights.size(); ++j) {
            complex_powers(-std::cos(rule.nodes[j]), std::sin(rule.nodes[j]), kMaxOrder, &cosines[j * kMaxOrder],
                           &sines[j * kMaxOrder]);
        }
    }
};

/// Fourier moments of the lobe over the azimuth at one θ: out[m] = ∫ f·cos cos mφ dφ; returns ∫ (f·cos)² dφ.
double azimuth_moments(const LobeShape& shape, double sine, double cosine, const Vec3d& wo, const Azimuths& phi,
                       std::vector<double>& out) {
    std::fill(out.begin(), out.end(), 0.0);
    double square = 0;
    for (std::size_t j = 0; j < phi.weights.size(); ++j) {
        const double* c = &phi.cosines[j * kMaxOrder];
        const Vec3d wi(sine * c[1], sine * phi.sines[j * kMaxOrder + 1], cosine);
        const double f = lobe_value(shape, wi, wo);
        const double weighted = 2 * f * phi.weights[j];
        square += f * weighted;
        for (std::size_t m = 0; m < kMaxOrder; ++m) {
            out[m] += weighted * c[m];
        }
    }
    return square;
}

}  // namespace

LobeRule lobe_rule(double width, double theta_o, int panel_points) {
    const double half_pi = std::numbers::pi / 2;
    // The lobe is α wide in the plane of incidence and α cosθ_o across; masking varies over α near the horizon.
    const double across = width * std::max(std::cos(theta_o), 0.05);
    return {graded_rule(0, half_pi, {{theta_o, width}, {half_pi, width}}, panel_points),
            graded_rule(0, std::numbers::pi, {{0.0, across / std::max(std::sin(theta_o), across)}}, panel_points)};
}

double least_grazing(double theta_o) {
    return std::min(theta_o, std::numbers::pi / 2 - 1e-6);  // the same in float
}

LobeMoments lobe_moments(const LobeShape& shape, double theta_o) {
    const Vec3d wo(std::sin(theta_o), 0.0, std::cos(theta_o));
    const auto [theta, around] = lobe_rule(lobe_width(shape), theta_o, kPanelPoints);
    const Azimuths phi(around);

    LobeMoments result{std::vector<double>(kCosineMax, 0.0), 0.0};
    std::vector<double> fourier(kMaxOrder);
    std::vector<double> sines(kMaxOrder);
    for (std::size_t i = 0; i < theta.nodes.size(); ++i) {
        const double sine = std::sin(theta.nodes[i]);
        const double cosine = std::cos(theta.nodes[i]);
        const double weight = theta.weights[i] * sine;
        result.norm_squared += weight * azimuth_moments(shape, sine, cosine, wo, phi, fourier);
        powers(sine, kMaxOrder, sines.data());
        for (std::size_t m = 0; m < kMaxOrder; ++m) {
            fourier[m] *= weight * sines[m] * (m == 0 ? 1.0 : std::numbers::sqrt2);
        }
        LegendreRows<double> legendre(cosine, sine * sine);
        for (int l = 0; l < kMaxOrder; ++l) {
            for (int m = 0; m <= l; ++m) {
                result.moments[at(l, m)] += legendre[m] * fourier[m];
            }
            if (l + 1 < kMaxOrder) {
                legendre.advance();
            }
        }
    }
    return result;
}

std::vector<LobeMoments> moments_of_all_views(const LobeShape& shape) {
    std::vector<LobeMoments> views(kViewNodes);
    // Isolated, because a thread that waits here must not start unrelated work that asks for this same lobe.
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(0, kViewNodes,
                          [&](int node) { views[node] = lobe_moments(shape, least_grazing(view_angle(node))); });
    });
    return views;
}

}  // namespace shlight
