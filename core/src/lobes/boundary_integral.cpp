// SPDX-License-Identifier: MIT
#include "lobes/boundary_integral.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/perpendicular.h"
#include "lobes/boundary_kernel.h"
#include "lobes/boundary_path.h"
#include "lobes/boundary_quadrature.h"
#include "lobes/toon.h"
#include "math/gauss_legendre.h"

namespace shlight {
namespace {

/// Floats suffice for tolerances, over the albedo, from this one on.
constexpr double kLeastTolerance32 = 1e-6;

/// A lobe of a smaller albedo gets all of it from the rise towards grazing angles, which varies fast: the rule along a
/// radius then errs by a share of this one.
constexpr double kLeastAlbedo = 0.02;

/// Derivatives by α may err by such a part of themselves, or of the floor ÷ α.
constexpr double kDerivativeError = 1e-7, kDerivativeFloor = 1e-5;

/// Number of points along a radius; the factors of the slope distribution vary slowly, but a table may hold anything.
/// tolerance: ÷ albedo.
int points_for(const LobeShape& shape, double tolerance) {
    return std::holds_alternative<TableShape>(shape) ? 24
           : tolerance > 4e-3                        ? 4
           : tolerance > 2e-4                        ? 6
           : tolerance > 1e-5                        ? 12
                                                     : 24;
}

/// A lobe, summed along radii, at points of a boundary.
class RadialSums {
  public:
    using Values = std::array<double, 1>;

    RadialSums(const LobeShape& shape, double cos_theta_o, double tolerance, double albedo)
        : slope_ndf_{shape, cos_theta_o, &gauss_rule(points_for(shape, tolerance / std::max(albedo, kLeastAlbedo)))},
          tolerance_(tolerance),
          f32_(tolerance >= kLeastTolerance32 * albedo) {}

    void densities(const ArcPath& path, std::span<const double> parameters, std::span<Values> values) const {
        std::array<double, kBoundaryPoints> numbers;
        boundary_densities(slope_ndf_, path.columns(), f32_, parameters, std::span(numbers).first(parameters.size()));
        std::transform(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(values.size()), values.begin(),
                       [](double number) { return Values{number}; });
    }
    static double scale(const Values& /*sum*/) { return 1; }
    static double size(const Values& error) { return std::abs(error[0]); }
    double tolerance(const Values& /*sum*/) const { return tolerance_; }
    std::size_t points() const { return slope_ndf_.rule->nodes.size(); }

  private:
    SlopeNdf slope_ndf_;
    double tolerance_;
    bool f32_;  // whether floats will do
};

/// Derivatives of lobes by their α, summed along radii that begin on the third axis of a frame.
class RadialSumsByAlpha {
  public:
    using Values = std::array<double, 3>;

    explicit RadialSumsByAlpha(const SlopeNdfByAlpha& slope_ndf) : slope_ndf_(slope_ndf) {}

    void densities(const ArcPath& path, std::span<const double> parameters, std::span<Values> values) const {
        const BoundaryPath& p = path.columns();
        const glm::dmat3& f = slope_ndf_.frame;
        boundary_densities_by_alpha(slope_ndf_, {p.middle * f, p.cosine * f, p.sine * f, p.flatness}, parameters,
                                    values);
    }
    double scale(const Values& sum) const { return size(sum) + kDerivativeFloor / slope_ndf_.alpha; }
    static double size(const Values& error) {
        return std::max({std::abs(error[0]), std::abs(error[1]), std::abs(error[2])});
    }
    double tolerance(const Values& sum) const { return kDerivativeError * scale(sum); }

  private:
    SlopeNdfByAlpha slope_ndf_;
};

template <class Radial>
BoundaryQuadrature<Radial> integrate(const Radial& radial, const Vec3d& view, const glm::dvec2& alpha,
                                     std::span<const Arc<double>> arcs) {
    BoundaryQuadrature<Radial> boundary(radial);
    for (const Arc<double>& arc : arcs) {
        boundary.add(ArcPath(arc, view, alpha), 1.0 / static_cast<double>(arcs.size()));
    }
    boundary.refine();
    return boundary;
}

Vec3d turned(const Vec3d& v, double cosine, double sine) {
    return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y, v.z};
}

/// A point of a boundary: the direction of light, and that of its half vector in the plane of slopes.
struct SlopePoint {
    Vec3d light, slope;

    SlopePoint(const Vec3d& wi, const Vec3d& view, double alpha) : light(wi) {
        const Vec3d half = wi + view;
        slope = glm::normalize(Vec3d(half.x / alpha, half.y / alpha, half.z));
    }
};

/// The middle of a boundary, above the horizon.
Vec3d middle_of(std::span<const Arc<double>> arcs, const Vec3d& otherwise) {
    Vec3d sum(0);  // ∫ ω ds / 2
    for (const Arc<double>& arc : arcs) {
        sum += arc.sine * (arc.half * arc.cosine * arc.axis + std::sin(arc.half) * arc.sine * arc.middle);
    }
    const double length = glm::length(sum);
    return length > 0 ? sum / length : otherwise;
}

std::vector<SlopePoint> points_along(std::span<const Arc<double>> arcs, const Vec3d& view, double alpha) {
    std::vector<SlopePoint> points;
    for (const Arc<double>& arc : arcs) {
        const Vec3d across = glm::cross(arc.axis, arc.middle);
        for (const double part : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
            const double psi = part * arc.half;
            const Vec3d outwards = std::cos(psi) * arc.middle + std::sin(psi) * across;
            points.emplace_back(arc.cosine * arc.axis + arc.sine * outwards, view, alpha);
        }
    }
    return points;
}

/// How far the factors of the slope distribution change along radii from a centre to these points. They vary with the
/// slope's direction, and with the heights of half vector and light where these are no more than α. Infinite if a
/// radius is more than a quarter turn: it may pass the lobe's middle, which its ends do not tell.
double span_from(const SlopePoint& centre, std::span<const SlopePoint> points, double alpha) {
    const auto height = [alpha](double z) {
        const double over = std::max(z, 0.0) / alpha;
        return over + std::sqrt(over * over + 1);
    };
    const auto ratio = [&](double a, double b) { return std::max(height(a) / height(b), height(b) / height(a)); };
    double largest = 1;
    double farthest = 0;
    for (const SlopePoint& point : points) {
        largest = std::max({largest, ratio(point.slope.z, centre.slope.z), ratio(point.light.z, centre.light.z)});
        farthest = std::max(farthest, glm::length(point.slope - centre.slope));
    }
    return farthest > std::numbers::sqrt2 ? std::numeric_limits<double>::infinity() : std::log(largest) + farthest;
}

/// Decides where radii begin, and how many points they take. Across a light no larger than the lobe, few points suffice
/// from the middle of the light; radii to a larger one begin at the lobe's middle.
SlopeNdfByAlpha shortest_radii(std::span<const WeightedLobe> lobes, const Vec3d& view,
                               std::span<const Arc<double>> arcs) {
    const double alpha = lobe_width(lobes[0].shape);
    const Vec3d mirrored(-view.x, 0, view.z);
    const std::vector<SlopePoint> points = points_along(arcs, view, alpha);
    const SlopePoint of_lobe(mirrored, view, alpha);
    const SlopePoint of_light(middle_of(arcs, mirrored), view, alpha);
    const double from_lobe = span_from(of_lobe, points, alpha);
    const double from_light = span_from(of_light, points, alpha);
    const double root = std::min(from_lobe, from_light) + 2.2;
    const double count = std::min<double>(std::ceil(root * root), kMaxGaussPoints);
    const Vec3d& axis = (from_light < from_lobe ? of_light : of_lobe).slope;
    const Vec3d across = perpendicular(axis);
    return {lobes, alpha, view.z, &gauss_rule(static_cast<int>(count)),
            glm::dmat3(across, glm::cross(axis, across), axis)};
}

}  // namespace

BoundaryIntegral boundary_integral(const LobeShape& shape, double cos_theta_o, std::span<const Arc<double>> arcs,
                                   double tolerance, double albedo) {
    if (!(cos_theta_o > 0)) {
        return {0, 0, 0};
    }
    if (const auto* toon = std::get_if<ToonShape>(&shape)) {
        return toon_boundary_integral(*toon, cos_theta_o, arcs, tolerance);
    }
    const Vec3d view = resolved_view(cos_theta_o);
    const RadialSums radial(shape, view.z, tolerance, albedo);
    const auto result = [&](const Vec3d& own_view, const glm::dvec2& alpha, std::span<const Arc<double>> own) {
        const auto boundary = integrate(radial, own_view, alpha, own);
        return BoundaryIntegral{boundary.sum()[0], boundary.error(),
                                boundary.points() * static_cast<int>(radial.points())};
    };
    if (!is_stretched(shape)) {
        return result(view, glm::dvec2(lobe_width(shape)), arcs);
    }
    const auto& ggx = std::get<GgxShape>(shape);
    const double c = std::cos(ggx.azimuth);
    const double s = std::sin(ggx.azimuth);
    std::vector<Arc<double>> own(arcs.begin(), arcs.end());
    for (Arc<double>& arc : own) {
        arc.axis = turned(arc.axis, c, s);
        arc.middle = turned(arc.middle, c, s);
    }
    return result(turned(view, c, s), {ggx.alpha, ggx.across}, own);
}

std::array<double, 3> boundary_integral_by_alpha(std::span<const WeightedLobe> lobes, double cos_theta_o,
                                                 std::span<const Arc<double>> arcs) {
    const auto varies = [](const WeightedLobe& lobe) { return std::holds_alternative<GgxShape>(lobe.shape); };
    if (arcs.empty() || std::none_of(lobes.begin(), lobes.end(), varies)) {
        return {};
    }
    const Vec3d view = resolved_view(cos_theta_o);
    const RadialSumsByAlpha radial(shortest_radii(lobes, view, arcs));
    return integrate(radial, view, glm::dvec2(lobe_width(lobes[0].shape)), arcs).sum();
}

}  // namespace shlight
