// SPDX-License-Identifier: MIT
//
// What a lobe reflects of a light, by brute force: dense product rules on the true f·cos, split at the horizon, with
// the points crowded where the lobe is narrow. Shares nothing with the library but the value of f·cos.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "math/gauss_legendre.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight::testing {

inline Vec3d view_direction(double cos_theta_o) {
    return {std::sqrt((1 - cos_theta_o) * (1 + cos_theta_o)), 0, cos_theta_o};
}

inline std::vector<LobeShape> rough_diffuse_shapes() {
    return {DiffuseShape{Diffuse::oren_nayar},
            DiffuseShape{Diffuse::oren_nayar_loss},
            DiffuseShape{Diffuse::bumped_ggx},
            DiffuseShape{Diffuse::bumped_cubic},
            kDisneyDiffuse,
            kDisneyRetro,
            kDisneyRetroSquare,
            kDisneyEntry,
            kDisneySheen};
}

/// Σ of terms at m ≥ 0 times a direction's basis.
inline double expansion(const std::vector<float>& terms, int order, const std::vector<double>& basis) {
    double sum = 0;
    for (int l = 0; l < order; ++l) {
        for (int m = 0; m <= l; ++m) {
            sum += static_cast<double>(terms[cosine_index(l, m)]) * basis[coefficient_index(l, m)];
        }
    }
    return sum;
}

/// Break points of (from, to) that crowd towards `peak` geometrically, down to a piece of length `finest`.
inline std::vector<double> crowded(double from, double to, double peak, double finest) {
    std::vector<double> breaks = {from, to};
    peak = std::clamp(peak, from, to);
    for (double step = finest; step < to - from; step *= 2) {
        for (const double x : {peak - step, peak + step}) {
            if (x > from && x < to) {
                breaks.push_back(x);
            }
        }
    }
    if (peak > from && peak < to) {
        breaks.push_back(peak);
    }
    std::sort(breaks.begin(), breaks.end());
    return breaks;
}

template <class F>
double gauss_pieces(const std::vector<double>& breaks, int points, const F& f) {
    const GaussRule& rule = gauss_rule(points);
    double sum = 0;
    for (std::size_t piece = 0; piece + 1 < breaks.size(); ++piece) {
        const double length = breaks[piece + 1] - breaks[piece];
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            sum += length * rule.weights[i] * f(breaks[piece] + length * rule.nodes[i]);
        }
    }
    return sum;
}

/// ∫ f·cos over the part of a cap above the horizon. In the polar coordinates of the mirror direction, where the lobe's
/// peak is a point and the cap's rim cuts each ring in an arc that is found in closed form.
inline double lobe_over_cap(const GgxShape& shape, double cos_theta_o, const Vec3d& axis, double half_angle,
                            int points = 12) {
    const Vec3d view = view_direction(cos_theta_o);
    const Vec3d mirror(-view.x, 0, view.z);
    const Vec3d across(0, 1, 0);
    const Vec3d up = glm::cross(mirror, across);  // in the plane of incidence
    const double cos_between = std::clamp(glm::dot(axis, mirror), -1.0, 1.0);
    const double between = std::acos(cos_between);
    const double azimuth = std::atan2(glm::dot(axis, across), glm::dot(axis, up));
    const auto ring = [&](double angle) {
        // The arc of this ring within the cap.
        const double c = std::cos(angle);
        const double s = std::sin(angle);
        const double reach = (std::cos(half_angle) - c * cos_between) / std::max(1e-300, s * std::sin(between));
        if (reach >= 1) {
            return 0.0;
        }
        const double half = reach <= -1 ? std::numbers::pi : std::acos(reach);
        // Break where the ring crosses the horizon, z = 0 at up·cos φ = -mirror.z c / (up.z s) …
        std::vector<double> ends = {azimuth - half, azimuth + half};
        const double height = -mirror.z * c / (up.z * s == 0 ? 1e-300 : up.z * s);
        if (std::abs(height) < 1) {
            for (const double crossing : {std::acos(height), -std::acos(height)}) {
                for (const int turn : {-1, 0, 1}) {
                    const double phi = crossing + turn * 2 * std::numbers::pi;
                    if (phi > azimuth - half && phi < azimuth + half) {
                        ends.push_back(phi);
                    }
                }
            }
        }
        std::sort(ends.begin(), ends.end());
        // … and crowd towards the plane of incidence, in which a grazing lobe is narrow.
        std::vector<double> breaks;
        for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
            std::vector<double> part = {ends[i], ends[i + 1]};
            for (int k = -4; k <= 4; ++k) {
                const double peak = k * std::numbers::pi / 2;
                if (peak > ends[i] && peak < ends[i + 1]) {
                    part.push_back(peak);
                }
            }
            std::sort(part.begin(), part.end());
            for (std::size_t j = 0; j + 1 < part.size(); ++j) {
                for (const double peak : {part[j], part[j + 1]}) {
                    const double middle = (part[j] + part[j + 1]) / 2;
                    const std::vector<double> fine = peak == part[j] ? crowded(part[j], middle, peak, 0.02)
                                                                     : crowded(middle, part[j + 1], peak, 0.02);
                    breaks.insert(breaks.end(), fine.begin(), fine.end());
                }
            }
        }
        std::sort(breaks.begin(), breaks.end());
        return s * gauss_pieces(breaks, points, [&](double phi) {
                   const Vec3d w = c * mirror + s * (std::cos(phi) * up + std::sin(phi) * across);
                   return lobe_value(shape, w, view);
               });
    };
    const double from = std::max(0.0, between - half_angle);
    const double to = std::min(std::numbers::pi, between + half_angle);
    // Square-root behaviour of the arcs at both ends of the range: x = from + … (1 - cos t)/2 removes it.
    std::vector<double> breaks = crowded(from, to, 0, shape.alpha * cos_theta_o / 4);
    for (const double kink :
         {half_angle - between, std::numbers::pi / 2 - std::asin(mirror.x < 0 ? -mirror.x : mirror.x)}) {
        if (kink > from && kink < to) {
            breaks.push_back(kink);
        }
    }
    std::sort(breaks.begin(), breaks.end());
    double sum = 0;
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
        const double a = breaks[i];
        const double length = breaks[i + 1] - a;
        sum += gauss_pieces({0.0, std::numbers::pi}, points, [&](double t) {
            return length * std::sin(t) / 2 * ring(a + length * (1 - std::cos(t)) / 2);
        });
    }
    return sum;
}

/// ∫ f·cos over a planar polygon above the horizon, convex: its triangles are quartered until a rule of 8 × 8 points
/// agrees with itself on the quarters.
class PolygonTruth {
  public:
    PolygonTruth(const GgxShape& shape, double cos_theta_o) : shape_(shape), view_(view_direction(cos_theta_o)) {}

    double integral(const std::vector<Vec3d>& vertices) const {
        std::vector<Vec3d> kept;
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            const Vec3d& a = vertices[i];
            const Vec3d& b = vertices[(i + 1) % vertices.size()];
            if (a.z >= 0) {
                kept.push_back(a);
            }
            if ((a.z >= 0) != (b.z >= 0)) {
                kept.push_back(a + a.z / (a.z - b.z) * (b - a));
            }
        }
        double sum = 0;
        for (std::size_t i = 1; i + 1 < kept.size(); ++i) {
            sum += refined(kept[0], kept[i], kept[i + 1], once(kept[0], kept[i], kept[i + 1]), 0);
        }
        return sum;
    }

  private:
    double once(const Vec3d& a, const Vec3d& b, const Vec3d& c) const {
        const GaussRule& rule = gauss_rule(8);
        const double volume = std::abs(glm::dot(a, glm::cross(b - a, c - a)));
        double sum = 0;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
                const double u = rule.nodes[i];
                const Vec3d p = a + u * ((1 - rule.nodes[j]) * (b - a) + rule.nodes[j] * (c - a));
                const double r = glm::length(p);
                sum += rule.weights[i] * rule.weights[j] * u * volume / (r * r * r) * lobe_value(shape_, p / r, view_);
            }
        }
        return sum;
    }

    double refined(const Vec3d& a, const Vec3d& b, const Vec3d& c, double whole, int depth) const {
        const Vec3d ab = (a + b) / 2.0;
        const Vec3d bc = (b + c) / 2.0;
        const Vec3d ca = (c + a) / 2.0;
        const std::array<double, 4> parts = {once(a, ab, ca), once(ab, b, bc), once(ca, bc, c), once(ab, bc, ca)};
        const double sum = parts[0] + parts[1] + parts[2] + parts[3];
        // At least four levels, for a lobe narrower than the points' distance.
        if (depth > 12 || (depth >= 4 && std::abs(sum - whole) <= 1e-9)) {
            return sum;
        }
        return refined(a, ab, ca, parts[0], depth + 1) + refined(ab, b, bc, parts[1], depth + 1) +
               refined(ca, bc, c, parts[2], depth + 1) + refined(ab, bc, ca, parts[3], depth + 1);
    }

    GgxShape shape_;
    Vec3d view_;
};

}  // namespace shlight::testing
