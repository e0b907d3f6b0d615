// SPDX-License-Identifier: MIT
//
// Memory of large results: that of the last one that died serves the next one. The system clears a fresh page when it
// is first touched, which takes as long as our kernels take to fill it.
#pragma once

#include <vector>

#include "arrays.h"

namespace shlight::python {

/// An array whose values are not set. Throws MemoryError.
template <class T>
Array<T> uninitialized(const std::vector<py::ssize_t>& shape);

extern template Array<float> uninitialized(const std::vector<py::ssize_t>& shape);
extern template Array<double> uninitialized(const std::vector<py::ssize_t>& shape);

}  // namespace shlight::python
