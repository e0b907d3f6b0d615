// SPDX-License-Identifier: MIT
//
// Disks and ellipses against the 113-bit reference. Errors are the largest over all coefficients of a light, relative
// to its L_00.
#include "shlight/disk.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "error_message.h"
#include "error_record.h"
#include "quad_truth.h"
#include "random_disk.h"
#include "shlight/cap.h"

namespace shlight {
namespace {

using testing::as_float;
using testing::EllipseInput;
using testing::ErrorRecord;
using testing::Plane;
using testing::RandomInput;

template <class T>
std::vector<T> coefficients(const EllipseInput& disk, int order, bool clip, DiskMethod method = DiskMethod::automatic) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const std::array centers = {Vec3<T>(disk.center)};
    const std::array half_axes_u = {Vec3<T>(disk.half_axis_u)};
    const std::array half_axes_v = {Vec3<T>(disk.half_axis_v)};
    disk_coefficients<T>(centers, half_axes_u, half_axes_v, order, clip, std::span<T>(result), method);
    return result;
}

EllipseInput rounded_to_float(const EllipseInput& disk) {
    return {as_float(disk.center), as_float(disk.half_axis_u), as_float(disk.half_axis_v)};
}

std::string describe(const EllipseInput& disk, bool clip) {
    std::string text = clip ? "clipped" : "unclipped";
    for (const Vec3d& v : {disk.center, disk.half_axis_u, disk.half_axis_v}) {
        std::array<char, 100> vector{};
        std::snprintf(vector.data(), vector.size(), " {%.17g, %.17g, %.17g}", v.x, v.y, v.z);
        text += vector.data();
    }
    return text;
}

/// 0 for lights that are not seen at all.
template <class T>
double relative_error(const EllipseInput& disk, int order, bool clip, const truth::Coefficients& reference,
                      DiskMethod method = DiskMethod::automatic) {
    const double largest = truth::largest_error(reference, order, coefficients<T>(disk, order, clip, method).data());
    return largest == 0 ? 0 : largest / reference.high[0];
}

struct Class {
    const char* name;
    EllipseInput (*draw)(RandomInput&);
};

constexpr auto kClasses = std::to_array<Class>({
    {"disk", testing::plain_disk},
    {"ellipse", testing::plain_ellipse},
    {"small", testing::small_disk},
    {"tiny", testing::tiny_disk},
    {"large", testing::large_disk},
    {"near contact", testing::disk_near_contact},
    {"rim near contact", testing::rim_near_contact},
    {"thin", testing::thin_ellipse},
    {"nearly edge-on", testing::disk_nearly_edge_on},
    {"sliver", testing::sliver_of_disk},
    {"tangent", testing::tangent_disk},
    {"cut", testing::cut_disk},
    {"cut strip", testing::cut_strip},
    {"lune", testing::lune},
});

/// One in four is not clipped. At high orders, where the reference takes long, float64 gets the disks of float32.
void compare_class(const Class& kind, std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
    RandomInput random(seed);
    const auto clipped = [seed](std::size_t i) { return (i + seed) % 4 != 0; };
    const bool shared = orders.back() > 16;
    std::vector<EllipseInput> disks64(count);
    std::vector<EllipseInput> disks32(count);
    for (std::size_t i = 0; i < count; ++i) {
        disks32[i] = rounded_to_float(kind.draw(random));
        disks64[i] = shared ? disks32[i] : kind.draw(random);
    }
    std::vector<ErrorRecord> errors64(orders.size(), ErrorRecord(count));
    std::vector<ErrorRecord> errors32(orders.size(), ErrorRecord(count));
    testing::on_two_threads(count, [&](std::size_t i) {
        const bool clip = clipped(i);
        const truth::Coefficients reference32 = truth::ellipse(disks32[i], orders.back(), clip);
        const truth::Coefficients reference64 = shared ? reference32 : truth::ellipse(disks64[i], orders.back(), clip);
        for (std::size_t k = 0; k < orders.size(); ++k) {
            errors64[k][i] = relative_error<double>(disks64[i], orders[k], clip, reference64);
            errors32[k][i] = relative_error<float>(disks32[i], orders[k], clip, reference32);
        }
    });
    for (std::size_t k = 0; k < orders.size(); ++k) {
        const std::string name = std::string(kind.name) + ", n = " + std::to_string(orders[k]);
        errors64[k].publish(name + ", float64");
        errors32[k].publish(name + ", float32");
        const std::size_t worst64 = errors64[k].worst();
        const std::size_t worst32 = errors32[k].worst();
        EXPECT_LE(errors64[k].largest(), 1e-10) << name << ": " << describe(disks64[worst64], clipped(worst64));
        EXPECT_LE(errors32[k].largest(), 1e-5) << name << ": " << describe(disks32[worst32], clipped(worst32));
    }
}

void compare(std::size_t count, const std::vector<int>& orders, std::uint64_t seed) {
    for (const Class& kind : kClasses) {
        compare_class(kind, count, orders, seed++);
    }
}

const std::size_t kMore = testing::all_tests() ? 40 : 1;

TEST(Disk, AgreesWithReferenceUpToOrder16) {
    compare(8 * kMore, {1, 2, 3, 8, 16}, 1400);
}
TEST(Disk, AgreesWithReferenceAtOrders33And64) {
    compare(1 * kMore, {33, 64}, 1600);
}

/// Both roads at what either can do.
TEST(Disk, OutlineAndSweepAgree) {
    RandomInput random(1700);
    for (const Class& kind : kClasses) {
        for (int i = 0; i < 20; ++i) {
            const EllipseInput disk = kind.draw(random);
            const bool clip = i % 4 != 0;
            const auto swept = coefficients<double>(disk, 12, clip, DiskMethod::sweep);
            const auto outlined = coefficients<double>(disk, 12, clip, DiskMethod::outline);
            if (swept[0] > 0.02 || (!clip && swept[0] > 1e-3)) {
                for (std::size_t k = 0; k < swept.size(); ++k) {
                    EXPECT_LE(std::abs(swept[k] - outlined[k]), 1e-11 * swept[0])
                        << kind.name << ": " << describe(disk, clip);
                }
            }
        }
    }
}

template <class T>
void compare_facing_disks_with_caps(double tolerance) {
    RandomInput random(1800);
    for (int i = 0; i < 200; ++i) {
        const int order = random.integer(1, 20);
        const bool clip = random.chance(0.7);
        const Vec3d center = as_float(random.log_uniform(0.01, 100) * random.direction());
        const Plane plane(random, center);
        const double radius = as_float(glm::length(center) * random.log_uniform(1e-3, 100));
        const EllipseInput disk = {center, radius * plane.u, radius * plane.v};
        std::vector<T> cap(coefficient_count(order));
        cap_coefficients(Cap<T>::of_facing_disk(center, radius), order, clip, cap.data());
        const auto computed = coefficients<T>(disk, order, clip);
        const double whole = coefficients<T>(disk, 1, false)[0];
        for (std::size_t k = 0; k < cap.size(); ++k) {
            EXPECT_LE(std::abs(computed[k] - cap[k]), tolerance * whole)
                << "order " << order << ' ' << describe(disk, clip);
        }
    }
}
TEST(Disk, FacingTheShadingPointIsACap) {
    compare_facing_disks_with_caps<double>(1e-11);
    compare_facing_disks_with_caps<float>(1e-4);
}

TEST(Disk, NothingIsSeenEdgeOnOrBelowTheHorizon) {
    for (const EllipseInput& disk :
         {EllipseInput{{3, 0, 1}, {1, 0, 0}, {0, 0, 1}}, EllipseInput{{0, 0, -1}, {1, 0, 0.5}, {0, 1, 0}},
          EllipseInput{{3, 0, 0}, {1, 0, 0}, {0, 1, 0}}}) {
        EXPECT_EQ(coefficients<double>(disk, 5, true), std::vector<double>(25, 0.0));
        EXPECT_EQ(coefficients<float>(disk, 5, true), std::vector<float>(25, 0.0F));
    }
}

/// Half of the sphere is seen in the end, from either side.
TEST(Disk, ContactIsHalfTheSphere) {
    for (const double distance : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15, -1e-12}) {
        const EllipseInput disk = {{0.3, -0.2, distance}, {1, 0.5, 0}, {-0.2, 0.8, 0}};
        const double half = std::sqrt(std::numbers::pi);
        EXPECT_LE(std::abs(coefficients<double>(disk, 1, false)[0] - half), 5 * std::abs(distance) + 1e-15);
    }
}

std::string refusal(const Vec3d& center, const Vec3d& u, const Vec3d& v, int order = 3) {
    return testing::error_message([&] { coefficients<double>({center, u, v}, order, true); });
}
TEST(Disk, BadArgumentsAreNamed) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(refusal({0, 0, 1}, {1, 0, 0}, {0, 1, 0}, 3), "");
    EXPECT_EQ(refusal({kNan, 0, 1}, {1, 0, 0}, {0, 1, 0}).rfind("centers", 0), 0U);
    EXPECT_EQ(refusal({0, 0, 1}, {1, kNan, 0}, {0, 1, 0}).rfind("half_axes_u", 0), 0U);
    EXPECT_EQ(refusal({0, 0, 1}, {1, 0, 0}, {0, 1, 1 / 0.0}).rfind("half_axes_v", 0), 0U);
    EXPECT_EQ(refusal({0, 0, 1}, {0, 0, 0}, {0, 1, 0}).rfind("half_axes_u", 0), 0U);
    EXPECT_EQ(refusal({0, 0, 1}, {1, 0, 0}, {0, 0, 0}).rfind("half_axes_v", 0), 0U);
    EXPECT_EQ(refusal({0, 0, 1}, {1, 2, 3}, {-2, -4, -6}).rfind("half_axes_v", 0), 0U);
    EXPECT_EQ(refusal({0.5, 0.5, 0}, {1, 0, 0}, {0, 1, 0}).rfind("centers", 0), 0U);
    EXPECT_EQ(refusal({0.5, 1, 0}, {1, 0, 0}, {0, 1, 0}), "");
}

}  // namespace
}  // namespace shlight
