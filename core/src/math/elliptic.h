// SPDX-License-Identifier: MIT
//
// Jacobi's elliptic functions of real arguments by arithmetic–geometric means (Gauss; Abramowitz & Stegun 16.12, 17.6).
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace shlight {

/// sn, cn and dn for the complementary modulus k' in (0, 1]; the parameter is m = 1 - k'².
class EllipticFunctions {
  public:
    explicit EllipticFunctions(double complement) : complement_(complement) {
        double a = 1;
        double b = complement;
        // Each step doubles the number of correct digits; k' = 1e-300 takes eleven more steps to begin with.
        while (std::abs(a - b) > std::numeric_limits<double>::epsilon() * a && steps_ < kMostSteps) {
            levels_[steps_++] = {a, b, (a - b) / (a + b)};
            const double mean = (a + b) / 2;
            b = std::sqrt(a * b);
            a = mean;
        }
        mean_ = (a + b) / 2;
        scale_ = std::ldexp(mean_, steps_);
    }

    double complement() const { return complement_; }
    /// K: sn, cn and dn have the periods 4K, 4K and 2K.
    double quarter_period() const { return std::numbers::pi / (2 * mean_); }

    struct Values {
        double sn, cn, dn;
    };
    /// Gauss's (descending Landen's) transformation. 1 - ratio sn² is formed as a sum, which cannot cancel.
    Values at(double u) const {
        const double phi = mean_ * u;
        Values f = {std::sin(phi), std::cos(phi), 1};
        for (int i = steps_; i-- > 0;) {
            const Level& level = levels_[static_cast<std::size_t>(i)];
            const double over = 1 / (1 + level.ratio * f.sn * f.sn);
            const double dn = (2 * level.b / (level.a + level.b) + level.ratio * f.cn * f.cn) * over;
            f = {(1 + level.ratio) * f.sn * over, f.cn * f.dn * over, dn};
        }
        return f;
    }

    /// The argument u with sn u : cn u = k'⁻¹ sin τ : cos τ. It grows with τ, by 4K for a whole turn.
    double argument(double tau) const {
        constexpr double kTurn = 2 * std::numbers::pi;
        // The angle with this sine and cosine that lies in the quadrant of `angle`, which rounding may put on its edge.
        const auto next_to = [](double angle, double sine, double cosine) {
            const double other = std::atan2(sine, cosine);
            return other + kTurn * std::round((angle - other) / kTurn);
        };
        const double turns = std::round(tau / kTurn);
        const double rest = tau - kTurn * turns;
        // tan(φ_{n+1} - φ_n) = b/a tan φ_n, and the first of these differences is τ itself.
        double phi = next_to(rest, std::sin(rest), complement_ * std::cos(rest));
        for (int i = 0; i < steps_; ++i) {
            const Level& level = levels_[static_cast<std::size_t>(i)];
            phi += next_to(phi, level.b * std::sin(phi), level.a * std::cos(phi));
        }
        return phi / scale_ + 4 * quarter_period() * turns;
    }

  private:
    static constexpr int kMostSteps = 24;
    struct Level {
        double a, b;
        double ratio;  ///< (a-b)/(a+b), the modulus of the next level
    };

    double complement_, mean_, scale_;
    int steps_ = 0;
    std::array<Level, kMostSteps> levels_;
};

}  // namespace shlight
