// SPDX-License-Identifier: MIT
//
// Eq. 5 of Zhou & Wei 2020: outgoing radiance as the dot product of light and material coefficients.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// radiance[i] = Σ_k light[i·n² + k] · bsdf[i·n² + k], n = order.
/// Throws std::invalid_argument for an order outside 1 … 64 or sizes that do not fit.
template <class T>
void shade(std::span<const T> light, std::span<const T> bsdf, int order, std::span<T> radiance);

/// The same for a lobe given by its cosine terms (cosine_count(order) values) and one light of order'² coefficients,
/// order' ≥ order. A lobe with the mirror plane y = 0 has no other terms.
template <class T>
T shade_cosine(const T* light, const T* cosine_terms, int order);

}  // namespace shlight
