// SPDX-License-Identifier: MIT
#include "shlight/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <numeric>

#include <glm/common.hpp>

namespace shlight {
namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
    x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
    x = ((x >> 4) & 0x0F0F0F0FU) | ((x & 0x0F0F0F0FU) << 4);
    x = ((x >> 8) & 0x00FF00FFU) | ((x & 0x00FF00FFU) << 8);
    return (x >> 16) | (x << 16);
}

/// Owen scrambling of a bit-reversed number: each bit is flipped by a hash of the bits below it (Laine & Karras 2011,
/// with Vegdahl's constants).
std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3D20ADEAU;
    x += seed;
    x *= (seed >> 16) | 1U;
    x ^= x * 0x05526C56U;
    x ^= x * 0x53A22864U;
    return x;
}

/// The second Sobol dimension, bit-reversed: the index times the Pascal matrix modulo 2, in log steps.
std::uint32_t pascal(std::uint32_t x) {
    x ^= x >> 16;
    x ^= (x >> 8) & 0x00FF00FFU;
    x ^= (x >> 4) & 0x0F0F0F0FU;
    x ^= (x >> 2) & 0x33333333U;
    x ^= (x >> 1) & 0x15555555U;
    return x;
}

using DirectionNumbers = std::array<std::uint32_t, 32>;

/// Sobol direction numbers by v_k = v_(k-s) ^ v_(k-s) >> s ^ v_(k-o), from the first s. other: o.
constexpr DirectionNumbers direction_numbers(std::initializer_list<std::uint32_t> first, std::size_t other) {
    DirectionNumbers numbers{};
    std::copy(first.begin(), first.end(), numbers.begin());
    for (std::size_t k = first.size(); k < numbers.size(); ++k) {
        const std::uint32_t before = numbers[k - first.size()];
        numbers[k] = before ^ (before >> first.size()) ^ numbers[k - other];
    }
    return numbers;
}

/// Direction numbers of the primitive polynomials x² + x + 1 and x³ + x + 1.
constexpr DirectionNumbers kThird = direction_numbers({0x80000000U, 0xC0000000U}, 1);
constexpr DirectionNumbers kFourth = direction_numbers({0x80000000U, 0xC0000000U, 0x20000000U}, 2);

/// One coordinate of a Sobol point, bit-reversed.
std::uint32_t reversed_coordinate(const DirectionNumbers& numbers, std::uint32_t index) {
    std::uint32_t x = 0;
    for (std::size_t k = 0; index != 0; ++k, index >>= 1) {
        x ^= (index & 1) != 0 ? numbers[k] : 0;
    }
    return reverse_bits(x);
}

double unit(std::uint32_t x) {
    return (static_cast<double>(x) + 0.5) * 0x1p-32;
}

}  // namespace

std::uint32_t hash(std::uint32_t a, std::uint32_t b) {
    // Two rounds of the 32-bit finalizer "lowbias32" (Wellons 2018).
    std::uint32_t x = a;
    for (const std::uint32_t add : {0x9E3779B9U, b}) {
        x += add;
        x ^= x >> 16;
        x *= 0x7FEB352DU;
        x ^= x >> 15;
        x *= 0x846CA68BU;
        x ^= x >> 16;
    }
    return x;
}

glm::dvec2 sobol_beyond(std::uint32_t index, std::uint32_t seed) {
    return {unit(reverse_bits(scramble_reversed(reversed_coordinate(kThird, index), hash(seed, 0)))),
            unit(reverse_bits(scramble_reversed(reversed_coordinate(kFourth, index), hash(seed, 1))))};
}

SobolSequence::SobolSequence(std::uint32_t seed) : x_(hash(seed, 0)), y_(hash(seed, 1)), order_(hash(seed, 2)) {}

glm::dvec2 SobolSequence::point(std::uint32_t index) const {
    const std::uint32_t place = reverse_bits(scramble_reversed(reverse_bits(index), order_));
    return {unit(reverse_bits(scramble_reversed(place, x_))), unit(reverse_bits(scramble_reversed(pascal(place), y_)))};
}

glm::dvec2 lattice_point(std::size_t i, std::size_t count, std::uint32_t seed) {
    // Multiples of the golden ratio modulo 1 are evenly spread for any count.
    constexpr double kStep = std::numbers::phi - 1;
    const auto number = static_cast<double>(i);
    return {(number + unit(hash(seed, 0))) / static_cast<double>(count),
            glm::fract(number * kStep + unit(hash(seed, 1)))};
}

std::vector<glm::dvec2> nested_points(std::uint32_t count) {
    // Sobol points lie in corners of the smallest cells. The shift moves them inside: to 1/3 of a cell at every level,
    // but to 7/12 for sets of four, which are the most frequent.
    constexpr std::uint32_t kShift = 0x25555555U;
    // All other bits are flipped if the first one is 1.
    const auto coordinate = [](std::uint32_t x) { return unit(((x >> 31) != 0 ? x ^ 0x7FFFFFFFU : x) ^ kShift); };
    std::vector<glm::dvec2> points(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        points[i] = {coordinate(reverse_bits(i)), coordinate(reverse_bits(pascal(i)))};
    }
    return points;
}

std::vector<glm::dvec2> hammersley(std::uint32_t count) {
    // Radical inverses of 0 … count-1 are evenly spaced for powers of two only; their ranks are for any count.
    std::vector<std::uint32_t> by_inverse(count);
    std::iota(by_inverse.begin(), by_inverse.end(), 0U);
    std::sort(by_inverse.begin(), by_inverse.end(),
              [](std::uint32_t a, std::uint32_t b) { return reverse_bits(a) < reverse_bits(b); });
    std::vector<glm::dvec2> points(count);
    for (std::uint32_t rank = 0; rank < count; ++rank) {
        const std::uint32_t index = by_inverse[rank];
        points[index] = glm::dvec2(index + 0.5, rank + 0.5) / static_cast<double>(count);
    }
    return points;
}

}  // namespace shlight
