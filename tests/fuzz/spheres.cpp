// SPDX-License-Identifier: MIT
#include "regions.h"
#include "shlight/cap.h"

namespace shlight::fuzzing {
namespace {

struct Spheres {
    static constexpr bool kSeesHalf = true;
    static constexpr int kMostOrder = kMaxOrder + 1;
    static constexpr std::size_t kAngles = 0;

    explicit Spheres(Input& /*input*/) {}

    template <class T>
    Region<T> draw(Input& input) const {
        if (input.rarely()) {
            return any_region<T>(input, 1, true);
        }
        Region<T> region;
        const double unit = input.power_of_two(), sine = input.chance() ? input.uniform(0, 1) : input.small(12);
        append(region.numbers, unit * input.direction());
        const double distance = glm::length(Vec3d(vector_at(region, 0))), height = std::abs(region.numbers[2]);
        // Contact with the shading point or with the horizon, or nearly so.
        const std::array<double, 5> radii = {sine, 1, 1 - input.small(16), height / unit, height / unit * (1 - sine)};
        region.numbers.push_back(static_cast<T>(distance * input.one_of(radii)));
        const double ratio = static_cast<double>(region.numbers[3]) / distance;
        if (ratio > 0 && ratio < 0.99) {
            region.solid_angle = 2 * std::numbers::pi * ratio * ratio / (1 + std::sqrt(1 - ratio * ratio));
            region.is_above = region.numbers[2] > region.numbers[3];
        }
        return region;
    }

    template <class T>
    void coefficients(std::span<const Region<T>> regions, int order, bool clip, std::span<T> out) const {
        const std::vector<Vec3<T>> centers = vectors(regions, 0);
        const std::vector<T> radii = last_numbers(regions);
        sphere_coefficients<T>(centers, radii, order, clip, out);
    }
};

}  // namespace
}  // namespace shlight::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return shlight::fuzzing::fuzz_regions<shlight::fuzzing::Spheres>(data, size);
}
