// SPDX-License-Identifier: MIT
#include "math/band_rotation.h"

#include <cmath>
#include <cstdlib>

#include "math/legendre.h"

namespace shlight {
namespace {

/// Rotation matrices of real harmonics, each band from the one before (Ivanic & Ruedenberg 1996, erratum 1998). Element
/// (m, n) is the coefficient of Y_lm in the rotated Y_ln.
class BandMatrices {
  public:
    explicit BandMatrices(const glm::dmat3& rotation) {
        // The harmonics of band 1 are proportional to (y, z, x).
        constexpr std::array<int, 3> kAxes = {1, 2, 0};
        band_.resize(9);
        for (int m = -1; m <= 1; ++m) {
            for (int n = -1; n <= 1; ++n) {
                one_[static_cast<std::size_t>(m + 1)][static_cast<std::size_t>(n + 1)] =
                    rotation[kAxes[static_cast<std::size_t>(n + 1)]][kAxes[static_cast<std::size_t>(m + 1)]];
                band_[index(1, m, n)] = first(m, n);
            }
        }
    }

    int band() const { return l_; }
    double operator()(int m, int n) const { return band_[index(l_, m, n)]; }

    void advance() {
        ++l_;
        before_.swap(band_);
        band_.assign(static_cast<std::size_t>((2 * l_ + 1) * (2 * l_ + 1)), 0.0);
        for (int m = -l_; m <= l_; ++m) {
            for (int n = -l_; n <= l_; ++n) {
                band_[index(l_, m, n)] = element(m, n);
            }
        }
    }

  private:
    static std::size_t index(int l, int m, int n) { return static_cast<std::size_t>((m + l) * (2 * l + 1) + n + l); }
    double first(int m, int n) const { return one_[static_cast<std::size_t>(m + 1)][static_cast<std::size_t>(n + 1)]; }
    double before(int m, int n) const { return before_[index(l_ - 1, m, n)]; }

    double product(int i, int m, int n) const {
        if (n == l_) {
            return first(i, 1) * before(m, l_ - 1) - first(i, -1) * before(m, 1 - l_);
        }
        if (n == -l_) {
            return first(i, 1) * before(m, 1 - l_) + first(i, -1) * before(m, l_ - 1);
        }
        return first(i, 0) * before(m, n);
    }

    double element(int m, int n) const {
        const int a = std::abs(m);
        const double denominator = std::abs(n) == l_ ? 2.0 * l_ * (2 * l_ - 1) : 1.0 * (l_ + n) * (l_ - n);
        double sum = 0;
        if (a < l_) {
            sum += std::sqrt((l_ + m) * (l_ - m) / denominator) * product(0, m, n);
        }
        const double next = 0.5 * std::sqrt((l_ + a - 1) * (l_ + a) / denominator);
        const double over = 0.5 * std::sqrt((l_ - a - 1) * (l_ - a) / denominator);
        if (m == 0) {
            sum -= std::sqrt(2.0) * next * (product(1, 1, n) + product(-1, -1, n));
        } else if (m > 0) {
            sum += m == 1 ? std::sqrt(2.0) * next * product(1, 0, n)
                          : next * (product(1, m - 1, n) - product(-1, 1 - m, n));
        } else {
            sum += m == -1 ? std::sqrt(2.0) * next * product(-1, 0, n)
                           : next * (product(1, m + 1, n) + product(-1, -m - 1, n));
        }
        if (m != 0 && a < l_ - 1) {
            sum -= over * (m > 0 ? product(1, m + 1, n) + product(-1, -m - 1, n)
                                 : product(1, m - 1, n) - product(-1, 1 - m, n));
        }
        return sum;
    }

    int l_ = 1;
    std::array<std::array<double, 3>, 3> one_{};
    std::vector<double> band_, before_;
};

/// Number 0 … 3 of a symmetry class: whether a harmonic is odd under x → -x, and under a second mirror.
int symmetry(bool odd_in_x, bool odd_in_other) {
    return (odd_in_x ? 2 : 0) + (odd_in_other ? 1 : 0);
}

bool odd_in_x(int m) {
    return (m % 2 != 0) != (m < 0);
}

}  // namespace

const QuarterTurn& QuarterTurn::get() {
    static const QuarterTurn turn;
    return turn;
}

QuarterTurn::QuarterTurn() : bands_(kMaxOrder) {
    BandMatrices matrices(glm::dmat3(1, 0, 0, 0, 0, 1, 0, -1, 0));
    for (int l = 1; l < kMaxOrder; ++l) {
        auto& blocks = bands_[static_cast<std::size_t>(l)];
        for (int m = -l; m <= l; ++m) {
            const bool odd_in_z = (l + m) % 2 != 0;
            blocks[static_cast<std::size_t>(symmetry(odd_in_x(m), m < 0))].from.push_back(m + l);
            blocks[static_cast<std::size_t>(symmetry(odd_in_x(m), odd_in_z))].to.push_back(m + l);
        }
        for (Block& block : blocks) {
            for (const int from : block.from) {
                for (const int to : block.to) {
                    block.columns.push_back(static_cast<float>(matrices(to - l, from - l)));
                }
            }
            for (const int to : block.to) {
                for (const int from : block.from) {
                    block.rows.push_back(static_cast<float>(matrices(to - l, from - l)));
                }
            }
        }
        matrices.advance();
    }
}

void BandRotation::Turn::set(double cosine, double sine) {
    std::array<double, kMaxOrder> c, s;
    complex_powers(cosine, sine, kMaxOrder, c.data(), s.data());
    for (std::size_t m = 0; m < kMaxOrder; ++m) {
        cosines[m] = static_cast<float>(c[m]);
        sines[m] = static_cast<float>(s[m]);
    }
}

BandRotation::BandRotation(const glm::dmat3& rotation) {
    auto& [first, second, third] = turns_;
    const Vec3d& z = rotation[2];
    const double sine = std::hypot(z.x, z.y);
    second.set(z.z, sine);
    // Near the poles only the sum of the outer angles is known.
    if (sine > 1e-9) {
        first.set(-rotation[0].z / sine, rotation[1].z / sine);
        third.set(z.x / sine, z.y / sine);
    } else {
        const Vec3d& y = rotation[1];
        const double length = std::hypot(y.x, y.y);
        first.set(1, 0);
        third.set(y.y / length, -y.x / length);
    }
}

}  // namespace shlight
