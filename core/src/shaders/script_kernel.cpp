// SPDX-License-Identifier: MIT
#include "shaders/script_kernel.h"

// Compiled for each instruction set, because those without fused operations have functions for them.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shaders/script_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "base/checks.h"
#include "shaders/gradient_noise.h"
#include "shaders/script_functions-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

using Word = std::uint32_t;
using Integer = std::int32_t;

struct Instruction;
using Act = void (*)(Word* registers, const Instruction& at);

/// Numbers of registers; `to` of a jump, which has no act, is the number of an instruction.
struct Instruction {
    Act act;
    Word to, a, b, c;
    bool is_conditional;
};

template <class T>
T read(const Word* registers, Word index) {
    return std::bit_cast<T>(registers[index]);
}

template <class T>
void write(Word* registers, Word index, T value) {
    if constexpr (std::is_same_v<T, bool>) {
        registers[index] = static_cast<Word>(value);
    } else {
        registers[index] = std::bit_cast<Word>(value);
    }
}

/// Acts that apply a function to one, two or three registers.
template <class T, auto kFunction>
constexpr Act one = [](Word* r, const Instruction& at) { write(r, at.to, kFunction(read<T>(r, at.a))); };
template <class T, auto kFunction>
constexpr Act two =
    [](Word* r, const Instruction& at) { write(r, at.to, kFunction(read<T>(r, at.a), read<T>(r, at.b))); };
template <class T, auto kFunction>
constexpr Act three = [](Word* r, const Instruction& at) {
    write(r, at.to, kFunction(read<T>(r, at.a), read<T>(r, at.b), read<T>(r, at.c)));
};

/// Gradient noise, -1 … 1, at a place in as many registers.
template <std::size_t kCount>
void perlin(Word* registers, const Instruction& at) {
    constexpr std::size_t kLanes = 16;
    std::array<std::array<float, kLanes>, kCount> places{};
    std::array<float, kLanes> zeros{}, ones{}, result{};
    ones.fill(1);
    // One octave; of the arguments after it all are 0, which stands for no period and no footprint.
    std::array<const float*, 16> arguments{};
    arguments.fill(zeros.data());
    for (std::size_t i = 0; i < kCount; ++i) {
        places[i].fill(read<float>(registers, at.a + static_cast<Word>(i)));
        arguments[i] = places[i].data();
    }
    arguments[kCount] = ones.data();
    float* out = result.data();
    noise<kCount>({arguments.data(), &out, 1, nullptr, nullptr, static_cast<Word>(Fractal::fbm_sum), nullptr});
    write(registers, at.to, result[0]);
}

/// A. R. Smith, "Color Gamut Transform Pairs" (SIGGRAPH 1978).
void rgb_from_hsv(Word* registers, const Instruction& at) {
    const auto h = read<float>(registers, at.a), s = read<float>(registers, at.a + 1);
    const auto v = read<float>(registers, at.a + 2);
    const float turn = 6 * (h - std::floor(h));
    const Integer sixth = script::integer(std::floor(turn));
    const float f = turn - static_cast<float>(sixth);
    const float p = v * (1 - s), q = v * (1 - s * f), t = v * (1 - s * (1 - f));
    const std::array<std::array<float, 3>, 6> colors = {
        {{v, t, p}, {q, v, p}, {p, v, t}, {p, q, v}, {t, p, v}, {v, p, q}}};
    const bool is_gray = s < 0.0001F;
    for (Word i = 0; i < 3; ++i) {
        write(registers, at.to + i, is_gray ? v : colors[sixth < 0 || sixth > 5 ? 5 : sixth][i]);
    }
}

/// An element of an array of `at.c` registers; the first or the last one in the place of what lies before or behind.
Word element(const Word* registers, const Instruction& at, Word index) {
    return static_cast<Word>(std::clamp(read<Integer>(registers, index), 0, static_cast<Integer>(at.c) - 1));
}
void load(Word* registers, const Instruction& at) {
    registers[at.to] = registers[at.a + element(registers, at, at.b)];
}
void store(Word* registers, const Instruction& at) {
    registers[at.to + element(registers, at, at.a)] = registers[at.b];
}

// Divisions that have no result are 0; -1 is a divisor of its own, for the least integer has no negative.
constexpr Word kMinusOne = ~0U;
Word int_quotient(Word a, Word b) {
    if (b == 0 || b == kMinusOne) {
        return b == 0 ? 0 : 0 - a;
    }
    return std::bit_cast<Word>(std::bit_cast<Integer>(a) / std::bit_cast<Integer>(b));
}
Word int_remainder(Word a, Word b) {
    return b == 0 || b == kMinusOne ? 0 : std::bit_cast<Word>(std::bit_cast<Integer>(a) % std::bit_cast<Integer>(b));
}

Integer shifted_right(Integer a, Integer by) {
    return a >> (by & 31);
}

/// A component of a vector product: a0 b1 - a1 b0 of pairs of registers, rounded as in Cycles.
void cross_term(Word* registers, const Instruction& at) {
    const float second = read<float>(registers, at.a + 1) * read<float>(registers, at.b);
    write(registers, at.to, std::fma(read<float>(registers, at.a), read<float>(registers, at.b + 1), -second));
}

/// The scalar product of triples of registers, rounded as in Cycles.
void dot(Word* registers, const Instruction& at) {
    const auto product = [&](Word i, float rest) {
        return std::fma(read<float>(registers, at.a + i), read<float>(registers, at.b + i), rest);
    };
    const float y = read<float>(registers, at.a + 1) * read<float>(registers, at.b + 1);
    write(registers, at.to, product(2, product(0, y)));
}

constexpr std::string_view kJump = "jump", kJumpUnless = "jump_unless", kLoad = "load", kStore = "store";

struct Named {
    std::string_view name;
    Act act;
};

constexpr std::array kInstructions = {
    Named{kJump, nullptr},
    Named{kJumpUnless, nullptr},
    Named{kLoad, &load},
    Named{kStore, &store},
    Named{"copy", one<Word, [](Word a) { return a; }>},
    Named{"add", two<float, std::plus<>{}>},
    Named{"sub", two<float, std::minus<>{}>},
    Named{"mul", two<float, std::multiplies<>{}>},
    Named{"div", two<float, script::quotient>},
    Named{"plain_div", two<float, std::divides<>{}>},
    Named{"fmod", two<float, script::remainder>},
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
    Named{"smoothstep", three<float, script::smooth_step>},
    Named{"sqrt", one<float, [](float a) { return a >= 0 ? std::sqrt(a) : 0.0F; }>},
    Named{"inversesqrt", one<float, [](float a) { return 0 < a ? 1 / std::sqrt(a) : 0.0F; }>},
    Named{"cbrt", one<float, script::cube_root>},
    Named{"pow", two<float, script::power>},
    Named{"exp", one<float, script::exponential>},
    Named{"exp2", one<float, script::power2>},
    Named{"expm1", one<float, script::exponential_less_one>},
    Named{"log", one<float, script::logarithm>},
    Named{"log2", one<float, script::logarithm2>},
    Named{"log10", one<float, script::logarithm10>},
    Named{"logb", one<float, script::exponent>},
    Named{"erf", one<float, script::error_function>},
    Named{"erfc", one<float, [](float a) { return 1 - script::error_function(a); }>},
    Named{"sin", one<float, script::sine>},
    Named{"cos", one<float, script::cosine>},
    Named{"tan", one<float, script::tangent>},
    Named{"asin", one<float, script::arcsine>},
    Named{"acos", one<float, script::arccosine>},
    Named{"atan", one<float, script::arctangent>},
    Named{"atan2", two<float, script::arctangent2>},
    Named{"sinh", one<float, script::hyperbolic_sine>},
    Named{"cosh", one<float, script::hyperbolic_cosine>},
    Named{"tanh", one<float, script::hyperbolic_tangent>},
    Named{"perlin1", &perlin<1>},
    Named{"perlin2", &perlin<2>},
    Named{"perlin3", &perlin<3>},
    Named{"perlin4", &perlin<4>},
    Named{"dot", &dot},
    Named{"cross_term", &cross_term},
    Named{"hsv_to_rgb", &rgb_from_hsv},
    Named{"to_float", one<Integer, [](Integer a) { return static_cast<float>(a); }>},
    Named{"to_int", one<float, script::integer>},
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

constexpr std::size_t kWords = 5;  // of an instruction: its number, and where it writes and reads
/// Registers that an instruction may use from one on, without those of `load` and `store`.
constexpr std::size_t kMostWide = 4;
/// Jumps backwards for a hit, after which a script ends, so that an endless one does too.
constexpr std::size_t kMostPasses = std::size_t{1} << 20U;

bool fits(const ShaderScript& script, const Word* words) {
    const auto [number, to, a, b, c] = std::array{words[0], words[1], words[2], words[3], words[4]};
    if (number >= kInstructions.size()) {
        return false;
    }
    const std::size_t count = script.registers.size(), most = count - std::min(count, kMostWide - 1);
    const std::string_view name = kInstructions[number].name;
    if (name == kJump || name == kJumpUnless) {
        return to <= script.code.size() / kWords && a < count;
    }
    if (name == kLoad || name == kStore) {
        const std::size_t first = name == kLoad ? a : to;
        return to < count && a < count && b < count && c > 0 && c <= count && first + c <= count;
    }
    return to < most && a < most && b < most && c < most;
}

std::vector<Instruction> instructions(const ShaderScript& script) {
    std::vector<Instruction> found;
    for (std::size_t i = 0; i < script.code.size(); i += kWords) {
        const Word* words = &script.code[i];
        const Named& named = kInstructions[words[0]];
        found.push_back({named.act, words[1], words[2], words[3], words[4], named.name == kJumpUnless});
    }
    return found;
}

void run(const std::vector<Instruction>& code, Word* registers) {
    std::size_t passes = kMostPasses;
    for (std::size_t next = 0; next < code.size();) {
        const Instruction& at = code[next];
        ++next;
        if (at.act != nullptr) {
            at.act(registers, at);
        } else if (!at.is_conditional || registers[at.a] == 0) {
            if (at.to < next && --passes == 0) {
                return;
            }
            next = at.to;
        }
    }
}

std::span<const std::string_view> instruction_names() {
    static const auto names = [] {
        std::array<std::string_view, kInstructions.size()> list{};
        std::transform(kInstructions.begin(), kInstructions.end(), list.begin(), [](const Named& n) { return n.name; });
        return list;
    }();
    return names;
}

void check_one(const ShaderScript& script) {
    const std::size_t count = script.registers.size();
    bool is_sound = script.code.size() % kWords == 0 && script.argument_count <= count &&
                    std::all_of(script.results.begin(), script.results.end(), [&](Word r) { return r < count; });
    for (std::size_t i = 0; is_sound && i < script.code.size(); i += kWords) {
        is_sound = fits(script, &script.code[i]);
    }
    if (!is_sound) {
        reject("scripts: an instruction reaches beyond the script");
    }
}

void run_lanes(const OperationLanes& lanes) {
    const ShaderScript& script = *lanes.script;
    const std::vector<Instruction> code = instructions(script);
    std::vector<Word> registers;
    for (std::size_t lane = 0; lane < lanes.count; ++lane) {
        registers = script.registers;
        for (std::size_t i = 0; i < script.argument_count; ++i) {
            registers[i] = std::bit_cast<Word>(lanes.arguments[i][lane]);
        }
        run(code, registers.data());
        for (std::size_t i = 0; i < script.results.size(); ++i) {
            lanes.results[i][lane] = std::bit_cast<float>(registers[script.results[i]]);
        }
    }
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(instruction_names);
HWY_EXPORT(check_one);
HWY_EXPORT(run_lanes);

std::span<const std::string_view> script_instructions() {
    return HWY_DYNAMIC_DISPATCH(instruction_names)();
}

void check_script(const ShaderScript& script) {
    HWY_DYNAMIC_DISPATCH(check_one)(script);
}

void run_script(const OperationLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(run_lanes)(lanes);
}

}  // namespace shlight
#endif
