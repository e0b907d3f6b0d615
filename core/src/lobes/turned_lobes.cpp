// SPDX-License-Identifier: MIT
#include "lobes/turned_lobes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lobes/turned_lobes.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <type_traits>
#include <vector>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

static_assert(kTurnedLanes % kLaneCount<Floats> == 0);
static_assert(std::is_standard_layout_v<TurnedLobe> && sizeof(TurnedLobe) % sizeof(float) == 0);

/// Lane vectors, one for each degree of a band, and one for each multiple of an angle.
using Band = std::array<float, 2 * kMaxOrder * kLaneCount<Floats>>;
using Multiples = std::array<float, kMaxOrder * kLaneCount<Floats>>;

HWY_INLINE V<Floats> load(const float* vectors, int i) {
    return hn::Load(Floats(), vectors + static_cast<std::size_t>(i) * kLaneCount<Floats>);
}

HWY_INLINE void store(V<Floats> value, float* vectors, int i) {
    hn::Store(value, Floats(), vectors + static_cast<std::size_t>(i) * kLaneCount<Floats>);
}

/// Gathers one number from each lobe of the lanes; `first` points to that of the first lobe.
HWY_INLINE V<Floats> gather_each(const float* first) {
    const hn::RebindToSigned<Floats> di;
    constexpr int kStride = sizeof(TurnedLobe) / sizeof(float);
    return hn::GatherIndex(Floats(), first, hn::Mul(hn::Iota(di, 0), hn::Set(di, kStride)));
}

struct TurnLanes {
    alignas(64) Multiples cosines, sines;

    HWY_INLINE void load_from(const BandRotation::Turn& first, int order) {
        for (int m = 0; m < order; ++m) {
            store(gather_each(&first.cosines[static_cast<std::size_t>(m)]), cosines.data(), m);
            store(gather_each(&first.sines[static_cast<std::size_t>(m)]), sines.data(), m);
        }
    }
    /// Rotates the terms of degrees m and -m.
    HWY_INLINE void apply(int m, V<Floats>& even, V<Floats>& odd) const {
        const auto c = load(cosines.data(), m);
        const auto s = load(sines.data(), m);
        const auto turned = hn::NegMulAdd(s, odd, hn::Mul(c, even));
        odd = hn::MulAdd(s, even, hn::Mul(c, odd));
        even = turned;
    }
};

/// out at to[0] … to[kCount - 1] = Σ_k columns[k · height + …] · in at from[k].
template <std::size_t kCount>
HWY_INLINE void multiply_some(const std::vector<int>& from, const int* to, const float* columns, std::size_t height,
                              const float* in, float* out) {
    const Floats d;
    std::array<V<Floats>, kCount> sums;
    sums.fill(hn::Zero(d));
    for (const int k : from) {
        const auto factor = load(in, k);
        for (std::size_t i = 0; i < kCount; ++i) {
            sums[i] = hn::MulAdd(hn::Set(d, columns[i]), factor, sums[i]);
        }
        columns += height;
    }
    for (std::size_t i = 0; i < kCount; ++i) {
        store(sums[i], out, to[i]);
    }
}

HWY_INLINE void multiply(const std::vector<int>& from, const std::vector<int>& to, const std::vector<float>& columns,
                         const float* in, float* out) {
    std::size_t i = 0;
    for (; i + 8 <= to.size(); i += 8) {
        multiply_some<8>(from, &to[i], &columns[i], to.size(), in, out);
    }
    for (; i + 2 <= to.size(); i += 2) {
        multiply_some<2>(from, &to[i], &columns[i], to.size(), in, out);
    }
    for (; i < to.size(); ++i) {
        multiply_some<1>(from, &to[i], &columns[i], to.size(), in, out);
    }
}

/// A group of lobes, one in each lane.
class LobeLanes {
  public:
    LobeLanes(const TurnedLobe& first, int order)
        : first_(&first), sine_(gather_each(&first.sine)), cosine_(hn::Sub(hn::Set(Floats(), 1.0F), sine_)) {
        for (std::size_t i = 0; i < 3; ++i) {
            turns_[i].load_from(first.rotation.turns()[i], order);
        }
    }

    /// The lobes' band l without its last turn; degree m of the band is vector l + m of the result.
    HWY_INLINE const float* turn(int l) {
        const QuarterTurn& quarter = QuarterTurn::get();
        store(gather_each(&first_->terms[at(l, 0)]), band_.data(), l);
        for (int m = 1; m <= l; ++m) {
            const auto term = gather_each(&first_->terms[at(l, m)]);
            auto even = hn::Mul(cosine_, term);
            auto odd = hn::Mul(sine_, term);
            turns_[0].apply(m, even, odd);
            store(even, band_.data(), l + m);
            store(odd, band_.data(), l - m);
        }
        for (const QuarterTurn::Block& block : quarter.blocks(l)) {
            multiply(block.from, block.to, block.columns, band_.data(), turned_.data());
        }
        for (int m = 1; m <= l; ++m) {
            auto even = load(turned_.data(), l + m);
            auto odd = load(turned_.data(), l - m);
            turns_[1].apply(m, even, odd);
            store(even, turned_.data(), l + m);
            store(odd, turned_.data(), l - m);
        }
        for (const QuarterTurn::Block& block : quarter.blocks(l)) {
            multiply(block.to, block.from, block.rows, turned_.data(), band_.data());
        }
        return band_.data();
    }
    const TurnLanes& last_turn() const { return turns_[2]; }

  private:
    const TurnedLobe* first_;
    V<Floats> sine_, cosine_;
    std::array<TurnLanes, 3> turns_;
    alignas(64) Band band_, turned_;
};

void reflect(const TurnedLobe* lobes, int order, const ColorHarmonics& light, Rgb* reflected) {
    const Floats d;
    LobeLanes lanes(*lobes, order);
    std::array<V<Floats>, 3> sums;
    for (std::size_t c = 0; c < 3; ++c) {
        sums[c] = hn::Mul(gather_each(lobes->terms.data()), hn::Set(d, light[c][0]));
    }
    for (int l = 1; l < order; ++l) {
        const float* band = lanes.turn(l);
        const auto add = [&](int m, V<Floats> value) HWY_ATTR {
            for (std::size_t c = 0; c < 3; ++c) {
                const float coefficient = light[c][static_cast<std::size_t>(coefficient_index(l, m))];
                sums[c] = hn::MulAdd(value, hn::Set(d, coefficient), sums[c]);
            }
        };
        add(0, load(band, l));
        for (int m = 1; m <= l; ++m) {
            auto even = load(band, l + m);
            auto odd = load(band, l - m);
            lanes.last_turn().apply(m, even, odd);
            add(m, even);
            add(-m, odd);
        }
    }
    alignas(64) std::array<std::array<float, kLaneCount<Floats>>, 3> colors;
    for (std::size_t c = 0; c < 3; ++c) {
        hn::Store(sums[c], d, colors[c].data());
    }
    for (std::size_t i = 0; i < kLaneCount<Floats>; ++i) {
        reflected[i] = Rgb(colors[0][i], colors[1][i], colors[2][i]);
    }
}

void reflect_all(std::span<const TurnedLobe> lobes, int order, const ColorHarmonics& light, std::span<Rgb> reflected) {
    for (std::size_t i = 0; i < lobes.size(); i += kLaneCount<Floats>) {
        reflect(&lobes[i], order, light, &reflected[i]);
    }
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(reflect_all);

void reflect_turned(std::span<const TurnedLobe> lobes, int order, const ColorHarmonics& light,
                    std::span<Rgb> reflected) {
    HWY_DYNAMIC_DISPATCH(reflect_all)(lobes, order, light, reflected);
}

}  // namespace shlight
#endif
