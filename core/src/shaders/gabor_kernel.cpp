// SPDX-License-Identifier: MIT
#include "shaders/gabor_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shaders/gabor_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <cstddef>
#include <numbers>

#include "shaders/cell_hash-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr float kHalfTurn = std::numbers::pi_v<float>;
constexpr int kImpulses = 8;  // in each cell

struct Phasor {
    Number cosine, sine;
};

/// The waves of a place: their frequency, their angles, and the share of random angles that is added.
template <std::size_t n>
struct Waves {
    Number frequency, isotropy;
    Row<n - 1> angles;
};

/// Random numbers of a cell: of its impulses' places, and of the angles of their waves.
HWY_INLINE Row<2> random_place(const Row<3>& seed) {
    const auto& [x, y, i] = seed;
    return {jenkins(seed), jenkins<3>({i, x, y})};
}
HWY_INLINE Row<3> random_place(const Row<4>& seed) {
    const auto& [x, y, z, i] = seed;
    return {jenkins(seed), jenkins<4>({z, x, i, y}), jenkins<4>({i, z, y, x})};
}
HWY_INLINE Row<1> random_angles(const Row<3>& seed) {
    return {hn::Sub(jenkins(seed), constant(0.5F))};
}
HWY_INLINE Row<2> random_angles(const Row<4>& seed) {
    const auto& [x, y, z, i] = seed;
    return {jenkins(seed), jenkins<4>({z, x, i, y})};
}

/// The unit vector of angles.
HWY_INLINE Row<2> direction(const Row<1>& angles) {
    const Floats d;
    return {hn::Cos(d, angles[0]), hn::Sin(d, angles[0])};
}
HWY_INLINE Row<3> direction(const Row<2>& angles) {
    const Floats d;
    const auto sine = hn::Sin(d, angles[0]);
    return {hn::Mul(sine, hn::Cos(d, angles[1])), hn::Mul(sine, hn::Sin(d, angles[1])), hn::Cos(d, angles[0])};
}

/// Adds the impulses of a cell; from: the place relative to the cell's corner.
template <std::size_t n>
HWY_INLINE void add_cell(const Row<n>& cell, const Row<n>& from, const Waves<n>& waves, Phasor& sum) {
    const Floats d;
    Row<n + 1> seed;
    for (std::size_t k = 0; k < n; ++k) {
        seed[k] = cell[k];
    }
    for (int i = 0; i < 3 * kImpulses; i += 3) {
        seed[n] = constant(static_cast<float>(i + 1));
        const Row<n> center = random_place(seed);
        Row<n> way;
        for (std::size_t k = 0; k < n; ++k) {
            way[k] = hn::Sub(from[k], center[k]);
        }
        const auto square = dot(way, way);
        const auto near = hn::Lt(square, constant(1));
        if (hn::AllFalse(d, near)) {
            continue;
        }
        seed[n] = constant(static_cast<float>(i));
        Row<n - 1> angles = random_angles(seed);
        for (std::size_t k = 0; k + 1 < n; ++k) {
            angles[k] = hn::Add(waves.angles[k], hn::Mul(hn::Mul(angles[k], constant(kHalfTurn)), waves.isotropy));
        }
        seed[n] = constant(static_cast<float>(i + 2));
        const auto is_negative = hn::Lt(jenkins(seed), constant(0.5F));
        // The Gaussian ends at 1 by Hann's window.
        const auto turn = hn::Mul(constant(kHalfTurn), square);
        const auto window =
            hn::Add(constant(0.5F), hn::Mul(constant(0.5F), hn::Cos(d, hn::Min(turn, constant(kHalfTurn)))));
        const auto envelope = hn::IfThenElseZero(near, hn::Mul(hn::Exp(d, hn::Neg(turn)), window));
        const auto size = hn::IfThenElse(is_negative, hn::Neg(envelope), envelope);
        const auto along = hn::Mul(dot(way, direction(angles)), waves.frequency);
        // One turn less its whole number, which sine and cosine need not know.
        const auto phase = hn::Mul(constant(2 * kHalfTurn), hn::Sub(along, hn::Round(along)));
        sum.cosine = hn::Add(sum.cosine, hn::Mul(size, hn::Cos(d, phase)));
        sum.sine = hn::Add(sum.sine, hn::Mul(size, hn::Sin(d, phase)));
    }
}

template <std::size_t n>
HWY_INLINE Phasor noise(const Row<n>& place, const Waves<n>& waves) {
    Row<n> own;
    Row<n> local;
    for (std::size_t k = 0; k < n; ++k) {
        own[k] = hn::Floor(place[k]);
        local[k] = hn::Sub(place[k], own[k]);
    }
    Phasor sum{constant(0), constant(0)};
    constexpr int kCells = n == 2 ? 9 : 27;
    for (int i = 0; i < kCells; ++i) {
        Row<n> cell;
        Row<n> from;
        int rest = i;
        for (std::size_t k = 0; k < n; ++k) {
            const auto offset = constant(static_cast<float>(rest % 3 - 1));
            cell[k] = hn::Add(own[k], offset);
            from[k] = hn::Sub(local[k], offset);
            rest /= 3;
        }
        add_cell(cell, from, waves, sum);
    }
    return sum;
}

template <std::size_t n>
void gabor_in_lanes(const OperationLanes& lanes) {
    const Floats d;
    for (std::size_t i = 0; i < lanes.count; i += kLaneCount<Floats>) {
        const auto argument = [&](std::size_t k) HWY_ATTR { return hn::LoadU(d, lanes.arguments[k] + i); };
        Row<n> place;
        for (std::size_t k = 0; k < n; ++k) {
            place[k] = argument(k);
        }
        Waves<n> waves;
        waves.frequency = argument(n);
        waves.isotropy = argument(n + 1);
        for (std::size_t k = 0; k + 1 < n; ++k) {
            waves.angles[k] = argument(n + 2 + k);
        }
        const Phasor found = noise(place, waves);
        hn::StoreU(found.cosine, d, lanes.results[0] + i);
        hn::StoreU(found.sine, d, lanes.results[1] + i);
    }
}

void gabor2(const OperationLanes& lanes) {
    gabor_in_lanes<2>(lanes);
}
void gabor3(const OperationLanes& lanes) {
    gabor_in_lanes<3>(lanes);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(gabor2);
HWY_EXPORT(gabor3);

template <>
void gabor<2>(const OperationLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(gabor2)(lanes);
}
template <>
void gabor<3>(const OperationLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(gabor3)(lanes);
}

}  // namespace shlight
#endif
