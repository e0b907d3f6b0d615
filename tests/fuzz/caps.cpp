// SPDX-License-Identifier: MIT
#include "regions.h"
#include "shlight/cap.h"

namespace shlight::fuzzing {
namespace {

struct Caps {
    static constexpr bool kSeesHalf = false;
    static constexpr int kMostOrder = kMaxOrder + 1;
    static constexpr std::size_t kAngles = 1;

    explicit Caps(Input& /*input*/) {}

    template <class T>
    Region<T> draw(Input& input) const {
        if (input.rarely()) {
            return any_region<T>(input, 1, true);
        }
        Region<T> region;
        const Vec3d axis = input.direction();
        append(region.numbers, input.power_of_two() * axis);
        // Tangent to the horizon from either side, nothing or everything, or nearly so.
        const double tilt = std::acos(axis.z), pi = std::numbers::pi, any = input.uniform(0, pi);
        const std::array<double, 6> angles = {
            any, pi * input.small(12), std::abs(pi / 2 - tilt), pi - std::abs(pi / 2 - tilt), pi, pi - input.small(8)};
        region.numbers.push_back(static_cast<T>(input.one_of(angles)));
        if (const auto half = static_cast<double>(region.numbers[3]); half > 0) {
            region.solid_angle = 4 * pi * std::pow(std::sin(std::min(half, pi) / 2), 2);
            region.is_above = tilt + half < pi / 2;
        }
        return region;
    }

    template <class T>
    void coefficients(std::span<const Region<T>> regions, int order, bool clip, std::span<T> out) const {
        const std::vector<Vec3<T>> axes = vectors(regions, 0);
        const std::vector<T> half_angles = last_numbers(regions);
        cap_coefficients<T>(axes, half_angles, order, clip, out);
    }
};

}  // namespace
}  // namespace shlight::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return shlight::fuzzing::fuzz_regions<shlight::fuzzing::Caps>(data, size);
}
