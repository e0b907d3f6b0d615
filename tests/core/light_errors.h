// SPDX-License-Identifier: MIT
//
// Errors of the coefficients of lights against the 113-bit reference, in both precisions and at several orders.
#pragma once

#include <array>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "error_record.h"
#include "quad_truth.h"

namespace shlight::testing {

/// The largest error of a light's coefficients ÷ its L_00; 0 for lights that are not seen at all.
template <class T>
double relative_error(const truth::Coefficients& reference, int order, const std::vector<T>& computed) {
    const double largest = truth::largest_error(reference, order, computed.data());
    return largest == 0 ? 0 : largest / reference.high[0];
}

struct BothErrors {
    ErrorRecord float64, float32;
};

/// Errors of `count` lights at each order, found on two threads and published. measure(i): returns both errors of light
/// i at an order.
template <class Measure>
std::vector<BothErrors> errors_by_order(const char* name, std::size_t count, const std::vector<int>& orders,
                                        const Measure& measure) {
    std::vector<BothErrors> errors(orders.size(), {ErrorRecord(count), ErrorRecord(count)});
    on_two_threads(count, [&](std::size_t i) {
        const auto at_order = measure(i);
        for (std::size_t k = 0; k < orders.size(); ++k) {
            const std::array<double, 2> both = at_order(orders[k]);
            errors[k].float64[i] = both[0];
            errors[k].float32[i] = both[1];
        }
    });
    for (std::size_t k = 0; k < orders.size(); ++k) {
        const std::string named = std::string(name) + ", n = " + std::to_string(orders[k]);
        errors[k].float64.publish(named + ", float64");
        errors[k].float32.publish(named + ", float32");
    }
    return errors;
}

/// A light by the vectors that define it, with all their digits.
inline std::string describe(std::span<const Vec3d> vectors, bool clip) {
    std::string text = clip ? "clipped" : "unclipped";
    for (const Vec3d& v : vectors) {
        std::array<char, 100> vector{};
        std::snprintf(vector.data(), vector.size(), " {%.17g, %.17g, %.17g}", v.x, v.y, v.z);
        text += vector.data();
    }
    return text;
}

}  // namespace shlight::testing
