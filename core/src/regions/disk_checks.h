// SPDX-License-Identifier: MIT
//
// What may be passed as a disk: checks that throw std::invalid_argument naming the argument.
#pragma once

#include "shlight/disk.h"
#include "shlight/types.h"

namespace shlight {

/// Finite, with half axes that are independent to the precision of T, and a shading point that is not on the disk.
template <class T>
void check_disk(const Ellipse<Wider<T>>& disk);

}  // namespace shlight
