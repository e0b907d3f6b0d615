// SPDX-License-Identifier: MIT
#include "lights/polygon_sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/unit_direction.h"
#include "regions/spherical_polygon.h"

namespace shlight {
namespace {

/// A triangle is sampled by area, which needs no angles, if its corners' distances differ by less than this factor: the
/// weights of its points then vary by about the factor's cube.
constexpr double kEvenDistances = 1.6;
/// Solid angle below which a spherical triangle's angles lose digits.
constexpr double kSmallest = 1e-5;

/// The part of v at right angles to the unit vector `axis`, as a unit vector.
Vec3d orthogonal(const Vec3d& v, const Vec3d& axis) {
    return glm::normalize(v - glm::dot(v, axis) * axis);
}

bool has_even_distances(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const auto [nearest, farthest] = std::minmax({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)});
    return farthest < kEvenDistances * kEvenDistances * nearest;
}

}  // namespace

SphericalTriangle::SphericalTriangle(const Vec3d& corner_a, const Vec3d& corner_b, const Vec3d& corner_c)
    : a_(glm::normalize(corner_a)), b_(glm::normalize(corner_b)) {
    const Vec3d c = glm::normalize(corner_c);
    const Vec3d ab = glm::normalize(glm::cross(a_, b_));
    const Vec3d bc = glm::normalize(glm::cross(b_, c));
    const Vec3d ca = glm::normalize(glm::cross(c, a_));
    alpha_ = angle_between(ab, -ca);
    cos_alpha_ = std::cos(alpha_);
    sin_alpha_ = std::sin(alpha_);
    area_ = alpha_ + angle_between(bc, -ab) + angle_between(ca, -bc) - std::numbers::pi;
    towards_c_ = orthogonal(c, a_);
}

Vec3d SphericalTriangle::sample(const glm::dvec2& point) const {
    const double angle = point.x * area_ - alpha_;
    const double s = std::sin(angle);
    const double t = std::cos(angle);
    const double u = t - cos_alpha_;
    const double v = s + sin_alpha_ * glm::dot(a_, b_);
    const double q = std::clamp(((v * t - u * s) * cos_alpha_ - v) / ((v * s + u * t) * sin_alpha_), -1.0, 1.0);
    const Vec3d corner = q * a_ + std::sqrt(1 - q * q) * towards_c_;
    const Vec3d chord = corner - b_;
    const double drop = point.y * 0.5 * glm::dot(chord, chord);  // 1 - z in Arvo's paper
    return (1 - drop) * b_ + std::sqrt(std::max(0.0, drop * (2 - drop))) * orthogonal(corner, b_);
}

void PolygonSampler::start(const Vec3d& normal, const Vec3d& corner) {
    pieces_.clear();
    total_ = 0;
    normal_ = normal;
    height_ = glm::dot(normal, corner);
}

void PolygonSampler::reset(std::span<const Vec3d> corners, std::span<const Triangle> triangles, const Vec3d& normal) {
    start(normal, corners[0]);
    for (const Triangle& t : triangles) {
        add_clipped(corners[t.x], corners[t.y], corners[t.z]);
    }
}

void PolygonSampler::reset(const std::array<Vec3d, 4>& corners) {
    reset(corners, glm::normalize(glm::cross(corners[1] - corners[0], corners[3] - corners[0])));
}

void PolygonSampler::reset(std::span<const Vec3d> corners, const Vec3d& normal) {
    start(normal, corners[0]);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        add_clipped(corners[0], corners[i], corners[i + 1]);
    }
}

void PolygonSampler::add_clipped(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    std::array<Vec3d, 4> kept{};
    std::size_t count = 0;
    const std::array<Vec3d, 3> corners = {a, b, c};
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d& from = corners[i];
        const Vec3d& to = corners[(i + 1) % 3];
        if (from.z >= 0) {
            kept[count++] = from;
        }
        if ((from.z >= 0) != (to.z >= 0)) {
            kept[count++] = from + from.z / (from.z - to.z) * (to - from);
        }
    }
    for (std::size_t i = 2; i < count; ++i) {
        Piece piece = {kept[0], kept[i - 1], kept[i], std::abs(triangle_solid_angle(kept[0], kept[i - 1], kept[i])),
                       0,       std::nullopt};
        if (!(piece.solid_angle > 0)) {
            continue;
        }
        if (piece.solid_angle < kSmallest || has_even_distances(piece.a, piece.b, piece.c)) {
            piece.area = 0.5 * glm::length(glm::cross(piece.b - piece.a, piece.c - piece.a));
        } else {
            piece.spherical.emplace(piece.a, piece.b, piece.c);
        }
        total_ += piece.solid_angle;
        pieces_.push_back(piece);
    }
}

std::optional<double> PolygonSampler::meets(const Vec3d& direction) const {
    const double distance = height_ / glm::dot(normal_, direction);
    const bool met = distance > 0 && std::any_of(pieces_.begin(), pieces_.end(), [&](const Piece& piece) {
                         return line_meets(direction, piece.a, piece.b, piece.c);
                     });
    return met ? std::optional(distance) : std::nullopt;
}

LightSample PolygonSampler::sample(glm::dvec2 point) const {
    if (!(total_ > 0)) {
        return {Vec3d(0, 0, 1), 0, 0};
    }
    double left = point.x * total_;
    const Piece* piece = pieces_.data();
    while (left >= piece->solid_angle && piece != &pieces_.back()) {
        left -= piece->solid_angle;
        ++piece;
    }
    LightSample drawn = sample(*piece, {std::min(left / piece->solid_angle, 1.0), point.y});
    drawn.weight *= total_ / piece->solid_angle;
    return drawn;
}

LightSample PolygonSampler::sample_patch(std::size_t patch, const glm::dvec2& point) const {
    return sample(pieces_[patch], point);
}

LightSample PolygonSampler::sample(const Piece& piece, const glm::dvec2& point) const {
    if (piece.spherical) {
        const Vec3d direction = piece.spherical->sample(point);
        return {direction, height_ / glm::dot(normal_, direction), piece.solid_angle};
    }
    const double root = std::sqrt(point.x);
    const Vec3d target = (1 - root) * piece.a + root * ((1 - point.y) * piece.b + point.y * piece.c);
    const double distance = glm::length(target);
    return {target / distance, distance, weight(piece, distance)};
}

double PolygonSampler::weight(const Piece& piece, double distance) const {
    // dω = |cos at the light| dA / distance²
    return piece.spherical ? piece.solid_angle : piece.area * std::abs(height_) / (distance * distance * distance);
}

double PolygonSampler::weight(const Vec3d& direction) const {
    const double distance = height_ / glm::dot(normal_, direction);
    for (const Piece& piece : pieces_) {
        if (distance > 0 && line_meets(direction, piece.a, piece.b, piece.c)) {
            return weight(piece, distance) * total_ / piece.solid_angle;
        }
    }
    return 0;
}

}  // namespace shlight
