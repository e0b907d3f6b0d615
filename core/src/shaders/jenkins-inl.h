// SPDX-License-Identifier: MIT
//
// Bob Jenkins's hash of 1 … 4 words (lookup3.c, public domain), in lanes. Included once per instruction set.
#if defined(SHLIGHT_SHADERS_JENKINS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_SHADERS_JENKINS_INL_H_
#undef SHLIGHT_SHADERS_JENKINS_INL_H_
#else
#define SHLIGHT_SHADERS_JENKINS_INL_H_
#endif

#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

using Words = hn::RebindToUnsigned<Floats>;

template <int kBits>
HWY_INLINE V<Words> rotated_left(V<Words> x) {
    return hn::RotateRight<32 - kBits>(x);
}

/// The final mixing of three words.
HWY_INLINE V<Words> mixed_words(V<Words> a, V<Words> b, V<Words> c) {
    c = hn::Sub(hn::Xor(c, b), rotated_left<14>(b));
    a = hn::Sub(hn::Xor(a, c), rotated_left<11>(c));
    b = hn::Sub(hn::Xor(b, a), rotated_left<25>(a));
    c = hn::Sub(hn::Xor(c, b), rotated_left<16>(b));
    a = hn::Sub(hn::Xor(a, c), rotated_left<4>(c));
    b = hn::Sub(hn::Xor(b, a), rotated_left<14>(a));
    return hn::Sub(hn::Xor(c, b), rotated_left<24>(b));
}

/// One step of the mixing that comes before further words: x - y, mixed with y, where y then grows by z.
template <int kBits>
HWY_INLINE void stir_words(V<Words>& x, V<Words>& y, V<Words> z) {
    x = hn::Xor(hn::Sub(x, y), rotated_left<kBits>(y));
    y = hn::Add(y, z);
}

template <std::size_t kCount>
HWY_INLINE V<Words> hash_of_words(const std::array<V<Words>, kCount>& key) {
    const Words d;
    const auto start = hn::Set(d, static_cast<std::uint32_t>(0xDEADBEEFU + (kCount << 2U) + 13));
    std::array<V<Words>, 3> state = {start, start, start};
    for (std::size_t i = 0; i < kCount; ++i) {
        if (i == 3) {
            auto& [a, b, c] = state;
            stir_words<4>(a, c, b);
            stir_words<6>(b, a, c);
            stir_words<8>(c, b, a);
            stir_words<16>(a, c, b);
            stir_words<19>(b, a, c);
            stir_words<4>(c, b, a);
        }
        state[i % 3] = hn::Add(state[i % 3], key[i]);
    }
    return mixed_words(state[0], state[1], state[2]);
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
