// SPDX-License-Identifier: MIT
//
// Disks and ellipses against the 113-bit reference. Errors are the largest over all coefficients of a light, relative
// to its L_00.
#include "shlight/disk.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "light_errors.h"
#include "quad_truth.h"
#include "random_disk.h"
#include "regions/spherical_ellipse.h"

namespace shlight {
namespace {

using testing::as_float;
using testing::BothErrors;
using testing::describe;
using testing::EllipseClass;
using testing::EllipseInput;
using testing::errors_by_order;
using testing::RandomInput;
using testing::relative_error;

template <class T>
std::vector<T> coefficients(const EllipseInput& disk, int order, bool clip) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const std::array centers = {Vec3<T>(disk.center)};
    const std::array half_axes_u = {Vec3<T>(disk.half_axis_u)};
    const std::array half_axes_v = {Vec3<T>(disk.half_axis_v)};
    disk_coefficients<T>(centers, half_axes_u, half_axes_v, order, clip, std::span<T>(result));
    return result;
}

EllipseInput rounded_to_float(const EllipseInput& disk) {
    return {as_float(disk.center), as_float(disk.half_axis_u), as_float(disk.half_axis_v)};
}

std::array<Vec3d, 3> vectors_of(const EllipseInput& disk) {
    return {disk.center, disk.half_axis_u, disk.half_axis_v};
}

/// One in four is not clipped. At high orders, where the reference takes long, float64 gets the disks of float32.
void compare_class(const EllipseClass& kind, std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
    RandomInput random(seed);
    const auto clipped = [seed](std::size_t i) { return (i + seed) % 4 != 0; };
    const bool shared = orders.back() > 16;
    std::vector<EllipseInput> disks64(count);
    std::vector<EllipseInput> disks32(count);
    for (std::size_t i = 0; i < count; ++i) {
        disks32[i] = rounded_to_float(kind.draw(random));
        disks64[i] = shared ? disks32[i] : kind.draw(random);
    }
    const std::vector<BothErrors> errors = errors_by_order(kind.name, count, orders, [&](std::size_t i) {
        const bool clip = clipped(i);
        truth::Coefficients reference32 = truth::ellipse(disks32[i], orders.back(), clip);
        truth::Coefficients reference64 = shared ? reference32 : truth::ellipse(disks64[i], orders.back(), clip);
        return [&disk64 = disks64[i], &disk32 = disks32[i], clip, reference64 = std::move(reference64),
                reference32 = std::move(reference32)](int order) {
            return std::array{relative_error(reference64, order, coefficients<double>(disk64, order, clip)),
                              relative_error(reference32, order, coefficients<float>(disk32, order, clip))};
        };
    });
    for (const auto& [float64, float32] : errors) {
        const std::size_t worst64 = float64.worst();
        const std::size_t worst32 = float32.worst();
        EXPECT_LE(float64.largest(), 1e-10)
            << kind.name << ": " << describe(vectors_of(disks64[worst64]), clipped(worst64));
        EXPECT_LE(float32.largest(), 1e-5)
            << kind.name << ": " << describe(vectors_of(disks32[worst32]), clipped(worst32));
    }
}

void compare(std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
    for (const EllipseClass& kind : testing::kEllipseClasses) {
        compare_class(kind, count, orders, seed++);
    }
}

const std::size_t kMore = testing::all_tests() ? 16 : 1;

TEST(Disk, AgreesWithReferenceUpToOrder16) {
    compare(4 * kMore, {1, 2, 3, 8, 16}, 1400);
}
TEST(Disk, AgreesWithReferenceAtOrders33And64) {
    compare(1 * kMore, {33, 64}, 1600);
}

TEST(Disk, HalfAxesMayBeAllButOrthogonal) {
    const Vec3d center(2, 1.98, 0), u(0, 0, 2);
    for (const bool clip : {true, false}) {
        const auto expected = coefficients<double>({center, u, {2, 0, 0}}, 3, clip);
        const auto found = coefficients<double>({center, u, {2, 0, 1e-200}}, 3, clip);
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_LE(std::abs(found[i] - expected[i]), 1e-14) << i;  // NaN fails
        }
    }
}

/// The rounding of its numbers alone keeps it off the shading point.
EllipseInput rounded_off_contact(RandomInput& random) {
    const testing::Plane plane(random, random.direction());
    EllipseInput disk{};
    do {
        const Vec3d aside = random.uniform(-0.4, 0.4) * plane.u + random.uniform(-0.4, 0.4) * plane.v;
        disk = testing::conjugate(random, aside, plane, 1, random.uniform(0.5, 1));
    } while (place_of_origin({disk.center, disk.half_axis_u, disk.half_axis_v}) != OriginPlace::beside_plane);
    return disk;
}
TEST(Disk, OneOfItsSidesIsSeenHoweverNear) {
    compare_class({"rounded off contact", rounded_off_contact}, 24, {1, 2, 8}, 1800);
}

}  // namespace
}  // namespace shlight
