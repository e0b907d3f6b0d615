// SPDX-License-Identifier: MIT
#include "caps/cap_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "caps/single_caps.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>

#include "caps/cap_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

// Single caps: all lanes are the same light.

template <class T>
CapLanes<Lanes<T>> in_all_lanes(const Cap<T>& cap) {
    const Lanes<T> d;
    const auto set = [&](T x) HWY_ATTR { return hn::Set(d, x); };
    const T edge_height = std::cos(cap.edge) * cap.sin_half * cap.sin_tilt;
    return {set(cap.cos_tilt), set(cap.sin_tilt),    set(cap.cos_azimuth),    set(cap.sin_azimuth), set(cap.cos_half),
            set(cap.sin_half), set(cap.arc),         set(cap.cos_arc),        set(cap.sin_arc),     set(cap.edge),
            set(edge_height),  set(cap.solid_angle), set(cap.horizon_height), set(cap.horizon_sine)};
}

Cap<double> first_lane(const CapLanes<Doubles>& cap, bool crossing) {
    return {hn::GetLane(cap.cos_tilt),    hn::GetLane(cap.sin_tilt),    hn::GetLane(cap.cos_azimuth),
            hn::GetLane(cap.sin_azimuth), hn::GetLane(cap.cos_half),    hn::GetLane(cap.sin_half),
            hn::GetLane(cap.arc),         hn::GetLane(cap.cos_arc),     hn::GetLane(cap.sin_arc),
            hn::GetLane(cap.edge),        hn::GetLane(cap.solid_angle), crossing,
            hn::GetLane(cap.height),      hn::GetLane(cap.horizon_sine)};
}

CircleLanes<Doubles> in_all_lanes(const Circle& circle) {
    const Doubles d;
    CircleLanes<Doubles> lanes{hn::Set(d, circle.axis.x),
                               hn::Set(d, circle.axis.y),
                               hn::Set(d, circle.axis.z),
                               hn::Set(d, circle.cosine),
                               hn::Set(d, circle.sine),
                               hn::Zero(d),
                               hn::Zero(d)};
    set_squares(d, lanes);
    return lanes;
}

/// crossing_squared: null if it is to be taken from the circle.
void inside_circle(const Circle& circle, const double* crossing, const Circle& image, double height, double sine,
                   Cap<double>& out) {
    const Doubles d;
    CircleLanes<Doubles> light = in_all_lanes(circle);
    if (crossing != nullptr) {
        light.crossing_squared = hn::Set(d, *crossing);
    }
    const auto shrink = hn::Set(d, circle.sine > 0 ? image.sine / circle.sine : 1);
    const auto contact = contact_of_image(d, light, in_all_lanes(image), shrink, hn::Set(d, height), hn::Set(d, sine));
    out = first_lane(cap_in_contact(d, contact), hn::GetLane(light.crossing_squared) > 0);
}

void in_contact(const Contact& c, Cap<double>& out) {
    const Doubles d;
    const ContactLanes<Doubles> contact{
        in_all_lanes(c.light), hn::Set(d, c.height), hn::Set(d, c.sine), hn::Set(d, c.chord * c.chord),
        hn::Set(d, c.corner),  hn::Set(d, c.arc),    hn::Set(d, c.edge)};
    out = first_lane(cap_in_contact(d, contact), c.chord > 0);
}

/// Visits the bands from 1 on, by the recurrences that the cap needs.
template <bool kPlane, class T, class Visit>
void visit_bands(const Cap<T>& cap, const CapLanes<Lanes<T>>& lanes, std::size_t order, Visit& visit) {
    const BandChoice<T> choice(order);
    const auto solve = [&](auto&& bands) HWY_ATTR {
        for (std::size_t l = 1; l < order; ++l) {
            bands.solve(l, visit);
        }
    };
    const auto choose = [&]<bool kCrossing>(std::bool_constant<kCrossing> /*crossing*/) HWY_ATTR {
        using Bands = BandsOf<T, kCrossing, kPlane, true>;
        if (hn::AllTrue(Lanes<T>(), choice.template others<kCrossing>(lanes))) {
            solve(typename Bands::Others(lanes, order));
        } else {
            solve(typename Bands::Most(lanes, order));
        }
    };
    if (cap.crossing) {
        choose(std::true_type());
    } else {
        choose(std::false_type());
    }
}

/// One number of each term.
template <class T>
class TermVisitor {
    using D = Lanes<T>;

  public:
    explicit TermVisitor(T* terms) : terms_(terms) {}

    struct Band {};
    Band open(std::size_t /*l*/) { return {}; }
    struct Turn {};
    Turn turn(std::size_t /*m*/) const { return {}; }
    void put_zonal(const Band& /*band*/, V<D> value) { values_.put(0, value); }
    void put(const Band& /*band*/, std::size_t m, Turn /*turn*/, V<D> value) { values_.put(m, value); }
    void close(const Band& /*band*/, std::size_t l) {
        for (std::size_t m = 0; m <= l; ++m) {
            give(l, m, values_[m]);
        }
    }

    /// A band whose values are to be multiplied with `share`.
    struct Part {
        V<D> share;
    };
    Part open(std::size_t /*l*/, V<D> share) { return {share}; }
    void put(const Part& part, std::size_t m, V<D> null) { values_.put(m, hn::Mul(part.share, null)); }
    void close(const Part& part, std::size_t l, V<D> null, V<D> extra) {
        values_.put(0, hn::MulAdd(part.share, null, extra));
        close(Band(), l);
    }

    void term(Band& /*band*/, std::size_t m, V<D> /*null*/, V<D> particular) { values_.put(m, particular); }
    template <class Bands>
    void close(const Band& /*band*/, std::size_t l, V<D> green, V<D> share, const Bands& bands) {
        for (std::size_t m = 0; m <= l; ++m) {
            give(l, m, hn::MulAdd(share, bands.null(m), hn::Mul(green, values_[m])));
        }
    }

  private:
    void give(std::size_t l, std::size_t m, V<D> value) {
        terms_[at(static_cast<int>(l), static_cast<int>(m))] =
            hn::GetLane(value) * (m == 0 ? T(1) : std::numbers::sqrt2_v<T>);
    }

    T* terms_;
    DegreeRow<T> values_;
};

template <class T>
void terms_of(const Cap<T>& cap, std::size_t order, T* terms) {
    const auto lanes = in_all_lanes(cap);
    TermVisitor<T> visit(terms);
    terms[0] = hn::GetLane(band_zero(Lanes<T>(), lanes));
    visit_bands<false>(cap, lanes, order, visit);
}

template <class T>
T shaded(const Cap<T>& cap, const T* lobe_terms, std::size_t order) {
    const Lanes<T> d;
    const auto lanes = in_all_lanes(cap);
    alignas(64) std::array<T, kCosineMax * kLaneCount<Lanes<T>>> terms;
    for (std::size_t k = 0; k < order * (order + 1) / 2; ++k) {
        hn::Store(hn::Set(d, lobe_terms[k]), d, terms.data() + k * kLaneCount<Lanes<T>>);
    }
    ShadingVisitor<T> visit(lanes, order, terms.data());
    visit_bands<false>(cap, lanes, order, visit);
    return hn::GetLane(visit.sum());
}

template <class T>
void row_of(const Cap<T>& cap, std::size_t order, T* row) {
    const auto lanes = in_all_lanes(cap);
    RowPointers<T> rows;
    rows.fill(row);
    CoefficientVisitor<T> visit(lanes, order, rows, Output::cached);
    visit_bands<true>(cap, lanes, order, visit);
    visit.finish();
}

void terms_float(const Cap<float>& cap, std::size_t order, float* terms) {
    terms_of(cap, order, terms);
}
void terms_double(const Cap<double>& cap, std::size_t order, double* terms) {
    terms_of(cap, order, terms);
}
float shaded_float(const Cap<float>& cap, const float* lobe_terms, std::size_t order) {
    return shaded(cap, lobe_terms, order);
}
double shaded_double(const Cap<double>& cap, const double* lobe_terms, std::size_t order) {
    return shaded(cap, lobe_terms, order);
}
void row_float(const Cap<float>& cap, std::size_t order, float* row) {
    row_of(cap, order, row);
}
void row_double(const Cap<double>& cap, std::size_t order, double* row) {
    row_of(cap, order, row);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(inside_circle);
HWY_EXPORT(in_contact);
HWY_EXPORT(terms_float);
HWY_EXPORT(terms_double);
HWY_EXPORT(shaded_float);
HWY_EXPORT(shaded_double);
HWY_EXPORT(row_float);
HWY_EXPORT(row_double);

Cap<double> cap_inside(const Circle& circle, double crossing_squared, const Warp& warp) {
    Cap<double> cap;
    HWY_DYNAMIC_DISPATCH(inside_circle)
    (circle, &crossing_squared, warp.is_identity() ? circle : warp.warped(circle), warp.horizon_height(),
     warp.horizon_sine(), cap);
    return cap;
}
Cap<double> cap_inside(const Circle& circle, const Warp& warp) {
    Cap<double> cap;
    HWY_DYNAMIC_DISPATCH(inside_circle)
    (circle, nullptr, warp.is_identity() ? circle : warp.warped(circle), warp.horizon_height(), warp.horizon_sine(),
     cap);
    return cap;
}

Cap<double> cap_in_contact(const Contact& contact) {
    Cap<double> cap;
    HWY_DYNAMIC_DISPATCH(in_contact)(contact, cap);
    return cap;
}

void terms_of_cap(const Cap<float>& cap, int order, float* cosine_terms) {
    HWY_DYNAMIC_DISPATCH(terms_float)(cap, static_cast<std::size_t>(order), cosine_terms);
}
void terms_of_cap(const Cap<double>& cap, int order, double* cosine_terms) {
    HWY_DYNAMIC_DISPATCH(terms_double)(cap, static_cast<std::size_t>(order), cosine_terms);
}
float shade_one_cap(const Cap<float>& cap, const float* lobe_terms, int order) {
    return HWY_DYNAMIC_DISPATCH(shaded_float)(cap, lobe_terms, static_cast<std::size_t>(order));
}
double shade_one_cap(const Cap<double>& cap, const double* lobe_terms, int order) {
    return HWY_DYNAMIC_DISPATCH(shaded_double)(cap, lobe_terms, static_cast<std::size_t>(order));
}
void row_of_cap(const Cap<float>& cap, int order, float* row) {
    HWY_DYNAMIC_DISPATCH(row_float)(cap, static_cast<std::size_t>(order), row);
}
void row_of_cap(const Cap<double>& cap, int order, double* row) {
    HWY_DYNAMIC_DISPATCH(row_double)(cap, static_cast<std::size_t>(order), row);
}

}  // namespace shlight
#endif
