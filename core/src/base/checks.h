// SPDX-License-Identifier: MIT
//
// Argument checks that throw std::invalid_argument naming the argument.
#pragma once

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "shlight/types.h"

namespace shlight {

template <class T>
bool is_finite(const Vec3<T>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

[[noreturn]] inline void reject(const std::string& message) {
    throw std::invalid_argument(message);
}

inline void check_size(const char* name, std::size_t actual, std::size_t expected) {
    if (actual != expected) {
        reject(std::string(name) + " has " + std::to_string(actual) + " values, expected " + std::to_string(expected));
    }
}

template <class T>
void check_finite(const char* name, const Vec3<T>& v) {
    if (!is_finite(v)) {
        reject(std::string(name) + " contains a number that is not finite");
    }
}

}  // namespace shlight
