// SPDX-License-Identifier: MIT
//
// Parts of scenes that several targets draw.
#pragma once

#include <memory>
#include <vector>

#include "input.h"
#include "shlight/scene.h"

namespace shlight::fuzzing {

inline std::shared_ptr<const CompiledScene> compiled(const std::vector<Mesh>& meshes, const std::vector<Light>& lamps,
                                                     const Environment& environment) {
    Scene scene;
    for (const Mesh& mesh : meshes) {
        scene.add_mesh(mesh);
    }
    for (const Light& lamp : lamps) {
        scene.add_lamp(lamp);
    }
    scene.set_environment(environment);
    return scene.compile(1);
}

/// A turned and shifted frame, of any scale where `scaled`, or any matrix.
inline glm::dmat4 draw_place(Input& input, bool scaled) {
    glm::dmat4 place(1);
    const Vec3d z = input.direction(),
                x = glm::normalize(glm::cross(std::abs(z.z) < 0.9 ? Vec3d(0, 0, 1) : Vec3d(1, 0, 0), z));
    const double scale = scaled ? input.power_of_two() : 1;
    place[0] = glm::dvec4(scale * x, 0);
    place[1] = glm::dvec4(scale * glm::cross(z, x), 0);
    place[2] = glm::dvec4(scale * z, 0);
    place[3] = glm::dvec4(scale * Vec3d(input.uniform(-2, 2), input.uniform(-2, 2), input.uniform(-2, 2)), 1);
    if (input.rarely()) {
        place[input.integer(0, 3)][input.integer(0, 3)] = input.rarely() ? input.broken() : input.number<double>();
    }
    return place;
}

}  // namespace shlight::fuzzing
