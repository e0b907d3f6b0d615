// SPDX-License-Identifier: MIT
//
// What each instruction of a script does, for several hits at a time.
#if defined(SHLIGHT_SCRIPT_INSTRUCTIONS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_SCRIPT_INSTRUCTIONS_INL_H_
#undef SHLIGHT_SCRIPT_INSTRUCTIONS_INL_H_
#else
#define SHLIGHT_SCRIPT_INSTRUCTIONS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string_view>
#include <type_traits>

#include "shaders/gradient_noise.h"
#include "shaders/script_functions-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE::script {

namespace hn = hwy::HWY_NAMESPACE;
using Word = std::uint32_t;
using Integer = std::int32_t;

/// Hits that a script runs for at the same time.
inline constexpr std::size_t kHits = 32;
template <class T>
struct alignas(kHits * sizeof(T)) PerHit : std::array<T, kHits> {};

/// All bits of a hit that something holds for.
inline constexpr Word kYes = ~0U;

/// Registers of each hit, and the hits that an instruction is for.
struct Machine {
    PerHit<Word>* registers;
    PerHit<Word> active;
};

struct Instruction;
using Act = void (*)(const Machine& machine, const Instruction& at);

/// Numbers of registers; `to` of a jump, which has no act, is the number of an instruction.
struct Instruction {
    Act act;
    Word to, a, b, c;
    bool is_conditional;
};

template <class T>
T read(const Machine& machine, Word index, std::size_t hit) {
    return std::bit_cast<T>(machine.registers[index][hit]);
}

template <class T>
Word word(T value) {
    if constexpr (std::is_same_v<T, bool>) {
        return static_cast<Word>(value);
    } else {
        return std::bit_cast<Word>(value);
    }
}

/// Gives active hits their values.
HWY_INLINE void keep(const Machine& machine, Word to, const PerHit<Word>& values) {
    const hn::CappedTag<Word, kHits> d;
    PerHit<Word>& kept = machine.registers[to];
    for (std::size_t hit = 0; hit < kHits; hit += hn::Lanes(d)) {
        const auto active = hn::Load(d, &machine.active[hit]);
        hn::Store(hn::IfVecThenElse(active, hn::Load(d, &values[hit]), hn::Load(d, &kept[hit])), d, &kept[hit]);
    }
}

/// Gives active hits what a function says of them. It is asked of all, so that the loop vectorises.
template <class Function>
void write(const Machine& machine, Word to, Function value) {
    PerHit<Word> values;
    for (std::size_t hit = 0; hit < kHits; ++hit) {
        values[hit] = word(value(hit));
    }
    keep(machine, to, values);
}

/// Acts that apply a function to one, two or three registers.
template <class T, auto kFunction>
inline constexpr Act one = [](const Machine& m, const Instruction& at) {
    write(m, at.to, [&](std::size_t hit) { return kFunction(read<T>(m, at.a, hit)); });
};
template <class T, auto kFunction>
inline constexpr Act two = [](const Machine& m, const Instruction& at) {
    write(m, at.to, [&](std::size_t hit) { return kFunction(read<T>(m, at.a, hit), read<T>(m, at.b, hit)); });
};
template <class T, auto kFunction>
inline constexpr Act three = [](const Machine& m, const Instruction& at) {
    write(m, at.to, [&](std::size_t hit) {
        return kFunction(read<T>(m, at.a, hit), read<T>(m, at.b, hit), read<T>(m, at.c, hit));
    });
};

/// Gradient noise, -1 … 1, at a place in as many registers.
template <std::size_t kCount>
void perlin(const Machine& machine, const Instruction& at) {
    std::array<PerHit<float>, kCount> places;
    PerHit<float> zeros{}, ones{}, found{};
    ones.fill(1);
    // One octave; of the arguments after it all are 0, which stands for no period and no footprint.
    std::array<const float*, 16> arguments{};
    arguments.fill(zeros.data());
    for (std::size_t i = 0; i < kCount; ++i) {
        for (std::size_t hit = 0; hit < kHits; ++hit) {
            places[i][hit] = read<float>(machine, at.a + static_cast<Word>(i), hit);
        }
        arguments[i] = places[i].data();
    }
    arguments[kCount] = ones.data();
    float* out = found.data();
    noise<kCount>({arguments.data(), &out, kHits, nullptr, nullptr, static_cast<Word>(Fractal::fbm_sum), nullptr});
    write(machine, at.to, [&](std::size_t hit) { return found[hit]; });
}

/// A. R. Smith, "Color Gamut Transform Pairs" (SIGGRAPH 1978).
inline void rgb_from_hsv(const Machine& machine, const Instruction& at) {
    std::array<PerHit<Word>, 3> found;
    for (std::size_t hit = 0; hit < kHits; ++hit) {
        const auto h = read<float>(machine, at.a, hit), s = read<float>(machine, at.a + 1, hit);
        const auto v = read<float>(machine, at.a + 2, hit);
        const float turn = 6 * (h - std::floor(h));
        const Integer sixth = integer(std::floor(turn));
        const float f = turn - static_cast<float>(sixth);
        const float p = v * (1 - s), q = v * (1 - s * f), t = v * (1 - s * (1 - f));
        const std::array<std::array<float, 3>, 6> colors = {
            {{v, t, p}, {q, v, p}, {p, v, t}, {p, q, v}, {t, p, v}, {v, p, q}}};
        const bool is_gray = s < 0.0001F;
        for (std::size_t i = 0; i < 3; ++i) {
            found[i][hit] = word(is_gray ? v : colors[sixth < 0 || sixth > 5 ? 5 : sixth][i]);
        }
    }
    for (Word i = 0; i < 3; ++i) {
        keep(machine, at.to + i, found[i]);
    }
}

/// An element of an array of `at.c` registers; the first or the last one in the place of what lies before or behind.
inline Word element(const Machine& machine, const Instruction& at, Word index, std::size_t hit) {
    return static_cast<Word>(std::clamp(read<Integer>(machine, index, hit), 0, static_cast<Integer>(at.c) - 1));
}
inline void load(const Machine& machine, const Instruction& at) {
    write(machine, at.to,
          [&](std::size_t hit) { return read<Word>(machine, at.a + element(machine, at, at.b, hit), hit); });
}
inline void store(const Machine& machine, const Instruction& at) {
    for (std::size_t hit = 0; hit < kHits; ++hit) {
        if (machine.active[hit] != 0) {
            machine.registers[at.to + element(machine, at, at.a, hit)][hit] = read<Word>(machine, at.b, hit);
        }
    }
}

// Divisions that have no result are 0; -1 is a divisor of its own, for the least integer has no negative.
inline constexpr Word kMinusOne = ~0U;
inline Word int_quotient(Word a, Word b) {
    if (b == 0 || b == kMinusOne) {
        return b == 0 ? 0 : 0 - a;
    }
    return std::bit_cast<Word>(std::bit_cast<Integer>(a) / std::bit_cast<Integer>(b));
}
inline Word int_remainder(Word a, Word b) {
    return b == 0 || b == kMinusOne ? 0 : std::bit_cast<Word>(std::bit_cast<Integer>(a) % std::bit_cast<Integer>(b));
}

inline Integer shifted_right(Integer a, Integer by) {
    return a >> (by & 31);
}

/// A component of a vector product: a0 b1 - a1 b0 of pairs of registers, rounded as in Cycles.
inline void cross_term(const Machine& machine, const Instruction& at) {
    const auto a = [&](Word i, std::size_t hit) { return read<float>(machine, at.a + i, hit); };
    const auto b = [&](Word i, std::size_t hit) { return read<float>(machine, at.b + i, hit); };
    write(machine, at.to, [&](std::size_t hit) { return std::fma(a(0, hit), b(1, hit), -(a(1, hit) * b(0, hit))); });
}

/// The scalar product of triples of registers, rounded as in Cycles.
inline void dot(const Machine& machine, const Instruction& at) {
    const auto a = [&](Word i, std::size_t hit) { return read<float>(machine, at.a + i, hit); };
    const auto b = [&](Word i, std::size_t hit) { return read<float>(machine, at.b + i, hit); };
    write(machine, at.to, [&](std::size_t hit) {
        return std::fma(a(2, hit), b(2, hit), std::fma(a(0, hit), b(0, hit), a(1, hit) * b(1, hit)));
    });
}

inline constexpr std::string_view kJump = "jump", kJumpUnless = "jump_unless", kLoad = "load", kStore = "store";

struct Named {
    std::string_view name;
    Act act;
};

inline constexpr std::array kInstructions = {
    Named{kJump, nullptr},
    Named{kJumpUnless, nullptr},
    Named{kLoad, &load},
    Named{kStore, &store},
    Named{"copy", one<Word, [](Word a) { return a; }>},
    Named{"add", two<float, std::plus<>{}>},
    Named{"sub", two<float, std::minus<>{}>},
    Named{"mul", two<float, std::multiplies<>{}>},
    Named{"div", two<float, quotient>},
    Named{"plain_div", two<float, std::divides<>{}>},
    Named{"fmod", two<float, remainder>},
    Named{"plain_fmod", two<float, [](float a, float b) { return std::fmod(a, b); }>},
    Named{"neg", one<float, std::negate<>{}>},
    Named{"min", two<float, [](float a, float b) { return a <= b ? a : b; }>},
    Named{"max", two<float, [](float a, float b) { return b < a ? a : b; }>},
    Named{"abs", one<float, [](float a) { return std::abs(a); }>},
    Named{"floor", one<float, [](float a) { return std::floor(a); }>},
    Named{"ceil", one<float, [](float a) { return std::ceil(a); }>},
    Named{"round", one<float, [](float a) { return std::round(a); }>},
    Named{"trunc", one<float, [](float a) { return std::trunc(a); }>},
    Named{"sign", one<float, [](float a) { return a < 0    ? -1.0F
                                                  : a == 0 ? 0.0F
                                                           : 1.0F; }>},
    Named{"step", two<float, [](float edge, float x) { return x < edge ? 0.0F : 1.0F; }>},
    Named{"smoothstep", three<float, smooth_step>},
    Named{"sqrt", one<float, [](float a) { return a >= 0 ? std::sqrt(a) : 0.0F; }>},
    Named{"inversesqrt", one<float, [](float a) { return 0 < a ? 1 / std::sqrt(a) : 0.0F; }>},
    Named{"cbrt", one<float, cube_root>},
    Named{"pow", two<float, power>},
    Named{"exp", one<float, exponential>},
    Named{"exp2", one<float, power2>},
    Named{"expm1", one<float, exponential_less_one>},
    Named{"log", one<float, logarithm>},
    Named{"log2", one<float, logarithm2>},
    Named{"log10", one<float, logarithm10>},
    Named{"logb", one<float, exponent>},
    Named{"erf", one<float, error_function>},
    Named{"erfc", one<float, [](float a) { return 1 - error_function(a); }>},
    Named{"sin", one<float, sine>},
    Named{"cos", one<float, cosine>},
    Named{"tan", one<float, tangent>},
    Named{"asin", one<float, arcsine>},
    Named{"acos", one<float, arccosine>},
    Named{"atan", one<float, arctangent>},
    Named{"atan2", two<float, arctangent2>},
    Named{"sinh", one<float, hyperbolic_sine>},
    Named{"cosh", one<float, hyperbolic_cosine>},
    Named{"tanh", one<float, hyperbolic_tangent>},
    Named{"perlin1", &perlin<1>},
    Named{"perlin2", &perlin<2>},
    Named{"perlin3", &perlin<3>},
    Named{"perlin4", &perlin<4>},
    Named{"dot", &dot},
    Named{"cross_term", &cross_term},
    Named{"hsv_to_rgb", &rgb_from_hsv},
    Named{"to_float", one<Integer, [](Integer a) { return static_cast<float>(a); }>},
    Named{"to_int", one<float, integer>},
    Named{"isnan", one<float, [](float a) { return std::isnan(a); }>},
    Named{"isinf", one<float, [](float a) { return std::isinf(a); }>},
    Named{"isfinite", one<float, [](float a) { return std::isfinite(a); }>},
    Named{"less", two<float, std::less<>{}>},
    Named{"less_equal", two<float, std::less_equal<>{}>},
    Named{"equal", two<float, std::equal_to<>{}>},
    Named{"int_less", two<Integer, std::less<>{}>},
    Named{"int_less_equal", two<Integer, std::less_equal<>{}>},
    Named{"int_equal", two<Integer, std::equal_to<>{}>},
    Named{"int_add", two<Word, std::plus<>{}>},
    Named{"int_sub", two<Word, std::minus<>{}>},
    Named{"int_mul", two<Word, std::multiplies<>{}>},
    Named{"int_div", two<Word, int_quotient>},
    Named{"int_mod", two<Word, int_remainder>},
    Named{"int_neg", one<Word, [](Word a) { return 0 - a; }>},
    Named{"int_abs", one<Word, [](Word a) { return (a & 0x80000000U) != 0 ? 0 - a : a; }>},
    Named{"int_min", two<Integer, [](Integer a, Integer b) { return std::min(a, b); }>},
    Named{"int_max", two<Integer, [](Integer a, Integer b) { return std::max(a, b); }>},
    Named{"bitand", two<Word, std::bit_and<>{}>},
    Named{"bitor", two<Word, std::bit_or<>{}>},
    Named{"xor", two<Word, std::bit_xor<>{}>},
    Named{"compl", one<Word, std::bit_not<>{}>},
    Named{"shl", two<Word, [](Word a, Word b) { return a << (b & 31U); }>},
    Named{"shr", two<Integer, shifted_right>},
    Named{"and", two<Word, [](Word a, Word b) { return a != 0 && b != 0; }>},
    Named{"or", two<Word, [](Word a, Word b) { return (a | b) != 0; }>},
    Named{"select", three<Word, [](Word a, Word b, Word c) { return a != 0 ? b : c; }>},
};

}  // namespace shlight::HWY_NAMESPACE::script
HWY_AFTER_NAMESPACE();

#endif
