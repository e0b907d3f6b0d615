// SPDX-License-Identifier: MIT
//
// 113-bit arithmetic for the references that the tests compare with: elementary functions, Gauss–Legendre rules and
// normalised Legendre functions. Included by the quad_*.cpp files only; everyone else sees quad_truth.h.
#pragma once

#include <cmath>
#include <vector>

#include "quad_truth.h"

namespace shlight::truth {

#if __LDBL_MANT_DIG__ == 113  // on Arm, where GCC 12 has no other type of 113 bits
using quad = long double;
#else
__extension__ typedef __float128 quad;  // NOLINT(modernize-use-using): an alias-declaration takes no __extension__
#endif

}  // namespace shlight::truth

#if defined(__clang__)  // glibc has these functions, but hides their declarations from clang in C++
extern "C" {
shlight::truth::quad sqrtf128(shlight::truth::quad) noexcept;
shlight::truth::quad sinf128(shlight::truth::quad) noexcept;
shlight::truth::quad cosf128(shlight::truth::quad) noexcept;
shlight::truth::quad asinf128(shlight::truth::quad) noexcept;
shlight::truth::quad atan2f128(shlight::truth::quad, shlight::truth::quad) noexcept;
shlight::truth::quad expf128(shlight::truth::quad) noexcept;
shlight::truth::quad fabsf128(shlight::truth::quad) noexcept;
}
#endif

namespace shlight::truth {

/// π = 3.14159265358979323846264338327950288…
quad pi();

struct Vec3q {
    quad x, y, z;
};

inline Vec3q operator+(const Vec3q& a, const Vec3q& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3q operator-(const Vec3q& a, const Vec3q& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3q operator*(quad s, const Vec3q& a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline quad dot(const Vec3q& a, const Vec3q& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3q cross(const Vec3q& a, const Vec3q& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline quad length(const Vec3q& a) {
    return sqrtf128(dot(a, a));
}
inline Vec3q normalized(const Vec3q& a) {
    return (1 / length(a)) * a;
}
inline Vec3q quad_vector(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

/// Nodes and weights on [-1, 1].
struct GaussRule {
    std::vector<quad> nodes, weights;
};

/// The rule with `count` nodes, computed once. Thread-safe.
const GaussRule& gauss_rule(int count);

/// Constants of one order: what the loops below would otherwise compute over and over.
struct OrderTables {
    explicit OrderTables(int bands);

    int order;
    std::vector<quad> a, b;        ///< P̂_l = a z P̂_{l-1} - b P̂_{l-2}, at cosine_index(l, m)
    std::vector<quad> diagonal;    ///< P̂_m^m, a constant
    std::vector<quad> derivative;  ///< √(l(l+1)): P̄_l^0' = √(l(l+1)) P̂_l^1
};

/// The tables of one order, computed once. Thread-safe.
const OrderTables& order_tables(int order);

/// P̂_l^m(z) = P̄_l^m(z) / (1 - z²)^{m/2} with P̄ = K_l^m P_l^m, at cosine_index(l, m).
void reduced_legendre(const OrderTables& tables, quad z, std::vector<quad>& values);

/// Takes sums of order² quads to the form that tests compare with.
Coefficients rounded(const std::vector<quad>& values);

}  // namespace shlight::truth
