// SPDX-License-Identifier: MIT
//
// Plain double-precision cubature over the hemisphere and over clipped caps, for what needs no more digits.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <vector>

#include "shlight/types.h"

namespace shlight::testing {

struct Node {
    double x, weight;
};

/// Gauss–Legendre nodes on [-1, 1], computed once for each count.
inline const std::vector<Node>& unit_gauss_nodes(int count) {
    static thread_local std::map<int, std::vector<Node>> rules;
    std::vector<Node>& nodes = rules[count];
    for (int i = static_cast<int>(nodes.size()); i < count; ++i) {
        double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
        double slope = 0;
        for (int step = 0; step < 6; ++step) {
            const auto n = static_cast<unsigned>(count);
            slope = count * (std::legendre(n - 1, x) - x * std::legendre(n, x)) / (1 - x * x);
            x -= std::legendre(n, x) / slope;
        }
        nodes.push_back({x, 2 / ((1 - x * x) * slope * slope)});
    }
    return nodes;
}

/// The same on [low, high].
inline std::vector<Node> gauss_nodes(int count, double low, double high) {
    std::vector<Node> nodes = unit_gauss_nodes(count);
    for (Node& node : nodes) {
        node = {(low + high) / 2 + (high - low) / 2 * node.x, (high - low) / 2 * node.weight};
    }
    return nodes;
}

using Integrand = std::function<double(const Vec3d&)>;

/// A direction and its solid angle.
struct Sample {
    Vec3d direction;
    double weight;
};

/// Directions over half of the upper hemisphere, y ≥ 0, for what is even in y; the weights count both halves.
/// z = t², because lobes have square roots of z at the horizon at most.
inline std::vector<Sample> mirrored_hemisphere(int circles, int longitudes) {
    std::vector<Sample> samples;
    const std::vector<Node> around = gauss_nodes(longitudes, 0, std::numbers::pi);
    for (const Node& t : gauss_nodes(circles, 0, 1)) {
        const double z = t.x * t.x;
        const double r = std::sqrt(1 - z * z);
        for (const Node& phi : around) {
            const Vec3d direction(r * std::cos(phi.x), r * std::sin(phi.x), z);
            samples.push_back({direction, 2 * phi.weight * t.weight * 2 * t.x});
        }
    }
    return samples;
}

/// Directions over the part of a cap above the horizon: rings about its axis, the kept arc of each.
inline std::vector<Sample> clipped_cap_samples(const Vec3d& axis, double half, int count) {
    const Vec3d pole = glm::normalize(axis);
    const Vec3d side = std::abs(pole.z) < 0.9 ? glm::normalize(glm::cross({0, 0, 1}, pole))
                                              : glm::normalize(glm::cross({1, 0, 0}, pole));
    // `up` climbs towards z as fast as it can, where that is defined.
    const Vec3d up = glm::cross(pole, side);
    const double highest = std::atan2(glm::dot(side, Vec3d(0, 0, 1)), up.z);
    const double first_cut = std::min(half, std::abs(std::asin(std::clamp(pole.z, -1.0, 1.0))));
    const double steepness = std::hypot(up.z, side.z);
    std::vector<Sample> samples;
    const auto add_ring = [&](double alpha, double weight, double kept) {
        for (const Node& psi : gauss_nodes(count, highest - kept, highest + kept)) {
            const Vec3d across = std::cos(psi.x) * up + std::sin(psi.x) * side;
            samples.push_back(
                {std::cos(alpha) * pole + std::sin(alpha) * across, weight * psi.weight * std::sin(alpha)});
        }
    };
    if (pole.z > 0) {
        for (const Node& alpha : gauss_nodes(count, 0, first_cut)) {
            add_ring(alpha.x, alpha.weight, std::numbers::pi);
        }
    }
    for (const Node& u : gauss_nodes(count, 0, 1)) {  // the kept arc starts with a square root
        const double alpha = first_cut + (half - first_cut) * u.x * u.x;
        const double cosine = -pole.z / (steepness * std::tan(alpha));
        if (half > first_cut && cosine < 1) {
            add_ring(alpha, u.weight * 2 * u.x * (half - first_cut), std::acos(std::max(cosine, -1.0)));
        }
    }
    return samples;
}

inline double integral(const std::vector<Sample>& samples, const Integrand& f) {
    double sum = 0;
    for (const Sample& sample : samples) {
        sum += sample.weight * f(sample.direction);
    }
    return sum;
}

/// ∫ f dω over a parallelogram, of which the corners 0, 1 and 3 are asked for, seen from p: two Gauss points each way
/// in panels² parts.
inline double over_parallelogram(const Vec3d& p, const std::vector<Vec3d>& corners, int panels, const Integrand& f) {
    const Vec3d along = corners[1] - corners[0];
    const Vec3d across = corners[3] - corners[0];
    const Vec3d area = glm::cross(along, across) / (1.0 * panels * panels);
    double sum = 0;
    for (const Node& a : gauss_nodes(2, 0, 1)) {
        for (const Node& b : gauss_nodes(2, 0, 1)) {
            for (int i = 0; i < panels * panels; ++i) {
                const double v = i / panels + b.x;  // NOLINT(bugprone-integer-division): rows of panels
                const Vec3d way = corners[0] + (i % panels + a.x) / panels * along + v / panels * across - p;
                const double distance = glm::length(way);
                const double seen = std::abs(glm::dot(area, way)) / (distance * distance * distance);
                sum += a.weight * b.weight * seen * f(way / distance);
            }
        }
    }
    return sum;
}

}  // namespace shlight::testing
