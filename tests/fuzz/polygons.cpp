// SPDX-License-Identifier: MIT
#include "plane.h"
#include "regions.h"
#include "shlight/polygon.h"

namespace shlight::fuzzing {
namespace {

struct Polygons {
    static constexpr bool kSeesHalf = true;
    static constexpr int kMostOrder = 20;
    static constexpr std::size_t kAngles = 0;

    explicit Polygons(Input& input) : corners(input.count(3, input.rarely() ? 19 : 6)) {}

    template <class T>
    Region<T> draw(Input& input) const {
        if (input.rarely()) {
            Region<T> region = any_region<T>(input, corners);
            region.may_cross = corners > 3;
            return region;
        }
        Region<T> region;
        const Plane plane(input);
        const double unit = input.power_of_two(), thin = input.chance() ? 1 : input.small(30);
        const bool repeats = input.rarely();
        double lowest = 0;
        for (std::size_t i = 0; i < corners; ++i) {
            const double turn = (static_cast<double>(repeats ? i / 2 * 2 : i) + (repeats ? 0 : input.uniform(0, 0.7)));
            const double angle = 2 * std::numbers::pi * turn / static_cast<double>(corners);
            const double radius = input.uniform(0.4, 1);
            append(region.numbers, unit * plane.point(radius * std::cos(angle), thin * radius * std::sin(angle)));
            lowest = std::min(lowest, static_cast<double>(region.numbers[3 * i + 2]));
        }
        if (thin == 1 && corners > 3 && plane.distance() > 1e-2) {
            region.solid_angle = solid_angle(region);
            region.is_above = lowest == 0;
        }
        return region;
    }

    template <class T>
    void coefficients(std::span<const Region<T>> regions, int order, bool clip, std::span<T> out) const {
        std::vector<Vec3<T>> vertices;
        for (const Region<T>& region : regions) {
            for (std::size_t i = 0; i < corners; ++i) {
                vertices.push_back(vector_at(region, i));
            }
        }
        polygon_coefficients<T>(vertices, static_cast<int>(corners), order, clip, out);
    }

    /// This sums a fan of triangles (Van Oosterom & Strackee 1983, "The Solid Angle of a Plane Triangle").
    template <class T>
    double solid_angle(const Region<T>& region) const {
        const auto corner = [&](std::size_t i) { return glm::vec<3, long double>(vector_at(region, i)); };
        long double sum = 0;
        for (std::size_t i = 2; i < corners; ++i) {
            const auto a = corner(0), b = corner(i - 1), c = corner(i);
            const long double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
            sum += 2 * std::atan2(glm::dot(a, glm::cross(b - a, c - a)),
                                  la * lb * lc + glm::dot(a, b) * lc + glm::dot(a, c) * lb + glm::dot(b, c) * la);
        }
        return static_cast<double>(std::abs(sum));
    }

    std::size_t corners;
};

}  // namespace
}  // namespace shlight::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return shlight::fuzzing::fuzz_regions<shlight::fuzzing::Polygons>(data, size);
}
