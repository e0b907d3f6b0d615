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
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/checks.h"
#include "shaders/script_instructions-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using script::Instruction, script::Machine, script::PerHit, script::Word, script::kHits, script::kYes;

constexpr std::size_t kWords = 5;  // of an instruction: its number, and where it writes and reads
/// Registers that an instruction may use from one on, without those of `load` and `store`.
constexpr std::size_t kMostWide = 4;
/// Jumps backwards for a hit, after which a script ends, so that an endless one does too.
constexpr Word kMostPasses = Word{1} << 20U;

bool fits(const ShaderScript& script, const Word* words) {
    const auto [number, to, a, b, c] = std::array{words[0], words[1], words[2], words[3], words[4]};
    if (number >= script::kInstructions.size()) {
        return false;
    }
    const std::size_t count = script.registers.size(), most = count - std::min(count, kMostWide - 1);
    const std::string_view name = script::kInstructions[number].name;
    if (name == script::kJump || name == script::kJumpUnless) {
        return to <= script.code.size() / kWords && a < count;
    }
    if (name == script::kLoad || name == script::kStore) {
        const std::size_t first = name == script::kLoad ? a : to;
        return to < count && a < count && b < count && c > 0 && c <= count && first + c <= count;
    }
    return to < most && a < most && b < most && c < most;
}

std::vector<Instruction> instructions(const ShaderScript& script) {
    std::vector<Instruction> found;
    for (std::size_t i = 0; i < script.code.size(); i += kWords) {
        const Word* words = &script.code[i];
        const script::Named& named = script::kInstructions[words[0]];
        found.push_back({named.act, words[1], words[2], words[3], words[4], named.name == script::kJumpUnless});
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
        std::array<std::string_view, script::kInstructions.size()> list{};
        std::transform(script::kInstructions.begin(), script::kInstructions.end(), list.begin(),
                       [](const script::Named& n) { return n.name; });
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
                    i < script_.argument_count ? script::word(lanes_.arguments[i][hits_[place]]) : script_.registers[i];
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
