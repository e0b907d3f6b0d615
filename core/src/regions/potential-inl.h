// SPDX-License-Identifier: MIT
//
// A lobe's potential along arcs, in lanes: its normal derivative at points, and along the horizon (docs/theory.md, 4.3
// and 4.4). Included once per instruction set.
#if defined(SHLIGHT_KERNELS_POTENTIAL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_POTENTIAL_INL_H_
#undef SHLIGHT_KERNELS_POTENTIAL_INL_H_
#else
#define SHLIGHT_KERNELS_POTENTIAL_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "regions/arc_lanes-inl.h"
#include "regions/boundary_constants.h"
#include "shlight/types.h"
#include "simd/lanes-inl.h"
#include "simd/lobe_arrays.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

template <class R>
struct SeriesPair {
    V<Lanes<R>> down, same;
};

/// The two series of each degree for a vector of lobes.
template <class R>
class PotentialSeries {
    using D = Lanes<R>;

  public:
    explicit PotentialSeries(int order)
        : order_(static_cast<std::size_t>(order)), constants_(PotentialConstants::of(order)) {
        rise_.assign(constants_.rise.begin(), constants_.rise.end());
        down_.resize(rise_.size() * kWidth);
        same_.resize(rise_.size() * kWidth);
    }

    std::size_t order() const { return order_; }

    /// rows: each lane's terms, readable up to the next multiple of four.
    void set(const RowPointers<const float>& rows) {
        const D d;
        load_terms(rows);
        for (std::size_t i = 0; i < rise_.size(); ++i) {
            const R* f = terms_.data() + constants_.term[i] * kWidth;
            hn::StoreU(hn::Mul(hn::LoadU(d, f - kWidth), all(d, constants_.down[i])), d, down_.data() + i * kWidth);
            hn::StoreU(hn::Mul(hn::LoadU(d, f), all(d, constants_.same[i])), d, same_.data() + i * kWidth);
        }
    }

    HWY_INLINE SeriesPair<R> coefficients(std::size_t i) const {
        return {hn::LoadU(D(), down_.data() + i * kWidth), hn::LoadU(D(), same_.data() + i * kWidth)};
    }
    /// The factors of b_{l+1} in Clenshaw's recurrence at heights.
    template <std::size_t kPoints>
    HWY_INLINE std::array<V<D>, kPoints> slopes(std::size_t i, const std::array<V<D>, kPoints>& z) const {
        const auto rise = hn::Set(D(), rise_[i]);
        std::array<V<D>, kPoints> slopes;
        for (std::size_t k = 0; k < kPoints; ++k) {
            slopes[k] = hn::Mul(rise, z[k]);
        }
        return slopes;
    }

  private:
    static constexpr std::size_t kWidth = kLaneCount<D>;

    void load_terms(const RowPointers<const float>& rows) {
        const auto count = static_cast<std::size_t>(cosine_count(static_cast<int>(order_)));
        terms_.resize((count + 3) / 4 * 4 * kWidth);
        const hn::Rebind<float, D> of_float;
        if constexpr (hn::MaxLanes(of_float) < kSquare<decltype(of_float)>) {
            for (std::size_t i = 0; i < count * kWidth; ++i) {
                terms_[i] = static_cast<R>(rows[i % kWidth][i / kWidth]);
            }
        } else {
            for (std::size_t c = 0; c < count; c += kSquare<decltype(of_float)>) {
                const auto columns = load_columns(of_float, rows.data(), c);
                for (std::size_t j = 0; j < columns.size(); ++j) {
                    R* column = terms_.data() + (c + j) * kWidth;
                    if constexpr (std::is_same_v<R, float>) {
                        hn::StoreU(columns[j], of_float, column);
                    } else {
                        hn::StoreU(hn::PromoteTo(D(), columns[j]), D(), column);
                    }
                }
            }
        }
    }

    std::size_t order_;
    const PotentialConstants& constants_;
    std::vector<R> rise_, down_, same_, terms_;
};

/// before: b_{l+2}, becomes b_l.
template <class R, std::size_t kPoints>
HWY_INLINE void clenshaw_step(const PotentialSeries<R>& series, std::size_t i,
                              const std::array<V<Lanes<R>>, kPoints>& z, const std::array<SeriesPair<R>, kPoints>& b,
                              std::array<SeriesPair<R>, kPoints>& before) {
    const auto c = series.coefficients(i);
    const auto slopes = series.slopes(i, z);
    for (std::size_t k = 0; k < kPoints; ++k) {
        before[k].down = hn::MulAdd(slopes[k], b[k].down, hn::Sub(c.down, before[k].down));
        before[k].same = hn::MulAdd(slopes[k], b[k].same, hn::Sub(c.same, before[k].same));
    }
}

/// D_m and S_m at kPoints heights, by Clenshaw's recurrence b_l = c_l + slope b_{l+1} - b_{l+2}.
/// first: where degree m begins; count: its terms.
template <class R, std::size_t kPoints>
HWY_INLINE std::array<SeriesPair<R>, kPoints> clenshaw_sums(const PotentialSeries<R>& series, std::size_t first,
                                                            std::size_t count,
                                                            const std::array<V<Lanes<R>>, kPoints>& z) {
    const Lanes<R> d;
    std::array<SeriesPair<R>, kPoints> b;
    std::array<SeriesPair<R>, kPoints> other;
    for (std::size_t k = 0; k < kPoints; ++k) {
        b[k] = series.coefficients(first);
        other[k] = {hn::Zero(d), hn::Zero(d)};
    }
    std::size_t i = first + 1;
    const std::size_t end = first + count;
    for (; i + 1 < end; i += 2) {
        clenshaw_step<R>(series, i, z, b, other);
        clenshaw_step<R>(series, i + 1, z, other, b);
    }
    if (i < end) {
        clenshaw_step<R>(series, i, z, b, other);
        return other;
    }
    return b;
}

/// ν·∇F ds at points, ÷ weight · 2 half.
///
/// With ζ = x+iy both Re ζ^k and Re (ν_x + iν_y) ζ^k follow g_{k+1} = 2x g_k - |ζ|² g_{k-1}, so the sums over m are
/// Clenshaw's, too: four multiply-adds for each m, where Horner's rule for complex numbers takes seven.
template <class R, std::size_t kPoints>
HWY_INLINE std::array<V<Lanes<R>>, kPoints> normal_derivatives(const PotentialSeries<R>& series,
                                                               const std::array<ArcPoints<R>, kPoints>& points) {
    using D = Lanes<R>;
    struct Clenshaw {
        V<D> twice_x, square;
        V<D> down, same, down_before, same_before;
    };
    std::array<V<D>, kPoints> z;
    std::array<Clenshaw, kPoints> b;
    for (std::size_t k = 0; k < kPoints; ++k) {
        const auto& u = points[k].u;
        const auto zero = hn::Zero(D());
        z[k] = u.z;
        b[k] = {hn::Add(u.x, u.x), hn::MulAdd(u.x, u.x, hn::Mul(u.y, u.y)), zero, zero, zero, zero};
    }
    std::size_t first = 0;
    for (std::size_t count = 1; count < series.order(); first += count++) {
        const auto sums = clenshaw_sums<R>(series, first, count, z);
        for (std::size_t k = 0; k < kPoints; ++k) {
            auto& [twice_x, square, down, same, down_before, same_before] = b[k];
            const auto next_down = hn::MulAdd(twice_x, down, hn::NegMulAdd(square, down_before, sums[k].down));
            const auto next_same = hn::MulAdd(twice_x, same, hn::NegMulAdd(square, same_before, sums[k].same));
            down_before = down;
            same_before = same;
            down = next_down;
            same = next_same;
        }
    }
    std::array<V<D>, kPoints> values;
    for (std::size_t k = 0; k < kPoints; ++k) {
        const auto& [u, normal] = points[k];
        const auto across = hn::MulAdd(normal.x, u.x, hn::Mul(normal.y, u.y));
        const auto of_down = hn::NegMulAdd(u.x, b[k].down_before, b[k].down);
        const auto of_same = hn::NegMulAdd(across, b[k].same_before, hn::Mul(normal.x, b[k].same));
        values[k] = hn::MulAdd(normal.z, of_down, of_same);
    }
    return values;
}

/// ∫ ν·∇F ds along arcs in lanes, with so many Gauss points on each.
template <class R, bool kGreat>
HWY_INLINE V<Lanes<R>> arc_integral(const PotentialSeries<R>& series, const ArcLanes<R, kGreat>& arcs,
                                    const GaussRule& rule) {
    const Lanes<R> d;
    const std::size_t points = rule.nodes.size();
    const auto fraction = [&](std::size_t i) { return 1 - 2 * rule.nodes[i]; };
    auto sum = hn::Zero(d);
    const std::size_t pairs = points % 2 == 0 ? points / 2 : points > 1 ? points / 2 - 1 : 0;
    for (std::size_t i = 0; i < pairs; ++i) {
        const auto values = normal_derivatives<R, 2>(series, arcs.pair(fraction(i)));
        sum = hn::MulAdd(hn::Add(values[0], values[1]), all(d, rule.weights[i]), sum);
    }
    if (points == 1) {
        const auto value = normal_derivatives<R, 1>(series, {arcs.middle()});
        sum = value[0];
    } else if (points % 2 == 1) {
        const auto [before, after] = arcs.pair(fraction(pairs));
        const auto values = normal_derivatives<R, 3>(series, {before, after, arcs.middle()});
        sum = hn::MulAdd(hn::Add(values[0], values[1]), all(d, rule.weights[pairs]), sum);
        sum = hn::MulAdd(values[2], all(d, rule.weights[pairs + 1]), sum);
    }
    return hn::Mul(sum, arcs.angle());
}

/// Along the horizon z = z_0, s = √(1-z_0²): ν·∇F ds = Σ_m slopes[m] cos mφ dφ,
///   slopes[m] = s^{m+2} D_{m+1}(z_0) - z_0 s^m S_m(z_0).
template <class R>
HWY_INLINE void horizon_slopes(const PotentialSeries<R>& series, V<Lanes<R>> height, V<Lanes<R>> sine, R* slopes) {
    const Lanes<R> d;
    constexpr std::size_t kWidth = kLaneCount<Lanes<R>>;
    const std::size_t order = series.order();
    std::array<V<Lanes<R>>, kMaxOrder + 1> power;
    power[0] = all(d, 1);
    for (std::size_t m = 1; m <= order; ++m) {
        power[m] = hn::Mul(power[m - 1], sine);
    }
    std::size_t first = 0;
    auto waiting = hn::Zero(d);
    for (std::size_t count = 1; count < order; first += count++) {
        const std::size_t m = order - count;
        const auto sums = clenshaw_sums<R>(series, first, count, std::array{height})[0];
        const auto of_same = hn::NegMulAdd(hn::Mul(height, power[m]), sums.same, waiting);
        hn::StoreU(of_same, d, slopes + m * kWidth);
        waiting = hn::Mul(power[m + 1], sums.down);
    }
    hn::StoreU(waiting, d, slopes);
}

/// Σ_m slopes[m] ∫ cos mφ dφ over arcs of the horizon.
template <class R>
HWY_INLINE V<Lanes<R>> horizon_integral(const R* slopes, std::size_t order, const HorizonArc<R>* arcs) {
    const Lanes<R> d;
    constexpr std::size_t kWidth = kLaneCount<Lanes<R>>;
    const auto v = load_numbers<R, 8>(arcs);
    auto from_re = v[0];
    auto from_im = v[1];
    auto to_re = v[2];
    auto to_im = v[3];
    const auto turn = [&](auto& re, auto& im, std::size_t by) HWY_ATTR {
        const auto next = hn::MulSub(re, v[by], hn::Mul(im, v[by + 1]));
        im = hn::MulAdd(re, v[by + 1], hn::Mul(im, v[by]));
        re = next;
    };
    auto sum = hn::Mul(hn::LoadU(d, slopes), v[4]);
    for (std::size_t m = 1; m < order; ++m) {
        const auto slope = hn::Mul(hn::LoadU(d, slopes + m * kWidth), all(d, 1 / static_cast<double>(m)));
        sum = hn::MulAdd(slope, hn::Sub(to_im, from_im), sum);
        turn(from_re, from_im, 0);
        turn(to_re, to_im, 2);
    }
    return sum;
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
