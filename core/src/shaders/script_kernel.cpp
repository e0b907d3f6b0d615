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
#include <optional>
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

/// Hits that a script runs for at the same time.
constexpr std::size_t kHits = 16;
template <class T>
struct alignas(kHits * sizeof(T)) PerHit : std::array<T, kHits> {};

/// All bits of a hit that something holds for.
constexpr Word kYes = ~0U;

/// Registers of each hit, and the hits that an instruction is for.
struct Machine {
    PerHit<Word>* registers;
    PerHit<Word> active;
    bool are_all_active;
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
void keep(const Machine& machine, Word to, const PerHit<Word>& values) {
    PerHit<Word>& kept = machine.registers[to];
    if (machine.are_all_active) {
        kept = values;
        return;
    }
    for (std::size_t hit = 0; hit < kHits; ++hit) {
        kept[hit] = machine.active[hit] != 0 ? values[hit] : kept[hit];
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
constexpr Act one = [](const Machine& m, const Instruction& at) {
    write(m, at.to, [&](std::size_t hit) { return kFunction(read<T>(m, at.a, hit)); });
};
template <class T, auto kFunction>
constexpr Act two = [](const Machine& m, const Instruction& at) {
    write(m, at.to, [&](std::size_t hit) { return kFunction(read<T>(m, at.a, hit), read<T>(m, at.b, hit)); });
};
template <class T, auto kFunction>
constexpr Act three = [](const Machine& m, const Instruction& at) {
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
void rgb_from_hsv(const Machine& machine, const Instruction& at) {
    std::array<PerHit<Word>, 3> found;
    for (std::size_t hit = 0; hit < kHits; ++hit) {
        const auto h = read<float>(machine, at.a, hit), s = read<float>(machine, at.a + 1, hit);
        const auto v = read<float>(machine, at.a + 2, hit);
        const float turn = 6 * (h - std::floor(h));
        const Integer sixth = script::integer(std::floor(turn));
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
Word element(const Machine& machine, const Instruction& at, Word index, std::size_t hit) {
    return static_cast<Word>(std::clamp(read<Integer>(machine, index, hit), 0, static_cast<Integer>(at.c) - 1));
}
void load(const Machine& machine, const Instruction& at) {
    write(machine, at.to,
          [&](std::size_t hit) { return read<Word>(machine, at.a + element(machine, at, at.b, hit), hit); });
}
void store(const Machine& machine, const Instruction& at) {
    for (std::size_t hit = 0; hit < kHits; ++hit) {
        if (machine.active[hit] != 0) {
            machine.registers[at.to + element(machine, at, at.a, hit)][hit] = read<Word>(machine, at.b, hit);
        }
    }
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
void cross_term(const Machine& machine, const Instruction& at) {
    const auto a = [&](Word i, std::size_t hit) { return read<float>(machine, at.a + i, hit); };
    const auto b = [&](Word i, std::size_t hit) { return read<float>(machine, at.b + i, hit); };
    write(machine, at.to, [&](std::size_t hit) { return std::fma(a(0, hit), b(1, hit), -(a(1, hit) * b(0, hit))); });
}

/// The scalar product of triples of registers, rounded as in Cycles.
void dot(const Machine& machine, const Instruction& at) {
    const auto a = [&](Word i, std::size_t hit) { return read<float>(machine, at.a + i, hit); };
    const auto b = [&](Word i, std::size_t hit) { return read<float>(machine, at.b + i, hit); };
    write(machine, at.to, [&](std::size_t hit) {
        return std::fma(a(2, hit), b(2, hit), std::fma(a(0, hit), b(0, hit), a(1, hit) * b(1, hit)));
    });
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
constexpr Word kMostPasses = Word{1} << 20U;

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

/// Keeps the place of each hit in a script, and how often it may still jump back.
class Places {
  public:
    Places(std::size_t end, std::size_t count) : end_(static_cast<Word>(end)) {
        next_.fill(end_);
        std::fill_n(next_.begin(), count, 0);
        passes_.fill(kMostPasses);
    }

    /// Chooses the hits that are furthest behind; the others wait for them. False if all have ended.
    bool choose(Machine& machine) {
        first_ = *std::min_element(next_.begin(), next_.end());
        Word active = kYes;
        wait_ = end_;
        for (std::size_t hit = 0; hit < kHits; ++hit) {
            machine.active[hit] = next_[hit] == first_ ? kYes : 0;
            active &= machine.active[hit];
            wait_ = std::min(wait_, next_[hit] == first_ ? end_ : next_[hit]);
        }
        machine.are_all_active = active == kYes;
        return first_ < end_;
    }

    /// The place of the chosen hits, and the one where the first of the others waits.
    Word first() const { return first_; }
    Word wait() const { return wait_; }

    void go_on(const Machine& machine, Word to) {
        for (std::size_t hit = 0; hit < kHits; ++hit) {
            next_[hit] = machine.active[hit] != 0 ? to : next_[hit];
        }
    }

    /// Sends the chosen hits on from a jump; where all go, or nothing if they part.
    std::optional<Word> jump(const Machine& machine, const Instruction& at, Word from) {
        // Copies of all, and masks in place of conditions, so that the loop vectorises.
        const PerHit<Word> condition = machine.registers[at.a], active = machine.active;
        PerHit<Word> next = next_, passes = passes_;
        const Word always = at.is_conditional ? 0 : kYes, back = at.to <= from ? 1 : 0;
        Word least = kYes, most = 0;
        for (std::size_t hit = 0; hit < kHits; ++hit) {
            const Word jumps = always | (condition[hit] == 0 ? kYes : 0);
            passes[hit] -= back & jumps & active[hit];
            const Word ahead = (jumps & at.to) | (~jumps & (from + 1));
            next[hit] = (active[hit] & (passes[hit] == 0 ? end_ : ahead)) | (~active[hit] & next[hit]);
            least = std::min(least, next[hit] | ~active[hit]);
            most = std::max(most, next[hit] & active[hit]);
        }
        next_ = next;
        passes_ = passes;
        return least == most ? std::optional(most) : std::nullopt;
    }

  private:
    PerHit<Word> next_, passes_;
    Word end_, first_ = 0, wait_ = 0;
};

/// Runs a script for the first `count` hits. Those that a branch parts go on together where both ways meet, which is
/// further on in the script than the ways.
void run(const std::vector<Instruction>& code, PerHit<Word>* registers, std::size_t count) {
    Machine machine{registers, {}, false};
    Places places(code.size(), count);
    while (places.choose(machine)) {
        std::optional<Word> at = places.first();
        while (at && *at < places.wait()) {
            const Instruction& instruction = code[*at];
            if (instruction.act == nullptr) {
                at = places.jump(machine, instruction, *at);
                continue;
            }
            instruction.act(machine, instruction);
            ++*at;
        }
        if (at) {
            places.go_on(machine, *at);
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
    std::vector<PerHit<Word>> registers(script.registers.size());
    for (std::size_t first = 0; first < lanes.count; first += kHits) {
        const std::size_t count = std::min(kHits, lanes.count - first);
        for (std::size_t i = 0; i < registers.size(); ++i) {
            registers[i].fill(script.registers[i]);
        }
        for (std::size_t i = 0; i < script.argument_count; ++i) {
            std::transform(lanes.arguments[i] + first, lanes.arguments[i] + first + count, registers[i].begin(),
                           word<float>);
        }
        run(code, registers.data(), count);
        for (std::size_t i = 0; i < script.results.size(); ++i) {
            std::transform(registers[script.results[i]].begin(), registers[script.results[i]].begin() + count,
                           lanes.results[i] + first, [](Word bits) { return std::bit_cast<float>(bits); });
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
