// SPDX-License-Identifier: MIT
#include "shlight/aperture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/checks.h"
#include "base/scene_range.h"

namespace shlight {
namespace {

glm::dvec2 turned(const glm::dvec2& p, double angle) {
    return {std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y};
}

/// Concentric map from the square to the disk (Shirley & Chiu 1997).
glm::dvec2 disk_point(const glm::dvec2& square) {
    const glm::dvec2 p = 2.0 * square - 1.0;
    if (p.x == 0 && p.y == 0) {
        return p;
    }
    const bool steep = std::abs(p.y) > std::abs(p.x);
    const double radius = steep ? p.y : p.x;
    const double angle =
        steep ? std::numbers::pi / 2 - std::numbers::pi / 4 * (p.x / p.y) : std::numbers::pi / 4 * (p.y / p.x);
    return radius * glm::dvec2(std::cos(angle), std::sin(angle));
}

/// A point of the triangle between the centre and two corners that square.x selects. The first triangle is centred on
/// x.
glm::dvec2 polygon_point(const glm::dvec2& square, int corners) {
    const double triangle = std::min(std::floor(square.x * corners), corners - 1.0);
    const double outwards = std::sqrt(square.x * corners - triangle);
    const double across = 2 * square.y - 1;
    const double half = std::numbers::pi / corners;
    return turned(outwards * glm::dvec2(std::cos(half), across * std::sin(half)), 2 * triangle * half);
}

}  // namespace

glm::dvec2 Aperture::point(const glm::dvec2& square) const {
    const glm::dvec2 p = blades < 3 ? disk_point(square) : turned(polygon_point(square, blades), rotation);
    return size * glm::dvec2(p.x / ratio, p.y);
}

void check_aperture(const Aperture& aperture) {
    if (!(std::isfinite(aperture.size) && aperture.size >= 0)) {
        reject("aperture_size must be finite and not negative");
    }
    if (!(std::isfinite(aperture.ratio) && aperture.ratio > 0)) {
        reject("aperture_ratio must be positive and finite");
    }
    check_reach("aperture_size", aperture.reach());
    if (!(aperture.focus_distance > 0 && aperture.reach() <= kFarthest * aperture.focus_distance)) {
        reject("focus_distance must be positive, and more than 1e-10 of the aperture");
    }
    if (aperture.blades < 0) {
        reject("aperture_blades must not be negative");
    }
    if (!std::isfinite(aperture.rotation)) {
        reject("aperture_rotation must be finite");
    }
}

}  // namespace shlight
