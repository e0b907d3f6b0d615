// SPDX-License-Identifier: MIT
#include "plane.h"
#include "regions.h"
#include "shlight/disk.h"

namespace shlight::fuzzing {
namespace {

struct Disks {
    static constexpr bool kSeesHalf = true;
    static constexpr int kMostOrder = 20;
    static constexpr std::size_t kAngles = 0;

    explicit Disks(Input& /*input*/) {}

    template <class T>
    Region<T> draw(Input& input) const {
        if (input.rarely()) {
            return any_region<T>(input, 3);
        }
        if (input.integer(0, 3) == 0) {
            return facing<T>(input);
        }
        Region<T> region;
        const Plane plane(input);
        const double unit = input.power_of_two(), thin = input.chance() ? input.uniform(0.1, 1) : input.small(20);
        const double turn = input.uniform(0, std::numbers::pi), lean = input.chance() ? 0 : input.uniform(-1, 1);
        append(region.numbers, unit * plane.center);
        append(region.numbers, unit * (std::cos(turn) * plane.u + lean * thin * plane.v));
        append(region.numbers, unit * (std::sin(turn) * plane.u + thin * plane.v));
        return region;
    }

    /// A disk at right angles to an axis: it covers a cap.
    template <class T>
    static Region<T> facing(Input& input) {
        const int axis = input.integer(0, 2);
        const double unit = input.power_of_two(), radius = 10 * input.small(4);
        Region<T> region{std::vector<T>(9)};
        region.numbers[static_cast<std::size_t>(axis)] = static_cast<T>(input.chance() ? unit : -unit);
        region.numbers[static_cast<std::size_t>(3 + (axis + 1) % 3)] = static_cast<T>(radius * unit);
        region.numbers[static_cast<std::size_t>(6 + (axis + 2) % 3)] = static_cast<T>(radius * unit);
        const double far = std::hypot(1, radius);
        region.solid_angle = 2 * std::numbers::pi * radius * radius / (far * (far + 1));
        region.is_above = region.numbers[2] > 0;
        return region;
    }

    template <class T>
    void coefficients(std::span<const Region<T>> regions, int order, bool clip, std::span<T> out) const {
        const auto centers = vectors(regions, 0), u = vectors(regions, 1), v = vectors(regions, 2);
        disk_coefficients<T>(centers, u, v, order, clip, out);
    }
};

}  // namespace
}  // namespace shlight::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return shlight::fuzzing::fuzz_regions<shlight::fuzzing::Disks>(data, size);
}
