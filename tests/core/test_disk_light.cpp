// SPDX-License-Identifier: MIT
//
// Disk and ellipse lights: the polygons that stand for them, and pictures. Against exact coefficients and against
// cubature over the disk itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "lobes/material_lobes.h"
#include "math/gauss_legendre.h"
#include "math/triangle_cubature.h"
#include "random_disk.h"
#include "regions/disk_polygon.h"
#include "render_scenes.h"
#include "shlight/polygon.h"
#include "slanted_floor.h"

namespace shlight {
namespace {

using namespace testing;
using std::numbers::pi;

Ellipse ellipse_of(const EllipseInput& e) {
    return {e.center, e.half_axis_u, e.half_axis_v};
}

/// Relative to L_00.
double polygon_error(const Ellipse& disk, int order) {
    const SphericalEllipse ellipse(disk, true);
    if (ellipse.empty()) {
        return 0;
    }
    std::vector<Vec3d> corners;
    append_disk_polygon(ellipse, disk_polygon_size(ellipse, 1, 0.1, 1e-4), corners);
    const auto count = static_cast<std::size_t>(coefficient_count(order));
    std::vector<double> exact(count);
    std::vector<double> found(count);
    disk_coefficients<double>({&disk.center, 1}, {&disk.half_axis_u, 1}, {&disk.half_axis_v, 1}, order, true, exact);
    polygon_coefficients<double>(corners, static_cast<int>(corners.size()), order, true, found);
    double error = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double off = std::abs(found[i] - exact[i]);
        error = off <= error ? error : off;  // keeps NaN
    }
    return error / exact[0];
}

TEST(DiskPolygon, IsWithinATenThousandthOfTheDisk) {
    for (const EllipseClass& c : kEllipseClasses) {
        RandomInput random(21);
        double error = 0;
        for (int i = 0; i < 100; ++i) {
            const double one = polygon_error(ellipse_of(c.draw(random)), 9);
            error = one <= error ? error : one;  // keeps NaN
        }
        EXPECT_LE(error, 1e-4) << c.name;
    }
}

/// ∫ f·cos over the polygon of so many vertices: Gauss's product rule in each triangle about the cone's axis.
double reflected(const SphericalEllipse& ellipse, int size, const LobeShape& shape, const Vec3d& wo) {
    std::vector<Vec3d> corners;
    append_disk_polygon(ellipse, size, corners);
    const Vec3d& axis = ellipse.cone().axis;
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d a = glm::normalize(corners[i]);
        const Vec3d b = glm::normalize(corners[(i + 1) % corners.size()]);
        visit_triangle(axis, a, b, glm::dot(axis, glm::cross(a, b)), product_rule(10),
                       [&](const Vec3d& wi, double weight) { sum += weight * lobe_value(shape, wi, wo); });
    }
    return sum;
}

TEST(DiskPolygon, ReflectsWhatTheDiskDoes) {
    // Disks that are up to as large as the distance on which the lobe changes there, half of them about its peak.
    RandomInput random(22);
    std::vector<double> errors;
    while (errors.size() < 300) {
        const LobeShape shape = GgxShape{random.log_uniform(0.01, 0.7), Fresnel::one, 1.5};
        const Vec3d wo = random.at_tilt(random.uniform(0, 1.4));
        const double far = random.chance(0.5) ? 6 * lobe_width(shape) : 3;
        const Vec3d center = glm::normalize(mirrored(wo) + random.uniform(0, far) * random.direction());
        const Vec3d normal = glm::normalize(center + 0.7 * random.direction());
        const Vec3d u = glm::normalize(glm::cross(normal, random.direction()));
        const double half = random.uniform(0.05, 1) * distance_of_change(shape, center, wo);
        const SphericalEllipse ellipse({center, half * u, random.uniform(0.3, 1) * half * glm::cross(normal, u)}, true);
        if (center.z < 0.02 || ellipse.empty() || ellipse.cut()) {
            continue;
        }
        const double near = distance_of_change(shape, ellipse.cone().axis, wo);
        const int size = disk_polygon_size(ellipse, narrowest(shape, wo.z), near, 1e-4);
        const double exact = reflected(ellipse, 256, shape, wo);
        errors.push_back(std::abs(reflected(ellipse, size, shape, wo) / exact - 1));
    }
    std::sort(errors.begin(), errors.end());
    EXPECT_LE(errors[errors.size() * 95 / 100], 1e-4);
}

TEST(DiskLight, ItsRadiusHoldsAllOfIt) {
    RandomInput random(23);
    for (int i = 0; i < 100; ++i) {
        const EllipseInput e = plain_ellipse(random);
        const DiskLight light = make_disk_light(e.center, e.half_axis_u, e.half_axis_v, Rgb(1), true);
        double farthest = 0;
        for (int k = 0; k < 1000; ++k) {
            const double t = 2 * pi * k / 1000;
            farthest =
                std::max(farthest, glm::length(std::cos(t) * light.half_axis_u + std::sin(t) * light.half_axis_v));
        }
        EXPECT_LE(std::abs(farthest / light.radius - 1), 1e-4);
    }
}

constexpr double kHalf = 1.5;

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

/// Disks over the floor and through it.
const std::vector<DiskLight> kLights = {
    make_disk_light({0.3, -0.4, 1.2}, {0.6, 0.1, 0}, {0.1, -0.6, 0}, Rgb(1), false),  // nearly round, shines down
    make_disk_light({0.2, 0.1, 0.15}, {1, 0, 0.05}, {0, -1, 0}, Rgb(1), false),       // close
    make_disk_light({0, 2, 0.1}, {1.5, 0, 0.5}, {0.2, 0.1, 0.6}, Rgb(1), false),      // cut by the horizon
    make_disk_light({-1, 3, 1}, {0.1, 0.02, 0}, {0, 0, 0.02}, Rgb(1), false),         // small and thin
};

/// factor: of the radiance, by the cosine between the light's normal and the direction to the point.
void expect_integral(const DiskLight& light, double spread, const std::function<double(double)>& factor,
                     double roughness, double tolerance) {
    const auto add = [&](Scene& scene) {
        scene.add_disk_light(light.center, light.half_axis_u, light.half_axis_v, Rgb(1), spread);
    };
    const auto truth = [&](const Vec3d& p, const Reflection& f) {
        return over_disk(light, p, [&](const Vec3d& w) { return factor(-glm::dot(w, light.normal)) * f(w); });
    };
    RenderSettings settings = analytic_settings();
    settings.tolerance = 1e-4;
    EXPECT_LE(error_under(add, truth, roughness, settings), tolerance)
        << light.center.x << ' ' << spread << ' ' << roughness;
}

TEST(DiskLight, PicturesAreIntegralsOverTheDisk) {
    for (const DiskLight& light : kLights) {
        for (const double roughness : {kDiffuse, 0.5, 0.35}) {
            // The settings' tolerance is of the radiance of each way to integrate a lobe.
            expect_integral(
                light, pi, [](double) { return 1.0; }, roughness, roughness > 1 ? 2e-5 : 3e-4);
        }
    }
}

TEST(DiskLight, ShinesThroughItsSpread) {
    for (const double spread : {0.2, 2.5}) {
        const double h = spread / 2;
        const double scale = 1 / (std::tan(h) - h);
        const auto factor = [&](double cosine) {
            return scale * std::max(0.0, std::tan(h) - std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine);
        };
        for (const std::size_t i : {0, 1}) {
            for (const double roughness : {kDiffuse, 0.5}) {
                expect_integral(kLights[i], spread, factor, roughness, 4e-4 * scale * std::tan(h));
            }
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
