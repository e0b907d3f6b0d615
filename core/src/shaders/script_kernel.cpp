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
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/checks.h"
#include "shaders/gradient_noise.h"
#include "shaders/script_functions-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Word = std::uint32_t;
using Integer = std::int32_t;

/// Hits that a script runs for at the same time.
constexpr std::size_t kHits = 32;
template <class T>
struct alignas(kHits * sizeof(T)) PerHit : std::array<T, kHits> {};

/// All bits of a hit that something holds for.
constexpr Word kYes = ~0U;

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
    explicit Places(std::size_t end) : end_(static_cast<Word>(end)) { next_.fill(end_); }

    void begin(std::size_t hit) {
        next_[hit] = 0;
        passes_[hit] = kMostPasses;
    }
    bool has_ended(std::size_t hit) const { return next_[hit] == end_; }
    std::size_t ended() const { return static_cast<std::size_t>(std::count(next_.begin(), next_.end(), end_)); }

    /// Chooses the hits that are furthest behind; the others wait for them.
    void choose(Machine& machine) {
        first_ = *std::min_element(next_.begin(), next_.end());
        wait_ = end_;
        left_ = kMostPasses;
        for (std::size_t hit = 0; hit < kHits; ++hit) {
            const bool chosen = next_[hit] == first_;
            machine.active[hit] = chosen ? kYes : 0;
            wait_ = std::min(wait_, chosen ? end_ : next_[hit]);
            left_ = std::min(left_, chosen ? passes_[hit] : kMostPasses);
        }
        passed_ = 0;
    }

    /// The place of the chosen hits, and the one where the first of the others waits.
    Word first() const { return first_; }
    Word wait() const { return wait_; }

    /// Sends the chosen hits on from a jump; where all go, or nothing if they part or have jumped back too often.
    std::optional<Word> jump(const Machine& machine, const Instruction& at, Word from) {
        const auto [some, every] = at.is_conditional ? shares(machine, at.a) : std::pair(true, true);
        const bool is_back = at.to <= from;
        if (!some || (every && !is_back)) {
            return some ? at.to : from + 1;
        }
        if (every && passed_ + 1 < left_) {
            ++passed_;
            return at.to;
        }
        for (std::size_t hit = 0; hit < kHits; ++hit) {
            const bool jumps = every || machine.registers[at.a][hit] == 0;
            go_on(machine, hit, jumps ? at.to : from + 1, passed_ + (jumps && is_back ? 1 : 0));
        }
        return std::nullopt;
    }

    /// Keeps the place that the chosen hits have come to.
    void stop(const Machine& machine, Word to) {
        for (std::size_t hit = 0; hit < kHits; ++hit) {
            go_on(machine, hit, to, passed_);
        }
    }

  private:
    /// Whether a register is 0 for some of the chosen hits, and for all of them.
    static std::pair<bool, bool> shares(const Machine& machine, Word condition) {
        const hn::CappedTag<Word, kHits> d;
        auto some = hn::Zero(d), other = some;
        for (std::size_t hit = 0; hit < kHits; hit += hn::Lanes(d)) {
            const auto active = hn::Load(d, &machine.active[hit]);
            const auto is_zero = hn::VecFromMask(d, hn::Load(d, &machine.registers[condition][hit]) == hn::Zero(d));
            some = some | (is_zero & active);
            other = other | hn::AndNot(is_zero, active);
        }
        return {!hn::AllTrue(d, some == hn::Zero(d)), hn::AllTrue(d, other == hn::Zero(d))};
    }

    void go_on(const Machine& machine, std::size_t hit, Word to, Word passes) {
        if (machine.active[hit] != 0) {
            passes_[hit] -= std::min(passes, passes_[hit]);
            next_[hit] = passes_[hit] == 0 ? end_ : to;
        }
    }

    PerHit<Word> next_, passes_{};
    Word end_, first_ = 0, wait_ = 0;
    Word left_ = 0, passed_ = 0;  // jumps back that one of the chosen hits has left, and those since they were chosen
};

/// Runs a script for the chosen hits until they part, end, or come to where others wait: those that a branch parts go
/// on together where both ways meet, which is further on in the script than the ways.
void run(const std::vector<Instruction>& code, Machine& machine, Places& places) {
    places.choose(machine);
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
        places.stop(machine, *at);
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

/// Runs a script for many hits, of which kHits are at work at a time: once half of these have ended, the next ones take
/// their registers, so that few wait for the one that goes round a loop most often.
class Crew {
  public:
    explicit Crew(const OperationLanes& lanes)
        : lanes_(lanes),
          script_(*lanes.script),
          code_(instructions(script_)),
          registers_(script_.registers.size()),
          places_(code_.size()) {
        hits_.fill(kNone);
    }

    void run_all() {
        Machine machine{registers_.data(), {}};
        while (relieve()) {
            do {
                run(code_, machine, places_);
            } while (2 * places_.ended() < kHits);
        }
    }

  private:
    static constexpr std::size_t kNone = ~std::size_t{0};

    /// Takes the results of hits that have ended, and lets others begin; false if none is left.
    bool relieve() {
        std::array<std::size_t, kHits> free;
        std::size_t count = 0;
        for (std::size_t place = 0; place < kHits; ++place) {
            if (places_.has_ended(place)) {
                take_results(place);
                hits_[place] = begun_ < lanes_.count ? begun_++ : kNone;
                free[count] = place;
                count += hits_[place] != kNone ? 1 : 0;
            }
        }
        begin(std::span(free).first(count));
        return std::any_of(hits_.begin(), hits_.end(), [](std::size_t hit) { return hit != kNone; });
    }

    void take_results(std::size_t place) {
        for (std::size_t i = 0; hits_[place] != kNone && i < script_.results.size(); ++i) {
            lanes_.results[i][hits_[place]] = std::bit_cast<float>(registers_[script_.results[i]][place]);
        }
    }

    void begin(std::span<const std::size_t> places) {
        for (std::size_t i = 0; i < registers_.size(); ++i) {
            for (const std::size_t place : places) {
                registers_[i][place] =
                    i < script_.argument_count ? word(lanes_.arguments[i][hits_[place]]) : script_.registers[i];
            }
        }
        for (const std::size_t place : places) {
            places_.begin(place);
        }
    }

    const OperationLanes& lanes_;
    const ShaderScript& script_;
    std::vector<Instruction> code_;
    std::vector<PerHit<Word>> registers_;
    Places places_;
    std::array<std::size_t, kHits> hits_;
    std::size_t begun_ = 0;
};

void run_lanes(const OperationLanes& lanes) {
    Crew(lanes).run_all();
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
