// SPDX-License-Identifier: MIT
//
// Constants of cap_motion.h, the same for every light.
#pragma once

#include <vector>

namespace shlight {

/// Constants of degree m ≥ 0 of band l. rise and fall are of the bands l + 1 and l - 1; up and down of the degrees m +
/// 1 and m - 1.
template <class T>
struct MotionStep {
    T ladder_up, ladder_down;
    T rise_up, rise_down, rise;
    T fall_up, fall_down, fall;
    T plane;  ///< √2 P̄_l^m(0), 0 for odd l-m
};

/// At cosine_index(l, m).
template <class T>
const std::vector<MotionStep<T>>& motion_steps();

extern template const std::vector<MotionStep<float>>& motion_steps();
extern template const std::vector<MotionStep<double>>& motion_steps();

}  // namespace shlight
