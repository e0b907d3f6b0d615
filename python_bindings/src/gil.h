// SPDX-License-Identifier: MIT
//
// Work without the GIL, and the end of Python meanwhile.
#pragma once

#include <pybind11/pybind11.h>

namespace shlight::python {

/// Lets other Python threads run meanwhile, as pybind11::gil_scoped_release does. A thread that Python does not wait
/// for (a daemon) stays in here for ever once Python ends: to take the GIL then would end it amid C++ and abort the
/// process.
class GilReleased {
  public:
    GilReleased();
    ~GilReleased();
    GilReleased(const GilReleased&) = delete;
    GilReleased& operator=(const GilReleased&) = delete;
    GilReleased(GilReleased&&) = delete;
    GilReleased& operator=(GilReleased&&) = delete;

  private:
    PyThreadState* state_;
};

/// Throws RenderCancelled in a daemon thread once Python ends. What works without the GIL asks before it takes it.
void throw_at_end();

/// Lets Python's end cancel the calls of daemon threads from now on, and wait for them before what they use is gone.
void wait_at_end();

}  // namespace shlight::python
