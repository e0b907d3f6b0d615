// SPDX-License-Identifier: MIT
//
// Normalised associated Legendre functions in the form that survives the pole:
//   P̂_l^m(z) = P̄_l^m(z) / sin^m θ,   P̄_l^m = K_l^m P_l^m,
// polynomials of degree l - m in z, produced band after band.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "shlight/types.h"

namespace shlight {

/// Index of (l, m ≥ 0) as an array subscript.
constexpr std::size_t at(int l, int m) { return static_cast<std::size_t>(cosine_index(l, m)); }

inline constexpr std::size_t kCosineMax = static_cast<std::size_t>(cosine_count(kMaxOrder));

/// Constants of the recurrences, the same for every light.
template <class T>
struct LegendreConstants {
    std::array<T, kMaxOrder> diagonal;     ///< P̂_m^m
    std::array<T, kCosineMax> step;        ///< P̂_l = step · z · P̂_{l-1} - back · P̂_{l-2}
    std::array<T, kCosineMax> back;        //
    std::array<T, kCosineMax> ladder;      ///< √((l-m)(l+m+1)), the ladder operators' factor
    std::array<T, kCosineMax> at_horizon;  ///< P̄_l^m(0), zero for odd l - m
    std::array<T, kCosineMax> dz_at_horizon;  ///< dP̄_l^m/dz (0), zero for even l - m

    static const LegendreConstants& get();
};

extern template struct LegendreConstants<float>;
extern template struct LegendreConstants<double>;

/// P̂_l^0 … P̂_l^l for l = 0, 1, 2, … at one z.
template <class T>
class LegendreRows {
  public:
    explicit LegendreRows(T z) : z_(z) { current_[0] = constants_.diagonal[0]; }

    int band() const { return l_; }
    /// P̂_l^m of the present band, m = 0 … l.
    const T* row() const { return current_; }
    T operator[](int m) const { return current_[m]; }

    /// Steps to the next band.
    void advance() {
        ++l_;
        const T* step = &constants_.step[at(l_, 0)];
        const T* back = &constants_.back[at(l_, 0)];
        for (int m = 0; m + 1 < l_; ++m) {
            previous_[m] = step[m] * z_ * current_[m] - back[m] * previous_[m];
        }
        previous_[l_ - 1] = step[l_ - 1] * z_ * current_[l_ - 1];
        previous_[l_] = constants_.diagonal[static_cast<std::size_t>(l_)];
        std::swap(current_, previous_);
    }

    LegendreRows(const LegendreRows&) = delete;
    LegendreRows& operator=(const LegendreRows&) = delete;

  private:
    const LegendreConstants<T>& constants_ = LegendreConstants<T>::get();
    T z_;
    int l_ = 0;
    T storage_[2][kMaxOrder + 1];
    T* current_ = storage_[0];
    T* previous_ = storage_[1];
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

/// out_cos[m] + i out_sin[m] = (x + i y)^m for m = 0 … count-1.
/// With x + iy on the unit circle these are cos mφ and sin mφ; by rotation, because 2 cos φ · f_{m-1} - f_{m-2} loses digits.
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
