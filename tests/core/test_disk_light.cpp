// SPDX-License-Identifier: MIT
//
// Disk and ellipse lights: the polygons that stand for them, samples, pictures. Against exact coefficients and against
// cubature over the disk itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "disks/disk_polygon.h"
#include "error_message.h"
#include "lights/ellipse_sampling.h"
#include "lights/seen_light.h"
#include "math/gauss_legendre.h"
#include "random_disk.h"
#include "render_scenes.h"
#include "shlight/lobe_shape.h"
#include "shlight/polygon.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

using namespace testing;
using std::numbers::pi;

Ellipse<double> ellipse_of(const EllipseInput& e) {
    return {e.center, e.half_axis_u, e.half_axis_v};
}

/// Of the polygon of so many corners, or as many as are chosen for 0; relative to L_00.
double polygon_error(const Ellipse<double>& disk, int order, int size) {
    const SphericalEllipse<double> ellipse(disk, true);
    if (ellipse.empty()) {
        return 0;
    }
    std::vector<Vec3d> corners;
    append_disk_polygon(ellipse, size == 0 ? disk_polygon_size(ellipse, 1, 1e-4) : size, corners);
    const auto count = static_cast<std::size_t>(coefficient_count(order));
    std::vector<double> exact(count);
    std::vector<double> found(count);
    disk_coefficients<double>(disk, order, true, exact.data());
    polygon_coefficients<double>(std::span<const Vec3d>(corners), order, true, found.data());
    double error = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double off = std::abs(found[i] - exact[i]);
        error = off <= error ? error : off;  // keeps NaN
    }
    return error / exact[0];
}

constexpr auto kClasses = std::to_array<EllipseClass>({{"disk", plain_disk},
                                                       {"ellipse", plain_ellipse},
                                                       {"small", small_disk},
                                                       {"tiny", tiny_disk},
                                                       {"large", large_disk},
                                                       {"near contact", disk_near_contact},
                                                       {"rim near contact", rim_near_contact},
                                                       {"thin", thin_ellipse},
                                                       {"nearly edge-on", disk_nearly_edge_on},
                                                       {"sliver", sliver_of_disk},
                                                       {"tangent", tangent_disk},
                                                       {"cut", cut_disk},
                                                       {"cut strip", cut_strip},
                                                       {"lune", lune}});

TEST(DiskPolygon, IsWithinATenThousandthOfTheDisk) {
    for (const EllipseClass& c : kClasses) {
        RandomInput random(21);
        double error = 0;
        for (int i = 0; i < 100; ++i) {
            error = std::max(error, polygon_error(ellipse_of(c.draw(random)), 9, 0));
        }
        EXPECT_LE(error, 1e-4) << c.name;
    }
}

TEST(DiskPolygon, ConvergesWithTheFourthPowerOfItsSides) {
    for (const EllipseClass& c : {EllipseClass{"disk", plain_disk},
                                  {"large", large_disk},
                                  {"rim", rim_near_contact},
                                  {"thin", thin_ellipse},
                                  {"cut", cut_disk}}) {
        RandomInput random(22);
        std::array<double, 2> sums{};
        for (int i = 0; i < 40; ++i) {
            const Ellipse<double> disk = ellipse_of(c.draw(random));
            sums[0] += polygon_error(disk, 5, 48);
            sums[1] += polygon_error(disk, 5, 96);
        }
        // Sixteen, but for the corners that an open arc does not use, and rounding.
        EXPECT_LE(sums[1], sums[0] / 14 + 1e-7) << c.name;
    }
}

DiskLight light_of(const EllipseInput& e, bool two_sided = true) {
    return make_disk_light(e.center, e.half_axis_u, e.half_axis_v, Rgb(1), two_sided);
}

TEST(DiskLight, BadInputIsNamed) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto names = [](const Vec3d& center, const Vec3d& u, const Vec3d& v, const Rgb& radiance) {
        const std::string text = error_message([&] { make_disk_light(center, u, v, radiance, false); });
        return text.substr(0, text.find_first_of(" :"));
    };
    EXPECT_EQ(names({0, nan, 0}, {1, 0, 0}, {0, 1, 0}, Rgb(1)), "center");
    EXPECT_EQ(names({0, 0, 0}, {nan, 0, 0}, {0, 1, 0}, Rgb(1)), "half_axis_u");
    EXPECT_EQ(names({0, 0, 0}, {0, 0, 0}, {0, 1, 0}, Rgb(1)), "half_axis_u");
    EXPECT_EQ(names({0, 0, 0}, {1, 0, 0}, {0, 0, 0}, Rgb(1)), "half_axis_v");
    EXPECT_EQ(names({0, 0, 0}, {1, 0, 0}, {-2, 0, 0}, Rgb(1)), "half_axis_v");
    EXPECT_EQ(names({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, std::numeric_limits<float>::infinity()}), "radiance");
    EXPECT_EQ(names({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, Rgb(-1)), "");
}

TEST(DiskLight, ItsRadiusHoldsAllOfIt) {
    RandomInput random(23);
    for (int i = 0; i < 100; ++i) {
        const DiskLight light = light_of(plain_ellipse(random));
        double farthest = 0;
        for (int k = 0; k < 1000; ++k) {
            const double t = 2 * pi * k / 1000;
            farthest =
                std::max(farthest, glm::length(std::cos(t) * light.half_axis_u + std::sin(t) * light.half_axis_v));
        }
        EXPECT_LE(std::abs(farthest / light.radius - 1), 1e-4);
    }
}

TEST(EllipseSampling, CoversWhatIsAboveTheHorizon) {
    constexpr std::uint32_t kPoints = 1 << 14;
    for (const EllipseClass& c : kClasses) {
        RandomInput random(24);
        for (int i = 0; i < 20; ++i) {
            const Ellipse<double> disk = ellipse_of(c.draw(random));
            std::array<double, 4> exact{};
            disk_coefficients<double>(disk, 2, true, exact.data());
            const double solid_angle = exact[0] * std::sqrt(4 * pi);
            const EllipseSampler sampler(disk);
            glm::dvec2 sum(0);
            double largest = 0;
            for (std::uint32_t k = 0; k < kPoints; ++k) {
                const LightSample s = sampler.sample(sobol(k, 7));
                ASSERT_GE(s.weight, 0) << c.name;
                EXPECT_GE(s.direction.z, -1e-9) << c.name;
                sum += glm::dvec2(1, s.direction.z) * (s.weight / kPoints);
                largest = std::max(largest, s.weight);
            }
            // As test_render_sampling.cpp; the weights of cut ones are uneven.
            EXPECT_LE(std::abs(sum.x - solid_angle), 3e-3 * solid_angle) << c.name;
            EXPECT_LE(std::abs(sum.y - exact[2] * std::sqrt(4 * pi / 3)), 3e-3 * solid_angle) << c.name;
            EXPECT_LE(std::abs(sampler.solid_angle() - solid_angle), 0.05 * solid_angle) << c.name;
        }
    }
}

TEST(EllipseSampling, SamplesEndOnTheDiskAndRaysMeetIt) {
    const DiskLight light = make_disk_light({0.3, -0.5, 1}, {1, 0.2, 0.3}, {-0.2, 0.5, 0.4}, Rgb(1), true);
    const EllipseSampler sampler({light.center, light.half_axis_u, light.half_axis_v});
    const double area = glm::length(glm::cross(light.half_axis_u, light.half_axis_v));
    const auto radius_of = [&](const Vec3d& p) {
        const Vec3d way = p - light.center;
        return std::hypot(glm::dot(glm::cross(way, light.half_axis_v), light.normal),
                          glm::dot(glm::cross(light.half_axis_u, way), light.normal)) /
               area;
    };
    for (std::uint32_t i = 0; i < 256; ++i) {
        const LightSample s = sampler.sample(sobol(i, 2));
        const Vec3d p = s.distance * s.direction;
        EXPECT_LE(std::abs(glm::dot(p - light.center, light.normal)), 1e-9);
        EXPECT_LE(radius_of(p), 1 + 1e-9);
    }
    RandomInput random(25);
    for (int i = 0; i < 1000; ++i) {
        const Vec3d w = random.at_tilt(std::acos(random.uniform(0, 1)));
        const double distance = glm::dot(light.center, light.normal) / glm::dot(w, light.normal);
        const bool met = distance > 0 && radius_of(distance * w) <= 1;
        const auto found = sampler.meets(w);
        ASSERT_EQ(found.has_value(), met);
        EXPECT_LE(met ? std::abs(*found - distance) : 0, 1e-9);
    }
}

constexpr int kSize = 6;
constexpr double kHalf = 1.5;

/// A camera that looks at the floor from the side, without perspective.
const glm::dmat4 kSlanted = look_at({3, -2, 4}, {0, 0, 0});

Vec3d slanted_point(int column, int row) {
    const Vec3d origin(
        kSlanted * glm::dvec4((2 * (column + 0.5) / kSize - 1) * kHalf, (1 - 2 * (row + 0.5) / kSize) * kHalf, 0, 1));
    const Vec3d towards_viewer(kSlanted[2]);
    return origin - origin.z / towards_viewer.z * towards_viewer;
}

/// ∫ g(direction) over the disk above z = 0, seen from p: Gauss in the square of the radius, trapezoids around.
double over_disk(const DiskLight& light, const Vec3d& p, const std::function<double(const Vec3d&)>& g) {
    constexpr int kAround = 480;
    const GaussRule& rule = gauss_rule(kMaxGaussPoints);
    const double area = pi * glm::length(glm::cross(light.half_axis_u, light.half_axis_v));
    double sum = 0;
    constexpr int kRings = 3;
    for (int ring = 0; ring < kRings; ++ring) {
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double radius = std::sqrt((ring + rule.nodes[i]) / kRings);
            for (int k = 0; k < kAround; ++k) {
                const double t = 2 * pi * (k + 0.5) / kAround;
                const Vec3d way =
                    light.center - p + radius * (std::cos(t) * light.half_axis_u + std::sin(t) * light.half_axis_v);
                const double d2 = glm::dot(way, way);
                const Vec3d w = way / std::sqrt(d2);
                const double cosine = -glm::dot(w, light.normal);
                if (w.z > 0 && (light.two_sided || cosine > 0)) {
                    sum += rule.weights[i] / (kAround * kRings) * std::abs(cosine) / d2 * g(w);
                }
            }
        }
    }
    return sum * area;
}

/// Largest error of a picture of the floor; roughness above 1: diffuse.
double picture_error(const Scene& lamps, const std::function<double(const Vec3d&, const LobeShape&)>& truth,
                     double roughness) {
    const bool diffuse = roughness > 1;
    Scene scene = lamps;
    scene.add_mesh(
        floor_mesh(9, 0, diffuse ? Bsdf::lambert(Rgb(1)) : Bsdf::ggx(static_cast<float>(roughness), Rgb(1))));
    const Camera camera(kSlanted, Window{-kHalf, kHalf, -kHalf, kHalf}, Projection::orthographic);
    RenderSettings settings = analytic_settings();
    settings.tolerance = 1e-4;
    const Image image = render_image(scene, camera, kSize, kSize, settings);
    const LobeShape shape =
        diffuse ? LobeShape(LambertShape{}) : LobeShape(GgxShape{roughness * roughness, Fresnel::one, 1.5});
    double error = 0;
    for (int row = 0; row < kSize; ++row) {
        for (int column = 0; column < kSize; ++column) {
            const double off = std::abs(image.red(column, row) - truth(slanted_point(column, row), shape));
            error = off <= error ? error : off;
        }
    }
    return error;
}

/// Disks over the floor and through it.
const std::vector<DiskLight> kLights = {
    make_disk_light({0.3, -0.4, 1.2}, {0.6, 0.1, 0}, {0.1, -0.6, 0}, Rgb(1), false),  // nearly round, shines down
    make_disk_light({0.2, 0.1, 0.15}, {1, 0, 0.05}, {0, -1, 0}, Rgb(1), false),       // close
    make_disk_light({0, 2, 0.1}, {1.5, 0, 0.5}, {0.2, 0.1, 0.6}, Rgb(1), false),      // cut by the horizon
    make_disk_light({-1, 3, 1}, {0.1, 0.02, 0}, {0, 0, 0.02}, Rgb(1), false),         // small and thin
};

TEST(DiskLight, PicturesAreIntegralsOverTheDisk) {
    for (const DiskLight& light : kLights) {
        Scene scene;
        scene.add_disk_light(light.center, light.half_axis_u, light.half_axis_v, Rgb(1));
        for (const double roughness : {2.0, 0.5, 0.35}) {
            const auto truth = [&](const Vec3d& p, const LobeShape& shape) {
                return over_disk(light, p, [&](const Vec3d& w) { return lobe_value(shape, w, Vec3d(kSlanted[2])); });
            };
            // The settings' tolerance is of the radiance of each way to integrate a lobe.
            EXPECT_LE(picture_error(scene, truth, roughness), roughness > 1 ? 2e-5 : 3e-4)
                << light.center.x << ' ' << roughness;
        }
    }
}

TEST(DiskLight, ShinesThroughItsSpread) {
    for (const double spread : {0.2, pi / 3, 2.5}) {
        const double h = spread / 2;
        const double scale = 1 / (std::tan(h) - h);
        for (std::size_t i = 0; i < 2; ++i) {
            const DiskLight& light = kLights[i];
            Scene scene;
            scene.add_disk_light(light.center, light.half_axis_u, light.half_axis_v, Rgb(1), spread);
            const auto truth = [&](const Vec3d& p, const LobeShape& shape) {
                return over_disk(light, p, [&](const Vec3d& w) {
                    const double cosine = -glm::dot(w, light.normal);
                    const double tangent = std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
                    return scale * std::max(0.0, std::tan(h) - tangent) * lobe_value(shape, w, Vec3d(kSlanted[2]));
                });
            };
            for (const double roughness : {2.0, 0.5}) {
                EXPECT_LE(picture_error(scene, truth, roughness), 4e-4 * scale * std::tan(h)) << spread << ' ' << i;
            }
        }
    }
}

TEST(DiskLight, ShinesToItsFrontOnlyAndNotInItsPlane) {
    const auto floor_under = [](const DiskLight& light) {
        Scene scene;
        scene.add_mesh(floor_mesh(9));
        scene.add_disk_light(light.center, light.half_axis_u, light.half_axis_v, Rgb(1));
        return render_image(scene, camera_above(kHalf, 0.5), kSize, kSize, analytic_settings());
    };
    const DiskLight up = make_disk_light({0, 0, 1}, {1, 0, 0}, {0, 1, 0}, Rgb(1), false);
    const DiskLight in_plane = make_disk_light({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, Rgb(1), false);
    for (const DiskLight& light : {up, in_plane}) {
        const Image image = floor_under(light);
        for (int i = 0; i < kSize * kSize; ++i) {
            EXPECT_EQ(image.red(i % kSize, i / kSize), 0.0F);
        }
    }
}

TEST(DiskLight, FillsTheSkyOfAPointThatAllButTouchesIt) {
    for (const double height : {1e-2, 1e-3, 1e-4}) {
        Scene scene;
        scene.add_mesh(floor_mesh(9));
        scene.add_disk_light({0, 0, height}, {0, 1, 0}, {1, 0, 0}, Rgb(1));
        const Image image = render_image(scene, camera_above(0.3, 0.5 * height), kSize, kSize, analytic_settings());
        for (int i = 0; i < kSize * kSize; ++i) {
            EXPECT_LE(std::abs(image.red(i % kSize, i / kSize) - 0.5), 2 * height * height);
        }
    }
}

TEST(DiskLight, AMirrorShowsIt) {
    // Seen from above in a mirror: the ellipse itself, whose edge 128 sides follow to 1e-4.
    Scene scene;
    scene.add_mesh(floor_mesh(9, 0, Bsdf::ggx(0, Rgb(1))));
    scene.add_disk_light({0.1, 0.2, 5}, {0, 0.5, 0}, {1, 0, 0}, Rgb(2));
    constexpr int kFine = 64;
    const Image image = render_image(scene, camera_above(kHalf, 1), kFine, kFine, analytic_settings());
    for (int i = 0; i < kFine * kFine; ++i) {
        const Vec3d p = floor_point(i % kFine, i / kFine, kFine, kHalf);
        const double radius = std::hypot(p.x - 0.1, (p.y - 0.2) / 0.5);
        if (std::abs(radius - 1) > 3e-4) {
            EXPECT_LE(std::abs(image.red(i % kFine, i / kFine) - (radius < 1 ? 2 : 0)), 1e-6) << p.x << ' ' << p.y;
        }
    }
}

}  // namespace
}  // namespace shlight
