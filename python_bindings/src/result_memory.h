// SPDX-License-Identifier: MIT
//
// Memory of large results, kept for the next one when an array dies.
//
// A fresh page is cleared by the kernel when it is first touched, which takes longer than most of our kernels take to
// fill it: coefficients of order 32 cost three times as much in fresh memory. Blocks that wait are marked as free to be
// taken back by the system (MADV_FREE), and no more than an eighth of the machine's memory waits.
#pragma once

#include <cstddef>
#include <vector>

#include "arrays.h"

namespace shlight::python {

/// An array whose values are not set. Throws MemoryError.
template <class T>
Array<T> uninitialized(const std::vector<py::ssize_t>& shape);

extern template Array<float> uninitialized(const std::vector<py::ssize_t>& shape);
extern template Array<double> uninitialized(const std::vector<py::ssize_t>& shape);

}  // namespace shlight::python
