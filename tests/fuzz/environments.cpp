// SPDX-License-Identifier: MIT
#include <vector>

#include "invariants.h"
#include "scenes.h"
#include "shlight/scene_queries.h"

namespace shlight::fuzzing {
namespace {

LatLong draw_picture(Input& input) {
    LatLong picture;
    picture.width = input.integer(1, input.rarely() ? 32 : 6);
    picture.height = input.integer(1, input.rarely() ? 32 : 6);
    picture.pixels.resize(static_cast<std::size_t>(picture.width * picture.height));
    const auto unit = static_cast<float>(input.power_of_two());
    for (Rgb& pixel : picture.pixels) {
        pixel = input.integer(0, 3) > 0 ? Rgb(unit) * static_cast<float>(input.uniform(0, 1))
                                        : glm::abs(input.vector<float>());
    }
    if (input.rarely()) {
        picture.pixels.back().y = input.chance() ? -unit : static_cast<float>(input.broken());
    }
    picture.to_world = glm::dmat3(draw_place(input, input.rarely()));
    return picture;
}

/// Light at a point from all around, in units of the picture's brightest.
void check_light(const Environment& environment, const Vec3d& largest, Input& input) {
    const auto scene = compiled({}, {}, environment);
    PointSettings settings;
    settings.rays = 0;
    settings.threads = 1;
    const Vec3d point(0), normal = input.direction();
    Vec3d irradiance(0), errors(0);
    shlight::irradiance(*scene, {&point, 1}, {&normal, 1}, settings, {&irradiance, 1}, {&errors, 1});
    const glm::dmat3 frame(1);
    const int order = input.integer(1, 4);
    std::vector<double> found(3 * static_cast<std::size_t>(coefficient_count(order)));
    light_coefficients(*scene, {&point, 1}, {&frame, 1}, order, settings, found);
    for (int channel = 0; channel < 3; ++channel) {
        const double most = largest[channel] * (1 + 1e-2) + 1e-30;
        check_most("irradiance is not finite, or more than the picture has", irradiance[channel],
                   std::numbers::pi * most);
        check_most("irradiance is negative", -irradiance[channel], 0);
        std::vector<double> one;
        for (std::size_t i = static_cast<std::size_t>(channel); i < found.size(); i += 3) {
            one.push_back(found[i] / most);
        }
        check_bands<double>(one, order, 2 * std::numbers::pi, {1e-2, 1e-2});
    }
}

void run(Input& input) {
    const LatLong picture = draw_picture(input);
    Environment environment;
    if (!answers([&] { environment = Environment(picture); })) {
        return;
    }
    Rgb least = picture.pixels.front(), largest = least;
    for (const Rgb& pixel : picture.pixels) {
        least = glm::min(least, pixel);
        largest = glm::max(largest, pixel);
    }
    for (int i = 0; i < 4; ++i) {
        const Rgb seen = environment.radiance(input.direction());
        for (int channel = 0; channel < 3; ++channel) {
            const double slack = 1e-5 * static_cast<double>(largest[channel]);
            check_most("radiance is brighter than any pixel", static_cast<double>(seen[channel] - largest[channel]),
                       slack);
            check_most("radiance is darker than any pixel", static_cast<double>(least[channel] - seen[channel]), slack);
        }
    }
    if (input.chance()) {
        check_light(environment, Vec3d(largest), input);
    }
}

}  // namespace
}  // namespace shlight::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    shlight::fuzzing::Input input(data, size);
    shlight::fuzzing::run(input);
    return 0;
}
