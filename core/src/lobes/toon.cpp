// SPDX-License-Identifier: MIT
#include "lobes/toon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lobes/boundary_path.h"
#include "lobes/boundary_quadrature.h"

namespace shlight {
namespace {

using std::numbers::pi;

/// Error of an albedo.
constexpr double kAlbedoError = 1e-6;

/// 1 - cos of an angle.
double versine(double angle) {
    const double half = std::sin(angle / 2);
    return 2 * half * half;
}

double angle_between(const Vec3d& a, const Vec3d& b) {
    return 2 * std::asin(std::min(glm::distance(a, b) / 2, 1.0));
}

/// flux(θ) dφ/dt at points of a boundary, in the frame of the lobe.
class ToonSums {
  public:
    using Values = std::array<double, 1>;

    ToonSums(const ToonCone& cone, double tolerance) : cone_(cone), tolerance_(tolerance) {}

    void densities(const ArcPath& path, std::span<const double> parameters, std::span<Values> values) const {
        std::transform(parameters.begin(), parameters.end(), values.begin(),
                       [&](double t) { return Values{density(path.columns(), t)}; });
    }
    static double scale(const Values& /*sum*/) { return 1; }
    static double size(const Values& error) { return std::abs(error[0]); }
    double tolerance(const Values& /*sum*/) const { return tolerance_; }

  private:
    double density(const BoundaryPath& path, double t) const {
        const double f = path.flatness;
        const double s = std::sin(t);
        const double c = std::cos(t);
        const double r = std::hypot(f * c, s);
        const Vec3d at = r * path.middle + f * c * path.cosine + s * path.sine;
        const Vec3d step = (1 - f) * (1 + f) * s * c / r * path.middle - f * s * path.cosine + c * path.sine;
        const double square = at.x * at.x + at.y * at.y;
        const double turn = at.x * step.y - at.y * step.x;
        return square > 0 ? cone_.flux(std::atan2(std::sqrt(square), at.z)) * turn / square : 0.0;
    }

    ToonCone cone_;
    double tolerance_;
};

/// Adds the parts of an arc from one crossing of a circle about z to the next. angles: of the circles.
void add_parts(const Arc<double>& arc, std::span<const double> angles, std::vector<Arc<double>>& parts) {
    const Vec3d across = glm::cross(arc.axis, arc.middle);
    const double middle = std::atan2(across.z, arc.middle.z);
    const double swing = arc.sine * std::hypot(across.z, arc.middle.z);
    std::vector<double> ends = {-arc.half, arc.half};
    for (const double angle : angles) {
        const double height = (std::cos(angle) - arc.cosine * arc.axis.z) / swing;
        if (!(std::abs(height) < 1)) {
            continue;
        }
        for (const double sign : {-1.0, 1.0}) {
            const double crossing = std::remainder(middle + sign * std::acos(height), 2 * pi);
            if (std::abs(crossing) < arc.half) {
                ends.push_back(crossing);
            }
        }
    }
    if (ends.size() == 2) {
        parts.push_back(arc);
        return;
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        const double turn = (ends[i] + ends[i + 1]) / 2;
        Arc<double> part = arc;
        part.half = (ends[i + 1] - ends[i]) / 2;
        part.middle = std::cos(turn) * arc.middle + std::sin(turn) * across;
        parts.push_back(part);
    }
}

}  // namespace

ToonCone::ToonCone(const ToonShape& shape)
    : inner(shape.size * pi / 2),
      outer(std::min(shape.size + shape.smooth, 1.0) * pi / 2),
      fade(shape.smooth * pi / 2),
      peak(1 / (2 * pi * versine(outer))) {}

double ToonCone::intensity(double angle) const {
    return angle > outer ? 0.0 : angle > inner ? 1 - (angle - inner) / fade : 1.0;
}

double ToonCone::flux(double angle) const {
    const double end = std::min(angle, outer);
    if (end <= inner) {
        return versine(end);
    }
    return 1 - std::cos(end) * intensity(end) - (std::sin(end) - std::sin(inner)) / fade;
}

glm::dmat3 toon_frame(const ToonShape& shape, const Vec3d& wo) {
    const Vec3d up = shape.glossy ? mirrored(wo) : Vec3d(0, 0, 1);
    return {Vec3d(up.z, 0, -up.x), Vec3d(0, 1, 0), up};
}

BoundaryIntegral toon_boundary_integral(const ToonShape& shape, double cos_theta_o, std::span<const Arc<double>> arcs,
                                        double tolerance) {
    const ToonCone cone(shape);
    const glm::dmat3 frame = toon_frame(shape, resolved_view(cos_theta_o));
    std::vector<Arc<double>> parts;
    for (Arc<double> arc : arcs) {
        arc.axis = arc.axis * frame;
        arc.middle = arc.middle * frame;
        add_parts(arc, std::array{cone.inner, cone.outer}, parts);
    }
    BoundaryQuadrature<ToonSums> boundary(ToonSums(cone, tolerance / cone.peak));
    for (const Arc<double>& part : parts) {
        boundary.add(ArcPath(part, Vec3d(0), glm::dvec2(1)), 1.0 / static_cast<double>(parts.size()));
    }
    boundary.refine();
    return {boundary.sum()[0] * cone.peak, boundary.error() * cone.peak, boundary.points()};
}

double ToonShape::width() const {
    return std::sin(ToonCone(*this).outer / 2);
}

double ToonShape::value(const Vec3d& wi, const Vec3d& wo) const {
    const ToonCone cone(*this);
    return cone.peak * cone.intensity(angle_between(wi, toon_frame(*this, wo)[2]));
}

double ToonShape::albedo(double cos_theta_o) const {
    const Arc<double> horizon = {{0, 0, 1}, pi, {1, 0, 0}, 0, 0, 1, {}};
    return toon_boundary_integral(*this, cos_theta_o, {&horizon, 1}, kAlbedoError).value;
}

Vec3d ToonShape::sample(const Vec3d& wo, const glm::dvec2& point) const {
    const double below = point.x * versine(ToonCone(*this).outer);
    const double sine = std::sqrt(below * (2 - below));
    const double azimuth = 2 * pi * point.y;
    return toon_frame(*this, wo) * Vec3d(sine * std::cos(azimuth), sine * std::sin(azimuth), 1 - below);
}

double ToonShape::density(const Vec3d& wo, const Vec3d& wi) const {
    const ToonCone cone(*this);
    return angle_between(wi, toon_frame(*this, wo)[2]) <= cone.outer ? cone.peak : 0.0;
}

double ToonShape::largest_density(const Vec3d& /*wo*/) const {
    return ToonCone(*this).peak;
}

}  // namespace shlight
