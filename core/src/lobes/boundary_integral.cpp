// SPDX-License-Identifier: MIT
#include "lobes/boundary_integral.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lobes/boundary_kernel.h"
#include "math/gauss_legendre.h"

namespace shlight {
namespace {

/// Kronrod's extension of the Gauss rule of 7 points to 15 on (-1, 1): nodes ≥ 0 and both sets of weights, the Gauss
/// nodes being every other one (Piessens et al. 1983, QUADPACK).
constexpr std::array<double, 8> kNodes = {0.0,
                                          0.207784955007898467600689403773245,
                                          0.405845151377397166906606412076961,
                                          0.586087235467691130294144691693013,
                                          0.741531185599394439863864773280788,
                                          0.864864423359769072789712788640926,
                                          0.949107912342758524526189684047851,
                                          0.991455371120812639206854697526329};
constexpr std::array<double, 8> kKronrod = {0.209482141084727828012999174891714, 0.204432940075298892414161999234649,
                                            0.190350578064785409913256402421014, 0.169004726639267902826583426598550,
                                            0.140653259715525918745189590510238, 0.104790010322250183839876322541518,
                                            0.063092092629978553290700663189204, 0.022935322010529224963732008058970};
constexpr std::array<double, 4> kGauss = {0.417959183673469387755102040816327, 0.381830050505118944950369775488975,
                                          0.279705391489276667901467771423780, 0.129484966168869693270611432679082};

/// Pieces of the boundary that may be waiting or done; past that the estimate stands as it is.
constexpr int kMostPieces = 96;

/// Floats suffice for tolerances, over the albedo, from this one on.
constexpr double kLeastTolerance32 = 1e-6;

/// A lower view mirrors itself in the horizon so closely that half vectors there lose their digits; what it sees
/// differs by less than 1e-6 ÷ the lobe's width.
constexpr double kLeastViewCosine = 1e-6;

/// Speed of a boost after which another sweep would change the parameter of a boundary by little.
constexpr double kEvenEnough = 0.05;

/// A lobe of a smaller albedo gets all of it from the rise towards grazing angles, which varies fast: the rule along a
/// radius then errs by a share of this one.
constexpr double kLeastAlbedo = 0.02;

/// Number of points along a radius; the factors of the slope distribution vary slowly, but a table may hold anything.
/// tolerance: ÷ albedo.
int points_for(const LobeShape& shape, double tolerance) {
    return std::holds_alternative<TableShape>(shape) ? 24
           : tolerance > 4e-3                        ? 4
           : tolerance > 2e-4                        ? 6
           : tolerance > 1e-5                        ? 12
                                                     : 24;
}

/// Half vectors along a circle, up to their length: middle + cosine cos τ + sine sin τ. Any parameter that is a Möbius
/// map of the angle has this form; one of them makes the three columns orthogonal in (h_x/α, h_y/α, h_z), in which the
/// slope distribution is round. The curve there is an ellipse's cone. If it is long and narrow, as for a circle much
/// larger than the lobe, τ passes the lobe in a very short interval at ±π/2; t with (cos τ, sin τ) ~ (f cos t, sin t)
/// does not.
class Path {
  public:
    Path(const Arc<double>& arc, const Vec3d& view, double alpha) : closed_(arc.half >= std::numbers::pi) {
        const Vec3d u = arc.sine * arc.middle;
        even_out(arc.cosine * arc.axis + view, u, glm::cross(arc.axis, u), alpha);
        const Vec3d scale(1 / alpha, 1 / alpha, 1);
        path_ = {columns_[0] * scale, columns_[1] * scale, columns_[2] * scale, flatness_};
        if (!is_closed()) {
            const double c = std::cos(arc.half);
            const double s = std::sin(arc.half);
            start_ = parameter(c, -s);
            length_ = parameter(c, s) - start_;
            length_ += length_ < 0 ? 2 * std::numbers::pi : 0;
        }
    }

    bool is_closed() const { return closed_; }
    double start() const { return start_; }
    double length() const { return length_; }

    /// The path as the kernel reads it.
    const BoundaryPath& columns() const { return path_; }

  private:
    using Triple = std::array<double, 3>;

    /// The vectors (1, cos τ, sin τ) are null vectors of the metric (+, -, -), and so are their images under its boosts
    /// and turns. Like Jacobi's rotations, those are found that make the squared length in (h_x/α, h_y/α, h_z), a
    /// quadratic form of them, diagonal. A few sweeps suffice, as the parameter need not be the best.
    void even_out(const Vec3d& middle, const Vec3d& u, const Vec3d& v, double alpha) {
        columns_ = {middle, u, v};
        const auto form = [&](int i, int j) {
            const Vec3d& a = columns_[i];
            const Vec3d& b = columns_[j];
            return (a.x * b.x + a.y * b.y) / (alpha * alpha) + a.z * b.z;
        };
        double largest = 1;
        for (int sweep = 0; sweep < 4 && largest > kEvenEnough; ++sweep) {
            largest = 0;
            for (int axis = 1; axis <= 2; ++axis) {
                const double ratio = -2 * form(0, axis) / (form(0, 0) + form(axis, axis));
                boost_by_half(axis, std::clamp(ratio, -1 + 1e-14, 1 - 1e-14));
                largest = std::max(largest, std::abs(ratio));
            }
            turn_by_half(form(1, 1) - form(2, 2), 2 * form(1, 2));
        }
        if (form(2, 2) > form(1, 1)) {
            turn(0, 1);
        }
        flatness_ = std::min(1.0, std::sqrt((form(0, 0) + form(2, 2)) / form(1, 1)));
    }

    /// A boost of columns 0 and `axis` by half the rapidity atanh(speed).
    void boost_by_half(int axis, double speed) {
        const double whole = 1 / std::sqrt((1 - speed) * (1 + speed));  // cosh of the rapidity
        const double c = std::sqrt((whole + 1) / 2);
        const double s = speed * whole / (2 * c);
        mix(0, axis, c, s, s, c);
    }
    /// A turn of columns 1 and 2 by half the angle of the point (x, y).
    void turn_by_half(double x, double y) {
        const double length = std::hypot(x, y);
        const double c = std::sqrt((length + std::abs(x)) / 2);
        if (c > 0) {
            const double other = y / (2 * c);
            const double unit = 1 / std::sqrt(length);
            x >= 0 ? turn(c * unit, other * unit) : turn(std::abs(other) * unit, std::copysign(c, y) * unit);
        }
    }
    void turn(double c, double s) { mix(1, 2, c, s, -s, c); }
    /// New columns i and j: (ii, ij) and (ji, jj) times the old ones.
    void mix(int i, int j, double ii, double ij, double ji, double jj) {
        const auto apply = [&](auto& list) {
            const auto first = ii * list[i] + ij * list[j];
            list[j] = ji * list[i] + jj * list[j];
            list[i] = first;
        };
        apply(columns_);
        for (Triple& row : frame_) {
            apply(row);
        }
    }

    /// t of the point at (cos, sin) of the circle's own angle.
    double parameter(double cosine, double sine) const {
        const auto component = [&](int column) {
            return frame_[1][column] * cosine + frame_[2][column] * sine - frame_[0][column];
        };
        return std::atan2(component(2), component(1) / flatness_);
    }

    std::array<Vec3d, 3> columns_;
    std::array<Triple, 3> frame_ = {Triple{1, 0, 0}, Triple{0, 1, 0}, Triple{0, 0, 1}};
    double flatness_ = 1;
    bool closed_;
    double start_ = 0;
    double length_ = 2 * std::numbers::pi;
    BoundaryPath path_{};
};

/// The boundary of one region, piece by piece.
class Boundary {
  public:
    Boundary(const LobeShape& shape, double cos_theta_o, double tolerance, double albedo)
        : slope_ndf_{shape, cos_theta_o, &gauss_rule(points_for(shape, tolerance / std::max(albedo, kLeastAlbedo)))},
          tolerance_(tolerance),
          f32_(tolerance >= kLeastTolerance32 * albedo) {}

    /// share: part of the tolerance.
    void add(const Arc<double>& arc, const Vec3d& view, double alpha, double share) {
        const Path& path = paths_.emplace_back(arc, view, alpha);
        if (path.is_closed() && add_circle(path, share * tolerance_)) {
            return;
        }
        const int parts = std::max(1, static_cast<int>(std::ceil(path.length() / std::numbers::pi - 1e-9)));
        const double part = path.length() / parts;
        for (int k = 0; k < parts; ++k) {
            add_piece(paths_.size() - 1, path.start() + k * part, path.start() + (k + 1) * part);
        }
    }

    /// Halves the worst pieces until the estimate meets the tolerance.
    void refine() {
        while (sum_.error > tolerance_ && !pieces_.empty() && pieces_.size() < kMostPieces) {
            const auto worst = std::max_element(pieces_.begin(), pieces_.end(),
                                                [](const Piece& a, const Piece& b) { return a.error < b.error; });
            const Piece halved = *worst;
            pieces_.erase(worst);
            sum_.value -= halved.value;
            sum_.error -= halved.error;
            add_piece(halved.path, halved.middle - halved.half, halved.middle);
            add_piece(halved.path, halved.middle, halved.middle + halved.half);
        }
    }

    const BoundaryIntegral& sum() const { return sum_; }

  private:
    struct Piece {
        std::size_t path;
        double middle, half;
        double value, error;
    };

    void densities(const Path& path, std::span<const double> parameters, std::span<double> values) {
        sum_.points += static_cast<int>(slope_ndf_.rule->nodes.size() * parameters.size());
        boundary_densities(slope_ndf_, path.columns(), f32_, parameters, values);
    }

    /// The difference of two rules is the error of the coarser one; that of the finer one is about its power 3/2
    /// (QUADPACK).
    static double error_estimate(double difference) {
        return std::min(difference, std::pow(200 * difference, 1.5) / 200);
    }

    /// A whole circle by the trapezoidal rule, which converges exponentially. False, with nothing added, if it does
    /// not.
    bool add_circle(const Path& path, double tolerance) {
        constexpr std::size_t kLast = 64;
        double total = 0;
        double before = 0;
        // First the points of two rules at once, then those between the points of the rule before.
        for (std::size_t count = kBoundaryPoints; count <= kLast; count *= 2) {
            const double step = 2 * std::numbers::pi / static_cast<double>(count);
            const bool first = count == kBoundaryPoints;
            double even = 0;
            double sum = 0;
            std::array<double, kBoundaryPoints> parameters, values;
            for (std::size_t i = 0; i < (first ? count : count / 2); i += kBoundaryPoints) {
                for (std::size_t k = 0; k < kBoundaryPoints; ++k) {
                    parameters[k] = step * static_cast<double>(first ? k : 2 * (i + k) + 1);
                }
                densities(path, parameters, values);
                for (std::size_t k = 0; k < kBoundaryPoints; ++k) {
                    sum += values[k];
                    even += k % 2 == 0 ? values[k] : 0.0;
                }
            }
            before = first ? 2 * step * even : before;
            total += sum;
            const double value = total * step;
            const double error = error_estimate(std::abs(value - before));
            if (error <= tolerance) {
                sum_.value += value;
                sum_.error += error;
                return true;
            }
            before = value;
        }
        return false;
    }

    void add_piece(std::size_t path, double from, double to) {
        Piece piece{path, (from + to) / 2, (to - from) / 2, 0, 0};
        double kronrod = 0;
        double gauss = 0;
        std::array<double, 2 * kNodes.size() - 1> parameters, values;
        for (std::size_t i = 0; i < kNodes.size(); ++i) {
            parameters[kNodes.size() - 1 + i] = piece.middle + kNodes[i] * piece.half;
            parameters[kNodes.size() - 1 - i] = piece.middle - kNodes[i] * piece.half;
        }
        densities(paths_[path], parameters, values);
        for (std::size_t i = 0; i < kNodes.size(); ++i) {
            double pair = values[kNodes.size() - 1 + i];
            if (i > 0) {
                pair += values[kNodes.size() - 1 - i];
            }
            kronrod += kKronrod[i] * pair;
            gauss += i % 2 == 0 ? kGauss[i / 2] * pair : 0.0;
        }
        piece.value = piece.half * kronrod;
        piece.error = error_estimate(std::abs(piece.half * (kronrod - gauss)));
        sum_.value += piece.value;
        sum_.error += piece.error;
        pieces_.push_back(piece);
    }

    SlopeNdf slope_ndf_;
    double tolerance_;
    bool f32_;  // whether floats will do
    std::vector<Path> paths_;
    std::vector<Piece> pieces_;
    BoundaryIntegral sum_{0, 0, 0};
};

}  // namespace

BoundaryIntegral boundary_integral(const LobeShape& shape, double cos_theta_o, std::span<const Arc<double>> arcs,
                                   double tolerance, double albedo) {
    if (!(cos_theta_o > 0)) {
        return {0, 0, 0};
    }
    const double cosine = std::max(cos_theta_o, kLeastViewCosine);
    const Vec3d view(std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine);
    Boundary boundary(shape, cosine, tolerance, albedo);
    for (const Arc<double>& arc : arcs) {
        boundary.add(arc, view, lobe_width(shape), 1.0 / static_cast<double>(arcs.size()));
    }
    boundary.refine();
    return boundary.sum();
}

}  // namespace shlight
