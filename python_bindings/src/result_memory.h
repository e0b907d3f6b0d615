// SPDX-License-Identifier: MIT
//
// Memory of large results, kept for the next one when an array dies.
//
// A fresh page is cleared by the kernel when it is first touched, which takes longer than most of our kernels take to
// fill it: coefficients of order 32 cost three times as much in fresh memory. No more than an eighth of the machine's
// memory waits. Blocks beyond the latest, a thirty-second of it, are marked as free to be taken back by the system
// (MADV_FREE); not all, because each time the other cores must forget where the pages were, which costs two threads a
// fifth of their time.
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
