// SPDX-License-Identifier: MIT
#include "cap_outline.h"

#include <cmath>
#include <numbers>

namespace shlight::methods {
namespace {

/// 1 - |cosσ| without cancellation.
template <class T>
T lack(const CapAngles<T>& cap) {
    return cap.sin_half * cap.sin_half / (1 + std::abs(cap.cos_half));
}

template <class T>
constexpr T kTurn = 2 * std::numbers::pi_v<T>;

/// sin²θ - cos²σ, positive where the circles cross, in the form with the smaller squares.
template <class T>
T squared_chord(const CapAngles<T>& cap, T sin_tilt) {
    const T cos_tilt = cap.axis.z;
    return cap.sin_half < std::abs(cap.cos_half) ? (cap.sin_half - cos_tilt) * (cap.sin_half + cos_tilt)
                                                 : (sin_tilt - cap.cos_half) * (sin_tilt + cap.cos_half);
}

}  // namespace

template <class T>
CapBoundary<T>::CapBoundary(const CapAngles<T>& cap, bool clip) {
    const T sin_tilt = std::hypot(cap.axis.x, cap.axis.y);
    const T chord2 = clip ? squared_chord(cap, sin_tilt) : T(0);
    crossing = chord2 > 0;
    if (crossing) {
        set_crossing(cap, sin_tilt, std::sqrt(chord2));
    } else if (!clip || (cap.cos_half >= 0 && cap.axis.z > 0)) {
        edge = kTurn<T>;
        solid_angle = kTurn<T> * (cap.cos_half > 0 ? lack(cap) : 1 - cap.cos_half);
    } else if (cap.cos_half < 0) {
        // Either the cap contains the upper hemisphere, or both together cover the sphere: then the edges add, and the
        // areas add to more than the sphere by the overlap.
        edge = cap.axis.z > 0 ? T(0) : kTurn<T>;
        horizon = kTurn<T>;
        solid_angle = cap.axis.z > 0 ? kTurn<T> : -kTurn<T> * cap.cos_half;
    }
}

/// Area by Gauss–Bonnet: Ω/2 = ψ_0 (1 - cosσ) + (β - ψ_0), with ψ_0 half the edge and β the turn at the crossing. This
/// is Eq. 21 without differences of large angles. A cap beyond a hemisphere uses its complement.
template <class T>
void CapBoundary<T>::set_crossing(const CapAngles<T>& cap, T sin_tilt, T chord) {
    const T cosine = cap.cos_half;
    const T cos_tilt = cap.axis.z;
    const T half_edge = std::atan2(chord, -cosine * cos_tilt);
    edge = 2 * half_edge;
    horizon = 2 * std::atan2(chord, cosine);

    const T turn = std::atan2(std::copysign(lack(cap), cosine) * chord * cos_tilt,
                              chord * chord + std::abs(cosine) * cos_tilt * cos_tilt);
    const T area = 2 * (half_edge * lack(cap) + turn);
    solid_angle = cosine < 0 ? kTurn<T> - area : area;

    const T radius = std::hypot(chord, cosine);  // sinθ but for rounding
    const T along = cosine / radius;
    const T across = chord / radius;
    const T x = cap.axis.x / sin_tilt;
    const T y = cap.axis.y / sin_tilt;
    left = {along * x + across * y, along * y - across * x, 0};
    right = {along * x - across * y, along * y + across * x, 0};
}

template struct CapBoundary<float>;
template struct CapBoundary<double>;

}  // namespace shlight::methods
