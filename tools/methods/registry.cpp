// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <string>

#include "base/checks.h"
#include "method.h"

// One line for each method.
#define SHLIGHT_METHODS(METHOD) \
    METHOD(exact)               \
    METHOD(zhou_wei)            \
    METHOD(snyder)              \
    METHOD(wang_ramamoorthi)    \
    METHOD(quadrature)          \
    METHOD(monte_carlo)         \
    METHOD(reference)

#define SHLIGHT_SHADING_METHODS(METHOD) \
    METHOD(plain_harmonics)             \
    METHOD(warped_harmonics)            \
    METHOD(outline)                     \
    METHOD(cubature)                    \
    METHOD(quadrature_shading)          \
    METHOD(monte_carlo_shading)

namespace shlight::methods {

#define SHLIGHT_DECLARE(name) Method name();
SHLIGHT_METHODS(SHLIGHT_DECLARE)
#undef SHLIGHT_DECLARE
#define SHLIGHT_DECLARE(name) ShadingMethod name();
SHLIGHT_SHADING_METHODS(SHLIGHT_DECLARE)
#undef SHLIGHT_DECLARE

namespace {

template <class M>
const M& find(std::span<const M> all, std::string_view name) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const M& method) { return method.name == name; });
    if (found == all.end()) {
        std::string known;
        for (const M& method : all) {
            known += (known.empty() ? "'" : ", '") + std::string(method.name) + "'";
        }
        reject("method must be one of " + known + ", got '" + std::string(name) + "'");
    }
    return *found;
}

}  // namespace

#define SHLIGHT_CALL(name) name(),
std::span<const Method> all_methods() {
    static const std::array methods = {SHLIGHT_METHODS(SHLIGHT_CALL)};
    return methods;
}

std::span<const ShadingMethod> all_shading_methods() {
    static const std::array methods = {SHLIGHT_SHADING_METHODS(SHLIGHT_CALL)};
    return methods;
}
#undef SHLIGHT_CALL

const Method& find_method(std::string_view name) {
    return find(all_methods(), name);
}

const ShadingMethod& find_shading_method(std::string_view name) {
    return find(all_shading_methods(), name);
}

}  // namespace shlight::methods
