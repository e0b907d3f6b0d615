// SPDX-License-Identifier: MIT
//
// Adaptive cubature of several functions at once over the patches of a region.
//
// On each piece of a patch Gauss's product rules (around a whole cap: Gauss and trapezoids) grow along each side until
// two rules in a row agree; pieces on which the largest rules disagree are halved. The difference is the error of the
// smaller rule, and the larger one's value is used, so that the error estimate is pessimistic.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "kept_region.h"
#include "math/gauss_legendre.h"

namespace shlight::methods {

/// Limits of an adaptive sum, and the rule that it starts from.
struct CubaturePlan {
    double tolerance;   ///< absolute bound of the largest error among the sums
    double rounding;    ///< relative rounding error of the functions, below which no rule can go
    int smallest_side;  ///< side of the first product rule
    int largest_side;   ///< pieces that need more are halved; ≤ 64
    std::size_t work;   ///< number of evaluations after which the best sums so far are used
};

/// T: of the values and sums. Integrand: void operator()(const Vec3d& direction, T* values) const, `count` of them.
template <class T, class Integrand>
class AdaptiveCubature {
  public:
    AdaptiveCubature(const Integrand& integrand, std::size_t count, const CubaturePlan& plan)
        : integrand_(integrand), count_(count), plan_(plan), values_(count), spoke_sums_(count) {}

    /// Adds the integrals over the patches to the sums.
    void add(std::span<const Patch> patches, T* sums) {
        for (const Patch& patch : patches) {
            const double share = plan_.tolerance / static_cast<double>(patches.size());
            add(patch, {0, 1, 0, 1, first_rule(), first_rule(), share}, sums);
        }
    }
    std::size_t points() const { return points_; }

  private:
    static constexpr std::array kSides = {1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36, 48, 64};

    /// A rectangle of a patch's unit square, the rules along its sides as indices of kSides, and its tolerance.
    struct Piece {
        double u, u_length, v, v_length;
        std::size_t u_rule, v_rule;
        double tolerance;
    };
    using Sums = std::vector<T>;

    std::size_t first_rule() const {
        return static_cast<std::size_t>(std::lower_bound(kSides.begin(), kSides.end() - 2, plan_.smallest_side) -
                                        kSides.begin());
    }

    void add(const Patch& patch, Piece piece, T* sums);
    bool halve(const Patch& patch, const Piece& piece, bool across, T* sums);
    Sums rule(const Patch& patch, const Piece& piece, std::size_t u_rule, std::size_t v_rule);
    double difference(const Sums& a, const Sums& b) const;
    void take(const Sums& found, T* sums) const;

    const Integrand& integrand_;
    std::size_t count_;
    CubaturePlan plan_;
    std::size_t points_ = 0;
    Sums values_, spoke_sums_;
};

template <class T, class Integrand>
void AdaptiveCubature<T, Integrand>::add(const Patch& patch, Piece piece, T* sums) {
    Sums coarse = rule(patch, piece, piece.u_rule, piece.v_rule);
    for (;;) {
        const Sums fine = rule(patch, piece, piece.u_rule + 1, piece.v_rule + 1);
        T largest = 0;
        for (const T value : fine) {
            largest = std::max(largest, std::abs(value));
        }
        const double tolerance = std::max(piece.tolerance, plan_.rounding * static_cast<double>(largest));
        const double error = difference(coarse, fine);
        if (!(error > tolerance) || points_ >= plan_.work) {
            take(fine, sums);
            return;
        }
        Sums between = rule(patch, piece, piece.u_rule + 1, piece.v_rule);
        const bool raise_u = difference(coarse, between) > tolerance / 2;
        const bool raise_v = difference(between, fine) > tolerance / 2;
        if ((raise_u && kSides[piece.u_rule + 1] >= plan_.largest_side && halve(patch, piece, false, sums)) ||
            (raise_v && kSides[piece.v_rule + 1] >= plan_.largest_side && halve(patch, piece, true, sums))) {
            return;
        }
        const std::size_t last = kSides.size() - 2;
        if ((!raise_u || piece.u_rule == last) && (!raise_v || piece.v_rule == last)) {
            take(fine, sums);
            return;
        }
        piece.u_rule += raise_u && piece.u_rule < last ? 1 : 0;
        piece.v_rule += raise_v && piece.v_rule < last ? 1 : 0;
        coarse = raise_u && raise_v ? fine
                 : raise_u          ? std::move(between)
                                    : rule(patch, piece, piece.u_rule, piece.v_rule);
    }
}

/// across: whether v is halved, not u. Whole circles are not halved, nor pieces whose length is near rounding.
template <class T, class Integrand>
bool AdaptiveCubature<T, Integrand>::halve(const Patch& patch, const Piece& piece, bool across, T* sums) {
    constexpr double kShortest = 64 * std::numeric_limits<double>::epsilon();
    if ((across && patch.goes_around()) || (across ? piece.v_length : piece.u_length) < kShortest) {
        return false;
    }
    Piece half = piece;
    half.tolerance /= 2;
    half.u_rule = std::min(half.u_rule, first_rule() + 2);
    half.v_rule = std::min(half.v_rule, first_rule() + 2);
    (across ? half.v_length : half.u_length) /= 2;
    add(patch, half, sums);
    (across ? half.v : half.u) += across ? half.v_length : half.u_length;
    add(patch, half, sums);
    return true;
}

template <class T, class Integrand>
auto AdaptiveCubature<T, Integrand>::rule(const Patch& patch, const Piece& piece, std::size_t u_rule,
                                          std::size_t v_rule) -> Sums {
    const GaussRule& along = gauss_rule(kSides[u_rule]);
    const GaussRule& across = gauss_rule(kSides[v_rule]);
    // Trapezoids on the circle are as accurate as half as many Gauss points, and as cheap to place.
    const int turns = 2 * kSides[v_rule];
    const std::size_t spokes = patch.goes_around() ? static_cast<std::size_t>(turns) : across.nodes.size();
    Sums sums(count_, T(0));
    for (std::size_t j = 0; j < spokes; ++j) {
        const double place = patch.goes_around() ? (static_cast<double>(j) + 0.5) / turns : across.nodes[j];
        const double share = (patch.goes_around() ? 1.0 / turns : across.weights[j]) * piece.v_length * piece.u_length;
        const Spoke spoke = patch.spoke(piece.v + place * piece.v_length);
        if (spoke.turn == 0) {
            continue;
        }
        std::fill(spoke_sums_.begin(), spoke_sums_.end(), T(0));
        for (std::size_t i = 0; i < along.nodes.size(); ++i) {
            const WeightedDirection at = patch.at(spoke, piece.u + along.nodes[i] * piece.u_length);
            integrand_(at.direction, values_.data());
            const T weight = static_cast<T>(at.weight * along.weights[i]);
            for (std::size_t k = 0; k < count_; ++k) {
                spoke_sums_[k] += weight * values_[k];
            }
        }
        for (std::size_t k = 0; k < count_; ++k) {
            sums[k] += static_cast<T>(share) * spoke_sums_[k];
        }
    }
    points_ += spokes * along.nodes.size();
    return sums;
}

template <class T, class Integrand>
double AdaptiveCubature<T, Integrand>::difference(const Sums& a, const Sums& b) const {
    double largest = 0;
    for (std::size_t k = 0; k < count_; ++k) {
        largest = std::max(largest, static_cast<double>(std::abs(a[k] - b[k])));
    }
    return largest;
}

template <class T, class Integrand>
void AdaptiveCubature<T, Integrand>::take(const Sums& found, T* sums) const {
    for (std::size_t k = 0; k < count_; ++k) {
        sums[k] += found[k];
    }
}

}  // namespace shlight::methods
