// SPDX-License-Identifier: MIT
//
// Adaptive integrals along the arcs of a boundary, of one number or of several at once.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "lobes/boundary_kernel.h"
#include "lobes/boundary_path.h"

namespace shlight {

/// Kronrod's extension of the Gauss rule of 7 points to 15 on (-1, 1): nodes ≥ 0 and both sets of weights, the Gauss
/// nodes being every other one (Piessens et al. 1983, QUADPACK).
inline constexpr std::array<double, 8> kKronrodNodes = {0.0,
                                                        0.207784955007898467600689403773245,
                                                        0.405845151377397166906606412076961,
                                                        0.586087235467691130294144691693013,
                                                        0.741531185599394439863864773280788,
                                                        0.864864423359769072789712788640926,
                                                        0.949107912342758524526189684047851,
                                                        0.991455371120812639206854697526329};
inline constexpr std::array<double, 8> kKronrodWeights = {
    0.209482141084727828012999174891714, 0.204432940075298892414161999234649, 0.190350578064785409913256402421014,
    0.169004726639267902826583426598550, 0.140653259715525918745189590510238, 0.104790010322250183839876322541518,
    0.063092092629978553290700663189204, 0.022935322010529224963732008058970};
inline constexpr std::array<double, 4> kKronrodGauss = {
    0.417959183673469387755102040816327, 0.381830050505118944950369775488975, 0.279705391489276667901467771423780,
    0.129484966168869693270611432679082};

/// Pieces of the boundary that may be waiting or done; past that the estimate stands as it is.
inline constexpr int kMostPieces = 96;

/// Rule has
///   Values                                          std::array<double, N> of what is integrated
///   densities(path, parameters, values)             of up to kBoundaryPoints parameters
///   scale(sum)                                      of Values: a unit in which errors are small numbers
///   size(values)                                    of an error, as a number
///   tolerance(sum)                                  permitted size of the error of a sum
template <class Rule>
class BoundaryQuadrature {
  public:
    using Values = typename Rule::Values;

    explicit BoundaryQuadrature(Rule rule) : rule_(std::move(rule)) {}

    /// share: part of the tolerance.
    void add(const ArcPath& path_of_arc, double share) {
        const ArcPath& path = paths_.emplace_back(path_of_arc);
        if (path.is_closed() && add_circle(path, share)) {
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
        while (error_ > rule_.tolerance(sum_) && !pieces_.empty() && pieces_.size() < kMostPieces) {
            const auto worst = std::max_element(pieces_.begin(), pieces_.end(),
                                                [](const Piece& a, const Piece& b) { return a.error < b.error; });
            const Piece halved = *worst;
            pieces_.erase(worst);
            sum_ = plus(sum_, -1, halved.value);
            error_ -= halved.error;
            add_piece(halved.path, halved.middle - halved.half, halved.middle);
            add_piece(halved.path, halved.middle, halved.middle + halved.half);
        }
    }

    const Values& sum() const { return sum_; }
    double error() const { return error_; }
    /// Values of the densities that it took.
    int points() const { return points_; }

  private:
    struct Piece {
        std::size_t path;
        double middle, half;
        Values value;
        double error;
    };

    /// a + factor b.
    static Values plus(Values a, double factor, const Values& b) {
        for (std::size_t k = 0; k < a.size(); ++k) {
            a[k] += factor * b[k];
        }
        return a;
    }
    static Values times(double factor, const Values& values) { return plus({}, factor, values); }

    void densities(const ArcPath& path, std::span<const double> parameters, std::span<Values> values) {
        points_ += static_cast<int>(parameters.size());
        rule_.densities(path, parameters, values);
    }

    /// The difference of two rules is the error of the coarser one; that of the finer one is about its power 3/2
    /// (QUADPACK).
    double error_estimate(const Values& finer, const Values& coarser) const {
        const double scale = rule_.scale(finer);
        const double difference = rule_.size(plus(finer, -1, coarser)) / scale;
        return scale * difference * std::min(1.0, std::sqrt(200 * difference));
    }

    /// A whole circle by the trapezoidal rule, which converges exponentially. False, with nothing added, if it does
    /// not.
    bool add_circle(const ArcPath& path, double share) {
        constexpr std::size_t kLast = 64;
        Values total{};
        Values before{};
        // First the points of two rules at once, then those between the points of the rule before.
        for (std::size_t count = kBoundaryPoints; count <= kLast; count *= 2) {
            const double step = 2 * std::numbers::pi / static_cast<double>(count);
            const bool first = count == kBoundaryPoints;
            Values even{};
            Values sum{};
            std::array<double, kBoundaryPoints> parameters;
            std::array<Values, kBoundaryPoints> values;
            for (std::size_t i = 0; i < (first ? count : count / 2); i += kBoundaryPoints) {
                for (std::size_t k = 0; k < kBoundaryPoints; ++k) {
                    parameters[k] = step * static_cast<double>(first ? k : 2 * (i + k) + 1);
                }
                densities(path, parameters, values);
                for (std::size_t k = 0; k < kBoundaryPoints; ++k) {
                    sum = plus(sum, 1, values[k]);
                    even = k % 2 == 0 ? plus(even, 1, values[k]) : even;
                }
            }
            before = first ? times(2 * step, even) : before;
            total = plus(total, 1, sum);
            const Values value = times(step, total);
            const double error = error_estimate(value, before);
            if (error <= share * rule_.tolerance(value)) {
                sum_ = plus(sum_, 1, value);
                error_ += error;
                return true;
            }
            before = value;
        }
        return false;
    }

    void add_piece(std::size_t path, double from, double to) {
        Piece piece{path, (from + to) / 2, (to - from) / 2, {}, 0};
        Values gauss{};
        constexpr std::size_t kHalf = kKronrodNodes.size() - 1;
        std::array<double, 2 * kHalf + 1> parameters;
        std::array<Values, 2 * kHalf + 1> values;
        for (std::size_t i = 0; i <= kHalf; ++i) {
            parameters[kHalf + i] = piece.middle + kKronrodNodes[i] * piece.half;
            parameters[kHalf - i] = piece.middle - kKronrodNodes[i] * piece.half;
        }
        densities(paths_[path], parameters, values);
        for (std::size_t i = 0; i <= kHalf; ++i) {
            const Values pair = i > 0 ? plus(values[kHalf + i], 1, values[kHalf - i]) : values[kHalf];
            piece.value = plus(piece.value, kKronrodWeights[i], pair);
            gauss = i % 2 == 0 ? plus(gauss, kKronrodGauss[i / 2], pair) : gauss;
        }
        piece.value = times(piece.half, piece.value);
        piece.error = error_estimate(piece.value, times(piece.half, gauss));
        sum_ = plus(sum_, 1, piece.value);
        error_ += piece.error;
        pieces_.push_back(piece);
    }

    Rule rule_;
    std::vector<ArcPath> paths_;
    std::vector<Piece> pieces_;
    Values sum_{};
    double error_ = 0;
    int points_ = 0;
};

}  // namespace shlight
