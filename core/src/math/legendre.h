// SPDX-License-Identifier: MIT
//
// Normalised associated Legendre functions, divided by sin^m θ so that they are finite and exact at the poles:
//   P̂_l^m(z) = P̄_l^m(z) / sin^m θ,   P̄_l^m = K_l^m P_l^m (Eq. 2 of the paper),
// which are polynomials of degree l - m in z, computed band after band.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "shlight/types.h"

namespace shlight {

/// cosine_index(l, m) as an array subscript.
constexpr std::size_t at(int l, int m) {
    return static_cast<std::size_t>(cosine_index(l, m));
}

inline constexpr std::size_t kCosineMax = static_cast<std::size_t>(cosine_count(kMaxOrder));

/// Constants of the recurrences, which do not depend on the light.
template <class T>
struct LegendreConstants {
    std::array<T, kMaxOrder> diagonal;  ///< P̂_m^m
    std::array<T, kCosineMax> step;     ///< P̂_l = step · z · P̂_{l-1} - back · P̂_{l-2}
    std::array<T, kCosineMax> back;     //
    std::array<T, kCosineMax> ladder;   ///< √((l-m)(l+m+1)), the ladder operators' factor
    std::array<T, kCosineMax> at_pole;  ///< P̂_l^m(1)

    static const LegendreConstants& get();
};

extern template struct LegendreConstants<float>;
extern template struct LegendreConstants<double>;

/// sin²θ below which LegendreRows uses differences, because the recurrence in z amplifies roundings by l² there.
inline constexpr double kNearPole = 0.0156;

/// P̂_l^0 … P̂_l^l for l = 0, 1, 2, … at one z = cosθ.
///
/// Near a pole P̂_l^m differs from its value there by about l²/2 · (1 - |z|), so the usual recurrence would amplify the
/// rounding of z, and of each step, by l². There the recurrence (2) of docs/theory.md runs on the differences of R_l =
/// P̂_l / P̂_l(1),
///   (l+m) (R_l - R_{l-1}) = (l-m-1) (R_{l-1} - R_{l-2}) - (2l-1) (1-|z|) R_{l-1},   1 - |z| = sin²θ / (1 + |z|).
template <class T>
class LegendreRows {
  public:
    LegendreRows(T z, T sine_squared) : z_(z), near_pole_(sine_squared < static_cast<T>(kNearPole)) {
        row_[0] = constants_.diagonal[0];
        other_[0] = 0;
        if (near_pole_) {
            distance_ = sine_squared / (1 + std::abs(z));
            state_[0] = 1;
        }
    }

    int band() const { return l_; }
    /// P̂_l^m of the current band, m = 0 … l.
    const T* row() const { return row_.data(); }
    T operator[](int m) const { return row_[m]; }

    /// Steps to the next band.
    void advance() {
        ++l_;
        if (near_pole_) {
            advance_near_pole();
        } else {
            advance_by_z();
        }
    }

  private:
    /// other_ holds the previous band.
    void advance_by_z() {
        const T* step = &constants_.step[at(l_, 0)];
        const T* back = &constants_.back[at(l_, 0)];
        for (int m = 0; m < l_; ++m) {
            const T next = step[m] * z_ * row_[m] - back[m] * other_[m];
            other_[m] = row_[m];
            row_[m] = next;
        }
        row_[l_] = constants_.diagonal[l_];
        other_[l_] = 0;
    }

    /// state_ holds R_l, other_ the difference R_l - R_{l-1}.
    void advance_near_pole() {
        const T* at_pole = &constants_.at_pole[at(l_, 0)];
        const T slope = static_cast<T>(2 * l_ - 1) * distance_;
        T sign = z_ < 0 && l_ % 2 == 1 ? T(-1) : T(1);
        for (int m = 0; m < l_; ++m) {
            other_[m] = (static_cast<T>(l_ - m - 1) * other_[m] - slope * state_[m]) / static_cast<T>(l_ + m);
            state_[m] += other_[m];
            row_[m] = sign * at_pole[m] * state_[m];
            sign = z_ < 0 ? -sign : sign;  // P̂_l^m(-z) = (-1)^(l-m) P̂_l^m(z)
        }
        state_[l_] = 1;
        other_[l_] = 0;
        row_[l_] = constants_.diagonal[l_];
    }

    const LegendreConstants<T>& constants_ = LegendreConstants<T>::get();
    T z_;
    T distance_ = 0;
    bool near_pole_;
    int l_ = 0;
    std::array<T, kMaxOrder> row_;
    std::array<T, kMaxOrder> state_;
    std::array<T, kMaxOrder> other_;
};

/// out[m] = base^m for m = 0 … count-1.
template <class T>
void powers(T base, int count, T* out) {
    T power = 1;
    for (int m = 0; m < count; ++m) {
        out[m] = power;
        power *= base;
    }
}

/// out_cos[m] + i out_sin[m] = (x + i y)^m for m = 0 … count-1. On the unit circle these are cos mφ and sin mφ. The
/// product is used since 2 cos φ · f_{m-1} - f_{m-2} loses digits.
template <class T>
void complex_powers(T x, T y, int count, T* out_cos, T* out_sin) {
    T re = 1;
    T im = 0;
    for (int m = 0; m < count; ++m) {
        out_cos[m] = re;
        out_sin[m] = im;
        const T next = re * x - im * y;
        im = re * y + im * x;
        re = next;
    }
}

}  // namespace shlight
