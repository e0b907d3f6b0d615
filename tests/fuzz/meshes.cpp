// SPDX-License-Identifier: MIT
#include <vector>

#include "invariants.h"
#include "plane.h"
#include "scenes.h"
#include "shlight/mesh_light.h"
#include "shlight/polygon.h"
#include "shlight/scene_queries.h"

namespace shlight::fuzzing {
namespace {

/// Faces of a few vertices that lie anywhere, or on a grid of whole numbers, where many are in one plane.
Mesh draw_mesh(Input& input, bool grid) {
    Mesh mesh;
    const std::size_t vertices = input.count(3, 12), triangles = input.count(1, 12);
    const auto unit = static_cast<float>(grid ? 1 : input.power_of_two());
    for (std::size_t i = 0; i < vertices; ++i) {
        const Vec3f whole(input.integer(-2, 2), input.integer(-2, 2), input.integer(0, 1));
        mesh.vertices.push_back(unit * (grid ? whole : input.vector<float>()));
    }
    for (std::size_t i = 0; i < triangles; ++i) {
        const auto corner = [&] { return static_cast<std::uint32_t>(input.integer(0, static_cast<int>(vertices))); };
        const std::uint32_t a = corner(), b = corner();
        mesh.triangles.emplace_back(a, b, corner());
    }
    mesh.emission = {Emission(Rgb(1))};
    return mesh;
}

Vec3d vector_area(const std::vector<Vec3d>& outline) {
    Vec3d area(0);
    for (std::size_t i = 2; i < outline.size(); ++i) {
        area += glm::cross(outline[i - 1] - outline[0], outline[i] - outline[0]) / 2.0;
    }
    return area;
}

/// Merged faces cover what the triangles do.
void check_merged(const Mesh& mesh) {
    const std::vector<Vec3d> vertices(mesh.vertices.begin(), mesh.vertices.end());
    Vec3d sum(0);
    double area = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3d one = vector_area({vertices[t.x], vertices[t.y], vertices[t.z]});
        sum += one;
        area += glm::length(one);
    }
    const auto outlines = merge_faces(vertices, mesh.triangles);
    for (const FaceOutline& outline : outlines.value()) {
        sum -= vector_area(outline);
    }
    check_most("merged faces have another area", glm::length(sum), 1e-6 * area);
}

/// The light of all triangles, each by itself, where no two are one face.
std::vector<double> light_of_triangles(const Mesh& mesh, const Vec3d& point, int order) {
    std::vector<Vec3d> corners;
    for (const Triangle& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            corners.push_back(Vec3d(mesh.vertices[t[i]]) - point);
        }
    }
    const auto count = static_cast<std::size_t>(coefficient_count(order));
    std::vector<double> each(mesh.triangles.size() * count), sum(count);
    polygon_coefficients<double>(corners, 3, order, true, each);
    for (std::size_t i = 0; i < each.size(); ++i) {
        sum[i % count] += each[i];
    }
    return sum;
}

/// known: of rounding nothing is to be seen.
void check_light(const Mesh& mesh, const Vec3d& point, int order, bool known) {
    const auto scene = compiled({mesh}, {}, {});
    PointSettings settings;
    settings.rays = 0;
    settings.threads = 1;
    const glm::dmat3 frame(1);
    std::vector<double> found(3 * static_cast<std::size_t>(coefficient_count(order)));
    light_coefficients(*scene, {&point, 1}, {&frame, 1}, order, settings, found);
    check_finite("light of a mesh is not finite", found);
    const std::vector<double> truth = light_of_triangles(mesh, point, order);
    for (std::size_t i = 0; i < truth.size() && known; ++i) {
        check_most("a mesh's light is not that of its triangles", std::abs(found[3 * i] - truth[i]),
                   1e-3 * (1 + truth[0]));
    }
}

void run(Input& input) {
    const bool grid = input.chance();
    const Mesh mesh = draw_mesh(input, grid);
    if (!answers([&] { check_shape(mesh); })) {
        return;
    }
    if (grid) {
        check_merged(mesh);
    }
    const Vec3d point(input.uniform(-3, 3), input.uniform(-3, 3), -input.uniform(0.1, 3));
    answers([&] { check_light(mesh, point, input.integer(1, 6), grid); });
}

}  // namespace
}  // namespace shlight::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    shlight::fuzzing::Input input(data, size);
    shlight::fuzzing::run(input);
    return 0;
}
