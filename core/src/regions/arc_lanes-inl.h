// SPDX-License-Identifier: MIT
//
// Points on arcs of circles and on the boundaries of elliptic cones, one arc a lane (docs/theory.md, 4.2, 4.7 and 5.2).
// Included once per instruction set.
#if defined(SHLIGHT_KERNELS_ARC_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_ARC_LANES_INL_H_
#undef SHLIGHT_KERNELS_ARC_LANES_INL_H_
#else
#define SHLIGHT_KERNELS_ARC_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numbers>
#include <type_traits>

#include "math/gauss_legendre.h"
#include "regions/arcs.h"
#include "regions/boost_lanes-inl.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

template <class R>
struct SineCosine {
    V<Lanes<R>> sine, cosine;
};

/// Sine and cosine of angles in -π/2 … π/2, as polynomials in their square; largest error 2e-8 and 2e-17 (Chebyshev
/// interpolation).
template <class R>
HWY_INLINE SineCosine<R> of_quarter_turn(V<Lanes<R>> angle) {
    const Lanes<R> d;
    const auto y = hn::Mul(angle, angle);
    const auto polynomial = [&](const auto& coefficients) HWY_ATTR {
        auto sum = hn::Zero(d);
        for (std::size_t i = coefficients.size(); i-- > 0;) {
            sum = hn::MulAdd(sum, y, all(d, coefficients[i]));
        }
        return sum;
    };
    if constexpr (std::is_same_v<R, float>) {
        constexpr std::array<double, 4> kSine = {-0.1666666596382118729, 0.0083332421350969387576,
                                                 -0.00019822739488631101798, 2.6347563918117812731e-6};
        constexpr std::array<double, 5> kCosine = {-0.49999999963953022676, 0.041666659360024926605,
                                                   -0.0013888651647261390631, 0.000024774579745194932456,
                                                   -2.6297517416492885068e-7};
        return {hn::MulAdd(hn::Mul(angle, y), polynomial(kSine), angle), hn::MulAdd(y, polynomial(kCosine), all(d, 1))};
    } else {
        constexpr std::array<double, 8> kSine = {-0.16666666666666666633,    0.0083333333333333158688,
                                                 -0.00019841269841254973769, 2.7557319219163233416e-6,
                                                 -2.5052107616996182891e-8,  1.6058977312464087621e-10,
                                                 -7.6439702967985720524e-13, 2.7314447669863993424e-15};
        constexpr std::array<double, 8> kCosine = {
            -0.49999999999999999362,   0.04166666666666633566,   -0.0013888888888860709697,  0.000024801587292446212237,
            -2.7557317767320528541e-7, 2.0876630867422995287e-9, -1.1464689885720027995e-11, 4.6276759850181717831e-14};
        return {hn::MulAdd(hn::Mul(angle, y), polynomial(kSine), angle), hn::MulAdd(y, polynomial(kCosine), all(d, 1))};
    }
}

/// Sine and cosine of angles in -π … π.
template <class R>
HWY_INLINE SineCosine<R> of_half_turn(V<Lanes<R>> angle) {
    const Lanes<R> d;
    const SineCosine<R> half = of_quarter_turn<R>(hn::Mul(angle, all(d, 0.5)));
    const auto twice = hn::Add(half.sine, half.sine);
    return {hn::Mul(twice, half.cosine), hn::NegMulAdd(twice, half.sine, all(d, 1))};
}

/// All numbers of arcs in lanes, one arc a lane, the first kCount of them.
template <class R, std::size_t kCount, class Row>
HWY_INLINE std::array<V<Lanes<R>>, kCount> load_numbers(const Row* arcs) {
    const Lanes<R> d;
    RowPointers<const R> rows;
    for (std::size_t lane = 0; lane < rows.size(); ++lane) {
        rows[lane] = numbers(arcs[lane]);
    }
    std::array<V<Lanes<R>>, kCount> v;
    for (std::size_t c = 0; c < kCount; c += kSquare<Lanes<R>>) {
        const auto columns = load_columns(d, rows.data(), c);
        std::copy(columns.begin(), columns.end(), v.begin() + c);
    }
    return v;
}

/// Points u of arcs, with ν ds ÷ (weight · 2 half), ν the inward normal.
template <class R>
struct ArcPoints {
    Vectors3<R> u, normal;
};

/// Arcs in lanes. kGreat: all are of great circles.
template <class R, bool kGreat>
class ArcLanes {
    using D = Lanes<R>;

  public:
    /// arcs: one a lane.
    explicit HWY_INLINE ArcLanes(const Arc<R>* arcs) {
        const auto v = load_numbers < R, kGreat ? 8 : 12 > (arcs);
        axis_ = {v[0], v[1], v[2]};
        half_ = v[3];
        middle_ = {v[4], v[5], v[6]};
        across_ = cross<R>(axis_, middle_);
        if constexpr (!kGreat) {
            cosine_ = v[8];
            sine_ = v[9];
            center_ = scaled<R>(axis_, cosine_);
            normal_ = scaled<R>(axis_, hn::Mul(sine_, sine_));
        }
    }

    V<D> angle() const { return hn::Add(half_, half_); }

    /// The point at `fraction` of the half angle from the middle, and its mirror image.
    HWY_INLINE std::array<ArcPoints<R>, 2> pair(double fraction) const {
        const auto turn = hn::Mul(half_, all(D(), fraction));
        if constexpr (kGreat) {
            const SineCosine<R> t = of_quarter_turn<R>(turn);
            const Vectors3<R> base = scaled<R>(middle_, t.cosine);
            const Vectors3<R> side = scaled<R>(across_, t.sine);
            return {ArcPoints<R>{base - side, axis_}, {base + side, axis_}};
        } else {
            const SineCosine<R> t = of_half_turn<R>(turn);
            const Vectors3<R> base = scaled<R>(middle_, hn::Mul(sine_, t.cosine));
            const Vectors3<R> side = scaled<R>(across_, hn::Mul(sine_, t.sine));
            return {at(base - side), at(base + side)};
        }
    }

    HWY_INLINE ArcPoints<R> middle() const {
        if constexpr (kGreat) {
            return {middle_, axis_};
        } else {
            return at(scaled<R>(middle_, sine_));
        }
    }

  private:
    /// radius: from the circle's middle. ν ds/dψ = axis - cosine u = sine² axis - cosine radius, where nothing cancels.
    HWY_INLINE ArcPoints<R> at(const Vectors3<R>& radius) const {
        return {center_ + radius, normal_ - scaled<R>(radius, cosine_)};
    }

    Vectors3<R> axis_, middle_, across_, center_, normal_;
    V<D> half_, cosine_, sine_;
};

/// Pieces of boundaries in lanes.
template <class R>
class ConeLanes {
    using D = Lanes<R>;

  public:
    /// arcs: one a lane.
    explicit HWY_INLINE ConeLanes(const ConeArc<R>* arcs) {
        const auto v = load_numbers<R, kNumbers<ConeArc<R>>>(arcs);
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
            one_minus_modulus_[level_count_] = hn::IfThenElse(counts, hn::Div(hn::Add(b, b), sum), all(d, 1));
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
            f.dn = hn::Mul(hn::Add(one_minus_modulus_[i], of_cosine), over);
        }
        return f;
    }

    Vectors3<R> u_sn_, u_cn_, u_dn_, normal_sn_, normal_cn_, normal_dn_;
    V<D> middle_, half_turn_, half_, product_, cos_short_;
    std::array<V<D>, kMostLevels> moduli_, one_minus_modulus_;
    std::size_t level_count_ = 0;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
