// SPDX-License-Identifier: MIT
//
// Small scenes for the render tests: floors, boxes, cameras, and a render into vectors.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "shlight/render.h"
#include "shlight/scene.h"

namespace shlight::testing {

/// A matrix with these axes and origin as columns.
inline glm::dmat4 frame_matrix(const Vec3d& x, const Vec3d& y, const Vec3d& z, const Vec3d& origin) {
    return {glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(origin, 1)};
}

inline glm::dmat4 look_at(const Vec3d& eye, const Vec3d& target) {
    const Vec3d z = glm::normalize(eye - target);
    const Vec3d x = glm::normalize(glm::cross(std::abs(z.z) < 0.99 ? Vec3d(0, 0, 1) : Vec3d(0, 1, 0), z));
    return frame_matrix(x, glm::cross(z, x), z, eye);
}

/// A square in the plane z = height about the z axis.
inline Mesh floor_mesh(float half_size, float height = 0, const Bsdf& bsdf = Bsdf::lambert(Rgb(0.5F))) {
    Mesh mesh;
    mesh.vertices = {{-half_size, -half_size, height},
                     {half_size, -half_size, height},
                     {half_size, half_size, height},
                     {-half_size, half_size, height}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.bsdfs = {bsdf};
    return mesh;
}

/// A sail at height 1 that blocks nothing about the z-axis, but only rays can tell: its box is there.
inline Mesh sail_mesh() {
    Mesh mesh;
    mesh.vertices = {{-3, -9, 1}, {9, -9, 1}, {9, 3, 1.1F}};
    mesh.triangles = {{0, 1, 2}};
    mesh.bsdfs = {Bsdf::lambert(Rgb(0.5F))};
    return mesh;
}

/// A closed sphere of latitude and longitude, with smooth normals if asked for.
inline Mesh sphere_mesh(const Vec3d& center, double radius, std::uint32_t rings, bool smooth) {
    Mesh mesh;
    const double pi = std::acos(-1.0);
    const std::uint32_t sectors = 2 * rings;
    for (std::uint32_t i = 0; i <= rings; ++i) {
        for (std::uint32_t j = 0; j < sectors; ++j) {
            const double tilt = pi * i / rings;
            const double azimuth = 2 * pi * j / sectors;
            const Vec3d n(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt));
            mesh.vertices.emplace_back(center + radius * n);
            if (smooth) {
                mesh.vertex_normals.emplace_back(n);
            }
        }
    }
    for (std::uint32_t i = 0; i < rings; ++i) {
        for (std::uint32_t j = 0; j < sectors; ++j) {
            const std::uint32_t a = i * sectors + j;
            const std::uint32_t b = i * sectors + (j + 1) % sectors;
            mesh.triangles.emplace_back(a, a + sectors, b + sectors);
            mesh.triangles.emplace_back(a, b + sectors, b);
        }
    }
    mesh.bsdfs = {Bsdf::lambert(Rgb(0.5F))};
    return mesh;
}

struct Image {
    int width, height;
    std::vector<float> values;
    RenderReport report;

    Rgb color(int column, int row) const {
        const float* pixel = &values[4 * static_cast<std::size_t>(row * width + column)];
        return {pixel[0], pixel[1], pixel[2]};
    }
    float red(int column, int row) const { return color(column, row).x; }
    float alpha(int column, int row) const { return values[4 * static_cast<std::size_t>(row * width + column) + 3]; }
};

inline Image render_image(const Scene& scene, const Camera& camera, int width, int height,
                          const RenderSettings& settings, const Progress& progress = {},
                          const PictureUpdate& on_update = {}) {
    Image image{width, height, {}, {}};
    image.values.assign(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), -1.0F);
    const auto compiled = scene.compile(settings.threads);
    image.report = render(*compiled, camera, width, height, settings, image.values, {progress, on_update});
    return image;
}

/// Looks straight down on a square about the origin of the floor: pixel (i, j) shows x from -half to half, y from half
/// to -half.
inline Camera camera_above(double half_size, double height = 10) {
    return {glm::dmat4(frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, height})),
            Window{-half_size, half_size, -half_size, half_size}, Projection::orthographic};
}

/// The floor point at the centre of a pixel of camera_above().
inline Vec3d floor_point(int column, int row, int size, double half_size, double height = 0) {
    return {(2 * (column + 0.5) / size - 1) * half_size, (1 - 2 * (row + 0.5) / size) * half_size, height};
}

/// Irradiance ÷ π on a point of a floor from a polygon of unit radiance above it (Lambert 1760): ½ Σ γ_i n·Γ_i ÷ π.
inline double form_factor(const Vec3d& point, const std::vector<Vec3d>& vertices) {
    double sum = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3d a = glm::normalize(vertices[i] - point);
        const Vec3d b = glm::normalize(vertices[(i + 1) % vertices.size()] - point);
        const Vec3d cross = glm::cross(a, b);
        sum += std::atan2(glm::length(cross), glm::dot(a, b)) * glm::normalize(cross).z;
    }
    return std::abs(sum) / (2 * std::numbers::pi);
}

/// One camera ray through each pixel's centre, and no shadows.
inline RenderSettings analytic_settings() {
    RenderSettings settings;
    settings.sampling = PixelSampling::fixed(1);
    settings.shadow_rays = 0;
    return settings;
}

/// A picture's red against truth(column, row).
struct PictureError {
    double largest = 0;
    double brightest = 0;  // of the truth
};
template <class Truth>
PictureError picture_error(const Image& image, const Truth& truth) {
    PictureError error;
    for (int row = 0; row < image.height; ++row) {
        for (int column = 0; column < image.width; ++column) {
            const double expected = truth(column, row);
            const double difference = std::abs(image.red(column, row) - expected);
            error.largest = difference <= error.largest ? error.largest : difference;  // keeps NaN
            error.brightest = std::max(error.brightest, expected);
        }
    }
    return error;
}

}  // namespace shlight::testing
