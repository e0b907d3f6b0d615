// SPDX-License-Identifier: MIT
//
// Functions of floats as scripts of Open Shading Language have them in Cycles.
//
// They are polynomials of few terms, whose errors of up to 1e-4 a fractal makes large. A picture of it is the same only
// if each of them is rounded as there, so the order of operations counts, and which of them are fused to one. They are
// defined for all arguments.
#if defined(SHLIGHT_SCRIPT_FUNCTIONS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_SCRIPT_FUNCTIONS_INL_H_
#undef SHLIGHT_SCRIPT_FUNCTIONS_INL_H_
#else
#define SHLIGHT_SCRIPT_FUNCTIONS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE::script {

inline constexpr float kLeast = std::numeric_limits<float>::min(), kMost = std::numeric_limits<float>::max();
inline constexpr float kPi = 3.14159265358979323846F;
/// The integer towards 0, as x86 has it: the least one where no integer holds the number.
inline std::int32_t integer(float x) {
    return std::abs(x) < 0x1p31F ? static_cast<std::int32_t>(x) : std::numeric_limits<std::int32_t>::min();
}

/// The end of an interval that a number lies beyond, or the number; `low` for NaN.
inline float between(float x, float low, float high) {
    const float above = low <= x ? x : low;
    return above > high ? high : above;
}

/// The number as `at` rounds it, so that tiny ones are 0.
inline float without_tiny(float x, float at = 1) {
    return at - (at - x);
}

/// c0 + x (c1 + x (c2 + ...)), from the last coefficient on.
template <class... Rest>
float polynomial(float x, float first, Rest... rest) {
    if constexpr (sizeof...(rest) == 0) {
        return first;
    } else {
        return std::fma(polynomial(x, rest...), x, first);
    }
}

/// An angle less the nearest multiple q of `unit` pi, where q fits an integer.
struct Turn {
    float angle, odd;  // 1 where q is odd, else 0: floats, so that loops vectorise

    Turn(float x, float unit) {
        const std::int32_t q = integer(std::rint(x * (1 / kPi / unit)));
        const auto number = static_cast<float>(q);
        // pi in four parts, of which the first ones have few digits, so that their products are exact.
        angle = std::fma(number, -3.140625F * unit, x);
        angle = std::fma(number, -0.00024187564849853515625F * 4 * unit, angle);
        angle = std::fma(number, -3.7747668102383613586e-08F * 4 * unit, angle);
        angle = std::fma(number, -1.2816720341285448015e-12F * 4 * unit, angle);
        odd = static_cast<float>(q & 1);
    }
};

inline float sine(float x) {
    const Turn turn(x, 1);
    const float t = without_tiny(turn.angle, kPi / 2);
    const float s = t * t, a = turn.odd != 0 ? -t : t;
    const float p = polynomial(s, -0.166666597127914428710938F, 0.00833307858556509017944336F,
                               -0.0001981069071916863322258F, 2.6083159809786593541503e-06F);
    return between(std::fma(s, p * a, a), -1, 1);
}

inline float cosine(float x) {
    const Turn turn(x, 1);
    const float t = without_tiny(turn.angle, kPi / 2);
    const float c = polynomial(t * t, 1.0F, -0.5F, 0.0416666641831398010253906F, -0.00138888787478208541870117F,
                               2.47990446951007470488548e-05F, -2.71811842367242206819355e-07F);
    return between(turn.odd != 0 ? -c : c, -1, 1);
}

inline float tangent(float x) {
    const Turn turn(x, 0.5F);
    const float t = turn.odd != 0 ? turn.angle : without_tiny(turn.angle, kPi / 4);
    const float s = t * t;
    const float p =
        polynomial(s, 0.333331853151321411132812F, 0.133383005857467651367188F, 0.0534495301544666290283203F,
                   0.0242998078465461730957031F, 0.00331984995864331722259521F, 0.00927245803177356719970703F);
    const float u = std::fma(s, p * t, t);
    return turn.odd != 0 ? -1 / u : u;
}

/// start + sign times the arccosine of |x|.
inline float acute_arccosine(float x, float start = 0, float sign = 1) {
    const float a = std::abs(x), m = a < 1 ? without_tiny(a) : 1.0F;
    const float p = polynomial(m, 1.5707963267F, -0.213300989F, 0.077980478F, -0.02164095F);
    return std::fma(sign * std::sqrt(1 - m), p, start);
}

inline float arccosine(float x) {
    const float a = acute_arccosine(x);
    return x < 0 ? kPi - a : a;
}

inline float arcsine(float x) {
    return std::copysign(acute_arccosine(x, kPi / 2, -1), x);
}

/// The arctangent of 0 … 1.
inline float low_arctangent(float x) {
    const float s = without_tiny(x), t = s * s;
    return s * std::fma(0.430165678F, t, 1.0F) / std::fma(std::fma(0.0579354987F, t, 0.763007998F), t, 1.0F);
}

inline float arctangent(float x) {
    const float a = std::abs(x), r = low_arctangent(a > 1 ? 1 / a : a);
    return std::copysign(a > 1 ? kPi / 2 - r : r, x);
}

inline float arctangent2(float y, float x) {
    const float a = std::abs(x), b = std::abs(y);
    const float ratio = a == b ? 1 : b > a ? a / b : b / a;
    const float r = low_arctangent(b == 0 ? 0 : ratio), turned = b > a ? kPi / 2 - r : r;
    return std::copysign(std::signbit(x) ? kPi - turned : turned, y);
}

inline float logarithm2(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(between(value, kLeast, kMost));
    const float f = std::bit_cast<float>((bits & 0x007FFFFFU) | 0x3F800000U) - 1;
    const float f2 = f * f, f4 = f2 * f2;
    const float high =
        polynomial(f, -0.34730547155299F, 0.24187369696082F, -0.13753123777116F, 0.05206469089414F, -0.00931049621349F);
    const float low = polynomial(f, 1.442689881667200F, -0.72116591947498F, 0.47868480909345F);
    return std::fma(f4, high, f * low) + static_cast<float>(static_cast<std::int32_t>(bits >> 23U) - 127);
}

inline float logarithm(float x) {
    return logarithm2(x) * 0.693147180559945309417F;
}

inline float logarithm10(float x) {
    return logarithm2(x) * 0.301029995663981195214F;
}

/// The exponent of a float.
inline float exponent(float value) {
    const float x = std::min(std::max(std::abs(value), kLeast), kMost);
    return static_cast<float>(static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(x) >> 23U) - 127);
}

inline float power2(float value) {
    const float x = between(value, -126, 126);
    const std::int32_t whole = integer(x);
    const float r = polynomial(without_tiny(x - static_cast<float>(whole)), 1.0F, 0.693144857883F, 0.2401793301105F,
                               5.551834031939e-2F, 9.810352697968e-3F, 1.33336498402e-3F);
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(r) + (static_cast<std::uint32_t>(whole) << 23U));
}

inline float exponential(float x) {
    return power2(x * 1.44269504088896340736F);
}

inline float exponential_less_one(float x) {
    if (std::abs(x) < 0.03F) {
        const float y = without_tiny(x);
        return std::copysign(std::fma(0.5F, y * y, y), x);
    }
    return exponential(x) - 1;
}

inline float hyperbolic_sine(float x) {
    float a = std::abs(x);
    if (a > 1) {
        const float e = exponential(a);
        return std::copysign(0.5F * e - 0.5F / e, x);
    }
    a = without_tiny(a);
    const float square = a * a;
    const float r = polynomial(square, 0.1666673421859F, 8.32990277558e-3F, 2.03945513931e-4F);
    return std::copysign(std::fma(r * a, square, a), x);
}

inline float hyperbolic_cosine(float x) {
    const float e = exponential(std::abs(x));
    return 0.5F * e + 0.5F / e;
}

inline float hyperbolic_tangent(float x) {
    return std::copysign(1 - 2 / (1 + exponential(2 * std::abs(x))), x);
}

/// base^exponent; 0 where that is not real, and of 0. Its cases are chosen in the end, so that loops vectorise.
inline float power(float base, float exponent) {
    const bool is_whole = exponent == std::trunc(exponent);
    const float sign = base < 0 ? static_cast<float>(1 - 2 * (integer(exponent) & 1)) : 1;
    float found = sign * power2(exponent * logarithm2(std::abs(base)));
    found = base < 0 && !is_whole ? 0 : found;
    found = exponent == 2 ? std::min(base * base, kMost) : found;
    found = exponent == 1 ? base : found;
    found = base == 0 ? 0 : found;
    return exponent == 0 ? 1 : found;
}

inline float cube_root(float x) {
    const float size = std::abs(x);
    if (size == 0) {
        return x;
    }
    constexpr float kThird = 0.333333333F;
    auto a = std::bit_cast<float>(0x2A5137A0 + std::bit_cast<std::int32_t>(size) / 3);
    a = kThird * (2 * a + size / (a * a));
    a = kThird * (2 * a + size / (a * a));
    return std::copysign(a, x);
}

/// Abramowitz and Stegun, Handbook of Mathematical Functions, 7.1.28.
inline float error_function(float x) {
    const float r = polynomial(without_tiny(std::abs(x)), 1.0F, 0.0705230784F, 0.0422820123F, 0.0092705272F,
                               0.0001520143F, 0.0002765672F, 0.0000430638F);
    const float r2 = r * r, r4 = r2 * r2, r8 = r4 * r4;
    return std::copysign(1 - 1 / (r8 * r8), x);
}

/// What is left of a division whose quotient is cut to an integer; 0 of a division by 0.
inline float remainder(float a, float b) {
    return b != 0 ? std::fma(-static_cast<float>(integer(a / b)), b, a) : 0;
}

/// A quotient; 0 where it is not finite.
inline float quotient(float a, float b) {
    const float q = a / b;
    return std::isfinite(q) ? q : 0;
}

inline float smooth_step(float low, float high, float x) {
    if (x < low || x >= high) {
        return x < low ? 0 : 1;
    }
    const float t = (x - low) / (high - low);
    return (3 - 2 * t) * (t * t);
}

}  // namespace shlight::HWY_NAMESPACE::script
HWY_AFTER_NAMESPACE();

#endif
