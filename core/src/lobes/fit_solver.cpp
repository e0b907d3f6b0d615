// SPDX-License-Identifier: MIT
//
// One least-squares fit in the warped sphere. The norm is that of the warped sphere, so the cosine terms of different
// degree m decouple: with a Fourier sum over the azimuth each m is a small fit in the height alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "lobes/fit_table.h"
#include "lobes/normal_equations.h"
#include "math/gauss_legendre.h"
#include "math/legendre.h"
#include "shlight/warped_fit.h"

namespace shlight {
namespace {

/// Squared L2 norms of a density: over the warped sphere and, with weight du/dω, over directions.
struct Norms {
    double warped = 0, direction = 0;
};

/// Azimuths in the middles of equal steps over half a turn: what is even in φ needs no more.
struct AzimuthTable {
    std::vector<double> cosines, sines;

    AzimuthTable(int points, int waves) : waves_(static_cast<std::size_t>(waves)) {
        std::vector<double> cosine(waves_), sine(waves_);
        for (int j = 0; j < points; ++j) {
            const double phi = std::numbers::pi * (j + 0.5) / points;
            cosines.push_back(std::cos(phi));
            sines.push_back(std::sin(phi));
            complex_powers(cosines.back(), sines.back(), waves, cosine.data(), sine.data());
            std::transform(cosine.begin(), cosine.end(), std::back_inserter(transform_),
                           [&](double c) { return 2 * c / points; });
            transform_[transform_.size() - waves_] /= 2;
        }
    }

    /// a_m of Σ a_m cos mφ, m = 0 … waves-1. Azimuth by azimuth: sums that do not wait for each other.
    void append_fourier(const std::vector<double>& values, std::vector<double>& out) const {
        out.resize(out.size() + waves_);
        double* a = &out[out.size() - waves_];
        for (std::size_t j = 0; j < values.size(); ++j) {
            for (std::size_t m = 0; m < waves_; ++m) {
                a[m] += values[j] * transform_[j * waves_ + m];
            }
        }
    }

  private:
    std::size_t waves_;
    std::vector<double> transform_;
};

/// The lobe's density g over a grid in the warped frame, as Fourier coefficients over the azimuth.
struct WarpedDensity {
    std::vector<double> heights, weights;  ///< Gauss points over u_z = z_0 … 1
    int waves;                             ///< degrees m = 0 … waves-1
    std::vector<double> fourier;           ///< heights × waves: g = Σ_m fourier cos mφ
    /// γ (1 + b u·axis) = constant + cosine · cos φ at each height: 1/√(dω/du).
    std::vector<double> shrink_constant, shrink_cosine;
    Norms norms;  ///< of all waves, also those beyond
};

/// Points over half a turn and over the heights. In its warp a lobe is still stretched by 1 : cosθ_o.
int azimuth_points(double cos_theta_o, int order) {
    return std::max({24, order + 8, static_cast<int>(std::min(128.0, 12 / cos_theta_o))});
}
int height_points(double cos_theta_o, int order) {
    return std::min(kMaxGaussPoints, std::max(cos_theta_o < 0.3 ? 64 : 40, order + 24));
}

WarpedDensity warped_density(const LobeShape& shape, double cos_theta_o, int order) {
    const Warp warp = lobe_warp(shape, cos_theta_o);
    const Vec3d wo(std::sqrt((1 - cos_theta_o) * (1 + cos_theta_o)), 0, cos_theta_o);
    const int points = azimuth_points(cos_theta_o, order);
    const GaussRule& rule = gauss_rule(height_points(cos_theta_o, order));
    WarpedDensity d;
    d.waves = std::max(24, order + 8);
    const AzimuthTable azimuths(points, d.waves);
    std::vector<double> values(static_cast<std::size_t>(points));
    const double z0 = warp.horizon_height();
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double z = z0 + (1 - z0) * rule.nodes[i];
        const double s = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
        const double weight = (1 - z0) * rule.weights[i];
        for (int j = 0; j < points; ++j) {
            const Vec3d u(s * azimuths.cosines[j], s * azimuths.sines[j], z);
            const double density = warp.density(u);
            values[j] = lobe_value(shape, warp.direction(u), wo) * density;
            const double square = 2 * std::numbers::pi / points * weight * values[j] * values[j];
            d.norms.warped += square;
            d.norms.direction += square / density;
        }
        d.heights.push_back(z);
        d.weights.push_back(weight);
        azimuths.append_fourier(values, d.fourier);
        const double towards = 1 / std::sqrt(warp.density({s, 0, z}));
        const double away = 1 / std::sqrt(warp.density({-s, 0, z}));
        d.shrink_constant.push_back((towards + away) / 2);
        d.shrink_cosine.push_back((towards - away) / 2);
    }
    return d;
}

/// ∫ (Σ_m a_m cos mφ)² dφ.
double square_over_circle(std::span<const double> a) {
    double sum = 2 * a[0] * a[0];
    for (std::size_t m = 1; m < a.size(); ++m) {
        sum += a[m] * a[m];
    }
    return std::numbers::pi * sum;
}

/// The same of a density given as Fourier coefficients.
Norms norms(const WarpedDensity& d, std::span<const double> fourier) {
    Norms sum;
    const auto waves = static_cast<std::size_t>(d.waves);
    std::vector<double> shrunk(waves + 1);
    for (std::size_t i = 0; i < d.heights.size(); ++i) {
        const auto a = fourier.subspan(i * waves, waves);
        std::fill(shrunk.begin(), shrunk.end(), 0.0);
        const double half = d.shrink_cosine[i] / 2;
        for (std::size_t m = 0; m < waves; ++m) {
            shrunk[m] += d.shrink_constant[i] * a[m];
            shrunk[m + 1] += half * a[m];
            shrunk[m == 0 ? 1 : m - 1] += half * a[m];  // cos φ · 1 = cos φ, in one piece
        }
        sum.warped += d.weights[i] * square_over_circle(a);
        sum.direction += d.weights[i] * square_over_circle(shrunk);
    }
    return sum;
}

/// ∫ of the density times each cosine term up to an order.
std::vector<double> moments(const WarpedDensity& d, const HeightBasis& basis) {
    std::vector<double> sums;
    for (int l = 0; l < basis.order(); ++l) {
        for (int m = 0; m <= l; ++m) {
            const auto values = basis.values(l, m);
            double sum = 0;
            for (std::size_t i = 0; i < d.heights.size(); ++i) {
                sum += d.weights[i] * values[i] * d.fourier[i * static_cast<std::size_t>(d.waves) + m];
            }
            sums.push_back(sum * (m == 0 ? 2 : std::numbers::sqrt2) * std::numbers::pi);
        }
    }
    return sums;
}

/// The density less an expansion.
std::vector<double> missing(const WarpedDensity& d, const HeightBasis& basis, std::span<const double> terms,
                            int order) {
    std::vector<double> rest = d.fourier;
    for (int l = 0; l < order; ++l) {
        for (int m = 0; m <= l; ++m) {
            const double term = terms[at(l, m)] * (m == 0 ? 1 : std::numbers::sqrt2);
            const auto values = basis.values(l, m);
            for (std::size_t i = 0; i < d.heights.size(); ++i) {
                rest[i * static_cast<std::size_t>(d.waves) + m] -= term * values[i];
            }
        }
    }
    return rest;
}

/// A cap's coefficients fall as λ_l ≤ √(8π/l³) (Funk–Hecke), and what the fit lacks lies in bands ≥ order, but for what
/// λ takes from the low ones: that shows in the whole, missing light, which a large light receives undiminished.
double shading_error(double warped_norm, double missing_light, int order, double albedo) {
    return albedo > 0 ? (std::sqrt(2.0 / (order * order * order)) * warped_norm + std::abs(missing_light)) / albedo
                      : 0.0;
}

/// ∫ of a density given as Fourier coefficients over the warped hemisphere.
double integral(const WarpedDensity& d, std::span<const double> fourier) {
    double sum = 0;
    for (std::size_t i = 0; i < d.heights.size(); ++i) {
        sum += 2 * std::numbers::pi * d.weights[i] * fourier[i * static_cast<std::size_t>(d.waves)];
    }
    return sum;
}

}  // namespace

void fit_node(const LobeShape& shape, double cos_theta_o, const NodeLayout& layout, std::span<float> out) {
    const int highest = *std::max_element(layout.orders().begin(), layout.orders().end());
    const WarpedDensity d = warped_density(shape, cos_theta_o, highest);
    // The lobe's own cubature: the grid here is too coarse for lobes whose order is out of reach.
    const double albedo = lobe_albedo(shape, cos_theta_o);
    out[NodeLayout::albedo()] = static_cast<float>(albedo);
    const Norms kept = norms(d, d.fourier);
    const Norms beyond = {std::max(0.0, d.norms.warped - kept.warped),
                          std::max(0.0, d.norms.direction - kept.direction)};
    const HeightBasis basis(d.heights, highest);
    const NormalEquations equations(basis, d.weights);
    std::vector<double> reduced = moments(d, basis);
    equations.reduce(reduced);
    std::array<double, kCosineMax> terms;
    for (std::size_t which = 0; which < layout.orders().size(); ++which) {
        const int order = layout.orders()[which];
        equations.solve(reduced, order, terms);
        std::transform(terms.begin(), terms.begin() + cosine_count(order), &out[layout.coefficients(which)],
                       [](double term) { return static_cast<float>(term); });
        const std::vector<double> left = missing(d, basis, terms, order);
        const Norms rest = norms(d, left);
        out[NodeLayout::shading_error(which)] =
            static_cast<float>(shading_error(std::sqrt(rest.warped + beyond.warped), integral(d, left), order, albedo));
        out[NodeLayout::residual(which)] = static_cast<float>(
            d.norms.direction > 0 ? std::sqrt((rest.direction + beyond.direction) / d.norms.direction) : 0.0);
    }
}

}  // namespace shlight
