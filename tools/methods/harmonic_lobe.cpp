// SPDX-License-Identifier: MIT
#include "harmonic_lobe.h"

#include <numeric>
#include <vector>

#include "regions/cap_arrays.h"
#include "regions/cap_kernels.h"
#include "regions/polygon_kernels.h"

namespace shlight::methods {

Reflected HarmonicLobe::radiance(const SphericalCap& cap, std::uint32_t seed) const {
    Reflected result{};
    radiances({&cap, 1}, {&seed, 1}, {&result, 1});
    return result;
}

Reflected HarmonicLobe::radiance(const SeenPolygon& polygon, std::uint32_t /*seed*/) const {
    constexpr std::uint32_t kOnly = 0;
    float value = 0;
    shade_polygons(polygon.vertices, static_cast<int>(polygon.vertices.size()), {&kOnly, 1}, lobe_, {&kOnly, 1},
                   {&value, 1});
    return {value, 0};
}

void HarmonicLobe::radiances(std::span<const SphericalCap> caps, std::span<const std::uint32_t> /*seeds*/,
                             std::span<Reflected> results) const {
    CapBatch circles;
    circles.resize(caps.size());
    for (std::size_t i = 0; i < caps.size(); ++i) {
        circles.set(i, caps[i]);
    }
    std::vector<std::uint32_t> circle_of(caps.size());
    std::iota(circle_of.begin(), circle_of.end(), 0U);
    const std::vector<std::uint32_t> view_of(caps.size(), 0);
    std::vector<float> values(caps.size());
    shade_caps(circles.arrays(), circle_of, lobe_, view_of, values);
    for (std::size_t i = 0; i < caps.size(); ++i) {
        results[i] = {values[i], 0};
    }
}

}  // namespace shlight::methods
