// SPDX-License-Identifier: MIT
//
// Points on the boundaries of cones of second degree, one piece of a boundary a lane (docs/theory.md, 5.2).
// Included once per instruction set.
#if defined(SHLIGHT_KERNELS_CONE_POINTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_CONE_POINTS_INL_H_
#undef SHLIGHT_KERNELS_CONE_POINTS_INL_H_
#else
#define SHLIGHT_KERNELS_CONE_POINTS_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <limits>
#include <numbers>

#include "regions/arc_points-inl.h"
#include "regions/ellipse_rows.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Pieces of boundaries in lanes.
template <class R>
class ConeLanes {
    using D = Lanes<R>;

  public:
    /// rows: one piece a lane.
    explicit HWY_INLINE ConeLanes(const ConeRow<R>* rows) {
        const D d;
        std::array<V<D>, kColumns> v;
        for (std::size_t c = 0; c < kColumns; c += kSquare<D>) {
            const auto columns = load_row_columns(d, rows, c);
            for (std::size_t j = 0; j < columns.size(); ++j) {
                v[c + j] = columns[j];
            }
        }
        middle_ = v[11];
        half_turn_ = v[12];
        half_ = v[13];
        const auto sin_long = v[14];
        const auto cos_long = v[15];
        const auto sin_short = v[16];
        const auto cos_short = v[17];
        const Vectors3<R> long_axis = {v[0], v[1], v[2]};
        const Vectors3<R> short_axis = {v[4], v[5], v[6]};
        const Vectors3<R> axis = {v[8], v[9], v[10]};
        u_sn_ = scaled<R>(long_axis, sin_long);
        u_cn_ = scaled<R>(short_axis, sin_short);
        u_dn_ = scaled<R>(axis, cos_short);
        // ω × dω/du
        normal_sn_ = scaled<R>(long_axis, hn::Neg(hn::Mul(hn::Mul(v[3], cos_long), sin_short)));
        normal_cn_ = scaled<R>(short_axis, hn::Neg(hn::Mul(sin_long, cos_short)));
        product_ = hn::Mul(sin_long, sin_short);
        normal_dn_ = scaled<R>(axis, product_);
        cos_short_ = cos_short;
        set_levels(v[3]);
    }

    /// Length of the pieces in u.
    V<D> length() const { return hn::Add(half_, half_); }

    struct Point {
        ArcPoints<R> on;
        /// The solid angle between the boundary and the axis, per du: ν·axis / (1 + ω·axis), where nothing cancels.
        V<D> fan;
    };
    /// t in -1 … 1.
    HWY_INLINE Point at(double t) const {
        const D d;
        const auto one = all(d, 1);
        auto [sn, cn, dn] = functions(hn::MulAdd(half_turn_, all(d, t), middle_));
        return {{combined(u_sn_, sn, u_cn_, cn, u_dn_, dn), combined(normal_sn_, sn, normal_cn_, cn, normal_dn_, dn)},
                hn::Div(hn::Mul(product_, dn), hn::MulAdd(cos_short_, dn, one))};
    }

  private:
    static constexpr std::size_t kColumns = std::tuple_size_v<ConeRow<R>>;
    static constexpr std::size_t kMostLevels = 14;

    struct Functions {
        V<D> sn, cn, dn;
    };

    static HWY_INLINE Vectors3<R> combined(const Vectors3<R>& a, V<D> s, const Vectors3<R>& b, V<D> c,
                                           const Vectors3<R>& e, V<D> n) {
        return {hn::MulAdd(a.x, s, hn::MulAdd(b.x, c, hn::Mul(e.x, n))),
                hn::MulAdd(a.y, s, hn::MulAdd(b.y, c, hn::Mul(e.y, n))),
                hn::MulAdd(a.z, s, hn::MulAdd(b.z, c, hn::Mul(e.z, n)))};
    }

    /// The moduli of Landen's transformations. Those too small to count are zero, which makes a level that only a
    /// neighbouring lane needs change nothing.
    HWY_INLINE void set_levels(V<D> complement) {
        const D d;
        auto a = all(d, 1);
        auto b = complement;
        const auto least = all(d, static_cast<double>(std::numeric_limits<R>::epsilon()) / 16);
        for (level_count_ = 0; level_count_ < kMostLevels; ++level_count_) {
            const auto sum = hn::Add(a, b);
            const auto modulus = hn::Div(hn::Sub(a, b), sum);
            const auto counts = hn::Gt(modulus, least);
            if (hn::AllFalse(d, counts)) {
                break;
            }
            moduli_[level_count_] = hn::IfThenElseZero(counts, modulus);
            lacks_[level_count_] = hn::IfThenElse(counts, hn::Div(hn::Add(b, b), sum), all(d, 1));
            b = hn::Sqrt(hn::Mul(a, b));
            a = hn::Mul(sum, all(d, 0.5));
        }
    }

    /// turn: π u / 2K. Landen's transformation leads from one modulus to the next larger one (Abramowitz &
    /// Stegun 16.12); with 1 - k sn² = (1 - k) + k cn² nothing cancels.
    HWY_INLINE Functions functions(V<D> turn) const {
        const D d;
        const auto one = all(d, 1);
        constexpr double kTwoPi = 2 * std::numbers::pi;
        const auto turns = hn::Round(hn::Mul(turn, all(d, 1 / kTwoPi)));
        const SineCosine<R> circle = of_half_turn<R>(hn::NegMulAdd(turns, all(d, kTwoPi), turn));
        Functions f = {circle.sine, circle.cosine, one};
        for (std::size_t i = level_count_; i-- > 0;) {
            const auto k = moduli_[i];
            const auto of_sine = hn::Mul(k, hn::Mul(f.sn, f.sn));
            const auto of_cosine = hn::Mul(k, hn::Mul(f.cn, f.cn));
            const auto over = hn::Div(one, hn::Add(one, of_sine));
            f.sn = hn::Mul(hn::MulAdd(k, f.sn, f.sn), over);
            f.cn = hn::Mul(hn::Mul(f.cn, f.dn), over);
            f.dn = hn::Mul(hn::Add(lacks_[i], of_cosine), over);
        }
        return f;
    }

    Vectors3<R> u_sn_, u_cn_, u_dn_, normal_sn_, normal_cn_, normal_dn_;
    V<D> middle_, half_turn_, half_, product_, cos_short_;
    std::array<V<D>, kMostLevels> moduli_, lacks_;
    std::size_t level_count_ = 0;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
