// SPDX-License-Identifier: MIT
#include "regions/cap_motion.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "regions/cap_motion.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "math/legendre-inl.h"
#include "regions/motion_constants.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

template <class D>
struct Complex {
    V<D> re, im;
};

/// Numbers of degrees m = -1 … kMaxOrder + 1, cosine and sine terms as real and imaginary parts, in lanes. Degree 0
/// counts √2 times, so that all degrees have the same scale.
template <class T>
class Degrees {
    using D = Lanes<T>;
    static constexpr std::size_t kLanes = kLaneCount<D>;

  public:
    Complex<D> operator[](std::size_t m) const { return {load(re_, m + 1), load(im_, m + 1)}; }
    /// Degree m - 1.
    Complex<D> before(std::size_t m) const { return {load(re_, m), load(im_, m)}; }
    void set(std::size_t m, const Complex<D>& value) {
        hn::Store(value.re, D(), re_.data() + (m + 1) * kLanes);
        hn::Store(value.im, D(), im_.data() + (m + 1) * kLanes);
    }
    /// The band before the first.
    void set_empty() {
        std::fill_n(re_.begin(), 3 * kLanes, T(0));
        std::fill_n(im_.begin(), 3 * kLanes, T(0));
    }
    /// Band l of rows of coefficients.
    void load_band(const T* const* rows, std::size_t l) {
        const D d;
        for (std::size_t first = 0; first <= 2 * l; first += kSquare<D>) {
            const auto columns = load_columns(d, rows, l * l + first);
            for (std::size_t j = 0; j < kSquare<D> && first + j <= 2 * l; ++j) {
                const std::size_t column = first + j;
                T* const to =
                    column >= l ? re_.data() + (column - l + 1) * kLanes : im_.data() + (l - column + 1) * kLanes;
                hn::Store(columns[j], d, to);
            }
        }
        const auto middle = hn::Load(d, re_.data() + kLanes);
        set(0, {hn::Mul(middle, all(d, std::numbers::sqrt2)), hn::Zero(d)});
        set(l + 1, {hn::Zero(d), hn::Zero(d)});
        set(l + 2, {hn::Zero(d), hn::Zero(d)});
        hn::Store(hn::Neg((*this)[1].re), d, re_.data());
        hn::Store((*this)[1].im, d, im_.data());
    }

  private:
    using Array = std::array<T, (kMaxOrder + 4) * kLanes>;

    static V<D> load(const Array& array, std::size_t place) { return hn::Load(D(), array.data() + place * kLanes); }

    alignas(64) Array re_, im_;
};

/// The numbers of CapMotion in lanes.
template <class T>
class Motions {
    using D = Lanes<T>;
    static constexpr std::size_t kLanes = kLaneCount<D>;

  public:
    /// Lanes from `lanes` on repeat the last cap.
    Motions(const CapMotion<T>* caps, std::size_t lanes) {
        alignas(64) std::array<std::array<T, kLanes>, kNumbers> numbers;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const CapMotion<T>& cap = caps[std::min(lane, lanes - 1)];
            const std::array<T, kNumbers> own = {
                cap.x,        cap.y,   cap.z,          cap.over_distance,  cap.over_depth,
                cap.over_rim, cap.cut, cap.cut_cosine, cap.azimuth_cosine, cap.azimuth_sine,
                cap.cut_sine};
            for (std::size_t k = 0; k < kNumbers; ++k) {
                numbers[k][lane] = own[k];
            }
        }
        for (std::size_t k = 0; k < kNumbers; ++k) {
            v_[k] = hn::Load(D(), numbers[k].data());
        }
    }

    V<D> x() const { return v_[0]; }
    V<D> y() const { return v_[1]; }
    V<D> z() const { return v_[2]; }
    V<D> over_distance() const { return v_[3]; }
    V<D> over_depth() const { return v_[4]; }
    V<D> over_rim() const { return v_[5]; }
    bool cut() const { return !hn::AllTrue(D(), hn::Eq(v_[6], hn::Zero(D()))); }

    /// ∫ e^{imφ} dφ over the horizon's arc within the cap, for degrees -1 … order.
    void arc_integrals(std::size_t order, Degrees<T>& out) const {
        const D d;
        alignas(64) std::array<std::array<T, (kMaxOrder + 1) * kLanes>, 4> powers;
        complex_powers_in_lanes(d, v_[7], v_[10], 1, order + 1, powers[0].data(), powers[1].data());
        complex_powers_in_lanes(d, v_[8], v_[9], 1, order + 1, powers[2].data(), powers[3].data());
        out.set(0, {hn::Add(v_[6], v_[6]), hn::Zero(d)});
        for (std::size_t m = 1; m <= order; ++m) {
            const auto at = [&](std::size_t k) HWY_ATTR { return hn::Load(d, powers[k].data() + m * kLanes); };
            const auto size = hn::Mul(at(1), all(d, 2 / static_cast<double>(m)));
            out.set(m, {hn::Mul(size, at(2)), hn::Mul(size, at(3))});
        }
    }

  private:
    static constexpr std::size_t kNumbers = 11;

    std::array<V<D>, kNumbers> v_;
};

/// The horizon's arc within the cap adds this to a degree of all bands, but for P̄_l^m(0): the integrals of e^{imφ}
/// times sinφ, cosφ and 1.
template <class D>
struct ArcParts {
    Complex<D> sine, cosine, one;
};

template <class T>
ArcParts<Lanes<T>> arc_parts(const Degrees<T>& arcs, std::size_t m) {
    const Lanes<T> d;
    const auto half = all(d, 0.5);
    const auto own = arcs[m];
    const auto next = arcs[m + 1];
    if (m == 0) {  // the integral of degree -1 is the conjugate of that of degree 1
        return {{next.im, hn::Zero(d)}, {next.re, hn::Zero(d)}, own};
    }
    const auto last = arcs[m - 1];
    return {{hn::Mul(half, hn::Sub(next.im, last.im)), hn::Mul(half, hn::Sub(last.re, next.re))},
            {hn::Mul(half, hn::Add(next.re, last.re)), hn::Mul(half, hn::Add(next.im, last.im))},
            own};
}

/// Derivatives of one coefficient, or of those of degrees m and -m.
template <class D>
struct Motion {
    std::array<V<D>, 3> by_center;
    V<D> by_radius;
};

/// turns: derivatives by turns of the cap about x, y and z. boost: by a boost along its axis.
template <class T>
HWY_INLINE Motion<Lanes<T>> motion(const Motions<T>& caps, const std::array<V<Lanes<T>>, 3>& turns, V<Lanes<T>> boost) {
    const auto along = hn::Mul(caps.over_depth(), boost);
    const auto component = [&](V<Lanes<T>> axis, V<Lanes<T>> a, V<Lanes<T>> b, V<Lanes<T>> c, V<Lanes<T>> e) HWY_ATTR {
        const auto across = hn::MulSub(a, b, hn::Mul(c, e));
        return hn::MulAdd(across, caps.over_distance(), hn::Mul(along, axis));
    };
    return {{component(caps.x(), turns[1], caps.z(), turns[2], caps.y()),
             component(caps.y(), turns[2], caps.x(), turns[0], caps.z()),
             component(caps.z(), turns[0], caps.y(), turns[1], caps.x())},
            hn::Neg(hn::Mul(caps.over_rim(), boost))};
}

/// The derivatives of a pair of coefficients. below, own, above: bands l - 1, l, l + 1.
template <class T>
class PairMotion {
    using D = Lanes<T>;

  public:
    PairMotion(const Motions<T>& caps, const Degrees<T>& below, const Degrees<T>& own, const Degrees<T>& above)
        : caps_(caps), below_(below), own_(own), above_(above) {}

    /// arc: null where the horizon cuts none of the caps.
    HWY_INLINE void find(std::size_t m, const MotionStep<T>& step, const ArcParts<D>* arc, Motion<D>& cosine,
                         Motion<D>& sine) const {
        const D d;
        const auto up = own_[m + 1];
        const auto down = own_.before(m);
        const auto k = [&](T number) HWY_ATTR { return hn::Set(d, number); };
        const auto a = hn::Mul(k(step.ladder_up), up.re);
        const auto b = hn::Mul(k(step.ladder_up), up.im);
        const auto degree = all(d, static_cast<double>(m));
        std::array<V<D>, 3> re = {hn::MulAdd(k(step.ladder_down), down.im, b),
                                  hn::MulSub(k(step.ladder_down), down.re, a), hn::Neg(hn::Mul(degree, own_[m].im))};
        std::array<V<D>, 3> im = {hn::Neg(hn::MulAdd(k(step.ladder_down), down.re, a)),
                                  hn::MulSub(k(step.ladder_down), down.im, b), hn::Mul(degree, own_[m].re)};
        Complex<D> along = boost(m, step);
        if (arc != nullptr) {
            const auto plane = k(step.plane);
            const auto add = [&](V<D>& sum, V<D> part) HWY_ATTR { sum = hn::MulAdd(plane, part, sum); };
            add(re[0], arc->sine.re);
            add(im[0], arc->sine.im);
            add(re[1], hn::Neg(arc->cosine.re));
            add(im[1], hn::Neg(arc->cosine.im));
            add(along.re, hn::Mul(caps_.z(), arc->one.re));
            add(along.im, hn::Mul(caps_.z(), arc->one.im));
        }
        cosine = motion(caps_, re, along.re);
        sine = motion(caps_, im, along.im);
    }

  private:
    /// ∫ ∇·(Y_lm a) for the field a of a boost along the cap's axis.
    HWY_INLINE Complex<D> boost(std::size_t m, const MotionStep<T>& step) const {
        const D d;
        const auto mixed = [&](T s, V<D> x, T t, V<D> y)
                               HWY_ATTR { return hn::MulAdd(hn::Set(d, s), x, hn::Mul(hn::Set(d, t), y)); };
        const auto more_re = mixed(step.rise_up, above_[m + 1].re, step.fall_up, below_[m + 1].re);
        const auto more_im = mixed(step.rise_up, above_[m + 1].im, step.fall_up, below_[m + 1].im);
        const auto less_re = mixed(step.rise_down, above_.before(m).re, step.fall_down, below_.before(m).re);
        const auto less_im = mixed(step.rise_down, above_.before(m).im, step.fall_down, below_.before(m).im);
        const auto re = mixed(step.fall, below_[m].re, step.rise, above_[m].re);
        const auto im = mixed(step.fall, below_[m].im, step.rise, above_[m].im);
        return {hn::MulAdd(caps_.x(), hn::Sub(less_re, more_re),
                           hn::NegMulAdd(caps_.y(), hn::Add(less_im, more_im), hn::Mul(caps_.z(), re))),
                hn::MulAdd(caps_.x(), hn::Sub(less_im, more_im),
                           hn::MulAdd(caps_.y(), hn::Add(less_re, more_re), hn::Mul(caps_.z(), im)))};
    }

    const Motions<T>& caps_;
    const Degrees<T>&below_, &own_, &above_;
};

/// The derivatives of one band, column by column, on their way to the rows.
template <class T>
class BandWriter {
    using D = Lanes<T>;
    static constexpr std::size_t kLanes = kLaneCount<D>;
    static constexpr std::size_t kColumns = 2 * kMaxOrder;

  public:
    BandWriter(const RowPointers<T>& by_center, const RowPointers<T>& by_radius, std::size_t order)
        : center_(by_center, order, Output::cached), radius_(by_radius, order, Output::cached) {}

    void set(std::size_t column, const Motion<D>& motion, V<D> scale) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            store(center_columns_, 3 * column + axis, hn::Mul(scale, motion.by_center[axis]));
        }
        store(radius_columns_, column, hn::Mul(scale, motion.by_radius));
    }
    void write(std::size_t columns) {
        for (std::size_t first = 0; first < 3 * columns; first += kColumns) {
            copy(center_columns_, first, std::min(kColumns, 3 * columns - first), center_);
        }
        copy(radius_columns_, 0, columns, radius_);
    }
    void finish() {
        center_.finish();
        radius_.finish();
    }

  private:
    template <class Array>
    static void store(Array& array, std::size_t column, V<D> value) {
        hn::Store(value, D(), array.data() + column * kLanes);
    }
    template <class Array>
    static void copy(const Array& array, std::size_t first, std::size_t columns, RowWriter<T>& writer) {
        std::copy_n(array.data() + first * kLanes, columns * kLanes, writer.take(columns));
    }

    RowWriter<T> center_, radius_;
    alignas(64) std::array<T, 3 * kColumns * kLanes> center_columns_;
    alignas(64) std::array<T, kColumns * kLanes> radius_columns_;
};

/// The derivatives of as many caps as there are lanes.
template <class T>
HWY_NOINLINE void write_motion(const Motions<T>& caps, std::size_t order, const RowPointers<const T>& rows,
                               BandWriter<T>& writer) {
    const Lanes<T> d;
    Degrees<T> arcs;
    const bool cut = caps.cut();
    if (cut) {
        caps.arc_integrals(order, arcs);
    }
    std::array<Degrees<T>, 3> bands;
    bands[2].set_empty();
    bands[0].load_band(rows.data(), 0);
    const MotionStep<T>* step = motion_steps<T>().data();
    for (std::size_t l = 0; l < order; ++l) {
        bands[(l + 1) % 3].load_band(rows.data(), l + 1);
        const PairMotion<T> pair(caps, bands[(l + 2) % 3], bands[l % 3], bands[(l + 1) % 3]);
        for (std::size_t m = 0; m <= l; ++m, ++step) {
            Motion<Lanes<T>> cosine, sine;
            if (cut && (l - m) % 2 == 0) {
                const auto parts = arc_parts(arcs, m);
                pair.find(m, *step, &parts, cosine, sine);
            } else {
                pair.find(m, *step, nullptr, cosine, sine);
            }
            writer.set(l + m, cosine, all(d, m == 0 ? 1 / std::numbers::sqrt2 : 1));
            if (m > 0) {
                writer.set(l - m, sine, all(d, 1));
            }
        }
        writer.write(2 * l + 1);
    }
    writer.finish();
}

template <class T>
void write_all(const CapMotion<T>* caps, std::size_t count, int order, const T* rows, T* by_center, T* by_radius) {
    constexpr std::size_t kLanes = kLaneCount<Lanes<T>>;
    const auto n = static_cast<std::size_t>(order);
    for (std::size_t first = 0; first < count; first += kLanes) {
        const std::size_t lanes = std::min(kLanes, count - first);
        RowPointers<const T> from;
        RowPointers<T> center, radius;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t i = first + std::min(lane, lanes - 1);
            from[lane] = rows + i * (n + 1) * (n + 1);
            center[lane] = by_center + i * n * n * 3;
            radius[lane] = by_radius + i * n * n;
        }
        BandWriter<T> writer(center, radius, n);
        write_motion(Motions<T>(caps + first, lanes), n, from, writer);
    }
}

void motion_float(const CapMotion<float>* caps, std::size_t count, int order, const float* rows, float* by_center,
                  float* by_radius) {
    write_all(caps, count, order, rows, by_center, by_radius);
}
void motion_double(const CapMotion<double>* caps, std::size_t count, int order, const double* rows, double* by_center,
                   double* by_radius) {
    write_all(caps, count, order, rows, by_center, by_radius);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(motion_float);
HWY_EXPORT(motion_double);

void write_cap_motion(const CapMotion<float>* caps, std::size_t count, int order, const float* rows, float* by_center,
                      float* by_radius) {
    HWY_DYNAMIC_DISPATCH(motion_float)(caps, count, order, rows, by_center, by_radius);
}
void write_cap_motion(const CapMotion<double>* caps, std::size_t count, int order, const double* rows,
                      double* by_center, double* by_radius) {
    HWY_DYNAMIC_DISPATCH(motion_double)(caps, count, order, rows, by_center, by_radius);
}

}  // namespace shlight
#endif
