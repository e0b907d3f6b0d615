// SPDX-License-Identifier: MIT
//
// The harmonics of a lat-long picture, integrated without an error but rounding.
//
// Along a row, linear interpolation between texels is a convolution with a triangle: the row's Fourier integral is the
// sum over its texels times 2π/w sinc²(πm/w). Down the columns, between the centres of two rows, what is integrated is
// linear times a harmonic: Gauss's rule.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <tbb/parallel_for.h>

#include "environment/environment_map.h"
#include "math/gauss_legendre.h"
#include "math/legendre.h"

namespace shlight {
namespace {

using std::numbers::pi;

/// ∫ L cos mφ dφ and ∫ L sin mφ dφ along a row, by channel and degree.
struct RowIntegrals {
    std::array<std::array<double, kMaxOrder>, 3> cosines{}, sines{};
};

/// cos and sin of the angles 2π j / 2w, of which all that is needed are multiples.
struct HalfSteps {
    std::vector<float> cosines, sines;

    explicit HalfSteps(int width) {
        for (int j = 0; j < 2 * width; ++j) {
            cosines.push_back(static_cast<float>(std::cos(pi * j / width)));
            sines.push_back(static_cast<float>(std::sin(pi * j / width)));
        }
    }
};

double squared_sinc(double x) {
    const double sinc = x == 0 ? 1 : std::sin(x) / x;
    return sinc * sinc;
}

RowIntegrals integrate_row(std::span<const Rgb> row, const HalfSteps& steps) {
    const std::size_t width = row.size();
    RowIntegrals result;
    for (std::size_t m = 0; m < kMaxOrder; ++m) {
        // φ = π - x with x = 2π (j + ½) / w.
        Vec3d cosine(0), sine(0);
        std::size_t step = m % (2 * width);
        const std::size_t stride = 2 * m % (2 * width);
        for (const Rgb& texel : row) {
            cosine += Vec3d(steps.cosines[step] * texel);
            sine += Vec3d(steps.sines[step] * texel);
            step += stride;
            step -= step >= 2 * width ? 2 * width : 0;
        }
        const auto columns = static_cast<double>(width);
        const double scale = 2 * pi / columns * squared_sinc(pi * static_cast<double>(m) / columns);
        const double sign = m % 2 == 0 ? scale : -scale;
        for (int c = 0; c < 3; ++c) {
            result.cosines[static_cast<std::size_t>(c)][m] = sign * cosine[c];
            result.sines[static_cast<std::size_t>(c)][m] = -sign * sine[c];
        }
    }
    return result;
}

/// Sums over points of a meridian.
class MeridianSum {
  public:
    MeridianSum() {
        for (auto& channel : sums_) {
            channel.assign(kMaxOrder * kMaxOrder, 0.0);
        }
    }

    /// The rows' integrals, mixed, at one θ.
    void add(double tilt, double weight, const RowIntegrals& above, const RowIntegrals& below, double share_below) {
        const double sine = std::sin(tilt);
        const double cosine = std::cos(tilt);
        std::array<double, kMaxOrder> factors;
        powers(sine, kMaxOrder, factors.data());
        std::array<std::array<double, kMaxOrder>, 3> even, odd;
        for (std::size_t m = 0; m < kMaxOrder; ++m) {
            const double factor = weight * sine * factors[m] * (m == 0 ? 1.0 : std::numbers::sqrt2);
            for (std::size_t c = 0; c < 3; ++c) {
                even[c][m] = factor * std::lerp(above.cosines[c][m], below.cosines[c][m], share_below);
                odd[c][m] = factor * std::lerp(above.sines[c][m], below.sines[c][m], share_below);
            }
        }
        LegendreRows<double> legendre(cosine, sine * sine);
        for (int l = 0; l < kMaxOrder; ++l) {
            for (std::size_t c = 0; c < 3; ++c) {
                double* center = &sums_[c][static_cast<std::size_t>(coefficient_index(l, 0))];
                for (int m = 0; m <= l; ++m) {
                    center[m] += legendre[m] * even[c][static_cast<std::size_t>(m)];
                }
                for (int m = 1; m <= l; ++m) {
                    center[-m] += legendre[m] * odd[c][static_cast<std::size_t>(m)];
                }
            }
            if (l + 1 < kMaxOrder) {
                legendre.advance();
            }
        }
    }

    const std::array<std::vector<double>, 3>& sums() const { return sums_; }

  private:
    std::array<std::vector<double>, 3> sums_;
};

}  // namespace

RadianceCoefficients radiance_coefficients(const LatLong& picture, const BrightTexels& bright, const Stopped& stopped) {
    const int height = picture.height;
    const HalfSteps steps(picture.width);
    std::vector<RowIntegrals> rows(static_cast<std::size_t>(height));
    tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t row) {
        end_if(stopped);
        std::vector<Rgb> texels(static_cast<std::size_t>(picture.width));
        const Rgb* source = picture.pixels.data() + row * texels.size();
        std::transform(source, source + texels.size(), texels.begin(),
                       [&](const Rgb& own) { return bright.below(own); });
        rows[row] = integrate_row(texels, steps);
    });
    const double step = pi / height;
    const GaussRule& rule = gauss_rule(std::min(kMaxGaussPoints, 4 + static_cast<int>(step * kMaxOrder)));
    MeridianSum sum;
    for (int interval = 0; interval <= height; ++interval) {
        end_if(stopped);
        const double from = interval == 0 ? 0.0 : (interval - 0.5) * step;
        const double to = interval == height ? pi : (interval + 0.5) * step;
        const RowIntegrals& above = rows[static_cast<std::size_t>(std::max(interval - 1, 0))];
        const RowIntegrals& below = rows[static_cast<std::size_t>(std::min(interval, height - 1))];
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            sum.add(from + rule.nodes[i] * (to - from), rule.weights[i] * (to - from), above, below, rule.nodes[i]);
        }
    }
    RadianceCoefficients result{};
    for (int l = 0; l < kMaxOrder; ++l) {
        for (const auto& channel : sum.sums()) {
            double power = 0;
            for (int m = -l; m <= l; ++m) {
                const double value = channel[static_cast<std::size_t>(coefficient_index(l, m))];
                power += value * value;
            }
            double& most = result.powers[static_cast<std::size_t>(l)];
            most = std::max(most, power);
        }
    }
    for (std::size_t c = 0; c < 3; ++c) {
        result.channels[c].assign(sum.sums()[c].begin(), sum.sums()[c].end());
    }
    return result;
}

}  // namespace shlight
