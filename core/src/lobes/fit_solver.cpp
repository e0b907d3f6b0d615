// SPDX-License-Identifier: MIT
//
// One least-squares fit of a lobe by harmonics over the boosted hemisphere. The norm is uniform in solid angle, so
// cosine terms of different degree m decouple: after a Fourier sum over the azimuth each m is a small fit in the height
// u_z alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "lobes/fit_table.h"
#include "lobes/normal_equations.h"
#include "math/gauss_legendre.h"
#include "math/legendre.h"
#include "shlight/boosted_fit.h"

namespace shlight {
namespace {

/// Azimuths in the middles of equal steps over half a turn, which suffices for functions that are even in φ.
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

    /// Appends a_m of Σ a_m cos mφ, m = 0 … waves-1. The loop over azimuths is outside, so that sums are independent.
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

/// The lobe's density g = f·cos dω/du over a grid in the boosted frame, as Fourier coefficients over the azimuth.
struct BoostedDensity {
    std::vector<double> heights, weights;  ///< Gauss points over u_z = z_0 … 1
    std::vector<double> fourier;           ///< heights × order: g ≈ Σ_m fourier cos mφ
    double square = 0;                     ///< ∫ g² du, of all degrees
};

/// Azimuths per half turn, and heights. A lobe stays stretched by 1 : cosθ_o after its boost.
int azimuth_points(double cos_theta_o, int order) {
    return std::max({24, order + 8, static_cast<int>(std::min(128.0, 12 / cos_theta_o))});
}
int height_points(double cos_theta_o, int order) {
    return std::min(kMaxGaussPoints, std::max(cos_theta_o < 0.3 ? 64 : 40, order + 24));
}

BoostedDensity boosted_density(const LobeShape& shape, double cos_theta_o, int order) {
    const Boost boost = lobe_boost(shape, cos_theta_o);
    const Vec3d wo(std::sqrt((1 - cos_theta_o) * (1 + cos_theta_o)), 0, cos_theta_o);
    const int points = azimuth_points(cos_theta_o, order);
    const GaussRule& rule = gauss_rule(height_points(cos_theta_o, order));
    BoostedDensity d;
    const AzimuthTable azimuths(points, order);
    std::vector<double> values(static_cast<std::size_t>(points));
    const double z0 = boost.horizon_height();
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double z = z0 + (1 - z0) * rule.nodes[i];
        const double s = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
        const double weight = (1 - z0) * rule.weights[i];
        for (int j = 0; j < points; ++j) {
            const Vec3d u(s * azimuths.cosines[j], s * azimuths.sines[j], z);
            values[j] = lobe_value(shape, boost.direction(u), wo) * boost.density(u);
            d.square += 2 * std::numbers::pi / points * weight * values[j] * values[j];
        }
        d.heights.push_back(z);
        d.weights.push_back(weight);
        azimuths.append_fourier(values, d.fourier);
    }
    return d;
}

/// ∫ of the density times each cosine term.
std::vector<double> moments(const BoostedDensity& d, const HeightBasis& basis) {
    const auto order = static_cast<std::size_t>(basis.order());
    std::vector<double> sums;
    for (int l = 0; l < basis.order(); ++l) {
        for (int m = 0; m <= l; ++m) {
            const auto values = basis.values(l, m);
            double sum = 0;
            for (std::size_t i = 0; i < d.heights.size(); ++i) {
                sum += d.weights[i] * values[i] * d.fourier[i * order + static_cast<std::size_t>(m)];
            }
            sums.push_back(sum * (m == 0 ? 2 : std::numbers::sqrt2) * std::numbers::pi);
        }
    }
    return sums;
}

/// ∫ (density - expansion) du over the boosted hemisphere.
double missing_light(const BoostedDensity& d, const HeightBasis& basis, std::span<const double> terms, int order) {
    double sum = 0;
    for (std::size_t i = 0; i < d.heights.size(); ++i) {
        double rest = d.fourier[i * static_cast<std::size_t>(basis.order())];
        for (int l = 0; l < order; ++l) {
            rest -= terms[at(l, 0)] * basis.values(l, 0)[i];
        }
        sum += 2 * std::numbers::pi * d.weights[i] * rest;
    }
    return sum;
}

}  // namespace

double shading_error(double squared_error, double missing_light, int order, double albedo) {
    return albedo > 0 ? (std::sqrt(2 * squared_error / (order * order * order)) + std::abs(missing_light)) / albedo
                      : 0.0;
}

void fit_row(const LobeShape& shape, int view, FitTable& table) {
    const double cosine = boosted_view_cosine(view);
    const int highest = *std::max_element(table.orders().begin(), table.orders().end());
    const BoostedDensity d = boosted_density(shape, cosine, highest);
    // lobe_albedo() integrates adaptively; the grid here is too coarse for lobes whose order is out of reach.
    const double albedo = lobe_albedo(shape, cosine);
    const auto row = table.row(view);
    row[FitTable::kAlbedo] = static_cast<float>(albedo);
    const HeightBasis basis(d.heights, highest);
    const NormalEquations equations(basis, d.weights);
    std::vector<double> reduced = moments(d, basis);
    equations.reduce(reduced);
    std::array<double, kCosineMax> terms;
    for (std::size_t i = 0; i < table.orders().size(); ++i) {
        const int order = table.orders()[i];
        equations.solve(reduced, order, terms);
        std::transform(terms.begin(), terms.begin() + cosine_count(order), &row[table.terms(i)],
                       [](double term) { return static_cast<float>(term); });
        const double squared_error = equations.squared_error(reduced, order, d.square);
        row[FitTable::kShadingErrors + i] =
            static_cast<float>(shading_error(squared_error, missing_light(d, basis, terms, order), order, albedo));
    }
}

}  // namespace shlight
