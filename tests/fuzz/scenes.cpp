// SPDX-License-Identifier: MIT
#include "scenes.h"

#include <vector>

#include "invariants.h"
#include "shlight/render.h"

namespace shlight::fuzzing {
namespace {

Rgb draw_color(Input& input) {
    return {input.uniform(0, 1), input.uniform(0, 1), input.rarely() ? 0 : input.uniform(0, 1)};
}

Bsdf draw_bsdf(Input& input) {
    const auto roughness = static_cast<float>(input.uniform(0, 1));
    switch (input.integer(0, 3)) {
        case 0:
            return Bsdf::ggx(input.chance() ? roughness : 0, draw_color(input));
        case 1:
            return Bsdf::layer(Bsdf::ggx(roughness, Rgb(0.04F), 1 + input.uniform(0.1, 3)),
                               Bsdf::lambert(draw_color(input)));
        case 2:
            return Bsdf();
        default:
            return Bsdf::lambert(draw_color(input));
    }
}

/// Any vector of the size of the scene; at times of any other.
Vec3d draw_point(Input& input, double unit) {
    if (input.rarely()) {
        return input.vector<double>();
    }
    return unit * Vec3d(input.uniform(-2, 2), input.uniform(-2, 2), input.uniform(-1, 3));
}

Mesh draw_mesh(Input& input, double unit) {
    Mesh mesh;
    const std::size_t vertices = input.count(3, 6);
    for (std::size_t i = 0; i < vertices; ++i) {
        mesh.vertices.emplace_back(draw_point(input, unit));
    }
    for (std::size_t i = 2; i < vertices; ++i) {
        mesh.triangles.emplace_back(0, i - 1, input.rarely() ? 1 : i);
    }
    if (input.rarely()) {
        mesh.vertex_normals.resize(vertices, Vec3f(input.direction()));
    }
    mesh.bsdfs = {draw_bsdf(input)};
    mesh.emission = {Emission(input.integer(0, 3) == 0 ? draw_color(input) : Rgb(0))};
    if (input.rarely()) {
        mesh.transforms = {draw_place(input, true), draw_place(input, false)};
    }
    return mesh;
}

Light draw_lamp(Input& input, double unit) {
    const Rgb strength = draw_color(input) * static_cast<float>(input.rarely() ? input.power_of_two() : unit);
    const Vec3d place = draw_point(input, unit);
    const double size = unit * input.small(6);
    LightTraits traits;
    traits.seen_by_camera = input.chance();
    traits.casts_shadows = !input.rarely();
    switch (input.integer(0, 5)) {
        case 0:
            return make_sphere_light(place, size, strength, input.chance(), traits);
        case 1:
            return make_disk_lamp(place, size * input.direction(), size * input.direction(), strength,
                                  input.uniform(0.1, 3.1), traits);
        case 2:
            return make_point_source(place, strength, traits);
        case 3:
            return make_sun_light(input.direction(), input.uniform(0, 3), strength, input.rarely(), traits);
        case 4: {
            const SpotProfile cone =
                make_spot_profile(lamp_axes(input.direction()), input.uniform(0.01, 3), input.uniform(0, 1));
            return make_spot_light(place, cone, strength, input.chance() ? 0 : size, input.chance(), traits);
        }
        default: {
            const Vec3d u = size * input.direction(), v = size * input.direction();
            return make_polygon_lamp({place, place + u, place + u + v, place + v}, strength, input.uniform(0.1, 3.1),
                                     traits);
        }
    }
}

RenderSettings draw_settings(Input& input) {
    RenderSettings settings;
    settings.sampling = PixelSampling::fixed(input.integer(1, 2));
    settings.shadow_rays = input.integer(0, 2);
    settings.max_bounces = input.integer(0, 3);
    settings.order = input.rarely() ? input.integer(0, 9) : 0;
    settings.seed = static_cast<std::uint32_t>(input.integer(0, 9));
    settings.threads = 1;
    return settings;
}

void check_picture(Input& input) {
    const double unit = input.integer(0, 3) > 0 ? 1 : input.power_of_two();
    std::vector<Mesh> meshes(input.count(1, 3));
    for (Mesh& mesh : meshes) {
        mesh = draw_mesh(input, unit);
    }
    std::vector<Light> lamps;
    for (int i = input.integer(0, 3); i > 0; --i) {
        lamps.push_back(draw_lamp(input, unit));
    }
    const Environment environment(input.rarely() ? draw_color(input) : Rgb(0));
    const auto scene = compiled(meshes, lamps, environment);
    glm::dmat4 place = draw_place(input, false);
    place[3] = glm::dvec4(unit * Vec3d(place[3]), 1);
    constexpr int kSide = 3;
    std::vector<float> image(std::size_t{4} * kSide * kSide);
    render(*scene, Camera(place, input.uniform(0.1, 3)), kSide, kSide, draw_settings(input), image);
    for (std::size_t i = 0; i < image.size(); ++i) {
        const auto number = static_cast<double>(image[i]);
        check_most("a picture's number is not finite", std::abs(number), 1e30);
        check_most("a picture's number is negative", -number, 1e-6);
        check_most("alpha is above 1", i % 4 == 3 ? number : 0, 1);
    }
}

}  // namespace
}  // namespace shlight::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    shlight::fuzzing::Input input(data, size);
    shlight::fuzzing::answers([&] { shlight::fuzzing::check_picture(input); });
    return 0;
}
