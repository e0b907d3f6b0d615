// SPDX-License-Identifier: MIT
//
// The library's method, registered for comparison with the others.
#include "method.h"
#include "shlight/cap.h"
#include "shlight/polygon.h"

namespace shlight::methods {
namespace {

template <class T>
void cap(const CapLight& light, int order, bool clip, const Options& /*options*/, T* coefficients) {
    const Vec3<T> axis(light.axis);
    const auto size = static_cast<T>(light.size);
    const std::span<T> row(coefficients, static_cast<std::size_t>(order * order));
    if (light.kind == CapLight::Kind::sphere) {
        sphere_coefficients<T>({&axis, 1}, {&size, 1}, order, clip, row);
    } else {
        cap_coefficients<T>({&axis, 1}, {&size, 1}, order, clip, row);
    }
}

template <class T>
void polygon(std::span<const Vec3<T>> vertices, int order, bool clip, const Options& /*options*/, T* coefficients) {
    polygon_coefficients(vertices, static_cast<int>(vertices.size()), order, clip,
                         std::span<T>(coefficients, static_cast<std::size_t>(order * order)));
}

}  // namespace

Method exact() {
    return {"exact",
            "docs/theory.md, 2 to 4: ladder recurrences in the degree, O(n²)",
            kMaxOrder,
            false,
            false,
            {&cap<float>, &polygon<float>},
            {&cap<double>, &polygon<double>}};
}

}  // namespace shlight::methods
