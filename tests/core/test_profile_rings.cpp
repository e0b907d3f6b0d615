// SPDX-License-Identifier: MIT
//
// The rule along the circles of a profile, against the exact coefficients of the same lights.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "lights/local_light.h"
#include "lights/profile_rings.h"
#include "random_input.h"
#include "shlight/basis.h"
#include "shlight/cap.h"
#include "shlight/disk.h"
#include "shlight/light.h"
#include "shlight/polygon.h"
#include "tracing/hits.h"

namespace shlight {
namespace {

using std::numbers::pi;

constexpr int kOrder = 5;
constexpr std::size_t kTerms = std::size_t{kOrder} * kOrder;
constexpr int kLights = 200;
// Between kinks all is analytic, so that rules of this size are exact; what is left are pieces that a touching circle
// makes as narrow as their own error.
constexpr int kPoints = 42;
constexpr double kTolerance = 1e-8;  // of L_00
constexpr double kLeast = 1e-10;     // pieces narrower than 1e-9 rad are left out

ShadingFrame random_frame(testing::RandomInput& random) {
    const Vec3d z = random.direction();
    return shading_frame(random.direction(), z, z);
}

/// Coefficients of what of the light shines on the hit, by the methods for even lights.
std::vector<double> truth(const LocalLight& light) {
    std::vector<double> l(kTerms);
    if (!light.corners().empty()) {
        polygon_coefficients<double>(light.corners(), static_cast<int>(light.corners().size()), kOrder, true, l);
    } else if (const std::optional<CapView>& cap = light.cap()) {
        const bool sphere = cap->kind == CapView::Kind::sphere;
        const double distance = glm::length(cap->center);
        // A facing disk is the cap of a sphere with the same tangent cone.
        const double radius = sphere ? cap->radius : cap->radius * distance / std::hypot(distance, cap->radius);
        sphere_coefficients<double>(std::span(&cap->center, 1), std::span(&radius, 1), kOrder, true, l);
    } else {
        const Ellipse& disk = light.ellipse();
        disk_coefficients<double>({&disk.center, 1}, {&disk.half_axis_u, 1}, {&disk.half_axis_v, 1}, kOrder, true, l);
    }
    return l;
}

struct Error {
    double largest, whole;  // of the integrals of the basis over the light; L_00
};

Error error_of(ProfileRings& rings, const LocalLight& light) {
    const std::vector<double> expected = truth(light);
    std::vector<double> sums(kTerms), basis(kTerms);
    rings.for_nodes(
        kPoints, [](const Vec3d&) { return 1.0; },
        [&](const Vec3d& direction, double weight, double factor) {
            sh_basis(direction, kOrder, basis.data());
            for (std::size_t i = 0; i < kTerms; ++i) {
                sums[i] += factor * weight * basis[i];
            }
        });
    double largest = 0;
    for (std::size_t i = 0; i < kTerms; ++i) {
        const double error = std::abs(sums[i] - expected[i]);
        largest = error <= largest ? largest : error;  // keeps NaN
    }
    return {largest, expected[0]};
}

/// make(random, frame): a light. known: least share of them that the rule knows.
template <class Make>
void compare(unsigned seed, double known, const Make& make) {
    testing::RandomInput random(seed), focus(seed + 100);
    ProfileRings rings;
    LocalLight seen_light;
    int seen = 0, covered = 0;
    for (int i = 0; i < kLights; ++i) {
        const ShadingFrame frame = random_frame(random);
        const Light light = make(random, frame);
        if (!seen_light.look(light, frame, 0)) {
            continue;
        }
        ++seen;
        if (!rings.reset(seen_light)) {
            continue;
        }
        ++covered;
        if (focus.chance(0.5)) {
            rings.focus(focus.direction(), focus.log_uniform(0.01, 1));
        }
        const Error error = error_of(rings, seen_light);
        EXPECT_LE(error.largest, kTolerance * error.whole + kLeast) << i;
    }
    EXPECT_GE(seen, kLights / 4);
    EXPECT_GE(covered, known * seen);
}

/// A place whose distance from the hit is 0.5 … 3, half of them near the horizon.
Vec3d random_place(testing::RandomInput& random, const ShadingFrame& frame) {
    const double tilt = random.chance(0.5) ? random.uniform(0, 1.2) : random.uniform(1.2, 1.8);
    return frame.origin + random.log_uniform(0.5, 3) * frame.to_world(random.at_tilt(tilt));
}

/// A direction within this angle of another.
Vec3d near(testing::RandomInput& random, const Vec3d& direction, double angle) {
    const ShadingFrame frame = shading_frame({}, direction, direction);
    return frame.to_world(random.at_tilt(random.uniform(0, angle)));
}

TEST(ProfileRings, CoverSpotsOfAnySize) {
    for (const bool facing_disk : {false, true}) {
        compare(1, 1, [&](testing::RandomInput& random, const ShadingFrame& frame) {
            const Vec3d place = random_place(random, frame);
            const double distance = glm::length(place - frame.origin);
            const double cone = random.uniform(0.2, 3);
            const Vec3d towards = near(random, (frame.origin - place) / distance, cone / 2);
            const SpotProfile profile = make_spot_profile(lamp_axes(towards), cone, random.uniform(0, 1));
            return make_spot_light(place, profile, Rgb(1), distance * random.log_uniform(0.01, 0.9), facing_disk);
        });
    }
}

TEST(ProfileRings, CoverConvexPolygonsUnderASpread) {
    compare(2, 1, [](testing::RandomInput& random, const ShadingFrame& frame) {
        const Vec3d place = random_place(random, frame);
        const Vec3d normal = near(random, glm::normalize(frame.origin - place), 1.2);
        const ShadingFrame plane = shading_frame(place, normal, normal);
        const int corners = random.integer(3, 6);
        std::vector<Vec3d> vertices;
        const double size = random.log_uniform(0.1, 2);
        const double begin = random.uniform(0, 2 * pi);
        for (int k = 0; k < corners; ++k) {
            // Corners of a circle, squeezed: convex.
            const double azimuth = begin + 2 * pi * (k + random.uniform(0, 0.6)) / corners;
            vertices.push_back(place + size * (std::cos(azimuth) * plane.x + 0.6 * std::sin(azimuth) * plane.y));
        }
        LightTraits traits;
        traits.profile = make_spread_profile(normal, random.uniform(0.3, 3));
        return Light(make_polygon_light(vertices, Rgb(1), false, traits));
    });
}

TEST(ProfileRings, CoverDisksUnderASpread) {
    for (const double shape : {1.0, 0.4}) {
        // Some disks are much larger than their lit part, which then is a polygon with many corners.
        compare(3, 0.99, [&](testing::RandomInput& random, const ShadingFrame& frame) {
            const Vec3d place = random_place(random, frame);
            const Vec3d normal = near(random, glm::normalize(frame.origin - place), 1.2);
            const ShadingFrame plane = shading_frame(place, normal, random.direction());
            const double size = random.log_uniform(0.1, 5);
            LightTraits traits;
            traits.profile = make_spread_profile(normal, random.uniform(0.3, 3));
            return Light(make_disk_light(place, size * plane.x, shape * size * plane.y, Rgb(1), false, traits));
        });
    }
}

TEST(ProfileRings, LeaveStretchedConesAndConcavePolygonsToOthers) {
    ProfileRings rings;
    const ShadingFrame frame = shading_frame({}, {0, 0, 1}, {0, 0, 1});
    const auto knows = [&](const Light& light) {
        LocalLight seen;
        EXPECT_TRUE(seen.look(light, frame, 0));
        return rings.reset(seen);
    };
    const glm::dmat3 axes(glm::dvec3(1, 0, 0), glm::dvec3(0, 2, 0), glm::dvec3(0, 0, 1));
    EXPECT_FALSE(knows(make_spot_light({0, 0, 2}, make_spot_profile(axes, 1, 0.5), Rgb(1), 0.3, false)));
    LightTraits traits;
    traits.profile = make_spread_profile({0, 0, -1}, 1);
    const std::vector<Vec3d> arrow = {{0, 1, 1}, {1, -1, 1}, {0, -0.5, 1}, {-1, -1, 1}};
    EXPECT_FALSE(knows(make_polygon_light(arrow, Rgb(1), false, traits)));
}

}  // namespace
}  // namespace shlight
