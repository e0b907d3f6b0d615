// SPDX-License-Identifier: MIT
//
// Pictures of a floor, seen from the side, against integrals of radiance times f·cos.
#pragma once

#include <functional>

#include "render_scenes.h"
#include "shlight/lobe_shape.h"

namespace shlight::testing {

/// f·cos of a direction towards the light, both in the world.
using Reflection = std::function<double(const Vec3d& towards_light)>;
/// The true light at a point of the floor.
using Truth = std::function<double(const Vec3d& point, const Reflection& reflection)>;

constexpr double kDiffuse = 2;

/// Largest error of a picture without perspective; roughness kDiffuse: a Lambert floor.
inline double error_under(const std::function<void(Scene&)>& add_light, const Truth& truth, double roughness,
                          const RenderSettings& settings = analytic_settings()) {
    constexpr int kPixels = 7;
    constexpr double kReach = 1.5;
    const glm::dmat4 frame = look_at({3, -2, 4}, {0, 0, 0});
    const Vec3d towards_viewer(frame[2]);
    const bool diffuse = roughness > 1;
    Scene scene;
    scene.add_mesh(
        floor_mesh(9, 0, diffuse ? Bsdf::lambert(Rgb(1)) : Bsdf::ggx(static_cast<float>(roughness), Rgb(1))));
    add_light(scene);
    const Camera camera(frame, Window{-kReach, kReach, -kReach, kReach}, Projection::orthographic);
    const Image image = render_image(scene, camera, kPixels, kPixels, settings);
    const LobeShape shape =
        diffuse ? LobeShape(LambertShape{}) : LobeShape(GgxShape{roughness * roughness, Fresnel::one, 1.5});
    const Reflection reflection = [&](const Vec3d& w) { return lobe_value(shape, w, towards_viewer); };
    const auto expected = [&](int column, int row) {
        const Vec3d at = floor_point(column, row, kPixels, kReach);
        const Vec3d origin(frame * glm::dvec4(at.x, at.y, 0, 1));
        return truth(origin - origin.z / towards_viewer.z * towards_viewer, reflection);
    };
    return picture_error(image, expected).largest;
}

}  // namespace shlight::testing
