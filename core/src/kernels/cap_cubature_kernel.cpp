// SPDX-License-Identifier: MIT
#include "kernels/cap_cubature_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/cap_cubature_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "kernels/ggx-inl.h"
#include "kernels/lanes-inl.h"
#include "kernels/view_lanes-inl.h"

#ifndef SHLIGHT_KERNELS_CAP_RULES
#define SHLIGHT_KERNELS_CAP_RULES
namespace shlight {

/// Points on a circle about a cap's axis that divides the cap's area at `inside`; weights of a rule sum to 1. They turn
/// by half a step from ring to ring.
struct Ring {
    double inside, weight;
    int spokes;
};

/// The middle; one ring, degree 3; the middle and one ring, degree 5; Gauss's three rings, degree 7 around.
inline constexpr std::array<Ring, 1> kOnePoint = {Ring{0, 1, 1}};
inline constexpr std::array<Ring, 1> kFourPoints = {Ring{0.5, 1, 4}};
inline constexpr std::array<Ring, 2> kSevenPoints = {Ring{0, 0.25, 1}, {2.0 / 3, 0.75, 6}};
inline constexpr std::array<Ring, 3> kTwentyFourPoints = {
    Ring{0.112701665379258, 5.0 / 18, 8}, {0.5, 4.0 / 9, 8}, {0.887298334620742, 5.0 / 18, 8}};

inline std::span<const Ring> rings_of(int rule) {
    switch (rule) {
        case 1:
            return kOnePoint;
        case 2:
            return kFourPoints;
        case 3:
            return kSevenPoints;
        default:
            return kTwentyFourPoints;
    }
}

/// The relative error of rule k for a light of relative size x is about (x / reach)^2k: measured over random lobes,
/// views and lights (95th percentile).
inline constexpr std::array<double, 4> kReach = {0.7, 1, 1, 1};

}  // namespace shlight
#endif

HWY_BEFORE_NAMESPACE();
namespace shlight {
namespace HWY_NAMESPACE {
namespace {

/// A circle and a view, rounded to float where that loses nothing.
struct SeenCircle {
    V<Floats> x, y, z, cosine, sine;
    HalfSum half;  // axis + view, summed in double
    V<Floats> cos_o;
};

template <class Circles, class Views>
HWY_INLINE SeenCircle seen(const CircleArrays& circles, const ViewArrays& views, const Circles& circle,
                           const Views& view) {
    SeenCircle s;
    s.x = circle.load(circles.x);
    s.y = circle.load(circles.y);
    s.z = circle.load(circles.z);
    s.cosine = circle.load(circles.cosine);
    s.sine = circle.load(circles.sine);
    s.half.x = rounded_sum(circle.pair(circles.x), view.pair(views.x));
    s.half.y = s.y;
    s.half.z = rounded_sum(circle.pair(circles.z), view.pair(views.z));
    s.cos_o = view.load(views.z);
    return s;
}

/// The square of how large a light looks to a lobe: its half angle over the least distance on which f·cos changes near
/// its middle. On the sphere where the bell is round, (h_x/α, h_y/α, h_z) normalised, a step of the direction is at
/// most 1/α long before normalising.
HWY_INLINE V<Floats> squared_size(float alpha2, const SeenCircle& s) {
    const Floats d;
    const auto angle = arctangent(d, s.sine, s.cosine);
    const auto across = hn::MulAdd(s.half.x, s.half.x, hn::Mul(s.half.y, s.half.y));
    const auto scale = hn::MulAdd(hn::Mul(hn::Set(d, alpha2), s.half.z), s.half.z, across);
    return hn::Div(hn::Mul(angle, angle), scale);
}

template <class Circles, class Views>
HWY_INLINE V<hn::RebindToUnsigned<Floats>> rule_of(float alpha2, const CircleArrays& circles, const ViewArrays& views,
                                                   const float* tolerances, const Circles& circle, const Views& view) {
    const Floats d;
    const hn::RebindToUnsigned<Floats> du;
    const SeenCircle s = seen(circles, views, circle, view);
    const auto tolerance = view.load(tolerances);
    const auto square = squared_size(alpha2, s);
    auto power = square;
    std::array<V<Floats>, kReach.size()> errors;
    for (std::size_t i = 0; i < kReach.size(); ++i) {
        errors[i] = hn::Mul(power, all(d, 1 / std::pow(kReach[i], 2 * (static_cast<double>(i) + 1))));
        power = hn::Mul(power, square);
    }
    auto rule = hn::Zero(du);
    for (std::size_t i = kReach.size(); i-- > 0;) {
        rule = hn::IfThenElse(hn::RebindMask(du, hn::Le(errors[i], tolerance)),
                              hn::Set(du, static_cast<std::uint32_t>(i + 1)), rule);
    }
    rule = hn::IfThenElseZero(hn::RebindMask(du, hn::Ge(s.z, s.sine)), rule);
    return hn::IfThenElse(hn::RebindMask(du, hn::Le(s.z, hn::Neg(s.sine))), hn::Set(du, kCapHidden), rule);
}

template <class Views>
void choose_rules(float alpha2, const CircleArrays& circles, const ViewArrays& views, const float* tolerances,
                  std::span<const std::uint32_t> view_of, std::span<std::uint8_t> rules) {
    const hn::Rebind<std::uint8_t, Floats> d8;
    constexpr std::size_t kLanes = kLaneCount<Floats>;
    std::size_t i = 0;
    for (; i + kLanes <= rules.size(); i += kLanes) {
        const auto rule = rule_of(alpha2, circles, views, tolerances, Neighbours(i), Views(view_of.data() + i, kLanes));
        hn::StoreU(hn::U8FromU32(rule), d8, rules.data() + i);
    }
    if (const std::size_t rest = rules.size() - i; rest > 0) {
        std::array<std::uint32_t, kLanes> last{};
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            last[lane] = static_cast<std::uint32_t>(i + std::min(lane, rest - 1));
        }
        const auto rule = rule_of(alpha2, circles, views, tolerances, Scattered(last.data(), kLanes),
                                  Views(view_of.data() + i, rest));
        store_some(d8, hn::U8FromU32(rule), rest, rules.data() + i);
    }
}

void choose_cap_rules_in_lanes(const GgxShape& shape, const CircleArrays& circles, const ViewArrays& views,
                               const float* tolerances, std::span<const std::uint32_t> view_of,
                               std::span<std::uint8_t> rules) {
    const auto alpha2 = static_cast<float>(shape.alpha * shape.alpha);
    if (views.shared) {
        choose_rules<Same>(alpha2, circles, views, tolerances, view_of, rules);
    } else {
        choose_rules<Scattered>(alpha2, circles, views, tolerances, view_of, rules);
    }
}

/// Two vectors at right angles to a unit axis, as perpendicular() chooses them.
struct Tangents {
    HalfSum u, v;
};

HWY_INLINE Tangents tangents(const SeenCircle& s) {
    const Floats d;
    const auto zero = hn::Zero(d);
    const auto flat = hn::Lt(hn::Abs(s.z), all(d, 0.9));
    const auto other = hn::IfThenElse(flat, s.x, s.z);
    const auto inverse = hn::Div(all(d, 1), hn::Sqrt(hn::MulAdd(s.y, s.y, hn::Mul(other, other))));
    const auto y = hn::Mul(s.y, inverse);
    const auto o = hn::Mul(other, inverse);
    Tangents t;
    // z × axis, or x × axis near the poles.
    t.u = {hn::IfThenElse(flat, hn::Neg(y), zero), hn::IfThenElse(flat, o, hn::Neg(o)), hn::IfThenElse(flat, zero, y)};
    t.v = {hn::NegMulAdd(s.z, t.u.y, hn::Mul(s.y, t.u.z)), hn::NegMulAdd(s.x, t.u.z, hn::Mul(s.z, t.u.x)),
           hn::NegMulAdd(s.y, t.u.x, hn::Mul(s.x, t.u.y))};
    return t;
}

/// Cosines and sines of a ring's spokes, over the circle.
struct Spokes {
    std::array<float, 8> cosine, sine;

    Spokes(int count, double phase) {
        for (int i = 0; i < count; ++i) {
            const double phi = 2 * std::numbers::pi * (i + phase) / count;
            cosine[i] = static_cast<float>(std::cos(phi));
            sine[i] = static_cast<float>(std::sin(phi));
        }
    }
};

/// A rule, as the loop over its points reads it.
class CapRule {
  public:
    explicit CapRule(int rule) : rings_(rings_of(rule)) {
        double phase = 0;
        for (std::size_t i = 0; i < rings_.size(); ++i) {
            spokes_[i] = Spokes(rings_[i].spokes, phase);
            phase = 0.5 - phase;
        }
    }

    template <Fresnel kFresnel>
    HWY_INLINE V<Floats> integral(const GgxLanes<kFresnel>& lobe, const SeenCircle& s) const {
        const Floats d;
        const auto height = hn::Div(hn::Mul(s.sine, s.sine), hn::Add(all(d, 1), s.cosine));  // 1 - cosσ
        const auto masking_o = lobe.masking(s.cos_o);
        const Tangents t = tangents(s);
        auto sum = hn::Zero(d);
        for (std::size_t i = 0; i < rings_.size(); ++i) {
            const Ring& ring = rings_[i];
            const auto drop = hn::Mul(height, all(d, ring.inside));  // 1 - cosine of the ring's angle
            const auto sine = hn::Sqrt(hn::Mul(drop, hn::Sub(all(d, 2), drop)));
            const HalfSum middle = {hn::NegMulAdd(drop, s.x, s.half.x), hn::NegMulAdd(drop, s.y, s.half.y),
                                    hn::NegMulAdd(drop, s.z, s.half.z)};
            const auto middle_cos_i = hn::NegMulAdd(drop, s.z, s.z);
            auto around = hn::Zero(d);
            for (int k = 0; k < ring.spokes; ++k) {
                const auto a = hn::Mul(sine, hn::Set(d, spokes_[i].cosine[k]));
                const auto b = hn::Mul(sine, hn::Set(d, spokes_[i].sine[k]));
                const auto rise = hn::MulAdd(a, t.u.z, hn::Mul(b, t.v.z));
                const HalfSum half = {hn::MulAdd(a, t.u.x, hn::MulAdd(b, t.v.x, middle.x)),
                                      hn::MulAdd(a, t.u.y, hn::MulAdd(b, t.v.y, middle.y)), hn::Add(middle.z, rise)};
                around = hn::Add(around, lobe.value(half, hn::Add(middle_cos_i, rise), s.cos_o, masking_o));
            }
            sum = hn::MulAdd(around, all(d, ring.weight / ring.spokes), sum);
        }
        return hn::Mul(hn::Mul(all(d, 2 * std::numbers::pi), height), sum);
    }

  private:
    std::span<const Ring> rings_;
    std::array<Spokes, 3> spokes_ = {Spokes(0, 0), Spokes(0, 0), Spokes(0, 0)};
};

template <Fresnel kFresnel, class Views>
void integrate(const GgxShape& shape, const CircleArrays& circles, std::span<const std::uint32_t> circle_of,
               const ViewArrays& views, std::span<const std::uint32_t> view_of, int rule, std::span<float> values) {
    const Floats d;
    constexpr std::size_t kLanes = kLaneCount<Floats>;
    const GgxLanes<kFresnel> lobe(shape);
    const CapRule cap_rule(rule);
    for (std::size_t i = 0; i < values.size(); i += kLanes) {
        const std::size_t count = std::min(kLanes, values.size() - i);
        const SeenCircle s =
            seen(circles, views, Scattered(circle_of.data() + i, count), Views(view_of.data() + i, count));
        store_some(d, cap_rule.integral(lobe, s), count, values.data() + i);
    }
}

template <Fresnel kFresnel>
void integrate_any(const GgxShape& shape, const CircleArrays& circles, std::span<const std::uint32_t> circle_of,
                   const ViewArrays& views, std::span<const std::uint32_t> view_of, int rule, std::span<float> values) {
    if (views.shared) {
        integrate<kFresnel, Same>(shape, circles, circle_of, views, view_of, rule, values);
    } else {
        integrate<kFresnel, Scattered>(shape, circles, circle_of, views, view_of, rule, values);
    }
}

void integrate_caps_in_lanes(const GgxShape& shape, const CircleArrays& circles,
                             std::span<const std::uint32_t> circle_of, const ViewArrays& views,
                             std::span<const std::uint32_t> view_of, int rule, std::span<float> values) {
    switch (shape.fresnel) {
        case Fresnel::one:
            return integrate_any<Fresnel::one>(shape, circles, circle_of, views, view_of, rule, values);
        case Fresnel::schlick:
            return integrate_any<Fresnel::schlick>(shape, circles, circle_of, views, view_of, rule, values);
        case Fresnel::dielectric:
            return integrate_any<Fresnel::dielectric>(shape, circles, circle_of, views, view_of, rule, values);
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace shlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(choose_cap_rules_in_lanes);
HWY_EXPORT(integrate_caps_in_lanes);

void choose_cap_rules(const GgxShape& shape, const CircleArrays& circles, const ViewArrays& views,
                      const float* tolerances, std::span<const std::uint32_t> view_of, std::span<std::uint8_t> rules) {
    HWY_DYNAMIC_DISPATCH(choose_cap_rules_in_lanes)(shape, circles, views, tolerances, view_of, rules);
}

void integrate_caps(const GgxShape& shape, const CircleArrays& circles, std::span<const std::uint32_t> circle_of,
                    const ViewArrays& views, std::span<const std::uint32_t> view_of, int rule,
                    std::span<float> values) {
    HWY_DYNAMIC_DISPATCH(integrate_caps_in_lanes)(shape, circles, circle_of, views, view_of, rule, values);
}

int cap_rule_points(int rule) {
    int points = 0;
    for (const Ring& ring : rings_of(rule)) {
        points += ring.spokes;
    }
    return points;
}

}  // namespace shlight
#endif
