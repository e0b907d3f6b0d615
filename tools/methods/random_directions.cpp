// SPDX-License-Identifier: MIT
#include "random_directions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/perpendicular.h"
#include "lights/polygon_sampling.h"

namespace shlight::methods {
namespace {

using std::numbers::pi;

/// Solid angle [sr] below which a flat triangle replaces a spherical one, whose angles lose digits: its density with
/// unit corners varies by about the solid angle.
constexpr double kSmallestSpherical = 0.01;

double one_minus_cos(const SphericalCap& cap) {
    return cap.cosine > 0 ? cap.sine * cap.sine / (1 + cap.cosine) : 1 - cap.cosine;
}

}  // namespace

ConeSampler::ConeSampler(const SphericalCap& cap)
    : cap_(cap),
      across_(perpendicular(cap.axis)),
      up_(glm::cross(cap.axis, across_)),
      height_(one_minus_cos(cap)),
      density_(1 / (2 * pi * height_)) {}

RandomDirection ConeSampler::sample(const glm::dvec2& point) const {
    const double drop = point.x * height_;
    const double sine = std::sqrt(drop * (2 - drop));
    const double azimuth = 2 * pi * point.y;
    return {(1 - drop) * cap_.axis + sine * (std::cos(azimuth) * across_ + std::sin(azimuth) * up_), density_};
}

double ConeSampler::density(const Vec3d& direction) const {
    // Compared by the sine, because cosines of small caps are all nearly 1.
    const double cosine = glm::dot(direction, cap_.axis);
    const double sine = glm::length(glm::cross(direction, cap_.axis));
    const bool inside = cap_.cosine >= 0 ? cosine >= 0 && sine <= cap_.sine : cosine >= 0 || sine >= cap_.sine;
    return inside ? density_ : 0;
}

RandomDirection SphereSurfaceSampler::sample(const glm::dvec2& point) const {
    const double z = 2 * point.x - 1;
    const double r = std::sqrt((1 - z) * (1 + z));
    const Vec3d normal(r * std::cos(2 * pi * point.y), r * std::sin(2 * pi * point.y), z);
    // At the distance 1 the radius is the sine.
    const Vec3d place = circle_.axis + circle_.sine * normal;
    const double distance = glm::length(place);
    const double facing = -glm::dot(normal, place);  // distance · cosine at the light
    if (!(facing > 0)) {
        return {circle_.axis, 0};
    }
    return {place / distance, distance * distance * distance / (4 * pi * circle_.sine * circle_.sine * facing)};
}

DiskSampler::DiskSampler(const SphericalCap& cap)
    : cap_(cap), across_(perpendicular(cap.axis)), up_(glm::cross(cap.axis, across_)) {}

RandomDirection DiskSampler::sample(const glm::dvec2& point) const {
    const double radius = cap_.sine / cap_.cosine;
    const double from_center = radius * std::sqrt(point.x);
    const double azimuth = 2 * pi * point.y;
    const Vec3d place = cap_.axis + from_center * (std::cos(azimuth) * across_ + std::sin(azimuth) * up_);
    const double distance = glm::length(place);
    return {place / distance, distance * distance * distance / (pi * radius * radius)};
}

EllipseAreaSampler::EllipseAreaSampler(const Ellipse& ellipse)
    : ellipse_(ellipse), normal_(glm::cross(ellipse.half_axis_u, ellipse.half_axis_v)) {
    const double length = glm::length(normal_);
    area_ = pi * length;
    normal_ /= length;
    height_ = glm::dot(normal_, ellipse.center);
}

RandomDirection EllipseAreaSampler::sample(const glm::dvec2& point) const {
    const double radius = std::sqrt(point.x);
    const double turn = 2 * pi * point.y;
    const Vec3d place =
        ellipse_.center + radius * (std::cos(turn) * ellipse_.half_axis_u + std::sin(turn) * ellipse_.half_axis_v);
    const double distance = glm::length(place);
    return height_ == 0 ? RandomDirection{normal_, 0} : RandomDirection{place / distance, density_at(distance)};
}

double EllipseAreaSampler::density(const Vec3d& direction) const {
    const double away = distance(direction);
    if (!(away > 0 && std::isfinite(away))) {
        return 0;
    }
    const Vec3d from_center = away * direction - ellipse_.center;
    const double a = glm::dot(glm::cross(from_center, ellipse_.half_axis_v), normal_);
    const double b = glm::dot(glm::cross(ellipse_.half_axis_u, from_center), normal_);
    return std::hypot(a, b) <= area_ / pi ? density_at(away) : 0;
}

TriangleSampler::TriangleSampler(Uniform uniform, std::span<const Vec3d> polygon) : uniform_(uniform) {
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        add(polygon[0], polygon[i], polygon[i + 1]);
    }
}

void TriangleSampler::clear() {
    pieces_.clear();
    total_ = 0;
    positive_ = negative_ = 0;
}

void TriangleSampler::add(const Vec3d& first, const Vec3d& second, const Vec3d& third) {
    const bool in_area = uniform_ == Uniform::in_area;
    const Vec3d a = in_area ? first : glm::normalize(first);
    const Vec3d b = in_area ? second : glm::normalize(second);
    const Vec3d c = in_area ? third : glm::normalize(third);
    Piece piece = {a, b - a, c - a, 0, 0, false};
    const Vec3d normal = glm::cross(piece.ab, piece.ac);
    piece.volume = glm::dot(a, normal);
    piece.size = in_area ? glm::length(normal) / 2 : std::abs(triangle_solid_angle(first, second, third));
    if (!(piece.size > 0 && piece.volume != 0)) {
        return;
    }
    piece.spherical = !in_area && piece.size >= kSmallestSpherical;
    total_ += piece.size;
    ++(piece.volume > 0 ? positive_ : negative_);
    pieces_.push_back(piece);
}

bool TriangleSampler::Piece::contains(const Vec3d& direction) const {
    const double turned = volume > 0 ? 1 : -1;
    const Vec3d b = a + ab;
    const Vec3d c = a + ac;
    return turned * glm::dot(direction, glm::cross(a, ab)) >= 0 &&
           turned * glm::dot(direction, glm::cross(b, c - b)) >= 0 &&
           turned * glm::dot(direction, glm::cross(ac, a)) >= 0;
}

double TriangleSampler::Piece::relative_density(const Vec3d& direction) const {
    if (spherical) {
        return 1;
    }
    // dω = cos dA / r², with the plane's distance r cos and area × distance = volume / 2.
    const double distance = volume / glm::dot(direction, glm::cross(ab, ac));
    return size * 2 * distance * distance * distance / std::abs(volume);
}

RandomDirection TriangleSampler::sample(glm::dvec2 point) const {
    double left = point.x * total_;
    const Piece* piece = pieces_.data();
    while (left >= piece->size && piece != &pieces_.back()) {
        left -= piece->size;
        ++piece;
    }
    point.x = std::min(left / piece->size, 1.0);
    Vec3d direction;
    if (piece->spherical) {
        direction = SphericalTriangle(piece->a, piece->a + piece->ab, piece->a + piece->ac).sample(point);
    } else {
        const double root = std::sqrt(point.x);
        direction = glm::normalize(piece->a + root * ((1 - point.y) * piece->ab + point.y * piece->ac));
    }
    if (positive_ > 0 && negative_ > 0) {
        return {direction, density(direction)};
    }
    return {direction, piece->relative_density(direction) / total_};
}

double TriangleSampler::density(const Vec3d& direction) const {
    double sum = 0;
    int winding = 0;
    for (const Piece& piece : pieces_) {
        if (piece.contains(direction)) {
            sum += piece.relative_density(direction);
            winding += piece.volume > 0 ? 1 : -1;
            if (positive_ == 0 || negative_ == 0) {
                break;
            }
        }
    }
    return winding != 0 ? sum / total_ : 0;
}

}  // namespace shlight::methods
