// SPDX-License-Identifier: MIT
#include <optional>

#include "invariants.h"
#include "scenes.h"
#include "shlight/camera.h"

namespace shlight::fuzzing {
namespace {

/// A usual number at most times, and any other at some.
double near(Input& input, double usual) {
    return input.integer(0, 7) > 0 ? usual * input.uniform(0.1, 1.5) : input.number<double>();
}

Window draw_window(Input& input) {
    return {-near(input, 1), near(input, 1), -near(input, 1), near(input, 1)};
}

Panorama draw_panorama(Input& input) {
    const double pi = std::numbers::pi;
    switch (input.integer(0, 6)) {
        case 0:
            return Equirectangular{-near(input, 2), near(input, 2), -near(input, 1), near(input, 1)};
        case 1:
            return CentralCylindrical{-near(input, 2), near(input, 2), -near(input, 1), near(input, 1)};
        case 2:
            return FisheyeEquidistant{near(input, pi)};
        case 3:
            return FisheyeEquisolid{near(input, 0.01), near(input, pi), {near(input, 0.03), near(input, 0.03)}};
        case 4:
            return FisheyeLensPolynomial{
                {near(input, 0.01), -near(input, 50), near(input, 1), near(input, 1), near(input, 1)},
                near(input, pi),
                {near(input, 0.03), near(input, 0.03)}};
        case 5:
            return MirrorBall{};
        default:
            return EquiangularCubemapFace{};
    }
}

Camera draw_camera(Input& input) {
    const glm::dmat4 place = draw_place(input, input.chance());
    Aperture aperture;
    if (input.chance()) {
        aperture = {near(input, 0.1), near(input, 3), input.integer(-1, 9), near(input, 1), near(input, 1)};
    }
    const int kind = input.integer(0, 3);
    if (kind == 0) {
        return {place, near(input, 2), aperture};
    }
    ClipRange clip;
    if (input.chance()) {
        clip = {near(input, 0.1), near(input, 100)};
    }
    if (kind == 1) {
        return {place, draw_panorama(input), {0, near(input, 1), 0, near(input, 1)}, clip, aperture};
    }
    return {place, draw_window(input), kind == 2 ? Projection::perspective : Projection::orthographic, clip, aperture};
}

void check_camera(const Camera& camera, Input& input) {
    const Window window = camera.window(input.integer(1, 64), input.integer(1, 64));
    for (int i = 0; i < 4; ++i) {
        const double x = std::lerp(window.left, window.right, input.uniform(0, 1));
        const double y = std::lerp(window.bottom, window.top, input.uniform(0, 1));
        const glm::dvec2 lens(input.uniform(0, 1), input.uniform(0, 1));
        const Ray ray = camera.ray(x, y, input.chance() ? std::optional(lens) : std::nullopt);
        check_finite("a ray's origin is not finite", Vec3d(ray.origin));
        check_unit("a ray's direction is no unit vector", Vec3d(ray.direction), 1e-6);
        check_most("a ray starts behind its origin", -ray.t_min, 0);
        check_most("a ray's end is no number", -ray.t_max, 1);
        const Vec3d point = Vec3d(ray.origin) + Vec3d(ray.direction);
        check_finite("a depth is not finite", std::array{camera.depth(point), camera.distance(point)});
        check_finite("a turned direction is not finite", camera.turned_to_frame(Vec3d(ray.direction)));
    }
}

}  // namespace
}  // namespace shlight::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace shlight::fuzzing;
    Input input(data, size);
    std::optional<shlight::Camera> camera;
    if (answers([&] { camera = draw_camera(input); })) {
        check_camera(*camera, input);
    }
    return 0;
}
