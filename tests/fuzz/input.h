// SPDX-License-Identifier: MIT
//
// Bytes of libFuzzer as arguments, many of them at the limits of what a function takes. When no bytes are left, all
// numbers are the least ones.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <type_traits>

#include <fuzzer/FuzzedDataProvider.h>

#include "shlight/types.h"

namespace shlight::fuzzing {

class Input {
  public:
    Input(const std::uint8_t* data, std::size_t size) : data_(data, size) {}

    int integer(int low, int high) { return data_.ConsumeIntegralInRange(low, high); }  // both included
    std::size_t count(int low, int high) { return static_cast<std::size_t>(integer(low, high)); }
    bool chance() { return data_.ConsumeBool(); }
    bool rarely() { return integer(0, 15) == 15; }
    double uniform(double low, double high) { return low + (high - low) * integer(0, 65535) / 65535.0; }
    template <class T, std::size_t kCount>
    T one_of(const std::array<T, kCount>& values) {
        return values[count(0, static_cast<int>(kCount) - 1)];
    }

    /// Any finite number.
    template <class T>
    T number() {
        using Limits = std::numeric_limits<T>;
        constexpr std::array<T, 11> kSpecial = {0,
                                                1,
                                                Limits::denorm_min(),
                                                Limits::min(),
                                                Limits::max(),
                                                Limits::epsilon(),
                                                1 + Limits::epsilon(),
                                                1 - Limits::epsilon() / 2,
                                                static_cast<T>(1e-12),
                                                static_cast<T>(1e15),
                                                std::numbers::pi_v<T>};
        const T sign = chance() ? T{1} : T{-1};
        switch (integer(0, 5)) {
            case 0:
                return sign * one_of(kSpecial);
            case 1:
                return sign * static_cast<T>(power_of_two());
            case 2:
                return any_bits<T>();
            default:
                return static_cast<T>(uniform(-2, 2));
        }
    }
    /// 1e-30 … 1e30.
    double power_of_two() { return std::exp2(integer(-100, 100)); }
    /// A number that is not finite.
    double broken() {
        return one_of(std::array{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity()});
    }
    /// 1e-n … 1.
    double small(double n) { return std::pow(10, -uniform(0, n)); }

    template <class T>
    Vec3<T> vector() {
        const T x = number<T>(), y = number<T>();
        return {x, y, number<T>()};
    }
    /// A unit vector, at times along an axis, or in the horizon or next to it.
    Vec3d direction() {
        const int kind = integer(0, 9);
        if (kind < 3) {
            Vec3d axis(0);
            axis[kind] = chance() ? 1 : -1;
            return axis;
        }
        const double z = kind > 3 ? uniform(-1, 1) : one_of(std::array{0.0, 1e-7, -1e-7, 1e-12, -1e-12});
        const double azimuth = uniform(-std::numbers::pi, std::numbers::pi), radius = std::sqrt(1 - z * z);
        return {radius * std::cos(azimuth), radius * std::sin(azimuth), z};
    }

  private:
    template <class T>
    T any_bits() {
        using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
        const T number = std::bit_cast<T>(data_.ConsumeIntegral<Bits>());
        return std::isfinite(number) ? number : T{0};
    }

    FuzzedDataProvider data_;
};

}  // namespace shlight::fuzzing
