// SPDX-License-Identifier: MIT
//
// Emissive meshes of many faces in pictures, against sphere lights and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "render_scenes.h"
#include "solids.h"

namespace shlight {
namespace {

using testing::camera_above;
using testing::Image;
using testing::render_image;

constexpr int kSize = 16;
constexpr double kHalf = 2;

Mesh emissive(const testing::Solid& solid, const Vec3d& center, double scale) {
    Mesh mesh;
    for (const Vec3d& v : solid.vertices) {
        mesh.vertices.emplace_back(center + scale * v);
    }
    mesh.triangles = solid.triangles;
    mesh.bsdfs = {Bsdf::lambert(Rgb(0))};
    mesh.emission = {Rgb(1)};
    return mesh;
}

/// Positions outside the square that camera_above shows.
const Vec3d kCenter(0.4, 3.5, 1.2);

/// The image of a floor under a blocker and the lights that `add` adds.
Image floor_under(const std::function<void(Scene&)>& add, const RenderSettings& settings, const Bsdf& floor,
                  const Mesh* blocker) {
    Scene scene;
    scene.add_mesh(testing::floor_mesh(10, 0, floor));
    if (blocker != nullptr) {
        scene.add_mesh(*blocker);
    }
    add(scene);
    return render_image(scene, camera_above(kHalf), kSize, kSize, settings);
}

Image of_sphere_light(const RenderSettings& settings, const Bsdf& floor, const Mesh* blocker) {
    return floor_under([](Scene& scene) { scene.add_sphere_light(kCenter, 1, Rgb(1)); }, settings, floor, blocker);
}

Image of_mesh(const Mesh& mesh, const RenderSettings& settings, const Bsdf& floor, const Mesh* blocker) {
    return floor_under([&](Scene& scene) { scene.add_mesh(mesh); }, settings, floor, blocker);
}

void expect_close(const Image& a, const Image& b, double relative) {
    for (int row = 0; row < kSize; ++row) {
        for (int column = 0; column < kSize; ++column) {
            EXPECT_LE(std::abs(a.red(column, row) - b.red(column, row)), relative * b.red(column, row))
                << column << " " << row;
        }
    }
}

/// Relative difference of the images' sums.
double mean_difference(const Image& a, const Image& b) {
    double difference = 0;
    double sum = 0;
    for (int row = 0; row < kSize; ++row) {
        for (int column = 0; column < kSize; ++column) {
            difference += a.red(column, row) - b.red(column, row);
            sum += b.red(column, row);
        }
    }
    return std::abs(difference) / sum;
}

TEST(RenderEmitters, NothingButWhatIsInTheWayShadows) {
    RenderSettings settings = testing::analytic_settings();
    settings.shadow_rays = 64;
    const Bsdf floor = Bsdf::lambert(Rgb(0.5F));
    const Mesh emitter = emissive(testing::icosphere(3), kCenter, 1);
    expect_close(of_mesh(emitter, settings, floor, nullptr),
                 of_mesh(emitter, testing::analytic_settings(), floor, nullptr), 1e-6);
    const Mesh blocker = testing::sphere_mesh({0, 2.2, 0.5}, 0.5, 16, false);
    const Image shadowed = of_mesh(emitter, settings, floor, &blocker);
    const Image expected = of_sphere_light(settings, floor, &blocker);
    // 0.6 % of the solid angle, and the noise of 64 rays in a few pixels.
    EXPECT_LE(mean_difference(shadowed, expected), 0.015);
}

/// A leaning screen of quadrilaterals beside the square that camera_above shows, and their radiance.
struct Screen {
    static constexpr std::uint32_t kSide = 20;

    Vec3d corner(std::uint32_t i, std::uint32_t j) const {
        return {3.0 * i / kSide - 1.5, 2.2 + 0.6 * j / kSide, 0.05 + 2.0 * j / kSide};
    }
    /// Smooth along the screen, with steps across it.
    Rgb radiance(std::uint32_t i, std::uint32_t j) const {
        const auto wave = static_cast<float>(1 + std::sin(9.0 * i / kSide));
        return {wave, j % 5 < 2 ? 2.0F : 0.1F, 0.5F};
    }
    Mesh mesh() const {
        Mesh mesh;
        mesh.bsdfs = {Bsdf::lambert(Rgb(0))};
        mesh.emission.clear();
        for (std::uint32_t j = 0; j < kSide; ++j) {
            for (std::uint32_t i = 0; i < kSide; ++i) {
                const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
                for (const Vec3d& v : {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)}) {
                    mesh.vertices.emplace_back(v);
                }
                mesh.triangles.emplace_back(first, first + 1, first + 2);
                mesh.triangles.emplace_back(first, first + 2, first + 3);
                const auto material = static_cast<std::uint32_t>(mesh.emission.size());
                mesh.material_indices.insert(mesh.material_indices.end(), 2, material);
                mesh.emission.push_back(radiance(i, j));
            }
        }
        return mesh;
    }
    void add_lamps(Scene& scene) const {
        for (std::uint32_t j = 0; j < kSide; ++j) {
            for (std::uint32_t i = 0; i < kSide; ++i) {
                scene.add_polygon_light({corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)},
                                        radiance(i, j));
            }
        }
    }
};

TEST(RenderEmitters, FacesOfDifferentRadianceAreOneLightAndAddUp) {
    RenderSettings exact = testing::analytic_settings();
    exact.tolerance = 1e-5;
    RenderSettings settings = testing::analytic_settings();
    settings.tolerance = 1e-3;
    for (const Bsdf& floor : {Bsdf::lambert(Rgb(0.5F)), Bsdf::ggx(0.5F, Rgb(0.9F))}) {
        const Image truth = floor_under([](Scene& scene) { Screen().add_lamps(scene); }, exact, floor, nullptr);
        const Image image = of_mesh(Screen().mesh(), settings, floor, nullptr);
        double squares = 0;
        double whole = 0;
        for (int row = 0; row < kSize; ++row) {
            for (int column = 0; column < kSize; ++column) {
                const Rgb difference = image.color(column, row) - truth.color(column, row);
                squares += double{glm::dot(difference, difference)};
                whole += double{glm::dot(truth.color(column, row), truth.color(column, row))};
            }
        }
        // A few times what settings.tolerance allows each part of the sum.
        EXPECT_LE(std::sqrt(squares), 0.01 * std::sqrt(whole));
        std::uint64_t shaded = image.report.cubature_count;
        for (const std::uint64_t of_order : image.report.order_counts) {
            shaded += of_order;
        }
        EXPECT_LE(shaded, 2 * image.report.hits);  // GGX has two lobes
    }
}

TEST(RenderEmitters, HalfAScreenInShadowKeepsItsColors) {
    // A wall hides the red half of the screen from the middle of the floor: no red is left there.
    Mesh mesh = Screen().mesh();
    for (std::size_t i = 0; i < mesh.emission.size(); ++i) {
        mesh.emission[i] = i % Screen::kSide < Screen::kSide / 2 ? Rgb(1, 0, 0) : Rgb(0, 1, 0);
    }
    Mesh wall;
    wall.vertices = {{-3, 1.9F, 0}, {0, 1.9F, 0}, {0, 1.9F, 4}, {-3, 1.9F, 4}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    wall.bsdfs = {Bsdf::lambert(Rgb(0))};
    RenderSettings settings = testing::analytic_settings();
    settings.shadow_rays = 64;
    const Image image = of_mesh(mesh, settings, Bsdf::lambert(Rgb(0.5F)), &wall);
    const Image open = of_mesh(mesh, testing::analytic_settings(), Bsdf::lambert(Rgb(0.5F)), nullptr);
    for (int row = 0; row < kSize; ++row) {
        const Rgb seen = image.color(kSize / 2 - 4, row);  // left of the wall's edge
        EXPECT_LE(seen.x, 0.02F * open.color(kSize / 2 - 4, row).x) << row;
        EXPECT_GE(image.color(kSize / 2, row).y, 0.9F * open.color(kSize / 2, row).y) << row;
    }
}

TEST(RenderEmitters, LayersBehindEachOtherShineOnce) {
    // Two spheres, the smaller hidden in the other.
    RenderSettings settings = testing::analytic_settings();
    settings.shadow_rays = 64;
    testing::Solid both = testing::icosphere(3);
    const auto count = static_cast<std::uint32_t>(both.vertices.size());
    const testing::Solid inner = both;
    for (const Vec3d& v : inner.vertices) {
        both.vertices.push_back(0.5 * v);
    }
    for (const Triangle& t : inner.triangles) {
        both.triangles.push_back(t + count);
    }
    const Bsdf floor = Bsdf::lambert(Rgb(0.5F));
    const Image alone = of_mesh(emissive(inner, kCenter, 1), settings, floor, nullptr);
    const Image layered = of_mesh(emissive(both, kCenter, 1), settings, floor, nullptr);
    // In each pixel 64 rays find which quarter of the light is two layers deep.
    EXPECT_LE(mean_difference(layered, alone), 0.015);
}

TEST(RenderEmitters, ARingBehindAWallIsHiddenFromFewRays) {
    // Most directions pass by a ring: rays that tell nothing of it must not count as a clear view.
    Mesh wall;
    wall.vertices = {{-99, 1.9F, 0}, {99, 1.9F, 0}, {99, 1.9F, 99}, {-99, 1.9F, 99}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    wall.bsdfs = {Bsdf::lambert(Rgb(0))};
    RenderSettings settings = testing::analytic_settings();
    settings.shadow_rays = 1;
    const Mesh ring = emissive(testing::torus(1, 0.1, 24, 12), kCenter + Vec3d(0, 1, 0), 1);
    const Image image = of_mesh(ring, settings, Bsdf::lambert(Rgb(0.5F)), &wall);
    EXPECT_LE(testing::picture_error(image, [](int, int) { return 0.0; }).largest, 1e-6);
}

TEST(RenderEmitters, WithinOneAllDirectionsShine) {
    for (const int rays : {0, 16}) {
        RenderSettings settings = testing::analytic_settings();
        settings.shadow_rays = rays;
        const Image image =
            of_mesh(emissive(testing::icosphere(3), Vec3d(0, 0, 0), 20), settings, Bsdf::lambert(Rgb(0.5F)), nullptr);
        EXPECT_LE(testing::picture_error(image, [](int, int) { return 0.5; }).largest, 1e-5);
    }
}

TEST(RenderEmitters, AnEmitterDoesNotLightItself) {
    Mesh mesh = emissive(testing::icosphere(4), Vec3d(0, 0, 0), 1);
    mesh.bsdfs = {Bsdf::lambert(Rgb(0.8F))};
    for (const int rays : {0, 16}) {
        RenderSettings settings = testing::analytic_settings();
        settings.shadow_rays = rays;
        Scene scene;
        scene.add_mesh(mesh);
        const Image image = render_image(scene, camera_above(0.6), kSize, kSize, settings);
        EXPECT_LE(testing::picture_error(image, [](int, int) { return 1.0; }).largest, 0.01);
    }
}

}  // namespace
}  // namespace shlight
