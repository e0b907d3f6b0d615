// SPDX-License-Identifier: MIT
#include "tracing/terminator.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "render_scenes.h"
#include "shlight/render.h"

namespace shlight {
using namespace testing;
namespace {

/// A triangle on the unit sphere with the sphere's normals, or those of its back.
struct Facet {
    std::array<Vec3d, 3> corners, normals;
};

Facet facet(double size, bool hollow) {
    Facet result;
    for (std::size_t i = 0; i < 3; ++i) {
        const double azimuth = 2.1 * static_cast<double>(i);
        result.corners[i] = {std::sin(size) * std::cos(azimuth), std::sin(size) * std::sin(azimuth), std::cos(size)};
        result.normals[i] = hollow ? -result.corners[i] : result.corners[i];
    }
    return result;
}

TEST(Terminator, FlatTrianglesAreNotLifted) {
    Facet flat = facet(0.4, false);
    flat.normals.fill(glm::normalize(glm::cross(flat.corners[1] - flat.corners[0], flat.corners[2] - flat.corners[0])));
    EXPECT_LE(glm::length(lift_to_smooth_surface(flat.corners, flat.normals, {0.2, 0.5, 0.3})), 1e-15);
}

TEST(Terminator, RaysStartBetweenTheSphereAndItsTangents) {
    // At the corners on the triangle; in between not below the sphere, and not above the nearest corner's plane.
    const Facet sphere = facet(0.4, false);
    for (int i = 0; i <= 10; ++i) {
        for (int j = 0; i + j <= 10; ++j) {
            const std::array<double, 3> weights = {(10 - i - j) / 10.0, i / 10.0, j / 10.0};
            Vec3d point(0);
            for (std::size_t k = 0; k < 3; ++k) {
                point += weights[k] * sphere.corners[k];
            }
            const Vec3d lifted = point + lift_to_smooth_surface(sphere.corners, sphere.normals, weights);
            EXPECT_GE(glm::length(lifted), 1 - 1e-3) << i << ' ' << j;
            double nearest = 2;
            for (std::size_t k = 0; k < 3; ++k) {
                nearest = std::min(nearest, glm::dot(lifted, sphere.normals[k]));
            }
            EXPECT_LE(nearest, 1 + 1e-15) << i << ' ' << j;
        }
    }
}

TEST(Terminator, HollowSurfacesLieBehindTheirTriangles) {
    // Their light is not cut off by the triangle itself, so that little is left to lift.
    const Facet bowl = facet(0.4, true);
    const Vec3d lift = lift_to_smooth_surface(bowl.corners, bowl.normals, {1 / 3.0, 1 / 3.0, 1 / 3.0});
    EXPECT_GE(glm::dot(lift, bowl.normals[0] + bowl.normals[1] + bowl.normals[2]), 0);
}

TEST(Terminator, OnlyRaysNearTheEdgeAreLifted) {
    const Terminator edge = {{0, 0, 1}, {0, 0, 1}, glm::normalize(Vec3d(0.3, 0, 1)), 0.1};
    const auto at = [](double elevation) { return Vec3d(-std::cos(elevation), 0, std::sin(elevation)); };
    EXPECT_EQ(edge.share(at(0.2)), 1.0);  // below the triangle
    EXPECT_EQ(edge.share(at(0.6)), 0.0);
    EXPECT_EQ(Terminator().lifts(), false);
    double last = 1;
    for (double elevation = 0.0; elevation < 0.6; elevation += 0.01) {
        EXPECT_LE(edge.share(at(elevation)), last);
        last = edge.share(at(elevation));
    }
}

TEST(Terminator, LightEndsEarlier) {
    Terminator early;
    EXPECT_EQ(early.let_in(0.3), 1.0);
    early.frequency = 1 / (1 - 0.5 / 2);
    EXPECT_LE(std::abs(early.let_in(1) - 1), 1e-15);
    EXPECT_EQ(early.let_in(std::cos(std::acos(-1.0) / 2 / early.frequency + 1e-9)), 0.0);
    EXPECT_LE(std::abs(early.let_in(0.5) - std::cos(early.frequency * std::acos(0.5)) / 0.5), 1e-15);
}

/// The mean of a picture of a coarse ball under a sun from the side.
double mean_of_ball(const TerminatorOffsets& offsets, bool shadows) {
    Mesh ball = sphere_mesh({0, 0, 0}, 1, 4, true);
    ball.terminator = offsets;
    Scene scene;
    scene.add_mesh(ball);
    LightTraits traits;
    traits.casts_shadows = shadows;
    scene.add_sun_light({-1, 0.2, -0.3}, 0.2, Rgb(3), false, traits);
    RenderSettings settings;
    settings.sampling = PixelSampling::refined(4);
    settings.shadow_rays = 16;
    const Image image = render_image(scene, camera_above(1.2), 32, 32, settings);
    double sum = 0;
    for (int i = 0; i < 32 * 32; ++i) {
        sum += double{image.red(i % 32, i / 32)};
    }
    return sum;
}

TEST(Terminator, ACoarseBallLosesNoLightToItsOwnTriangles) {
    const double unshadowed = mean_of_ball({}, false);
    EXPECT_LE(mean_of_ball({}, true), 0.99 * unshadowed);
    EXPECT_LE(std::abs(mean_of_ball({1, 0}, true) / unshadowed - 1), 2e-3);
    EXPECT_LE(std::abs(mean_of_ball({0, 0.3}, false) / mean_of_ball({1, 0.3}, true) - 1), 2e-3);
}

}  // namespace
}  // namespace shlight
