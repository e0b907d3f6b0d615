// SPDX-License-Identifier: MIT
#include "shlight/shading.h"

#include "base/checks.h"
#include "simd/dot_products.h"

namespace shlight {

template <class T>
void shade(std::span<const T> light, std::span<const T> bsdf, int order, std::span<T> radiance) {
    check_order(order);
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("light", light.size(), radiance.size() * row);
    check_size("bsdf", bsdf.size(), light.size());
    dot_products(light.data(), bsdf.data(), row, radiance.size(), radiance.data());
}

template <class T>
T shade_cosine(const T* light, const T* cosine_terms, int order) {
    T sum = 0;
    for (int l = 0; l < order; ++l) {
        const T* band = light + coefficient_index(l, 0);
        const T* terms = cosine_terms + cosine_index(l, 0);
        for (int m = 0; m <= l; ++m) {
            sum += band[m] * terms[m];
        }
    }
    return sum;
}

template void shade(std::span<const float>, std::span<const float>, int, std::span<float>);
template void shade(std::span<const double>, std::span<const double>, int, std::span<double>);
template float shade_cosine(const float*, const float*, int);
template double shade_cosine(const double*, const double*, int);

}  // namespace shlight
