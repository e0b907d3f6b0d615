// SPDX-License-Identifier: MIT
//
// One least-squares fit in the warped sphere. The norm is that of the warped sphere, so the cosine terms of different
// degree m decouple: with a Fourier sum over the azimuth each m is a small fit in the height alone.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>

#include "lobes/contour_integral.h"
#include "lobes/ggx_fit_table.h"
#include "math/gauss_legendre.h"
#include "math/legendre.h"
#include "shlight/warped_fit.h"

namespace shlight {
namespace {

/// Tikhonov's λ against Gram eigenvalues of at most 1: keeps what the fit does below the horizon, where nothing asks
/// for it, from growing. Its price is an error of about 1e-5 of the albedo.
constexpr double kWarpedRidge = 1e-7;

/// Squared L2 norms of a density: over the warped sphere and, with weight du/dω, over directions.
struct Norms {
    double warped = 0, direction = 0;
};

/// Azimuths in the middles of equal steps over half a turn: what is even in φ needs no more.
struct AzimuthTable {
    std::vector<double> cosines, sines;

    AzimuthTable(int points, int waves) : waves_(waves) {
        for (int j = 0; j < points; ++j) {
            const double phi = std::numbers::pi * (j + 0.5) / points;
            cosines.push_back(std::cos(phi));
            sines.push_back(std::sin(phi));
        }
        for (int m = 0; m < waves; ++m) {
            for (int j = 0; j < points; ++j) {
                transform_.push_back(std::cos(m * std::numbers::pi * (j + 0.5) / points) * (m == 0 ? 1.0 : 2.0) /
                                     points);
            }
        }
    }

    /// a_m of Σ a_m cos mφ, m = 0 … waves-1.
    void append_fourier(const std::vector<double>& values, std::vector<double>& out) const {
        for (int m = 0; m < waves_; ++m) {
            out.push_back(
                std::inner_product(values.begin(), values.end(), transform_.begin() + m * std::ssize(values), 0.0));
        }
    }

  private:
    int waves_;
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

WarpedDensity warped_density(const GgxShape& shape, double cos_theta_o, int order) {
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

/// The basis of one degree m over the heights: √2-normalised terms P̄_l^m, l = m … , row by row of l.
using HeightBasis = std::vector<std::vector<double>>;

HeightBasis height_basis(const WarpedDensity& d, int order) {
    HeightBasis basis(static_cast<std::size_t>(cosine_count(order)), std::vector<double>(d.heights.size()));
    std::array<double, kMaxOrder> sines;
    for (std::size_t i = 0; i < d.heights.size(); ++i) {
        const double z = d.heights[i];
        const double sine_squared = std::max(0.0, (1 - z) * (1 + z));
        powers(std::sqrt(sine_squared), order, sines.data());
        LegendreRows<double> legendre(z, sine_squared);
        for (int l = 0; l < order; ++l) {
            for (int m = 0; m <= l; ++m) {
                basis[at(l, m)][i] = legendre[m] * sines[m] * (m == 0 ? 1.0 : std::numbers::sqrt2);
            }
            if (l + 1 < order) {
                legendre.advance();
            }
        }
    }
    return basis;
}

/// The normal equations of one degree, factorised once for all orders: the leading blocks of a Cholesky factor are the
/// factors of the leading blocks.
class DegreeFit {
  public:
    DegreeFit(const WarpedDensity& d, const HeightBasis& basis, int m, int order) : size_(order - m) {
        const double circle = (m == 0 ? 2 : 1) * std::numbers::pi;
        factor_.assign(static_cast<std::size_t>(size_ * size_), 0.0);
        reduced_.resize(static_cast<std::size_t>(size_));
        std::vector<double> weighted(d.heights.size());
        for (int row = 0; row < size_; ++row) {
            const std::vector<double>& b = basis[at(m + row, m)];
            double moment = 0;
            for (std::size_t i = 0; i < weighted.size(); ++i) {
                weighted[i] = circle * d.weights[i] * b[i];
                moment += weighted[i] * d.fourier[i * static_cast<std::size_t>(d.waves) + static_cast<std::size_t>(m)];
            }
            for (int column = 0; column <= row; ++column) {
                const std::vector<double>& other = basis[at(m + column, m)];
                double sum = row == column ? kWarpedRidge : 0.0;
                for (std::size_t i = 0; i < weighted.size(); ++i) {
                    sum += weighted[i] * other[i];
                }
                for (int k = 0; k < column; ++k) {
                    sum -= entry(row, k) * entry(column, k);
                }
                entry(row, column) = row == column ? std::sqrt(sum) : sum / entry(column, column);
            }
            for (int k = 0; k < row; ++k) {
                moment -= entry(row, k) * reduced_[k];
            }
            reduced_[row] = moment / entry(row, row);
        }
    }

    /// The coefficients of l = m … order-1.
    std::vector<double> solve(int count) const {
        std::vector<double> x(reduced_.begin(), reduced_.begin() + count);
        for (int row = count - 1; row >= 0; --row) {
            x[row] /= entry(row, row);
            for (int k = 0; k < row; ++k) {
                x[k] -= entry(row, k) * x[row];
            }
        }
        return x;
    }

  private:
    double& entry(int row, int column) { return factor_[row * size_ + column]; }
    double entry(int row, int column) const { return factor_[row * size_ + column]; }

    int size_;
    std::vector<double> factor_, reduced_;
};

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

void fit_ggx_node(const GgxShape& shape, double cos_theta_o, const NodeLayout& layout, std::span<float> out) {
    const int highest = *std::max_element(layout.orders().begin(), layout.orders().end());
    const WarpedDensity d = warped_density(shape, cos_theta_o, highest);
    const auto waves = static_cast<std::size_t>(d.waves);
    // The lobe's own cubature: the grid here is too coarse for lobes whose order is out of reach.
    const OutlineArc horizon{{{0, 0, 1}, 0, 1}, {1, 0, 0}, {1, 0, 0}, true};
    const double albedo = outline_integral(shape, cos_theta_o, {&horizon, 1}, 1e-5).value;
    out[NodeLayout::albedo()] = static_cast<float>(albedo);
    const Norms kept = norms(d, d.fourier);
    const Norms beyond = {std::max(0.0, d.norms.warped - kept.warped),
                          std::max(0.0, d.norms.direction - kept.direction)};
    const HeightBasis basis = height_basis(d, highest);
    std::vector<DegreeFit> fits;
    fits.reserve(static_cast<std::size_t>(highest));
    for (int m = 0; m < highest; ++m) {
        fits.emplace_back(d, basis, m, highest);
    }
    for (std::size_t which = 0; which < layout.orders().size(); ++which) {
        const int order = layout.orders()[which];
        std::vector<double> missing = d.fourier;
        for (int m = 0; m < order; ++m) {
            const std::vector<double> terms = fits[m].solve(order - m);
            for (int l = m; l < order; ++l) {
                out[layout.coefficients(which) + at(l, m)] = static_cast<float>(terms[l - m]);
                for (std::size_t i = 0; i < d.heights.size(); ++i) {
                    missing[i * waves + static_cast<std::size_t>(m)] -= terms[l - m] * basis[at(l, m)][i];
                }
            }
        }
        const Norms rest = norms(d, missing);
        out[NodeLayout::shading_error(which)] = static_cast<float>(
            shading_error(std::sqrt(rest.warped + beyond.warped), integral(d, missing), order, albedo));
        out[NodeLayout::residual(which)] = static_cast<float>(
            d.norms.direction > 0 ? std::sqrt((rest.direction + beyond.direction) / d.norms.direction) : 0.0);
    }
}

}  // namespace shlight
