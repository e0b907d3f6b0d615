// SPDX-License-Identifier: MIT
#include "lobes/lobe_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "lobe_truth.h"
#include "lobes/refraction.h"
#include "random_input.h"
#include "shlight/lobe_table.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

using testing::RandomInput;

constexpr std::size_t kRays = 37;  // no multiple of any number of lanes

struct Vectors {
    explicit Vectors() : x(kRays + kLobeRayLanes), y(x), z(x) {}
    RayVectors arrays() { return {x.data(), y.data(), z.data()}; }
    ConstRayVectors vectors() const { return {x.data(), y.data(), z.data()}; }
    Vec3d operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
    std::vector<float> x, y, z;
};

std::shared_ptr<const LobeTable> random_table() {
    const TableAxis theta({0.0, 0.4, 0.9, 1.3, 1.6}, 0);
    const TableAxis phi({0.2, 1.0, 2.3, 3.5, 5.0}, 6.283185307179586);
    RandomInput random(7);
    std::vector<float> values(5 * 5 * 5 * 5 * 3);
    std::generate(values.begin(), values.end(), [&] { return static_cast<float>(random.uniform(0.5, 1.0)); });
    return std::make_shared<const LobeTable>(TableAngles::directions, std::array{theta, phi, theta, phi}, 3, values,
                                             std::vector<float>());
}

std::vector<LobeShape> shapes() {
    std::vector<LobeShape> list = {LambertShape()};
    const std::vector<LobeShape> diffuse = testing::rough_diffuse_shapes();
    list.insert(list.end(), diffuse.begin(), diffuse.end());
    for (const double alpha : {0.01, 0.3, 1.0}) {
        for (const Fresnel fresnel : {Fresnel::one, Fresnel::schlick, Fresnel::dielectric, Fresnel::dip}) {
            list.emplace_back(GgxShape{alpha, fresnel, 1.45});
        }
    }
    for (const Microfacets kind : {Microfacets::ggx, Microfacets::beckmann, Microfacets::ashikhmin_shirley}) {
        list.emplace_back(GgxShape{0.1, Fresnel::one, 1.5, kind, 0.7, 0.9});
        list.emplace_back(GgxShape{0.01, Fresnel::schlick, 1.5, kind, 0.1, 4.0});
    }
    static const std::shared_ptr<const LobeTable> table = random_table();
    list.emplace_back(TableShape{table, 2, 0.7});
    return list;
}

Vec3d random_view(RandomInput& random) {
    const double tilt = random.uniform(0.0, 1.5);
    return {std::sin(tilt), 0, std::cos(tilt)};
}

TEST(LobeRays, AreSpreadAsTheLobeSpreadsThem) {
    RandomInput random(5);
    std::vector<LobeShape> list = shapes();
    list.emplace_back(GgxShape{0});
    for (const LobeShape& shape : list) {
        const Vec3d view = random_view(random);
        std::vector<float> u(kRays + kLobeRayLanes);
        std::vector<float> v(u);
        std::generate(u.begin(), u.end(), [&] { return static_cast<float>(random.uniform(0.0, 1.0)); });
        std::generate(v.begin(), v.end(), [&] { return static_cast<float>(random.uniform(0.0, 1.0)); });
        Vectors directions;
        sample_lobe_rays(shape, view, u.data(), v.data(), kRays, directions.arrays());
        for (std::size_t i = 0; i < kRays; ++i) {
            // Some ten operations; roots lose half of the digits of a point near 0 or 1.
            EXPECT_LE(glm::length(directions[i] - sample_lobe(shape, view, {u[i], v[i]})), 1e-5) << i;
        }
    }
}

/// Half of them near the mirror direction, in a frame and of lengths that leave a float's range when squared.
TEST(LobeRays, AreWorthWhatTheLobeReflects) {
    RandomInput random(6);
    for (const LobeShape& shape : shapes()) {
        const ShadingFrame frame = shading_frame(Vec3d(0), random.direction(), random.direction());
        const Vec3d view = random_view(random);
        Vectors ways;
        std::vector<Vec3d> directions;
        for (std::size_t i = 0; i < kRays; ++i) {
            const Vec3d near_mirror = glm::normalize(mirrored(view) + 3 * lobe_width(shape) * random.direction());
            directions.push_back(i % 2 == 0 ? near_mirror : random.direction());
            const Vec3d way = std::exp(random.uniform(-60.0, 60.0)) * frame.to_world(directions[i]);
            ways.x[i] = static_cast<float>(way.x);
            ways.y[i] = static_cast<float>(way.y);
            ways.z[i] = static_cast<float>(way.z);
        }
        std::vector<float> values(kRays + kLobeRayLanes);
        std::vector<float> densities(values);
        weigh_lobe_rays(shape, frame, view, ways.vectors(), kRays, values.data(), densities.data());
        // A direction in floats is off by some 1e-7, the part α of which turns a half vector through the lobe.
        const double tolerance = 1e-5 + 4e-6 / lobe_width(shape);
        for (std::size_t i = 0; i < kRays; ++i) {
            const double value = lobe_value(shape, directions[i], view);
            const double density = lobe_density(shape, view, directions[i]);
            EXPECT_LE(std::abs(values[i] - value), tolerance * value + 1e-6) << i;
            EXPECT_LE(std::abs(densities[i] - density), tolerance * density + 1e-6) << i;
        }
    }
}

/// Integrals over all directions against the means of those that are drawn.
TEST(LobeRays, AnInterfaceHasTheLightOfItsRays) {
    constexpr std::uint32_t kDrawn = 1 << 16;
    const Vec3d view = glm::normalize(Vec3d(0.6, 0, 0.5));
    for (const auto reflection : {InterfaceReflection::drawn, InterfaceReflection::apart, InterfaceReflection::none}) {
        for (const RoughInterface& interface :
             {RoughInterface{0.3, 1.45, reflection}, RoughInterface{0.3, 1 / 1.45, reflection},
              RoughInterface{0.3, 1.45, reflection, Microfacets::beckmann}}) {
            Vec3d drawn(0);
            Vec3d integral(0);
            double share = 0;
            double density = 0;
            for (std::uint32_t i = 0; i < kDrawn; ++i) {
                const glm::dvec2 point = SobolSequence(3).point(i);
                const InterfaceRay ray = sample_interface(interface, view, point, sobol_beyond(i, 3).x);
                share += ray.weight > 0 ? 1.0 / kDrawn : 0.0;
                drawn += ray.weight * Vec3d(1, ray.way.x, ray.way.z) / (1.0 * kDrawn);
                const double up = 2 * point.x - 1;
                const double across = std::sqrt(1 - up * up);
                const double azimuth = 2 * std::numbers::pi * point.y;
                const Vec3d way(across * std::cos(azimuth), across * std::sin(azimuth), up);
                const InterfaceValue own = interface_value(interface, view, way);
                density += own.density * (4 * std::numbers::pi / kDrawn);
                if (own.density > 0) {
                    integral += own.value * Vec3d(1, way.x, way.z) * (4 * std::numbers::pi / kDrawn);
                }
            }
            EXPECT_LE(glm::distance(drawn, integral), 2e-3) << interface.ior;
            EXPECT_LE(std::abs(share - density), 2e-3) << interface.ior;
        }
    }
}

}  // namespace
}  // namespace shlight
