// SPDX-License-Identifier: MIT
//
// Closed surfaces to emit light.
#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight::testing {

struct Solid {
    std::vector<Vec3d> vertices;
    std::vector<Triangle> triangles;
};

/// Radius 1 about the origin; 20 · 4^subdivisions faces.
inline Solid icosphere(int subdivisions) {
    const double t = std::numbers::phi;
    Solid s{{{-1, t, 0},
             {1, t, 0},
             {-1, -t, 0},
             {1, -t, 0},
             {0, -1, t},
             {0, 1, t},
             {0, -1, -t},
             {0, 1, -t},
             {t, 0, -1},
             {t, 0, 1},
             {-t, 0, -1},
             {-t, 0, 1}},
            {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
             {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
             {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
    for (Vec3d& v : s.vertices) {
        v = glm::normalize(v);
    }
    for (int level = 0; level < subdivisions; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [at, added] = middles.try_emplace({std::min(a, b), std::max(a, b)}, s.vertices.size());
            if (added) {
                s.vertices.push_back(glm::normalize(s.vertices[a] + s.vertices[b]));
            }
            return at->second;
        };
        std::vector<Triangle> finer;
        for (const Triangle& f : s.triangles) {
            const std::uint32_t a = middle(f.x, f.y);
            const std::uint32_t b = middle(f.y, f.z);
            const std::uint32_t c = middle(f.z, f.x);
            finer.insert(finer.end(), {{f.x, a, c}, {f.y, b, a}, {f.z, c, b}, {a, b, c}});
        }
        s.triangles = std::move(finer);
    }
    return s;
}

/// About the z axis; not convex.
inline Solid torus(double radius, double tube, std::uint32_t around, std::uint32_t across) {
    Solid s;
    for (std::uint32_t i = 0; i < around; ++i) {
        for (std::uint32_t j = 0; j < across; ++j) {
            const double u = 2 * std::numbers::pi * i / around;
            const double v = 2 * std::numbers::pi * j / across;
            const double r = radius + tube * std::cos(v);
            s.vertices.emplace_back(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
        }
    }
    const auto at = [&](std::uint32_t i, std::uint32_t j) { return i % around * across + j % across; };
    for (std::uint32_t i = 0; i < around; ++i) {
        for (std::uint32_t j = 0; j < across; ++j) {
            s.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
            s.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
    return s;
}

}  // namespace shlight::testing
