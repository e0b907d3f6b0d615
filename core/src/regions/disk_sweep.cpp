// SPDX-License-Identifier: MIT
#include "regions/disk_sweep.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/gauss_legendre.h"
#include "regions/boundary_points.h"
#include "shlight/basis.h"

namespace shlight {
namespace {

/// Sines of the shorter half angle up to this are swept across it.
constexpr double kWidestStrip = 0.85;
/// And slivers above the horizon up to this height.
constexpr double kHighestSliver = 0.3;

/// Weighted directions, over which the basis is summed.
class Cubature {
  public:
    /// A meridian about a pole from a height downwards by `length`; equator: its point on the equator. Heights and
    /// longitudes have the density of the sphere (Archimedes).
    void add_line(const Vec3d& equator, const Vec3d& pole, double high, double length, double weight,
                  const GaussRule& rule) {
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double y = high - length * rule.nodes[i];
            directions_.push_back(std::sqrt((1 - y) * (1 + y)) * equator + y * pole);
            weights_.push_back(weight * length * rule.weights[i]);
        }
    }

    std::vector<double> coefficients(int order) const {
        constexpr std::size_t kAtOnce = 64;
        const auto row = static_cast<std::size_t>(coefficient_count(order));
        std::vector<double> sums(row), basis(kAtOnce * row);
        for (std::size_t first = 0; first < directions_.size(); first += kAtOnce) {
            const auto some = std::span(directions_).subspan(first, std::min(kAtOnce, directions_.size() - first));
            sh_basis(some, order, std::span(basis).first(some.size() * row));
            for (std::size_t i = 0; i < some.size(); ++i) {
                for (std::size_t k = 0; k < row; ++k) {
                    sums[k] += weights_[first + i] * basis[i * row + k];
                }
            }
        }
        return sums;
    }

  private:
    std::vector<Vec3d> directions_;
    std::vector<double> weights_;
};

/// A strip: lines across the shorter half angle, about the short axis as the pole. The boundary is the same above and
/// below the equator; one side of each line may end at the horizon instead.
class Strip {
  public:
    Strip(const SphericalEllipse& ellipse, int order, double epsilon)
        : ellipse_(ellipse),
          cone_(ellipse.cone()),
          points_(cone_.sin_long, cone_.complement),
          degree_(order - 1),
          digits_(digits_for(ellipse, order, epsilon)),
          across_(gauss_rule(points_across(std::asin(cone_.sin_short), degree_, digits_))),
          up_(cone_.short_axis.z < 0 ? -1 : 1) {}

    void sweep(Cubature& cubature) const {
        const double quarter = ellipse_.functions().quarter_period();
        if (!ellipse_.cut()) {
            // Period 2K.
            const Division division = points_.closed(quarter, 2 * degree_, 2 * digits_);
            const int count = (division.pieces * division.points + 1) / 2;
            const double step = 2 * quarter / count;
            for (int i = 0; i < count; ++i) {
                add(-quarter + step * (i + 0.5), step, cubature);
            }
            return;
        }
        const auto [first, second] = std::minmax({folded(ellipse_.cut()->from), folded(ellipse_.cut()->to)});
        add_part(-quarter, first, cubature);
        add_part(first, second, cubature);
        add_part(second, quarter, cubature);
    }

  private:
    /// Both ends of a line have the same sn: u in -K … K.
    double folded(double u) const {
        const double quarter = ellipse_.functions().quarter_period();
        const double rest = std::remainder(u, 4 * quarter);
        return rest > quarter ? 2 * quarter - rest : rest < -quarter ? -2 * quarter - rest : rest;
    }

    /// The line at u, whose ends are at ± `half`.
    struct Line {
        Vec3d equator;
        double half;
        double speed;  ///< longitude per u
        double kept;   ///< length above the horizon, from the upper end on
    };
    Line at(double u) const {
        auto f = ellipse_.functions().at(u);
        const double x = cone_.sin_long * f.sn;
        const double z = cone_.cos_short * f.dn;
        const double radius = std::hypot(x, z);
        // Upwards, as far as the short axis can tell.
        const Vec3d equator = (x / radius) * cone_.long_axis + (z / radius) * cone_.axis;
        Line line{equator, cone_.sin_short * f.cn, cone_.sin_long * cone_.cos_short * f.cn / (radius * radius), 0};
        line.kept = 2 * line.half;
        if (ellipse_.cut()) {
            // The length follows from the upper end's height: the difference of two heights says nothing of a low
            // sliver.
            f.cn *= up_;
            const double sine = ellipse_.height(f) / std::hypot(cone_.short_axis.z, equator.z);
            const double turn = std::asin(std::clamp(sine, 0.0, 1.0));
            line.kept = std::min(line.kept, 2 * std::cos(std::asin(line.half) - turn / 2) * std::sin(turn / 2));
        }
        return line;
    }

    void add_part(double from, double to, Cubature& cubature) const {
        const double half = (to - from) / 2;
        if (!(half > 0)) {
            return;
        }
        const Line middle = at(from + half);
        if (!(middle.kept > 0)) {
            return;
        }
        const bool cut = middle.kept < 2 * middle.half;
        // Poles of the longitude, where sn = i cot of the shorter half angle, and of the horizon's height.
        const double pole = std::atan2(std::sqrt(1 - cone_.sin_short * cone_.sin_short), cone_.sin_short);
        const Division division = points_.open(half, degree_, digits_ + 2, cut ? std::min(pole, half * pole) : pole);
        const GaussRule& rule = gauss_rule(division.points);
        const double piece = 2 * half / division.pieces;
        for (int i = 0; i < division.pieces; ++i) {
            for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
                add(from + piece * (i + rule.nodes[k]), piece * rule.weights[k], cubature);
            }
        }
    }

    void add(double u, double weight, Cubature& cubature) const {
        const Line line = at(u);
        cubature.add_line(line.equator, up_ * cone_.short_axis, line.half, line.kept, weight * line.speed, across_);
    }

    const SphericalEllipse& ellipse_;
    const Cone& cone_;
    BoundaryPoints points_;
    double degree_, digits_;
    const GaussRule& across_;
    double up_;
};

/// A sliver above the horizon: vertical lines from there to the boundary, which is run through as it turns about z.
void sweep_sliver(const SphericalEllipse& ellipse, int order, double epsilon, Cubature& cubature) {
    const Cone& cone = ellipse.cone();
    const HorizonCut& cut = *ellipse.cut();
    const double degree = order - 1;
    const double digits = digits_for(ellipse, order, epsilon) + 2;
    const double half = (cut.to - cut.from) / 2;
    const Division division = BoundaryPoints(cone.sin_long, cone.complement).open(half, degree, digits);
    const GaussRule& along = gauss_rule(division.points);
    const GaussRule& across = gauss_rule(points_across(std::min(1.5, 2 * std::asin(cut.highest.z)), degree, digits));
    const double piece = 2 * half / division.pieces;
    for (int i = 0; i < division.pieces; ++i) {
        for (std::size_t k = 0; k < along.nodes.size(); ++k) {
            const double u = cut.from + piece * (i + along.nodes[k]);
            const auto f = ellipse.functions().at(u);
            const Vec3d at = ellipse.direction(u);
            const double turn =
                cone.sin_long * cone.sin_short * f.dn * cone.axis.z -
                cone.sin_long * cone.cos_short * f.cn * cone.short_axis.z -
                cone.complement * cone.cos_long * cone.sin_short * f.sn * cone.long_axis.z;  // z of ω × dω/du
            const double radius = std::hypot(at.x, at.y);
            const double height = ellipse.height(f);
            // The interior is on the left, so over the top the boundary turns clockwise.
            const double weight = -turn / (radius * radius) * piece * along.weights[k];
            cubature.add_line({at.x / radius, at.y / radius, 0}, {0, 0, 1}, height, height, weight, across);
        }
    }
}

bool is_strip(const Cone& cone) {
    return cone.sin_short <= kWidestStrip;
}

}  // namespace

std::vector<double> disk_by_sweep(const SphericalEllipse& ellipse, int order, double epsilon) {
    Cubature cubature;
    if (is_strip(ellipse.cone())) {
        Strip(ellipse, order, epsilon).sweep(cubature);
    } else {
        sweep_sliver(ellipse, order, epsilon, cubature);
    }
    return cubature.coefficients(order);
}

bool can_be_swept(const SphericalEllipse& ellipse) {
    return is_strip(ellipse.cone()) || (ellipse.cut() && ellipse.cut()->highest.z < kHighestSliver);
}

}  // namespace shlight
