// SPDX-License-Identifier: MIT
#include "shaders/thin_film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "math/gauss_legendre.h"
#include "shlight/types.h"

namespace shlight {
namespace {

using Complex = std::complex<double>;

constexpr double kLeastCosine = 1e-4;
/// Powers of the light's way through the film and back that interfere; each is weaker by the product of both
/// interfaces' amplitudes.
constexpr std::size_t kOrders = 3;
constexpr std::size_t kFactors = kFilmResults / 3;

/// Looks up the mean of exp(2πi D / λ) in each channel, for a path difference D [nm].
std::array<Complex, 3> mean_phase(const ShaderTable& table, double path) {
    const std::size_t size = table.sizes[0];
    const double place = std::clamp(path / kLongestPath, 0.0, 1.0) * static_cast<double>(size - 1);
    const auto low = static_cast<std::size_t>(place), high = std::min(low + 1, size - 1);
    const double share = place - static_cast<double>(low);
    const auto at = [&](std::size_t row) {
        const float* values = table.values.data() + row * size;
        return (1 - share) * values[low] + share * values[high];
    };
    return {Complex(at(0), at(3)), Complex(at(1), at(4)), Complex(at(2), at(5))};
}

/// A metal's curve by its reflectance head-on and at a cosine of 1/7 (Kutz, Hašan & Edmondson 2021).
double metal_curve(double head_on, double edge, double cosine) {
    const auto schlick = [&](double rest) { return head_on + (1 - head_on) * std::pow(rest, 5); };
    constexpr double kEdge = 6.0 / 7;
    const double dip = (schlick(kEdge) - edge) * cosine * std::pow((1 - cosine) / kEdge, 6) * 7;
    return std::clamp(schlick(1 - cosine) - dip, 0.0, 1.0);
}

double finite_argument(const OperationLanes& lanes, std::size_t number, std::size_t lane) {
    const double value = lanes.arguments[number][lane];
    return std::isfinite(value) ? std::clamp(value, -1e6, 1e6) : 0;
}

/// A film on a surface.
class Film {
  public:
    Film(const OperationLanes& lanes, std::size_t lane) : table_(*lanes.table) {
        const auto argument = [&](std::size_t i) { return finite_argument(lanes, i, lane); };
        thickness_ = std::max(argument(2), 0.0);
        index_ = std::max(argument(3), 1e-5);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const std::size_t first = 4 + 4 * channel;
            below_[channel] = {std::max(argument(first), 1e-5), std::max(argument(first + 1), 0.0),
                               std::min(argument(first + 2), 1.0)};
            scale_[channel] = argument(first + 3);
        }
    }

    /// Fresnel's factor at a cosine between light and microfacet.
    Rgb factor(double cosine) const {
        const double c = std::clamp(cosine, kLeastCosine, 1.0);
        const double square = index_ * index_ - (1 - c * c);
        if (square <= 0) {
            return Rgb(1);
        }
        const double bent = std::sqrt(square);  // index · cosine in the film
        std::array<std::array<Complex, 3>, kOrders> phases;
        for (std::size_t order = 0; order < kOrders; ++order) {
            phases[order] = mean_phase(table_, 2 * static_cast<double>(order + 1) * thickness_ * bent);
        }
        const double steep = index_ * index_ * c;
        const std::array<double, 2> top = {(c - bent) / (c + bent), (steep - bent) / (steep + bent)};
        Rgb result(0);
        Waves waves;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            if (channel == 0 || below_[channel] != below_[channel - 1]) {
                waves = waves_from(below_[channel], bent, top);
            }
            double value = waves.mean;
            for (std::size_t order = 0; order < kOrders; ++order) {
                value += (waves.returning[order] * phases[order][channel]).real();
            }
            result[static_cast<int>(channel)] = static_cast<float>(scaled(std::clamp(value, 0.0, 1.0), channel));
        }
        return result;
    }

  private:
    /// What is below the film, of one channel.
    struct Below {
        double n, k, edge;

        bool operator==(const Below&) const = default;
    };
    /// The reflectance of waves whose phases do not matter, and what each order adds times its phase.
    struct Waves {
        double mean = 0;
        std::array<Complex, kOrders> returning{};
    };

    Waves waves_from(const Below& below, double bent, const std::array<double, 2>& top) const {
        const double c = bent / index_;
        const Complex square = Complex(below.n, below.k) * Complex(below.n, below.k);
        const Complex g = std::sqrt(square - index_ * index_ * (1 - c * c));
        const auto amplitude = [](Complex near, Complex far) {
            return (near - far) * std::conj(near + far) / std::norm(near + far);
        };
        const std::array<Complex, 2> bottom = {amplitude(bent, g), amplitude(square * c, index_ * g)};
        Waves sum;
        for (std::size_t polarization = 0; polarization < 2; ++polarization) {
            const double far = std::abs(bottom[polarization]);
            const double square_of_far = below.edge < 0 ? far * far : metal_curve(head_on(below), below.edge, c);
            const double near = top[polarization], passed = 1 - near * near;
            const double both = std::sqrt(near * near * square_of_far);
            const double returned = passed * passed * square_of_far / std::max(1 - both * both, 1e-9);
            sum.mean += (near * near + returned) / 2;
            // A wave that comes back through the film is reflected below it, and by its top from within.
            const Complex turn = far > 0 ? both / (near < 0 ? far : -far) * bottom[polarization] : Complex(both);
            Complex power = returned - passed;
            for (Complex& order : sum.returning) {
                power *= turn;
                order += power;
            }
        }
        return sum;
    }

    /// The reflectance below the film for light along the normal.
    double head_on(const Below& below) const {
        const double n = below.n / index_, k = below.k / index_;
        return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
    }

    double scaled(double factor, std::size_t channel) const {
        const double root = (below_[channel].n - 1) / (below_[channel].n + 1), bare = root * root;
        const double share = bare > 1e-5 ? std::clamp((1 - factor) / (1 - bare), 0.0, 1.0) : 0;
        return factor * (1 + (scale_[channel] - 1) * share);
    }

    const ShaderTable& table_;
    double thickness_, index_;
    std::array<Below, 3> below_;
    std::array<double, 3> scale_;
};

/// Least squares by normal equations.
class Fit {
  public:
    void add(double c, double weight, const Rgb& value) {
        const double s = 1 - c, square = s * s, sixth = square * square * square;
        const std::array<double, kFactors> factors = {
            1, s, square * square * s, c * square, c * square * s, c * sixth, c * sixth * sixth};
        for (std::size_t i = 0; i < kFactors; ++i) {
            for (std::size_t j = 0; j <= i; ++j) {
                matrix_[i][j] += weight * factors[i] * factors[j];
            }
            right_[i] += weight * factors[i] * Vec3d(value);
        }
    }

    /// Solves by Cholesky's decomposition. Where the factors hardly differ over a narrow lobe the smallest ones are
    /// preferred.
    std::array<Vec3d, kFactors> solved() const {
        auto lower = matrix_;
        auto x = right_;
        for (std::size_t i = 0; i < kFactors; ++i) {
            lower[i][i] *= 1 + kRidge;
            for (std::size_t j = 0; j <= i; ++j) {
                for (std::size_t k = 0; k < j; ++k) {
                    lower[i][j] -= lower[i][k] * lower[j][k];
                }
                lower[i][j] = i == j ? std::sqrt(std::max(lower[i][i], kRidge * kRidge * matrix_[i][i]))
                                     : lower[i][j] / lower[j][j];
            }
            for (std::size_t k = 0; k < i; ++k) {
                x[i] -= lower[i][k] * x[k];
            }
            x[i] /= lower[i][i];
        }
        for (std::size_t i = kFactors; i-- > 0;) {
            for (std::size_t k = i + 1; k < kFactors; ++k) {
                x[i] -= lower[k][i] * x[k];
            }
            x[i] /= lower[i][i];
        }
        return x;
    }

  private:
    static constexpr double kRidge = 1e-8;
    std::array<std::array<double, kFactors>, kFactors> matrix_{};
    std::array<Vec3d, kFactors> right_{};
};

/// Points of the rules over a lobe's visible normals.
constexpr int kHeights = 6, kTurns = 4;
/// Cosines that count a little in any fit, so that no lobe's sum leaves the curve far from its peak.
constexpr std::array<double, 5> kEverywhere = {0.02, 0.2, 0.45, 0.7, 0.93};
constexpr double kLittle = 1e-3;

/// Adds what a lobe reflects by visible normals, drawn as by GgxShape::sample, with the weights G₂/G₁.
void add_lobe(Fit& fit, const Film& film, double cos_o, double alpha) {
    const double sin_o = std::sqrt(1 - cos_o * cos_o);
    const double spread = std::hypot(alpha * sin_o, cos_o);
    const double view_x = alpha * sin_o / spread, view_z = cos_o / spread;
    const GaussRule& rule = gauss_rule(kHeights);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double z = (1 - rule.nodes[i]) * (1 + view_z) - view_z;
        const double across = std::sqrt(std::max(1 - z * z, 0.0));
        for (int turn = 0; turn < kTurns; ++turn) {
            const double angle = std::numbers::pi * (turn + 0.5) / kTurns;
            const Vec3d half = glm::normalize(
                Vec3d(alpha * (across * std::cos(angle) + view_x), alpha * across * std::sin(angle), z + view_z));
            const double c = std::clamp(half.x * sin_o + half.z * cos_o, 0.0, 1.0);
            const double cos_i = 2 * c * half.z - cos_o;
            if (cos_i > 0) {
                const double masking = std::sqrt(alpha * alpha + (1 - alpha * alpha) * cos_i * cos_i);
                const double both = cos_o * masking + cos_i * spread;
                fit.add(c, rule.weights[i] / kTurns * cos_i * (cos_o + spread) / both, film.factor(c));
            }
        }
    }
}

}  // namespace

void thin_film(const OperationLanes& lanes) {
    for (std::size_t lane = 0; lane < lanes.count; ++lane) {
        const Film film(lanes, lane);
        const double cos_o = std::clamp(finite_argument(lanes, 0, lane), kLeastCosine, 1.0);
        const double alpha = std::clamp(finite_argument(lanes, 1, lane), 0.0, 1.0);
        std::array<Vec3d, kFactors> shares{};
        if (alpha > 0) {
            Fit fit;
            add_lobe(fit, film, cos_o, alpha);
            for (const double c : kEverywhere) {
                fit.add(c, kLittle, film.factor(c));
            }
            shares = fit.solved();
        } else {
            shares[0] = film.factor(cos_o);
        }
        for (std::size_t i = 0; i < kFilmResults; ++i) {
            lanes.results[i][lane] = static_cast<float>(shares[i / 3][static_cast<int>(i % 3)]);
        }
    }
}

}  // namespace shlight
