// SPDX-License-Identifier: MIT
//
// Hashes of floats and of cells of a grid, as numbers 0 … 1, in lanes. Included once per instruction set.
#if defined(SHLIGHT_SHADERS_CELL_HASH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_SHADERS_CELL_HASH_INL_H_
#undef SHLIGHT_SHADERS_CELL_HASH_INL_H_
#else
#define SHLIGHT_SHADERS_CELL_HASH_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "shaders/jenkins-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

using Integers = hn::RebindToSigned<Floats>;

using Number = V<Floats>;
/// A place in n dimensions, or n numbers, of each lane.
template <std::size_t n>
using Row = std::array<Number, n>;

HWY_INLINE Number constant(float value) {
    return hn::Set(Floats(), value);
}

template <std::size_t n>
HWY_INLINE Number dot(const Row<n>& a, const Row<n>& b) {
    Number total = hn::Mul(a[0], b[0]);
    for (std::size_t i = 1; i < n; ++i) {
        total = hn::Add(total, hn::Mul(a[i], b[i]));
    }
    return total;
}

/// Bob Jenkins's hash of the bits of 1 … 4 floats.
template <std::size_t n>
HWY_INLINE Number jenkins(const Row<n>& key) {
    std::array<V<Words>, n> words;
    for (std::size_t i = 0; i < n; ++i) {
        words[i] = hn::BitCast(Words(), key[i]);
    }
    const Floats d;
    return hn::Mul(hn::ConvertTo(d, hash_of_words(words)), hn::Set(d, 0x1p-32F));
}

/// The same of a key and one number more.
template <std::size_t n>
HWY_INLINE Number jenkins(const Row<n>& key, float more) {
    Row<n + 1> longer;
    for (std::size_t i = 0; i < n; ++i) {
        longer[i] = key[i];
    }
    longer[n] = constant(more);
    return jenkins(longer);
}

/// One of two rounds of the hash of PCG in 2, 3 or 4 dimensions.
template <std::size_t n>
HWY_INLINE void pcg_round(std::array<V<Words>, n>& v) {
    const auto add = [&v](std::size_t i, V<Words> a, V<Words> b) HWY_ATTR { v[i] = hn::Add(v[i], hn::Mul(a, b)); };
    if constexpr (n == 2) {
        const auto factor = hn::Set(Words(), 1664525U);
        add(0, v[1], factor);
        add(1, v[0], factor);
    } else {
        add(0, v[1], v[n - 1]);
        add(1, v[2], v[0]);
        add(2, v[0], v[1]);
        if constexpr (n == 4) {
            add(3, v[1], v[2]);
        }
    }
}

/// PCG in 2, 3 or 4 dimensions (Jarzynski & Olano 2020, Hash Functions for GPU Rendering, JCGT 9(3)) of integers, of
/// which the sign bit is shifted in and the result leaves it out.
template <std::size_t n>
HWY_INLINE Row<n> pcg(const Row<n>& key) {
    const Words du;
    const Integers di;
    std::array<V<Words>, n> v;
    for (std::size_t i = 0; i < n; ++i) {
        const auto word = hn::BitCast(du, hn::ConvertTo(di, key[i]));
        v[i] = hn::Add(hn::Mul(word, hn::Set(du, 1664525U)), hn::Set(du, 1013904223U));
    }
    pcg_round(v);
    for (auto& word : v) {
        word = hn::Xor(word, hn::BitCast(du, hn::ShiftRight<16>(hn::BitCast(di, word))));
    }
    pcg_round(v);
    const Floats d;
    Row<n> numbers;
    for (std::size_t i = 0; i < n; ++i) {
        const auto positive = hn::BitCast(di, hn::And(v[i], hn::Set(du, 0x7FFFFFFFU)));
        numbers[i] = hn::Mul(hn::ConvertTo(d, positive), hn::Set(d, 0x1p-31F));
    }
    return numbers;
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
