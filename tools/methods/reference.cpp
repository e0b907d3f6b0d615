// SPDX-License-Identifier: MIT
//
// Quadrature over slices of constant z in 113 bits, independent of every other formula here, rounded at the end.
#include <cmath>
#include <vector>

#include "method.h"
#include "quad_truth.h"

namespace shlight::methods {
namespace {

template <class T>
void round_to(const truth::Coefficients& exact, T* coefficients) {
    for (std::size_t i = 0; i < exact.high.size(); ++i) {
        coefficients[i] = static_cast<T>(exact.high[i]);
    }
}

template <class T>
void cap(const CapLight& light, int order, bool clip, const Options& /*options*/, T* coefficients) {
    using Kind = truth::CapInput::Kind;
    const Kind kind = light.kind == CapLight::Kind::sphere ? Kind::sphere : Kind::angle;
    round_to(truth::cap({light.axis, kind, light.size}, order, clip), coefficients);
}

template <class T>
void polygon(std::span<const Vec3<T>> vertices, int order, bool clip, const Options& /*options*/, T* coefficients) {
    const std::vector<Vec3d> exact(vertices.begin(), vertices.end());
    round_to(truth::polygon(exact, order, clip), coefficients);
}

}  // namespace

Method reference() {
    return {"reference",
            "docs/theory.md, 3.6: quadrature over slices in 113 bits",
            kMaxOrder,
            false,
            false,
            {&cap<float>, &polygon<float>},
            {&cap<double>, &polygon<double>}};
}

}  // namespace shlight::methods
