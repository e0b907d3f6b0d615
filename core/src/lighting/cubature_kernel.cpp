// SPDX-License-Identifier: MIT
#include "lighting/cubature_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lighting/cubature_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lobes/lobe_lanes-inl.h"
#include "simd/gather-inl.h"
#include "simd/lanes-inl.h"

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

/// A rule's relative error for a light of relative size x is about (x / reach)^(2 half_power): measured over random
/// lobes, views and lights (95th percentile).
struct RuleError {
    double reach;
    int half_power;
};
inline constexpr std::array<RuleError, 4> kCapErrors = {RuleError{0.7, 1}, {1.0, 2}, {1.0, 3}, {1.0, 4}};
inline constexpr std::array<RuleError, 4> kPolygonErrors = {RuleError{1.5, 2}, {1.65, 3}, {1.6, 4}, {1.6, 5}};

/// Relative size of a polygon per radian: the projection of the sphere onto a plane varies like a lobe.
inline constexpr double kFlatness = 1.2;

}  // namespace shlight
#endif

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// A circle and a view, rounded to float where that loses nothing.
struct SeenCircle {
    V<Floats> x, y, z, cosine, sine;
    HalfSum half;  // axis + view, summed in double
    V<Floats> cos_o;
};

template <class Circles, class Views>
HWY_INLINE SeenCircle seen(const CapArrays& circles, const ViewArrays& views, const Circles& circle,
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

/// 1 ÷ the squared least distance over which f·cos changes near a light's middle, given the sum of its direction and
/// the view. On the sphere of (h_x/α, h_y/α, h_z), where the lobe is round, a step of the direction is at most 1/α long
/// before normalising.
HWY_INLINE V<Floats> squared_change(V<Floats> width, const HalfSum& half) {
    const Floats d;
    const auto across = hn::MulAdd(half.x, half.x, hn::Mul(half.y, half.y));
    return hn::Div(all(d, 1), hn::MulAdd(hn::Mul(hn::Mul(width, width), half.z), half.z, across));
}

/// The first rule whose error is at most the tolerance. square: of the light's size beside the lobe.
HWY_INLINE V<hn::RebindToUnsigned<Floats>> smallest_rule(const std::array<RuleError, 4>& rules, V<Floats> square,
                                                         V<Floats> tolerance) {
    const Floats d;
    const hn::RebindToUnsigned<Floats> du;
    auto rule = hn::Zero(du);
    for (std::size_t i = rules.size(); i-- > 0;) {
        const auto step = hn::Mul(square, all(d, 1 / (rules[i].reach * rules[i].reach)));
        auto error = step;
        for (int k = 1; k < rules[i].half_power; ++k) {
            error = hn::Mul(error, step);
        }
        rule = hn::IfThenElse(hn::RebindMask(du, hn::Le(error, tolerance)),
                              hn::Set(du, static_cast<std::uint32_t>(i + 1)), rule);
    }
    return rule;
}

template <class Lights, class Views>
HWY_INLINE V<hn::RebindToUnsigned<Floats>> rule_of(const float* widths, const CapArrays& circles,
                                                   const ViewArrays& views, const Lights& light, const Views& view,
                                                   V<Floats> tolerance) {
    const Floats d;
    const hn::RebindToUnsigned<Floats> du;
    const SeenCircle s = seen(circles, views, light, view);
    const auto angle = arctangent(d, s.sine, s.cosine);
    auto rule =
        smallest_rule(kCapErrors, hn::Mul(hn::Mul(angle, angle), squared_change(view.load(widths), s.half)), tolerance);
    rule = hn::IfThenElseZero(hn::RebindMask(du, hn::Ge(s.z, s.sine)), rule);
    return hn::IfThenElse(hn::RebindMask(du, hn::Le(s.z, hn::Neg(s.sine))), hn::Set(du, kHidden), rule);
}

template <class Lights, class Views>
HWY_INLINE V<hn::RebindToUnsigned<Floats>> rule_of(const float* widths, const PolygonArrays& polygons,
                                                   const ViewArrays& views, const Lights& light, const Views& view,
                                                   V<Floats> tolerance) {
    const Floats d;
    const hn::RebindToUnsigned<Floats> du;
    const HalfSum half = {rounded_sum(light.pair(polygons.x), view.pair(views.x)), light.load(polygons.y),
                          rounded_sum(light.pair(polygons.z), view.pair(views.z))};
    const auto angle = light.load(polygons.half_angle);
    const auto change = hn::Max(squared_change(view.load(widths), half), all(d, kFlatness * kFlatness));
    const auto rule = smallest_rule(kPolygonErrors, hn::Mul(hn::Mul(angle, angle), change), tolerance);
    return hn::IfThenElse(hn::RebindMask(du, hn::Lt(angle, hn::Zero(d))), hn::Set(du, kHidden), rule);
}

template <class Views, class Arrays>
void choose_rules(const float* widths, const Arrays& lights, const ViewArrays& views, const float* tolerances,
                  std::span<const std::uint32_t> view_of, std::span<std::uint8_t> rules) {
    const hn::Rebind<std::uint8_t, Floats> d8;
    constexpr std::size_t kLanes = kLaneCount<Floats>;
    std::size_t i = 0;
    for (; i + kLanes <= rules.size(); i += kLanes) {
        const Views view(view_of.data() + i, kLanes);
        const auto rule = rule_of(widths, lights, views, Contiguous(i), view, view.load(tolerances));
        hn::StoreU(hn::U8FromU32(rule), d8, rules.data() + i);
    }
    if (const std::size_t rest = rules.size() - i; rest > 0) {
        std::array<std::uint32_t, kLanes> last{};
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            last[lane] = static_cast<std::uint32_t>(i + std::min(lane, rest - 1));
        }
        const Views view(view_of.data() + i, rest);
        const auto rule = rule_of(widths, lights, views, Gather(last.data(), kLanes), view, view.load(tolerances));
        store_some(d8, hn::U8FromU32(rule), rest, rules.data() + i);
    }
}

template <class Arrays>
void choose_any_rules(const float* widths, const Arrays& lights, const ViewArrays& views, const float* tolerances,
                      std::span<const std::uint32_t> view_of, std::span<std::uint8_t> rules) {
    if (views.shared) {
        choose_rules<Broadcast>(widths, lights, views, tolerances, view_of, rules);
    } else {
        choose_rules<Gather>(widths, lights, views, tolerances, view_of, rules);
    }
}

void choose_cap_rules_in_lanes(const float* widths, const CapArrays& circles, const ViewArrays& views,
                               const float* tolerances, std::span<const std::uint32_t> view_of,
                               std::span<std::uint8_t> rules) {
    choose_any_rules(widths, circles, views, tolerances, view_of, rules);
}

void choose_polygon_rules_in_lanes(const float* widths, const PolygonArrays& polygons, const ViewArrays& views,
                                   const float* tolerances, std::span<const std::uint32_t> view_of,
                                   std::span<std::uint8_t> rules) {
    choose_any_rules(widths, polygons, views, tolerances, view_of, rules);
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

    template <class Lobe>
    HWY_INLINE V<Floats> integral(const Lobe& lobe, const SeenCircle& s, V<Floats> parameter) const {
        const Floats d;
        const auto height = hn::Div(hn::Mul(s.sine, s.sine), hn::Add(all(d, 1), s.cosine));  // 1 - cosσ
        const auto view = lobe.view(d, s.cos_o, parameter);
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
                const auto cos_i = hn::Add(middle_cos_i, rise);
                const auto above = hn::Gt(hn::Min(cos_i, s.cos_o), hn::Zero(d));
                around = hn::Add(around, hn::IfThenElseZero(above, lobe.value(half, cos_i, view)));
            }
            sum = hn::MulAdd(around, all(d, ring.weight / ring.spokes), sum);
        }
        return hn::Mul(hn::Mul(all(d, 2 * std::numbers::pi), height), sum);
    }

  private:
    std::span<const Ring> rings_;
    std::array<Spokes, 3> spokes_ = {Spokes(0, 0), Spokes(0, 0), Spokes(0, 0)};
};

template <class Views, class Lobe>
void integrate(const Lobe& lobe, const float* parameters, const CapArrays& circles,
               std::span<const std::uint32_t> circle_of, const ViewArrays& views,
               std::span<const std::uint32_t> view_of, int rule, std::span<float> values) {
    const Floats d;
    constexpr std::size_t kLanes = kLaneCount<Floats>;
    const CapRule cap_rule(rule);
    for (std::size_t i = 0; i < values.size(); i += kLanes) {
        const std::size_t count = std::min(kLanes, values.size() - i);
        const Views view(view_of.data() + i, count);
        const SeenCircle s = seen(circles, views, Gather(circle_of.data() + i, count), view);
        store_some(d, cap_rule.integral(lobe, s, view.load(parameters)), count, values.data() + i);
    }
}

void integrate_caps_in_lanes(const LobeShape& shape, const float* parameters, const CapArrays& circles,
                             std::span<const std::uint32_t> circle_of, const ViewArrays& views,
                             std::span<const std::uint32_t> view_of, int rule, std::span<float> values) {
    with_lobe_lanes(shape, [&](const auto& lobe) {
        if (views.shared) {
            integrate<Broadcast>(lobe, parameters, circles, circle_of, views, view_of, rule, values);
        } else {
            integrate<Gather>(lobe, parameters, circles, circle_of, views, view_of, rule, values);
        }
    });
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(choose_cap_rules_in_lanes);
HWY_EXPORT(choose_polygon_rules_in_lanes);
HWY_EXPORT(integrate_caps_in_lanes);

void choose_cap_rules(const float* widths, const CapArrays& circles, const ViewArrays& views, const float* tolerances,
                      std::span<const std::uint32_t> view_of, std::span<std::uint8_t> rules) {
    HWY_DYNAMIC_DISPATCH(choose_cap_rules_in_lanes)(widths, circles, views, tolerances, view_of, rules);
}

void choose_polygon_rules(const float* widths, const PolygonArrays& polygons, const ViewArrays& views,
                          const float* tolerances, std::span<const std::uint32_t> view_of,
                          std::span<std::uint8_t> rules) {
    HWY_DYNAMIC_DISPATCH(choose_polygon_rules_in_lanes)(widths, polygons, views, tolerances, view_of, rules);
}

void integrate_caps(const LobeShape& shape, const float* parameters, const CapArrays& circles,
                    std::span<const std::uint32_t> circle_of, const ViewArrays& views,
                    std::span<const std::uint32_t> view_of, int rule, std::span<float> values) {
    HWY_DYNAMIC_DISPATCH(integrate_caps_in_lanes)(shape, parameters, circles, circle_of, views, view_of, rule, values);
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
