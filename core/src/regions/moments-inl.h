// SPDX-License-Identifier: MIT
//
// Coefficients of arcs in lanes: what each adds to its region's (docs/theory.md, 4.2). Included once per
// instruction set.
#if defined(SHLIGHT_KERNELS_MOMENTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_MOMENTS_INL_H_
#undef SHLIGHT_KERNELS_MOMENTS_INL_H_
#else
#define SHLIGHT_KERNELS_MOMENTS_INL_H_
#endif

#include <hwy/aligned_allocator.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "regions/arc_lanes-inl.h"
#include "regions/boundary_constants.h"
#include "shlight/types.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Sums of P̃_l^m (x+iy)^{m-1} over the points of arcs in lanes, and what they are for the coefficients of each arc.
/// Along a great circle ν is constant, and two sums do instead of four.
template <class R, bool kGreat>
class ArcMoments {
    using D = Lanes<R>;

  public:
    using Rows = RowPointers<R>;

    explicit ArcMoments(int order)
        : order_(order), block_(hwy::AllocateAligned<R>(static_cast<std::size_t>(coefficient_count(order)) * kWidth)) {
        put(0, 0, hn::Zero(D()));  // no arc adds to band 0
    }

    /// Works out the coefficients of bands 2 … of the arcs, with so many Gauss points on each.
    HWY_INLINE void integrate(const ArcLanes<R, true>& arcs, const GaussRule& rule) {
        load(arcs, rule);
        for (int m = 1; m < order_; ++m) {
            add_degree(m);
        }
    }

    /// The same of any curves with `count` points, up to kMaxGaussPoints. place(i): a point of each lane's curve and
    /// its weight.
    template <class Place>
    HWY_INLINE void integrate_points(std::size_t count, const Place& place) {
        static_assert(!kGreat);
        count_ = count;
        for (std::size_t i = 0; i < count; ++i) {
            const auto [point, weight] = place(i);
            set(i, point, weight);
        }
        for (int m = 1; m < order_; ++m) {
            add_degree(m);
        }
    }

    /// Bands 0 and 1, if they are not worked out elsewhere.
    HWY_INLINE void put_low_bands(V<D> band_0, const Vectors3<R>& band_1) {
        put(0, 0, band_0);
        if (order_ > 1) {
            put(1, -1, band_1.y);
            put(1, 0, band_1.z);
            put(1, 1, band_1.x);
        }
    }

    /// Works out the coefficients of bands 2 … of arcs of the horizon z = 0, in closed form.
    HWY_INLINE void integrate_horizon(const HorizonArc<R>* arcs) {
        const D d;
        const auto v = load_numbers<R, 8>(arcs);
        auto from_re = all(d, 1);
        auto from_im = hn::Zero(d);
        auto to_re = from_re;
        auto to_im = from_im;
        auto cosine = v[4];  // ∫ cos mφ dφ
        auto sine = hn::Zero(d);
        for (int m = 0; m < order_; ++m) {
            if (m > 0) {
                turn(from_re, from_im, v[0], v[1]);
                turn(to_re, to_im, v[2], v[3]);
                const auto over = all(d, 1.0 / m);
                cosine = hn::Mul(hn::Sub(to_im, from_im), over);
                sine = hn::Mul(hn::Sub(from_re, to_re), over);
            }
            const MomentStep<R>* step = m + 1 < order_ ? MomentSteps<R>::get().of_degree(m + 1) : nullptr;
            for (int l = m; l < order_; ++l) {
                const auto slope = l > m ? hn::Set(d, step[l - m - 1].horizon) : hn::Zero(d);
                put(l, m, hn::Mul(slope, cosine));
                if (m > 0) {
                    put(l, -m, hn::Mul(slope, sine));
                }
            }
        }
    }

    /// Adds each lane's coefficients to its row, for `count` lanes one after the other: several may have the same.
    HWY_INLINE void add_to(const Rows& rows, std::size_t count) const {
        const auto numbers = static_cast<std::size_t>(coefficient_count(order_));
        alignas(64) std::array<R, kLine * kWidth> buffer;
        std::array<R*, kWidth> lines;
        for (std::size_t lane = 0; lane < kWidth; ++lane) {
            lines[lane] = buffer.data() + lane * kLine;
        }
        // A cache line of each row at a time: rows of a power of two in length share a few sets of the cache.
        std::size_t c = 0;
        for (; c + kLine <= numbers; c += kLine) {
            for (std::size_t i = 0; i < kLine; i += kSide) {
                std::array<V<D>, kSide> columns;
                for (std::size_t j = 0; j < kSide; ++j) {
                    columns[j] = hn::LoadU(D(), block_.get() + (c + i + j) * kWidth);
                }
                store_columns(D(), columns, lines.data(), i);
            }
            for (std::size_t lane = 0; lane < count; ++lane) {
                for (std::size_t i = 0; i < kLine; i += kWidth) {
                    R* to = rows[lane] + c + i;
                    hn::StoreU(hn::Add(hn::LoadU(D(), to), hn::Load(D(), lines[lane] + i)), D(), to);
                }
            }
        }
        for (; c < numbers; ++c) {
            for (std::size_t lane = 0; lane < count; ++lane) {
                rows[lane][c] += block_[c * kWidth + lane];
            }
        }
    }

  private:
    static constexpr std::size_t kWidth = kLaneCount<D>;
    static constexpr std::size_t kSide = kSquare<D>;
    static constexpr std::size_t kLine = 64 / sizeof(R);

    /// One point of each lane's arc, with its factors (x+iy)^{m-1} and, but for great circles, those times ν.
    struct Point {
        V<D> x, y, z, p, before, re, im;
        Vectors3<R> normal;
        V<D> down_re, down_im, same_re, same_im;
    };
    struct Sums {
        V<D> a, b, c, d;
    };

    static HWY_INLINE void turn(V<D>& re, V<D>& im, V<D> x, V<D> y) {
        const auto next = hn::MulSub(re, x, hn::Mul(im, y));
        im = hn::MulAdd(re, y, hn::Mul(im, x));
        re = next;
    }

    HWY_INLINE R* at(int l, int m) { return block_.get() + static_cast<std::size_t>(coefficient_index(l, m)) * kWidth; }
    HWY_INLINE void put(int l, int m, V<D> value) { hn::StoreU(value, D(), at(l, m)); }
    HWY_INLINE void add(int l, int m, V<D> value) { put(l, m, hn::Add(hn::LoadU(D(), at(l, m)), value)); }

    HWY_INLINE void set(std::size_t i, const ArcPoints<R>& from, V<D> weight) {
        points_[i].x = from.u.x;
        points_[i].y = from.u.y;
        points_[i].z = from.u.z;
        points_[i].normal = from.normal;
        points_[i].re = weight;
        points_[i].im = hn::Zero(D());
    }

    HWY_INLINE void load(const ArcLanes<R, true>& arcs, const GaussRule& rule) {
        const D d;
        count_ = rule.nodes.size();
        for (std::size_t i = 0; i < count_ / 2; ++i) {
            const auto pair = arcs.pair(1 - 2 * rule.nodes[i]);
            const auto weight = hn::Mul(arcs.angle(), all(d, rule.weights[i]));
            set(2 * i, pair[0], weight);
            set(2 * i + 1, pair[1], weight);
        }
        if (count_ % 2 == 1) {
            set(count_ - 1, arcs.middle(), hn::Mul(arcs.angle(), all(d, rule.weights[count_ / 2])));
        }
    }

    HWY_INLINE void start_degree() {
        const D d;
        for (std::size_t i = 0; i < count_; ++i) {
            Point& point = points_[i];
            point.p = all(d, 1);
            point.before = hn::Zero(d);
            if constexpr (kGreat) {
                point.down_re = point.re;
                point.down_im = point.im;
            } else {
                const auto& n = point.normal;
                point.down_re = hn::Mul(n.z, point.re);
                point.down_im = hn::Mul(n.z, point.im);
                point.same_re = hn::MulSub(n.x, point.re, hn::Mul(n.y, point.im));
                point.same_im = hn::MulAdd(n.x, point.im, hn::Mul(n.y, point.re));
            }
            turn(point.re, point.im, point.x, point.y);
        }
    }

    static HWY_INLINE void accumulate(Sums& sums, V<D> p, const Point& point) {
        sums.a = hn::MulAdd(p, point.down_re, sums.a);
        sums.b = hn::MulAdd(p, point.down_im, sums.b);
        if constexpr (!kGreat) {
            sums.c = hn::MulAdd(p, point.same_re, sums.c);
            sums.d = hn::MulAdd(p, point.same_im, sums.d);
        }
    }

    /// Two bands at once: half of the loads and stores.
    HWY_INLINE void add_degree(int m) {
        const D d;
        start_degree();
        const auto zero = hn::Zero(d);
        const MomentStep<R>* step = MomentSteps<R>::get().of_degree(m);
        for (int l = m; l < order_; l += 2, step += 2) {
            Sums first = {zero, zero, zero, zero};
            Sums second = {zero, zero, zero, zero};
            const auto beta = hn::Set(d, step[0].beta);
            const auto next_beta = hn::Set(d, step[1].beta);
            for (std::size_t i = 0; i < count_; ++i) {
                Point& point = points_[i];
                const auto p = point.p;
                const auto next = hn::MulSub(point.z, p, hn::Mul(beta, point.before));
                accumulate(first, p, point);
                accumulate(second, next, point);
                point.before = next;
                point.p = hn::MulSub(point.z, next, hn::Mul(next_beta, p));
            }
            write(first, step[0], l, m);
            if (l + 1 < order_) {
                write(second, step[1], l + 1, m);
            }
        }
    }

    HWY_INLINE void write(const Sums& sums, const MomentStep<R>& step, int l, int m) {
        const D d;
        const auto down = hn::Set(d, step.down);
        const auto same = hn::Set(d, step.same);
        Sums s = sums;
        if constexpr (kGreat) {
            const auto& n = points_[0].normal;
            s = {hn::Mul(n.z, sums.a), hn::Mul(n.z, sums.b), hn::MulSub(n.x, sums.a, hn::Mul(n.y, sums.b)),
                 hn::MulAdd(n.x, sums.b, hn::Mul(n.y, sums.a))};
        }
        put(l, m, hn::Mul(same, s.c));
        put(l, -m, hn::Mul(same, s.d));
        if (m > 1) {
            add(l, m - 1, hn::Mul(down, s.a));
            add(l, 1 - m, hn::Mul(down, s.b));
        } else {
            put(l, 0, hn::Mul(down, s.a));
        }
    }

    int order_;
    hwy::AlignedFreeUniquePtr<R[]> block_;  // NOLINT(modernize-avoid-c-arrays): as Highway names it
    std::array<Point, kMaxGaussPoints> points_;
    std::size_t count_ = 0;
};

/// Adds the coefficients of a list's arcs to the rows of their regions, a vector of arcs after the other.
/// integrate(arcs): lets `moments` work out those of a vector; row_of(region): order² numbers.
template <class Moments, class List, class RowOf, class Integrate>
HWY_INLINE void add_list(Moments& moments, const List& list, const RowOf& row_of, const Integrate& integrate) {
    typename Moments::Rows rows{};
    for (std::size_t first = 0; first < list.size(); first += rows.size()) {
        integrate(list.from(first));
        const std::size_t count = std::min(rows.size(), list.size() - first);
        for (std::size_t lane = 0; lane < count; ++lane) {
            rows[lane] = row_of(list.region(first + lane));
        }
        moments.add_to(rows, count);
    }
}

/// Adds bands 2 … of arcs of great circles to their regions' rows.
template <class R, class RowOf>
void add_moments(const ArcLists<R>& lists, int order, const RowOf& row_of) {
    if (order <= 2) {
        return;
    }
    ArcMoments<R, true> moments(order);
    for (std::size_t points = 1; points <= kMaxGaussPoints; ++points) {
        const GaussRule& rule = gauss_rule(static_cast<int>(points));
        add_list(moments, lists.arcs.rows(points), row_of,
                 [&](const Arc<R>* arcs) HWY_ATTR { moments.integrate(ArcLanes<R, true>(arcs), rule); });
    }
    add_list(moments, lists.horizon, row_of,
             [&](const HorizonArc<R>* arcs) HWY_ATTR { moments.integrate_horizon(arcs); });
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
