// SPDX-License-Identifier: MIT
#include "regions/disk_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "math/gauss_legendre.h"
#include "regions/boundary_points.h"
#include "shlight/basis.h"

namespace shlight {
namespace {

/// Sines of the shorter half angle up to this are swept across it.
constexpr double kWidestStrip = 0.85;
/// And slivers above the horizon up to this height.
constexpr double kHighestSliver = 0.3;

/// Sums of the basis over weighted directions, some at a time.
template <class T>
class BasisSum {
    using Real = Wider<T>;

  public:
    explicit BasisSum(int order) : order_(order), sums_(static_cast<std::size_t>(coefficient_count(order))) {}

    void add(const Vec3<Real>& direction, Real weight) {
        directions_.push_back(Vec3<T>(direction));
        weights_.push_back(static_cast<double>(weight));
        solid_angle_ += weight;
        if (directions_.size() == kSome) {
            flush();
        }
    }

    void finish(T* coefficients) {
        flush();
        std::transform(sums_.begin(), sums_.end(), coefficients, [](double c) { return static_cast<T>(c); });
        coefficients[0] = static_cast<T>(solid_angle_ * std::sqrt(1 / (4 * std::numbers::pi_v<Real>)));
    }

  private:
    static constexpr std::size_t kSome = 64;

    void flush() {
        basis_.resize(directions_.size() * sums_.size());
        sh_basis(std::span<const Vec3<T>>(directions_), order_, std::span<T>(basis_));
        for (std::size_t i = 0; i < directions_.size(); ++i) {
            const T* row = basis_.data() + i * sums_.size();
            for (std::size_t k = 0; k < sums_.size(); ++k) {
                sums_[k] += weights_[i] * static_cast<double>(row[k]);
            }
        }
        directions_.clear();
        weights_.clear();
    }

    int order_;
    Real solid_angle_ = 0;
    std::vector<double> sums_;
    std::vector<Vec3<T>> directions_;
    std::vector<double> weights_;
    std::vector<T> basis_;
};

/// A meridian about a pole between two heights. Heights and longitudes have the density of the sphere (Archimedes).
template <class Real>
struct Line {
    Vec3<Real> equator;  ///< its point on the equator
    Real low, high;      ///< sines of latitudes
};

template <class T>
void add_line(const Line<Wider<T>>& line, const Vec3<Wider<T>>& pole, Wider<T> weight, const GaussRule& rule,
              BasisSum<T>& sum) {
    using Real = Wider<T>;
    const Real length = line.high - line.low;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const Real y = line.low + length * static_cast<Real>(rule.nodes[i]);
        sum.add(std::sqrt((1 - y) * (1 + y)) * line.equator + y * pole,
                weight * length * static_cast<Real>(rule.weights[i]));
    }
}

/// A strip: lines across the shorter half angle, about the short axis as the pole. The boundary is the same above and
/// below the equator; one side of each line may end at the horizon instead.
template <class T>
class Strip {
    using Real = Wider<T>;

  public:
    Strip(const SphericalEllipse<Real>& ellipse, int order)
        : ellipse_(ellipse),
          cone_(ellipse.cone()),
          points_(static_cast<double>(cone_.sin_long), static_cast<double>(cone_.complement)),
          degree_(order - 1),
          digits_(digits_for<T>(ellipse, order)),
          across_(gauss_rule(points_across(std::asin(static_cast<double>(cone_.sin_short)), degree_, digits_))),
          up_(cone_.short_axis.z < 0 ? Real(-1) : Real(1)) {}

    void sweep(BasisSum<T>& sum) const {
        const Real quarter = ellipse_.functions().quarter_period();
        if (!ellipse_.cut()) {
            // Period 2K.
            const Division division = points_.closed(static_cast<double>(quarter), 2 * degree_, 2 * digits_);
            const int count = (division.pieces * division.points + 1) / 2;
            const Real step = 2 * quarter / static_cast<Real>(count);
            for (int i = 0; i < count; ++i) {
                add(-quarter + step * (static_cast<Real>(i) + Real(0.5)), step, false, sum);
            }
            return;
        }
        Real first = folded(ellipse_.cut()->from);
        Real second = folded(ellipse_.cut()->to);
        if (first > second) {
            std::swap(first, second);
        }
        add_part(-quarter, first, sum);
        add_part(first, second, sum);
        add_part(second, quarter, sum);
    }

  private:
    /// Both ends of a line have the same sn: u in -K … K.
    Real folded(Real u) const {
        const Real quarter = ellipse_.functions().quarter_period();
        const Real rest = u - 4 * quarter * std::round(u / (4 * quarter));
        return rest > quarter ? 2 * quarter - rest : rest < -quarter ? -2 * quarter - rest : rest;
    }

    struct At {
        Line<Real> line;  ///< ends at the boundary
        Real speed;       ///< longitude per u
        Real horizon;     ///< the height at which the line meets the horizon; what is above is kept
    };
    At at(Real u) const {
        const auto f = ellipse_.functions().at(u);
        const Real x = cone_.sin_long * f.sn;
        const Real z = cone_.cos_short * f.dn;
        const Real radius = std::hypot(x, z);
        const Real high = cone_.sin_short * f.cn;
        // Upwards, as far as the short axis can tell.
        const Vec3<Real> equator = (x / radius) * cone_.long_axis + (z / radius) * cone_.axis;
        const Real slope = up_ * cone_.short_axis.z;
        const Real steepness = std::hypot(slope, equator.z);
        return {{equator, -high, high},
                cone_.sin_long * cone_.cos_short * f.cn / (radius * radius),
                steepness > 0 ? -equator.z / steepness : Real(0)};
    }

    void add_part(Real from, Real to, BasisSum<T>& sum) const {
        const Real half = (to - from) / 2;
        if (!(half > 0)) {
            return;
        }
        const At middle = at(from + half);
        if (middle.horizon >= middle.line.high) {
            return;
        }
        const bool cut = middle.horizon > middle.line.low;
        const auto h = static_cast<double>(half);
        // Poles of the longitude, where sn = i cot of the shorter half angle, and of the horizon's height.
        const auto sine = static_cast<double>(cone_.sin_short);
        const double pole = std::atan2(std::sqrt(1 - sine * sine), sine);
        const Division division = points_.open(h, degree_, digits_ + 2, cut ? std::min(pole, h * pole) : pole);
        const GaussRule& rule = gauss_rule(division.points);
        const Real piece = 2 * half / static_cast<Real>(division.pieces);
        for (int i = 0; i < division.pieces; ++i) {
            const Real start = from + piece * static_cast<Real>(i);
            for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
                add(start + piece * static_cast<Real>(rule.nodes[k]), piece * static_cast<Real>(rule.weights[k]), cut,
                    sum);
            }
        }
    }

    void add(Real u, Real weight, bool cut, BasisSum<T>& sum) const {
        At here = at(u);
        if (cut) {
            here.line.low = std::max(here.line.low, here.horizon);
        }
        if (here.line.high > here.line.low) {
            add_line<T>(here.line, up_ * cone_.short_axis, weight * here.speed, across_, sum);
        }
    }

    const SphericalEllipse<Real>& ellipse_;
    const Cone<Real>& cone_;
    BoundaryPoints points_;
    double degree_, digits_;
    const GaussRule& across_;
    Real up_;
};

/// A sliver above the horizon: vertical lines from there to the boundary, which is run through as it turns about z.
template <class T>
void sweep_sliver(const SphericalEllipse<Wider<T>>& ellipse, int order, BasisSum<T>& sum) {
    using Real = Wider<T>;
    const Cone<Real>& cone = ellipse.cone();
    const HorizonCut<Real>& cut = *ellipse.cut();
    const double degree = order - 1;
    const double digits = digits_for<T>(ellipse, order) + 2;
    const BoundaryPoints points(static_cast<double>(cone.sin_long), static_cast<double>(cone.complement));
    const Real half = (cut.to - cut.from) / 2;
    const Division division = points.open(static_cast<double>(half), degree, digits);
    const GaussRule& along = gauss_rule(division.points);
    const double height = std::min(1.5, 2 * std::asin(static_cast<double>(cut.highest.z)));
    const GaussRule& across = gauss_rule(points_across(height, degree, digits));
    const Real piece = 2 * half / static_cast<Real>(division.pieces);
    for (int i = 0; i < division.pieces; ++i) {
        for (std::size_t k = 0; k < along.nodes.size(); ++k) {
            const Real u = cut.from + piece * (static_cast<Real>(i) + static_cast<Real>(along.nodes[k]));
            const auto f = ellipse.functions().at(u);
            const Vec3<Real> at = ellipse.direction(u);
            const Real turn =
                cone.sin_long * cone.sin_short * f.dn * cone.axis.z -
                cone.sin_long * cone.cos_short * f.cn * cone.short_axis.z -
                cone.complement * cone.cos_long * cone.sin_short * f.sn * cone.long_axis.z;  // z of ω × dω/du
            const Real radius = std::hypot(at.x, at.y);
            const Line<Real> line = {{at.x / radius, at.y / radius, 0}, 0, at.z};
            // The interior is on the left, so over the top the boundary turns clockwise.
            const Real weight = -turn / (radius * radius) * piece * static_cast<Real>(along.weights[k]);
            add_line<T>(line, {0, 0, 1}, weight, across, sum);
        }
    }
}

template <class Real>
bool is_strip(const Cone<Real>& cone) {
    return cone.sin_short <= static_cast<Real>(kWidestStrip);
}

}  // namespace

template <class T>
void disk_by_sweep(const SphericalEllipse<Wider<T>>& ellipse, int order, T* coefficients) {
    BasisSum<T> sum(order);
    if (is_strip(ellipse.cone())) {
        Strip<T>(ellipse, order).sweep(sum);
    } else {
        sweep_sliver<T>(ellipse, order, sum);
    }
    sum.finish(coefficients);
}

template <class Real>
bool can_be_swept(const SphericalEllipse<Real>& ellipse) {
    return is_strip(ellipse.cone()) || (ellipse.cut() && ellipse.cut()->highest.z < static_cast<Real>(kHighestSliver));
}

template void disk_by_sweep(const SphericalEllipse<double>&, int, float*);
template void disk_by_sweep(const SphericalEllipse<long double>&, int, double*);
template bool can_be_swept(const SphericalEllipse<double>&);
template bool can_be_swept(const SphericalEllipse<long double>&);

}  // namespace shlight
