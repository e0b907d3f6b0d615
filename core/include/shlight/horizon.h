// SPDX-License-Identifier: MIT
//
// The circle that clips light, at any height: the region above is {u : u_z ≥ z_0}.
//
// The plane of the surface is the horizon z_0 = 0; a lobe's warp moves it to another height (warp.h). What all lights
// need of it is worked out once.
#pragma once

#include <array>

#include "shlight/types.h"
#include "shlight/warp.h"

namespace shlight {

/// The Legendre functions along one horizon, P̄_l^m(z_0) and their slopes, with s_0 = √(1 - z_0²).
template <class T>
class Horizon {
  public:
    /// The horizon at `height` = z_0, with `sine` = s_0 > 0 given beside it because a narrow warp needs it, for the
    /// orders up to `order`. Costs O(order²), less than one light.
    Horizon(double height, double sine, int order);
    /// The image of the plane z = 0.
    Horizon(const Warp& warp, int order) : Horizon(warp.horizon_height(), warp.horizon_sine(), order) {}
    /// The plane z = 0 itself, for every order.
    static const Horizon& plane();

    double height() const { return height_; }
    double sine() const { return sine_; }
    int order() const { return order_; }
    /// s_0 P̄_l^m(z_0), m = 0 … l.
    const T* values(int l) const { return &values_[static_cast<std::size_t>(cosine_index(l, 0))]; }
    /// s_0² dP̄_l^m/dz(z_0), m = 0 … l.
    const T* slopes(int l) const { return &slopes_[static_cast<std::size_t>(cosine_index(l, 0))]; }

  private:
    static constexpr auto kCount = static_cast<std::size_t>(cosine_count(kMaxOrder));

    double height_, sine_;
    int order_;
    std::array<T, kCount> values_, slopes_;  // bands below order_ only
};

extern template class Horizon<float>;
extern template class Horizon<double>;

}  // namespace shlight
