// SPDX-License-Identifier: MIT
//
// What a light, as a kernel shades it, reflects of lobes with one boost.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "quad_truth.h"
#include "shlight/types.h"
#include "simd/lobe_arrays.h"

namespace shlight::testing {

/// BoostArrays of `count` views that share a boost.
class SharedBoost {
  public:
    SharedBoost(const truth::BoostInput& boost, std::size_t count) {
        const double r = 1 - boost.narrowness;
        const double gamma = (1 + r * r) / (boost.narrowness * (1 + r));
        const double speed = 2 * r / (1 + r * r);
        const double across = std::sin(boost.tilt);
        const double along = gamma * std::cos(boost.tilt);
        const double length = std::hypot(across, along);
        const std::array<double, 9> members = {
            across,    std::cos(boost.tilt), speed,          boost.narrowness * boost.narrowness / (1 + r * r),
            gamma,     across / length,      along / length, -speed * along / length,
            1 / length};
        for (std::size_t k = 0; k < members.size(); ++k) {
            members_[k].assign(count, members[k]);
        }
    }
    BoostArrays arrays() const {
        const auto at = [this](std::size_t k) { return members_[k].data(); };
        return {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8)};
    }

  private:
    std::array<std::vector<double>, 9> members_;
};

/// Under lobes with one boost, each with its own terms: row after row, of cosine_count(order) numbers.
/// shade(lights, lobe, views, values): the kernel's values for light 0, as often as there are lobes.
template <class Shade>
std::vector<float> shaded(const truth::BoostInput& boost, const std::vector<float>& terms, int order,
                          const Shade& shade) {
    const auto row = static_cast<std::size_t>(cosine_count(order));
    const std::size_t count = terms.size() / row;
    const std::size_t stride = (row + 15) / 16 * 16;
    std::vector<float> padded(count * stride);
    for (std::size_t i = 0; i < count; ++i) {
        std::copy_n(terms.data() + i * row, row, padded.data() + i * stride);
    }
    std::vector<std::uint32_t> views(count);
    std::iota(views.begin(), views.end(), 0U);
    const SharedBoost shared(boost, count);
    const std::vector<std::uint32_t> lights(count, 0);
    std::vector<float> values(count, std::numeric_limits<float>::quiet_NaN());
    shade(lights, LobeArrays{true, shared.arrays(), padded.data(), stride, order}, views, values);
    return values;
}

/// Cosine terms (m ≥ 0) of a light's image, found by shading lobes that are one harmonic each.
template <class Shade>
std::vector<float> boosted_terms(const truth::BoostInput& boost, int order, const Shade& shade) {
    const auto row = static_cast<std::size_t>(cosine_count(order));
    std::vector<float> terms(row * row);
    for (std::size_t k = 0; k < row; ++k) {
        terms[k * (row + 1)] = 1;
    }
    return shaded(boost, terms, order, shade);
}

/// The largest error of such terms; NaN if any is.
inline double largest_error(const truth::Coefficients& reference, int order, const std::vector<float>& terms) {
    double largest = 0;
    for (int l = 0; l < order; ++l) {
        for (int m = 0; m <= l; ++m) {
            const auto k = static_cast<std::size_t>(coefficient_index(l, m));
            const auto term = static_cast<double>(terms[static_cast<std::size_t>(cosine_index(l, m))]);
            const double error = std::abs((reference.high[k] - term) + reference.low[k]);
            largest = error <= largest ? largest : error;
        }
    }
    return largest;
}

}  // namespace shlight::testing
