// SPDX-License-Identifier: MIT
//
// Sources without extent in lanes, against each by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "delta_view.h"
#include "lights/delta_lights.h"
#include "lights/local_light.h"
#include "random_input.h"

namespace shlight {
namespace {

constexpr std::size_t kCount = 203;  // no multiple of any number of lanes
constexpr double kError = 1e-7;

Light random_light(testing::RandomInput& random, const Vec3d& around) {
    LightTraits traits;
    traits.lights_diffuse = random.chance(0.9);
    traits.lights_glossy = random.chance(0.9);
    const Vec3d position = around + random.log_uniform(1e-2, 1e2) * random.direction();
    const Rgb strength(static_cast<float>(random.uniform(-1, 2)), 1, 0.5F);
    switch (random.integer(0, 3)) {
        case 0:
            return make_sun_light(random.direction(), 0, strength, false, traits);
        case 1:
            return make_spot_light(position, make_spot_profile(lamp_axes(random.direction()), 2, 0.3), strength, 0,
                                   false, traits);
        default:
            return make_point_source(random.chance(0.05) ? around : position, strength, traits);
    }
}

double value_of(const Light& light, const ShadingFrame& frame, const LobeShape& shape, float cosine) {
    const auto seen = delta_view(light, frame, kError);
    const bool glossy = std::holds_alternative<GgxShape>(shape);
    if (!seen || !(glossy ? traits_of(light).lights_glossy : traits_of(light).lights_diffuse)) {
        return 0;
    }
    const double z = cosine;
    return seen->irradiance * lobe_value(shape, seen->direction, Vec3d(std::sqrt(1 - z * z), 0, z));
}

TEST(DeltaLights, ReflectAsEachByItself) {
    testing::RandomInput random(1);
    for (int round = 0; round < 20; ++round) {
        const ShadingFrame frame = shading_frame(100.0 * random.direction(), random.direction(), random.direction());
        std::vector<Light> lights;
        std::generate_n(std::back_inserter(lights), kCount, [&] { return random_light(random, frame.origin); });
        const DeltaLights deltas(lights);
        const auto cosine = static_cast<float>(random.uniform(0.1, 1));
        for (const LobeShape& shape : {LobeShape(LambertShape{}), LobeShape(GgxShape{0.3}), LobeShape(GgxShape{0})}) {
            for (const DeltaRange range : {DeltaRange{0, deltas.padded_size()}, DeltaRange{48, 32}}) {
                DeltaViews views;
                std::vector<float> values(range.count);
                deltas.see(range, frame, kError, views);
                deltas.reflect(range, views, shape, cosine, values.data());
                for (std::size_t i = 0; i < range.count; ++i) {
                    const std::size_t light = range.begin + i;
                    const double truth = light < kCount ? value_of(lights[light], frame, shape, cosine) : 0;
                    EXPECT_LE(std::abs(double{values[i]} - truth), 1e-6 * truth) << light;
                }
            }
        }
    }
}

}  // namespace
}  // namespace shlight
