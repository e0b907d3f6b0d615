// SPDX-License-Identifier: MIT
//
// Views and results of shading functions.
#pragma once

#include <cstdint>
#include <span>

#include "arrays.h"
#include "shlight/types.h"

namespace shlight::python {

/// The views of some lights: theirs, or the one for all.
inline std::span<const double> part_of(std::span<const double> views, std::size_t first, std::size_t count) {
    return views.size() == 1 ? views : views.subspan(first, count);
}

/// Radiance (count, 3) and, if requested, effort (count): as numpy arrays and as spans to fill.
struct Shaded {
    Array<float> radiance;
    Array<std::int32_t> effort;
    std::span<Rgb> colors;
    std::span<std::int32_t> efforts;

    explicit Shaded(std::size_t count, bool with_effort = true)
        : radiance({static_cast<py::ssize_t>(count), py::ssize_t{3}}),
          effort(static_cast<py::ssize_t>(with_effort ? count : 0)) {
        static_assert(sizeof(Rgb) == 3 * sizeof(float));
        colors = {reinterpret_cast<Rgb*>(radiance.mutable_data()), count};
        efforts = {effort.mutable_data(), with_effort ? count : 0};
    }

    /// The efforts of some lights; empty without effort.
    std::span<std::int32_t> effort_of(std::size_t first, std::size_t count) const {
        return efforts.empty() ? efforts : efforts.subspan(first, count);
    }

    py::tuple result() const { return py::make_tuple(radiance, effort); }
};

}  // namespace shlight::python
