// SPDX-License-Identifier: MIT
//
// Shadows: none where nothing is between (bit for bit), all where everything is, and penumbrae against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "base/ray_rounding.h"
#include "render_scenes.h"
#include "surfaces/placed_meshes.h"

namespace shlight {
namespace {

using namespace testing;

constexpr int kSize = 32;

RenderSettings with_rays(int pixel_samples, int shadow_rays) {
    RenderSettings settings;
    settings.sampling = PixelSampling::refined(pixel_samples);
    settings.shadow_rays = shadow_rays;
    return settings;
}

Mesh cuboid(const Vec3d& low, const Vec3d& high) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.vertices.emplace_back((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                                   (i & 4) != 0 ? high.z : low.z);
    }
    mesh.triangles = {{0, 3, 1}, {0, 2, 3}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 7, 3}, {2, 6, 7}, {0, 6, 2}, {0, 4, 6}, {1, 3, 7}, {1, 7, 5}};
    mesh.bsdfs = {Bsdf::lambert(Rgb(0.5F))};
    return mesh;
}

TEST(RenderShadows, AConvexBodyDoesNotShadowItself) {
    // All that lies above a flat facet's horizon is unblocked, so shadow rays must change no bit: no acne at any scale,
    // distance from the origin, or transform.
    for (const double scale : {1e-3, 1.0, 1e4}) {
        for (const double offset : {0.0, 30.0}) {
            for (const bool instanced : {false, true}) {
                const Vec3d origin = scale * offset * Vec3d(1, -0.7, 0.4);
                Mesh ball = sphere_mesh({0, 0, 0}, 1, 16, false);
                ball.transforms = {frame_matrix({scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, origin)};
                if (instanced) {
                    ball.transforms.push_back(
                        frame_matrix({scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, origin + Vec3d(0, 0, 50 * scale)));
                }
                Scene scene;
                scene.add_mesh(ball);
                scene.add_sphere_light(origin + scale * Vec3d(2, 1, 1.5), 0.7 * scale, Rgb(1));
                scene.add_polygon_light({origin + scale * Vec3d(-3, -1, 2), origin + scale * Vec3d(-1, -1, 4),
                                         origin + scale * Vec3d(-1, 1, 4), origin + scale * Vec3d(-3, 1, 2)},
                                        Rgb(1));
                const Camera camera(look_at(origin + scale * Vec3d(1, -2, 4), origin), 0.6);
                const Image shadowed = render_image(scene, camera, 64, 64, with_rays(1, 16));
                const Image plain = render_image(scene, camera, 64, 64, with_rays(1, 0));
                EXPECT_GT(plain.report.hits, 1000U);
                std::size_t different = 0;
                for (std::size_t i = 0; i < plain.values.size(); ++i) {
                    different += plain.values[i] == shadowed.values[i] ? 0 : 1;
                }
                EXPECT_EQ(different, 0U) << "scale " << scale << ", offset " << offset << ", instanced " << instanced;
            }
        }
    }
}

TEST(RenderShadows, NothingLeaksIntoAClosedRoom) {
    // Walls without thickness; strong lights just outside, at the edges and corners, some cut by the walls.
    for (const double scale : {1e-3, 1.0, 1e4}) {
        for (const double offset : {0.0, 30.0}) {
            const Vec3d origin = scale * offset * Vec3d(1, -0.7, 0.4);
            Scene scene;
            scene.add_mesh(cuboid(origin - scale * Vec3d(1), origin + scale * Vec3d(1)));
            scene.add_sphere_light(origin + scale * Vec3d(1.51, 0, 0.9), 0.5 * scale, Rgb(1e6F));
            scene.add_sphere_light(origin + scale * Vec3d(1.1, 1.1, -1.1), 0.1 * scale, Rgb(1e6F));
            scene.add_polygon_light({origin + scale * Vec3d(-2, -2, 1.01), origin + scale * Vec3d(-2, 2, 1.01),
                                     origin + scale * Vec3d(2, 2, 1.01), origin + scale * Vec3d(2, -2, 1.01)},
                                    Rgb(1e6F));
            const Camera camera(look_at(origin + scale * Vec3d(0.9, -0.9, 0.9), origin - scale * Vec3d(0.9, -0.9, 0.9)),
                                2.4);
            const Image image = render_image(scene, camera, 64, 64, with_rays(4, 8));
            EXPECT_EQ(image.report.hits, 4U * 64 * 64);
            float brightest = 0;
            for (int i = 0; i < 64 * 64; ++i) {
                brightest = std::max(brightest, image.red(i % 64, i / 64));
            }
            EXPECT_EQ(brightest, 0) << "scale " << scale << ", offset " << offset;
        }
    }
}

TEST(RenderShadows, TheSkyIsDrawnWhereAWindowShowsIt) {
    // A room's floor under an even sky that one window shows: a polygon's form factor. Where rays do not know the
    // window, 16 in each pixel are wrong by 163 % (one radiance) and 128 % (a picture).
    const std::vector<Vec3d> window = {{-0.6, 2, 1}, {0.6, 2, 1}, {0.6, 2, 2}, {-0.6, 2, 2}};
    Scene scene;
    scene.add_mesh(cuboid({-2, -2, -0.1}, {2, 2, 0}));
    scene.add_mesh(cuboid({-2, -2, 3}, {2, 2, 3.1}));
    for (const double side : {-2.05, 2.05}) {
        scene.add_mesh(cuboid({side - 0.05, -2, 0}, {side + 0.05, 2, 3}));
    }
    scene.add_mesh(cuboid({-2, -2.1, 0}, {2, -2, 3}));
    // Walls without thickness about the window.
    scene.add_mesh(cuboid({-2, 2, 0}, {2, 2, 1}));
    scene.add_mesh(cuboid({-2, 2, 2}, {2, 2, 3}));
    scene.add_mesh(cuboid({-2, 2, 1}, {-0.6, 2, 2}));
    scene.add_mesh(cuboid({0.6, 2, 1}, {2, 2, 2}));
    LatLong sky{std::vector<Rgb>(64 * 32, Rgb(1)), 64, 32};
    std::fill(sky.pixels.begin() + 64 * 16, sky.pixels.end(), Rgb(0.5F));  // the window shows nothing of it
    constexpr int kAcross = 64;
    RenderSettings settings = with_rays(4, 4);
    settings.sampling = PixelSampling::fixed(4);
    for (const bool picture : {false, true}) {
        scene.set_environment(picture ? Environment(sky) : Environment(Rgb(1)));
        settings.threads = 1;
        const Image image = render_image(scene, camera_above(1.5, 2.5), kAcross, kAcross, settings);
        double all = 0;
        double expected = 0;
        double squares = 0;
        for (int row = 0; row < kAcross; ++row) {
            for (int column = 0; column < kAcross; ++column) {
                const double truth = 0.5 * form_factor(floor_point(column, row, kAcross, 1.5), window);
                const double off = image.red(column, row) / truth - 1;
                all += image.red(column, row);
                expected += truth;
                squares += off * off / (kAcross * kAcross);
            }
        }
        EXPECT_LT(std::sqrt(squares), 0.3) << "picture " << picture;
        EXPECT_NEAR(all / expected, 1, 0.01) << "picture " << picture;
        for (const int threads : {2, 5}) {
            settings.threads = threads;
            EXPECT_EQ(render_image(scene, camera_above(1.5, 2.5), kAcross, kAcross, settings).values, image.values);
        }
    }
}

/// A half plane x < 0 at height 1, one of two instances, between the floor and a rectangle light at height 2.
struct HalfPlane {
    std::vector<Vec3d> light = {{-0.4, -0.5, 2}, {-0.4, 0.5, 2}, {0.6, 0.5, 2}, {0.6, -0.5, 2}};
    Scene occluders, scene;

    HalfPlane() {
        occluders.add_mesh(floor_mesh(10));
        Mesh blocker = floor_mesh(20, 1);
        blocker.transforms = {frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-20, 0, 0}),
                              frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {500, 0, 0})};
        occluders.add_mesh(blocker);
        scene = occluders;
        scene.add_polygon_light(light, Rgb(2));
    }

    /// Looks from below the blocker.
    static Camera camera() { return camera_above(1.5, 0.9); }

    /// The part of the light that is seen ends where the line over the blocker's edge meets it.
    double truth(const Vec3d& point) const {
        std::vector<Vec3d> seen = light;
        for (Vec3d& v : seen) {
            v.x = std::max(v.x, -point.x);
        }
        return seen[2].x > seen[0].x && -point.x < 0.6 ? form_factor(point, seen) : 0;
    }
};

TEST(RenderShadows, PenumbraOfAHalfPlane) {
    const HalfPlane setup;
    const auto errors = [&](int pixel_samples, int rays) {
        const Image image =
            render_image(setup.scene, HalfPlane::camera(), kSize, kSize, with_rays(pixel_samples, rays));
        double largest = 0;
        double squares = 0;
        double bias = 0;
        for (int row = 0; row < kSize; ++row) {
            for (int column = 0; column < kSize; ++column) {
                const Vec3d point = floor_point(column, row, kSize, 1.5);
                const double truth = setup.truth(point);
                const double error = image.red(column, row) - truth;
                // Wholly lit and wholly dark, away from the boundary by more than a pixel: no noise at all. Many camera
                // rays average over the pixel, which differs from its centre by (size of the pixel)² f'' / 24 = 4e-5.
                const bool penumbra = point.x > -0.75 && point.x < 0.55;
                if (!penumbra) {
                    EXPECT_LE(std::abs(error), pixel_samples == 1 ? 1e-5 : 1e-4) << point.x;
                }
                largest = std::max(largest, std::abs(error));
                squares += error * error / (kSize * kSize);
                bias += error / (kSize * kSize);
            }
        }
        return std::array{largest, std::sqrt(squares), std::abs(bias)};
    };
    // Full brightness is 0.13. A fraction that n stratified points measure of a straight cut is wrong by about n^-3/4.
    const auto fine = errors(1, 4096);
    EXPECT_LE(fine[0], 0.13 * 4 * std::pow(4096, -0.75));
    EXPECT_LE(fine[2], 1e-4);
    const auto usual = errors(16, 16);
    EXPECT_LE(usual[0], 0.13 * 8 * std::pow(256, -0.75));
    EXPECT_LE(usual[1], 0.13 * 1 * std::pow(256, -0.75));
    EXPECT_LE(usual[2], 2e-4);  // adaptive rays must not darken or brighten the rim
}

TEST(RenderShadows, APenumbraCountsEachPartOfTheLightByItsSolidAngle) {
    // A long strip, near at one end and far at the other: equal parts of its area count very unequally.
    HalfPlane setup;
    for (const double width : {1e-6, 0.2}) {
        setup.light = {{-8, -width, 1.2}, {-8, width, 1.2}, {0.6, width, 1.2}, {0.6, -width, 1.2}};
        Scene scene = setup.occluders;
        scene.add_polygon_light(setup.light, Rgb(2));
        const Image image = render_image(scene, HalfPlane::camera(), kSize, kSize, with_rays(1, 4096));
        for (int row = kSize / 2 - 1; row < kSize / 2 + 1; ++row) {
            for (int column = 0; column < kSize; ++column) {
                const Vec3d point = floor_point(column, row, kSize, 1.5);
                const double whole = form_factor(point, setup.light);
                // The line over the edge at height 1 meets height 1.2 at x = -0.2 point.x.
                std::vector<Vec3d> seen = setup.light;
                for (Vec3d& v : seen) {
                    v.x = std::max(v.x, -0.2 * point.x);
                }
                const double truth = form_factor(point, seen);
                EXPECT_LE(std::abs(image.red(column, row) - truth), whole * 4 * std::pow(4096, -0.75) + 1e-5 * whole);
            }
        }
    }
}

TEST(RenderShadows, AllRaysCountSoThatTheMeanIsRight) {
    // A plate hides a hundredth of the sky, which a pixel's first rays would mostly miss: a pixel that spared the
    // others then would be too bright by up to the part that is hidden.
    const std::vector<Vec3d> plate = {{-0.09, -0.09, 1}, {0.09, -0.09, 1}, {0.09, 0.09, 1}, {-0.09, 0.09, 1}};
    Scene scene;
    scene.add_mesh(floor_mesh(1));
    scene.add_mesh(floor_mesh(0.09F, 1));
    scene.set_environment(Environment(Rgb(1)));
    RenderSettings settings;
    settings.sampling = PixelSampling::fixed(4);
    const Image image = render_image(scene, Camera(look_at({0, 0, 0.3}, {0, 0, 0}), 0.6), kSize, kSize, settings);
    double sum = 0;
    for (int row = 0; row < kSize; ++row) {
        for (int column = 0; column < kSize; ++column) {
            sum += image.red(column, row);
        }
    }
    const double hidden = form_factor({0, 0, 0}, plate);
    // The hidden part's share of 64 rays errs by about its root times 64^-3/4, in each of kSize² pixels; over the floor
    // that is seen it falls by less than a fiftieth.
    const double noise = std::sqrt(hidden) * std::pow(64, -0.75) / kSize;
    EXPECT_NEAR(sum / (kSize * kSize), 0.5 * (1 - hidden), 0.5 * (4 * noise + hidden / 50));
    EXPECT_EQ(image.report.shadow_rays, 16 * image.report.hits);
}

TEST(RenderShadows, LightsThatCannotReachCostNoRays) {
    Scene scene;
    scene.add_mesh(floor_mesh(10));
    scene.add_sphere_light({0, 0, -2}, 0.5, Rgb(1));                                    // below the horizon
    scene.add_polygon_light({{-1, -1, 2}, {1, -1, 2}, {1, 1, 2}, {-1, 1, 2}}, Rgb(1));  // shines up
    const Image image = render_image(scene, camera_above(1), 8, 8, with_rays(4, 16));
    EXPECT_EQ(image.report.shadow_rays, 0U);
    EXPECT_EQ(image.red(4, 4), 0);
}

TEST(RenderShadows, ADimLightThatTheHorizonCutsIsNotTakenForHidden) {
    // Half of what shadow rays are drawn to lies below the horizon; the sky, which is brighter, leaves each light less
    // than one ray.
    const std::vector<std::function<void(Scene&)>> lights = {
        [](Scene& scene) {
            scene.add_sun_light({1, 0, 0}, 0.2, Rgb(2));
        },
        [](Scene& scene) {
            scene.add_sphere_light({4, 0, 0}, 0.5, Rgb(4));
        },
        [](Scene& scene) {
            scene.add_disk_light({4, 0, 0}, {0, 0, 0.5}, {0, 0.5, 0}, Rgb(4));
        }};
    for (const auto& add : lights) {
        Scene scene;
        scene.add_mesh(floor_mesh(10));
        scene.set_environment(Environment(Rgb(0.5F)));
        add(scene);
        const Image plain = render_image(scene, camera_above(1), kSize, kSize, with_rays(4, 0));
        const Image shadowed = render_image(scene, camera_above(1), kSize, kSize, with_rays(4, 16));
        EXPECT_GT(plain.red(0, 0), 0.2501);
        EXPECT_EQ(plain.values, shadowed.values);
    }
}

TEST(RenderShadows, ALargeMeshFarFromItsOriginKeepsItsPrecision) {
    // Rays that met it in its own frame would be rounded as 1e4 is.
    constexpr std::uint32_t kSteps = 150;
    Mesh mesh;
    for (std::uint32_t i = 0; i <= kSteps; ++i) {
        for (std::uint32_t j = 0; j <= kSteps; ++j) {
            mesh.vertices.emplace_back(1e4F + static_cast<float>(i) / 64, static_cast<float>(j) / 64, 0);
            const std::uint32_t corner = i * (kSteps + 1) + j;
            if (i < kSteps && j < kSteps) {
                mesh.triangles.emplace_back(corner, corner + 1, corner + kSteps + 1);
                mesh.triangles.emplace_back(corner + 1, corner + kSteps + 2, corner + kSteps + 1);
            }
        }
    }
    mesh.transforms[0][3].x = -1e4;
    Scene scene;
    scene.add_mesh(mesh);
    const auto compiled = scene.compile();
    const Ray down = {{1, 1, 1}, 0, {0, 0, -1}};
    RayHit hit;
    compiled->rays().intersect({&down, 1}, {&hit, 1});
    ASSERT_FALSE(hit.missed());
    const SurfacePoint point = compiled->placed().surface(hit, down.direction);
    EXPECT_LE(glm::distance(point.position, {1, 1, 0}), 1e-6);
    EXPECT_LE(point.error, 2 * kRayRounding);
}

TEST(RenderShadows, AnEmissiveCubeHidesItsFarSides) {
    // Each floor point sees the faces turned to it; the others are behind them. All from rays and closed forms.
    Mesh cube = cuboid({-0.3, -0.3, 0.5}, {0.3, 0.3, 1.1});
    cube.bsdfs = {Bsdf()};
    cube.emission = {Rgb(1)};
    Scene scene;
    scene.add_mesh(floor_mesh(10));
    scene.add_mesh(cube);
    EXPECT_EQ(scene.compile()->lights().size(), 6U);
    const auto face = [](int axis, double at) {
        std::vector<Vec3d> corners(4);
        for (int i = 0; i < 4; ++i) {
            const double u = i == 1 || i == 2 ? 0.3 : -0.3;
            const double v = i >= 2 ? 0.3 : -0.3;
            Vec3d& corner = corners[static_cast<std::size_t>(i)];
            corner[axis] = at;
            corner[(axis + 1) % 3] = u;
            corner[(axis + 2) % 3] = v;
            corner.z += 0.8;
        }
        return corners;
    };
    const Image image = render_image(scene, camera_above(1.5, 0.4), kSize, kSize, with_rays(1, 64));
    const auto truth = [&](int column, int row) {
        const Vec3d point = floor_point(column, row, kSize, 1.5);
        double sum = form_factor(point, face(2, -0.3));
        for (int axis = 0; axis < 2; ++axis) {
            sum += std::abs(point[axis]) > 0.3 ? form_factor(point, face(axis, std::copysign(0.3, point[axis]))) : 0;
        }
        return 0.5 * sum;
    };
    // A ray that ends within some roundings of an edge sees a far side: about one of 10⁵, each a 64th of a side.
    int seen = 0;
    for (int row = 0; row < kSize; ++row) {
        for (int column = 0; column < kSize; ++column) {
            const double difference = std::abs(image.red(column, row) - truth(column, row));
            ASSERT_LE(difference, 1e-3);
            seen += difference <= 1e-5 ? 0 : 1;
        }
    }
    EXPECT_LE(seen, 3);
}

TEST(RenderShadows, AFarGrazingEmitterDoesNotBlockItself) {
    // Seen from a hundred times its size away, nearly edge-on: float rays stray by more than the emitter's own
    // rounding.
    Scene scene;
    scene.add_mesh(floor_mesh(200));
    Mesh emitter = floor_mesh(0.5F, 0.6F);
    emitter.transforms = {frame_matrix({0.3, 0.1, 0.01}, {-0.1, 0.3, 0}, {0, 0, 1}, {0.1, 0.2, 0})};
    emitter.emission = {Rgb(1000)};
    scene.add_mesh(emitter);
    const Camera camera(frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 10}), Window{40, 90, -25, 25},
                        Projection::orthographic);
    const Image plain = render_image(scene, camera, kSize, kSize, with_rays(1, 0));
    const Image shadowed = render_image(scene, camera, kSize, kSize, with_rays(1, 16));
    EXPECT_GT(plain.red(0, 0), 0);
    EXPECT_EQ(plain.values, shadowed.values);
}

TEST(RenderShadows, ALampDoesNotBlockAndIsNotBlockedByWhatItIsMountedOn) {
    // A ceiling lamp in the ceiling's own plane, and another lamp between it and the floor.
    Scene scene;
    scene.add_mesh(floor_mesh(10));
    scene.add_mesh(floor_mesh(10, 2.1F));
    const std::vector<Vec3d> light = {{-0.5, -0.5, 2.1}, {-0.5, 0.5, 2.1}, {0.5, 0.5, 2.1}, {0.5, -0.5, 2.1}};
    scene.add_polygon_light(light, Rgb(2));
    scene.add_polygon_light({{-5, -5, 1}, {5, -5, 1}, {5, 5, 1}, {-5, 5, 1}}, Rgb(1));  // shines up
    const Image image = render_image(scene, camera_above(1.5, 0.9), kSize, kSize, with_rays(4, 16));
    // Four camera rays average over a pixel: their second difference, below 1e-3 of the brightness.
    const auto truth = [&](int column, int row) { return form_factor(floor_point(column, row, kSize, 1.5), light); };
    EXPECT_LE(picture_error(image, truth).largest, 1e-3 * 0.07 + 1e-5);
}

}  // namespace
}  // namespace shlight
