// SPDX-License-Identifier: MIT
//
// What holds of the coefficients of all regions: spheres, caps, polygons and disks.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "input.h"
#include "invariants.h"

namespace shlight::fuzzing {

/// One region as a list of numbers.
template <class T>
struct Region {
    std::vector<T> numbers;
    std::optional<double> solid_angle = {};  ///< if it is known; the region is then accepted
    bool is_above = false;                   ///< the horizon clips nothing of it
    bool may_cross = false;                  ///< it may be no region: nothing but finite numbers is promised
};

template <class T>
Vec3<T> vector_at(const Region<T>& region, std::size_t index) {
    return {region.numbers[3 * index], region.numbers[3 * index + 1], region.numbers[3 * index + 2]};
}
template <class T>
void append(std::vector<T>& numbers, const Vec3d& v) {
    numbers.insert(numbers.end(), {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)});
}

/// A region of any numbers: vectors, and at most one number after them.
template <class T>
Region<T> any_region(Input& input, std::size_t vectors, bool has_number = false) {
    Region<T> region;
    for (std::size_t i = 0; i < vectors; ++i) {
        append(region.numbers, Vec3d(input.vector<T>()));
    }
    if (has_number) {
        region.numbers.push_back(input.number<T>());
    }
    return region;
}

/// The vectors at a place of all regions.
template <class T>
std::vector<Vec3<T>> vectors(std::span<const Region<T>> regions, std::size_t index) {
    std::vector<Vec3<T>> found;
    for (const Region<T>& region : regions) {
        found.push_back(vector_at(region, index));
    }
    return found;
}

/// The numbers at the end of all regions.
template <class T>
std::vector<T> last_numbers(std::span<const Region<T>> regions) {
    std::vector<T> found;
    for (const Region<T>& region : regions) {
        found.push_back(region.numbers.back());
    }
    return found;
}

/// Shape: draw<T>() makes a Region<T>, coefficients() calls the core, up to kMostOrder; of a region's numbers the last
/// kAngles are no lengths. kSeesHalf: no region covers more than half the sphere.
template <class T, class Shape>
class RegionChecks {
  public:
    RegionChecks(Input& input, const Shape& shape)
        : shape_(shape),
          order_(input.integer(0, 7) == 7 ? input.integer(0, Shape::kMostOrder) : input.integer(1, 9)),
          clip_(input.chance()) {}

    void run(std::vector<Region<T>> regions, Input& input) const {
        if (input.rarely()) {
            auto& numbers = regions[input.count(0, static_cast<int>(regions.size()) - 1)].numbers;
            numbers[input.count(0, static_cast<int>(numbers.size()) - 1)] = static_cast<T>(input.broken());
            check_most("a number that is not finite is accepted", coefficients(regions) ? 1 : 0, 0);
            return;
        }
        const auto all = coefficients(regions);
        bool every = has_order();
        for (std::size_t i = 0; i < regions.size(); ++i) {
            const auto alone = coefficients({&regions[i], 1});
            every = every && alone;
            if (alone) {
                check_one(regions[i], *alone);
                check_most("a region is another among others",
                           all && !std::equal(alone->begin(), alone->end(), all->begin() + row(i)) ? 1 : 0, 0);
            } else if (regions[i].solid_angle && has_order()) {
                fail("a plain region is refused");
            }
        }
        check_most("regions are refused alone or together only", all.has_value() != every ? 1 : 0, 0);
    }

  private:
    bool has_order() const { return order_ >= 1 && order_ <= kMaxOrder; }
    std::ptrdiff_t row(std::size_t i) const { return static_cast<std::ptrdiff_t>(i) * coefficient_count(order_); }

    std::optional<std::vector<T>> coefficients(std::span<const Region<T>> regions) const {
        std::vector<T> found(static_cast<std::size_t>(row(regions.size())));
        const bool answered = answers([&] { shape_.template coefficients<T>(regions, order_, clip_, found); });
        return answered ? std::optional(found) : std::nullopt;
    }

    void check_one(const Region<T>& region, std::span<const T> found) const {
        if (region.may_cross) {
            check_finite("a coefficient is not finite", found);
            return;
        }
        const bool half = clip_ || Shape::kSeesHalf;
        check_bands(found, order_, (half ? 2 : 4) * std::numbers::pi, kSlack<T>);
        if (region.solid_angle && (!clip_ || region.is_above)) {
            const double truth = *region.solid_angle / std::sqrt(4 * std::numbers::pi);
            check_most("the solid angle is wrong", std::abs(static_cast<double>(found[0]) - truth),
                       truth * kSlack<T>.relative + kSlack<T>.absolute);
        }
        if (const auto scaled = in_own_unit(region)) {
            const auto other = coefficients({&*scaled, 1});
            if (!other) {
                fail("a region is refused in other units");
            }
            check_alike<T>("a region is another in other units", found, *other, kSlack<T>);
        }
    }

    /// Lengths in a power of two near the largest one; none where the least ones lose digits.
    static std::optional<Region<T>> in_own_unit(Region<T> region) {
        const std::span lengths(region.numbers.data(), region.numbers.size() - Shape::kAngles);
        T largest = 0;
        for (const T length : lengths) {
            largest = std::max(largest, std::abs(length));
        }
        const int exponent = largest > 0 ? std::ilogb(largest) : 0;
        for (T& length : lengths) {
            const T before = length;
            length = std::ldexp(length, -exponent);
            if (std::ldexp(length, exponent) != before) {
                return std::nullopt;
            }
        }
        return region;
    }

    const Shape& shape_;
    int order_;
    bool clip_;
};

template <class T, class Shape>
void check_regions(Input& input, const Shape& shape) {
    const RegionChecks<T, Shape> checks(input, shape);
    std::vector<Region<T>> regions(input.count(1, input.rarely() ? 19 : 3));
    for (Region<T>& region : regions) {
        region = shape.template draw<T>(input);
    }
    checks.run(std::move(regions), input);
}

/// One input of libFuzzer.
template <class Shape>
int fuzz_regions(const std::uint8_t* data, std::size_t size) {
    Input input(data, size);
    const Shape shape(input);
    input.chance() ? check_regions<float>(input, shape) : check_regions<double>(input, shape);
    return 0;
}

}  // namespace shlight::fuzzing
