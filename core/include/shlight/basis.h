// SPDX-License-Identifier: MIT
//
// The real spherical harmonic basis and the evaluation of expansions in it.
//
//   Y_l0 = P̄_l^0(z),  Y_lm = √2 P̄_l^m(z) cos mφ,  Y_l,-m = √2 P̄_l^m(z) sin mφ   (m > 0)
//
// with P̄_l^m = K_l^m P_l^m (Zhou & Wei 2020, Eq. 2, without Condon–Shortley phase).
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// The basis in one direction. `direction` must be a unit vector; writes order² values to `basis`.
template <class T>
void sh_basis(const Vec3<T>& direction, int order, T* basis);

/// The basis in many directions, of any length > 0 (they are normalised).
/// basis: directions.size() × order², row by row.
/// Throws std::invalid_argument for an order outside 1 … 64, a size that does not fit, a zero or non-finite direction.
template <class T>
void sh_basis(std::span<const Vec3<T>> directions, int order, std::span<T> basis, Output output = Output::cached);

/// values[i] = Σ coefficients[i·order² + k] · basis_k(directions[i]).
/// Throws as sh_basis does.
template <class T>
void evaluate(std::span<const T> coefficients, std::span<const Vec3<T>> directions, int order, std::span<T> values);

}  // namespace shlight
