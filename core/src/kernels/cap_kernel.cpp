// SPDX-License-Identifier: MIT
#include "kernels/cap_kernel.h"

#include <hwy/cache_control.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/cap_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "kernels/cap_batch-inl.h"
#include "kernels/cap_spheres-inl.h"
#include "kernels/cap_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// Spheres and their rows.
template <class T>
struct SphereSource {
    static constexpr bool kMayContainHorizon = false;

    const Vec3<T>* centers;
    const T* radii;

    HWY_INLINE CircleLanes<Lanes<T>> load(const Chosen<T>& chosen) const {
        const Lanes<T> d;
        constexpr std::size_t kLanes = kLaneCount<Lanes<T>>;
        V<Lanes<T>> x, y, z, r;
        if (are_in_a_row(chosen)) {
            hn::LoadInterleaved3(d, &centers[chosen.front()].x, x, y, z);
            r = hn::LoadU(d, radii + chosen.front());
        } else {
            alignas(64) std::array<T, 3 * kLanes> c;
            alignas(64) std::array<T, kLanes> own_radii;
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const Vec3<T>& center = centers[chosen[lane]];
                c[3 * lane] = center.x;
                c[3 * lane + 1] = center.y;
                c[3 * lane + 2] = center.z;
                own_radii[lane] = radii[chosen[lane]];
            }
            hn::LoadInterleaved3(d, c.data(), x, y, z);
            r = hn::Load(d, own_radii.data());
        }
        return circle_of_sphere_in_lanes(d, x, y, z, r);
    }

    /// Whether neighbouring spheres cross the plane z = 0, a bit for each; 16 bits higher, whether they are below it.
    HWY_INLINE std::uint32_t sides(std::size_t first, std::size_t count) const {
        const Lanes<T> d;
        V<Lanes<T>> x, y, z, r;
        if (count == kLaneCount<Lanes<T>>) {
            hn::LoadInterleaved3(d, &centers[first].x, x, y, z);
            r = hn::LoadU(d, radii + first);
        } else {
            std::array<T, kLaneCount<Lanes<T>>> heights, own_radii;
            for (std::size_t lane = 0; lane < heights.size(); ++lane) {
                const std::size_t i = first + std::min(lane, count - 1);
                heights[lane] = centers[i].z;
                own_radii[lane] = radii[i];
            }
            z = hn::LoadU(d, heights.data());
            r = hn::LoadU(d, own_radii.data());
        }
        const std::uint32_t crossing = bits_of(d, hn::Lt(hn::Abs(z), r));
        const std::uint32_t hidden = bits_of(d, hn::Le(z, hn::Neg(r)));
        const std::uint32_t all_lanes = (1U << count) - 1;
        return (crossing & all_lanes) | (hidden & all_lanes) << 16;
    }
};

/// Circles, and their rows.
template <class T>
struct CircleSource {
    static constexpr bool kMayContainHorizon = true;

    const Circle* circles;

    HWY_INLINE CircleLanes<Lanes<T>> load(const Chosen<T>& chosen) const {
        constexpr std::size_t kLanes = kLaneCount<Lanes<T>>;
        constexpr std::size_t kHalf = kLaneCount<Doubles>;
        const Doubles dd;
        std::array<CircleLanes<Doubles>, kLanes / kHalf> halves;
        for (std::size_t first = 0; first < kLanes; first += kHalf) {
            alignas(64) std::array<std::array<double, kHalf>, 5> fields;
            for (std::size_t lane = 0; lane < kHalf; ++lane) {
                const Circle& circle = circles[chosen[first + lane]];
                fields[0][lane] = circle.axis.x;
                fields[1][lane] = circle.axis.y;
                fields[2][lane] = circle.axis.z;
                fields[3][lane] = circle.cosine;
                fields[4][lane] = circle.sine;
            }
            CircleLanes<Doubles>& half = halves[first / kHalf];
            half = {hn::Load(dd, fields[0].data()),
                    hn::Load(dd, fields[1].data()),
                    hn::Load(dd, fields[2].data()),
                    hn::Load(dd, fields[3].data()),
                    hn::Load(dd, fields[4].data()),
                    hn::Zero(dd),
                    hn::Zero(dd)};
            set_squares(dd, half);
        }
        return narrowed_circle<T>(halves.front(), halves.back());
    }

    std::uint32_t sides(std::size_t first, std::size_t count) const {
        std::uint32_t bits = 0;
        for (std::size_t j = 0; j < count; ++j) {
            const Circle& c = circles[first + j];
            const bool by_sine = c.sine < std::abs(c.cosine);
            const bool crossing =
                by_sine ? c.sine > std::abs(c.axis.z) : c.axis.x * c.axis.x + c.axis.y * c.axis.y > c.cosine * c.cosine;
            bits |= (crossing ? 1U : 0U) << j;
            bits |= (!crossing && c.axis.z < 0 && c.cosine >= 0 ? 1U : 0U) << (j + 16);
        }
        return bits;
    }
};

/// Writes coefficients to rows, order² values for each light.
template <class T>
class RowSink {
    using D = Lanes<T>;

  public:
    RowSink(std::size_t order, T* rows, Output output) : order_(order), rows_(rows), output_(output) {}

    std::size_t order() const { return order_; }
    void hide(std::size_t i) const { std::fill_n(rows_ + i * order_ * order_, order_ * order_, T(0)); }

    /// again: a few lanes of this vector were written before, and need other recurrences.
    template <class Bands>
    HWY_NOINLINE void take(const CapLanes<D>& cap, const Chosen<T>& chosen, bool again) const {
        RowPointers<T> rows;
        for (std::size_t lane = 0; lane < rows.size(); ++lane) {
            rows[lane] = rows_ + chosen[lane] * order_ * order_;
        }
        CoefficientVisitor<T> visit(cap, order_, rows, again ? Output::cached : output_);
        if (order_ > 1) {
            solve_bands(Bands(cap, order_), order_, visit);
        }
        visit.finish();
    }

  private:
    std::size_t order_;
    T* rows_;
    Output output_;
};

/// Multiplies with the terms of one lobe that all lights share.
class LobeSink {
    using D = Floats;

  public:
    LobeSink(std::size_t order, const float* terms, float* values) : order_(order), values_(values) {
        for (std::size_t k = 0; k < order * (order + 1) / 2; ++k) {
            hn::Store(hn::Set(D(), terms[k]), D(), terms_.data() + k * kLaneCount<D>);
        }
    }

    std::size_t order() const { return order_; }
    void hide(std::size_t i) const { values_[i] = 0; }

    template <class Bands>
    HWY_NOINLINE void take(const CapLanes<D>& cap, const Chosen<float>& chosen, bool /*again*/) const {
        ShadingVisitor<float> visit(cap, order_, terms_.data());
        solve_bands(Bands(cap, order_), order_, visit);
        alignas(64) std::array<float, kLaneCount<D>> sums;
        hn::Store(visit.sum(), D(), sums.data());
        for (std::size_t lane = 0; lane < sums.size(); ++lane) {
            values_[chosen[lane]] = sums[lane];
        }
    }

  private:
    std::size_t order_;
    float* values_;
    alignas(64) std::array<float, kCosineMax * kLaneCount<D>> terms_;
};

/// A whole batch against the plane z = 0, sorted by need.
template <class T, class Source, class Sink>
class PlaneBatch {
  public:
    PlaneBatch(const Source& source, const Sink& sink, bool clip)
        : source_(source), sink_(sink), clip_(clip), least_sine_(least_unscaled_sine<T>(sink.order())) {}

    HWY_INLINE void run(std::size_t first, std::size_t last) {
        crossing_.clear();
        uncrossed_.clear();
        constexpr std::size_t kLanes = kLaneCount<D>;
        for (std::size_t i = first; i < last; i += kLanes) {
            const std::size_t count = std::min(kLanes, last - i);
            const std::uint32_t all_lanes = (1U << count) - 1;
            const std::uint32_t sides = clip_ ? source_.sides(i, count) : 0;
            const std::uint32_t hidden = sides >> 16;
            crossing_.add_block(i, count, sides & all_lanes);
            uncrossed_.add_block(i, count, all_lanes & ~(sides | hidden));
            for (std::size_t j = 0; hidden >> j != 0; ++j) {
                if ((hidden >> j & 1U) != 0) {
                    sink_.hide(i + j);
                }
            }
        }
        run_group<true>(crossing_);
        run_group<false>(uncrossed_);
    }

  private:
    using D = Lanes<T>;

    template <bool kCrossing, bool kScaled>
    using Bands = std::conditional_t<kCrossing, CrossedBands<T, true, kScaled>,
                                     UncrossedBands<T, kScaled, Source::kMayContainHorizon>>;

    template <bool kCrossing>
    HWY_INLINE void run_group(const LightList& lights) {
        scaled_.clear();
        lights.for_each_vector<T>([&](const Chosen<T>& chosen) HWY_ATTR {
            const auto cap = load<kCrossing>(chosen);
            sink_.template take<Bands<kCrossing, false>>(cap, chosen, false);
            const auto scaled = needs_scaling(D(), cap, least_sine_);
            if (!hn::AllFalse(D(), scaled)) {
                scaled_.add_marked(D(), scaled, chosen);
            }
        });
        scaled_.for_each_vector<T>([&](const Chosen<T>& chosen) HWY_ATTR {
            sink_.template take<Bands<kCrossing, true>>(load<kCrossing>(chosen), chosen, true);
        });
    }

    template <bool kCrossing>
    HWY_INLINE CapLanes<D> load(const Chosen<T>& chosen) const {
        const D d;
        const auto circle = source_.load(chosen);
        if constexpr (kCrossing) {
            return cap_across_plane(d, circle);
        } else {
            return clip_ ? cap_off_plane(d, circle) : unclipped_cap(d, circle);
        }
    }

    Source source_;
    const Sink& sink_;
    bool clip_;
    double least_sine_;
    LightList crossing_, uncrossed_, scaled_;
};

template <class T, class Source, class Sink>
void run_batch(const Source& source, std::size_t count, bool clip, const Sink& sink) {
    PlaneBatch<T, Source, Sink> batch(source, sink, clip);
    for (std::size_t first = 0; first < count; first += LightList::kMost) {
        batch.run(first, std::min(count, first + LightList::kMost));
    }
}

template <class T, class Source>
void rows_of(const Source& source, std::size_t count, std::size_t order, bool clip, T* rows, Output output) {
    run_batch<T>(source, count, clip, RowSink<T>(order, rows, output));
    if (output == Output::streamed) {
        hwy::FlushStream();
    }
}

void shade_spheres_float(const Vec3<float>* centers, const float* radii, std::size_t count, std::size_t order,
                         const float* terms, float* values) {
    run_batch<float>(SphereSource<float>{centers, radii}, count, true, LobeSink(order, terms, values));
}

template <class T>
bool sound(const Vec3<T>* centers, const T* radii, std::size_t count) {
    const Lanes<T> d;
    constexpr std::size_t kLanes = kLaneCount<Lanes<T>>;
    auto fine = hn::Eq(hn::Zero(d), hn::Zero(d));
    const auto check = [&](const T* c, const T* radius) HWY_ATTR {
        V<Lanes<T>> x, y, z;
        hn::LoadInterleaved3(d, c, x, y, z);
        const auto r = hn::LoadU(d, radius);
        const auto square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
        // NaN and infinity fail one of these; squares that underflow or that are near to r² are left to the exact test.
        fine = hn::And(fine, hn::Gt(r, hn::Zero(d)));
        fine = hn::And(fine, hn::Gt(square, hn::Set(d, std::numeric_limits<T>::min() * T(1e6))));
        fine = hn::And(fine, hn::Lt(square, hn::Set(d, std::numeric_limits<T>::max())));
        fine = hn::And(fine, hn::Ge(square, hn::Mul(hn::Mul(r, r), all(d, 1 + 1e-6))));
    };
    std::size_t first = 0;
    for (; first + kLanes <= count; first += kLanes) {
        check(&centers[first].x, radii + first);
    }
    if (first < count) {
        std::array<Vec3<T>, kLanes> c;
        std::array<T, kLanes> r;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            c[lane] = centers[std::min(first + lane, count - 1)];
            r[lane] = radii[std::min(first + lane, count - 1)];
        }
        check(&c[0].x, r.data());
    }
    return hn::AllTrue(d, fine);
}

bool sound_float(const Vec3<float>* centers, const float* radii, std::size_t count) {
    return sound(centers, radii, count);
}
bool sound_double(const Vec3<double>* centers, const double* radii, std::size_t count) {
    return sound(centers, radii, count);
}
void sphere_rows_float(const Vec3<float>* centers, const float* radii, std::size_t count, std::size_t order, bool clip,
                       float* rows, Output output) {
    rows_of(SphereSource<float>{centers, radii}, count, order, clip, rows, output);
}
void sphere_rows_double(const Vec3<double>* centers, const double* radii, std::size_t count, std::size_t order,
                        bool clip, double* rows, Output output) {
    rows_of(SphereSource<double>{centers, radii}, count, order, clip, rows, output);
}
void circle_rows_float(const Circle* circles, std::size_t count, std::size_t order, bool clip, float* rows,
                       Output output) {
    rows_of(CircleSource<float>{circles}, count, order, clip, rows, output);
}
void circle_rows_double(const Circle* circles, std::size_t count, std::size_t order, bool clip, double* rows,
                        Output output) {
    rows_of(CircleSource<double>{circles}, count, order, clip, rows, output);
}

// Single caps: all lanes are the same light.

template <class T>
CapLanes<Lanes<T>> in_all_lanes(const Cap<T>& cap) {
    const Lanes<T> d;
    const auto set = [&](T x) HWY_ATTR { return hn::Set(d, x); };
    return {set(cap.cos_tilt),    set(cap.sin_tilt), set(cap.cos_azimuth), set(cap.sin_azimuth),
            set(cap.cos_half),    set(cap.sin_half), set(cap.arc),         set(cap.cos_arc),
            set(cap.sin_arc),     set(cap.edge),     set(cap.solid_angle), set(cap.horizon_height),
            set(cap.horizon_sine)};
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

/// Calls run(bands) with the recurrences that the cap needs.
template <bool kPlane, class T, class Run>
void with_bands(const Cap<T>& cap, const CapLanes<Lanes<T>>& lanes, std::size_t order, const Run& run) {
    const bool scaled = std::min(cap.sin_tilt, cap.horizon_sine) < static_cast<T>(least_unscaled_sine<T>(order));
    if (cap.crossing && scaled) {
        run(CrossedBands<T, kPlane, true>(lanes, order));
    } else if (cap.crossing) {
        run(CrossedBands<T, kPlane, false>(lanes, order));
    } else if (scaled) {
        run(UncrossedBands<T, true, true>(lanes, order));
    } else {
        run(UncrossedBands<T, false, true>(lanes, order));
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
    void term(Band& /*band*/, std::size_t m, V<D> null) { values_.put(m, null); }
    void term(Band& /*band*/, std::size_t m, V<D> /*null*/, V<D> particular) { values_.put(m, particular); }
    void close(const Band& /*band*/, std::size_t l, V<D> share, V<D> extra) {
        for (std::size_t m = 0; m <= l; ++m) {
            const auto value = hn::Mul(share, values_[m]);
            put(l, m, m == 0 ? hn::Add(value, extra) : value);
        }
    }
    template <class Bands>
    void close(const Band& /*band*/, std::size_t l, V<D> green, V<D> share, const Bands& bands) {
        for (std::size_t m = 0; m <= l; ++m) {
            put(l, m, hn::MulAdd(share, bands.null(m), hn::Mul(green, values_[m])));
        }
    }

  private:
    void put(std::size_t l, std::size_t m, V<D> value) {
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
    with_bands<false>(cap, lanes, order, [&](auto&& bands) HWY_ATTR {
        for (std::size_t l = 1; l < order; ++l) {
            bands.solve(l, visit);
        }
    });
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
    with_bands<false>(cap, lanes, order, [&](auto&& bands) HWY_ATTR {
        for (std::size_t l = 1; l < order; ++l) {
            bands.solve(l, visit);
        }
    });
    return hn::GetLane(visit.sum());
}

template <class T>
void row_of(const Cap<T>& cap, std::size_t order, T* row) {
    const auto lanes = in_all_lanes(cap);
    RowPointers<T> rows;
    rows.fill(row);
    CoefficientVisitor<T> visit(lanes, order, rows, Output::cached);
    with_bands<true>(cap, lanes, order, [&](auto&& bands) HWY_ATTR {
        for (std::size_t l = 1; l < order; ++l) {
            bands.solve(l, visit);
        }
    });
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

HWY_EXPORT(sound_float);
HWY_EXPORT(sound_double);
HWY_EXPORT(sphere_rows_float);
HWY_EXPORT(sphere_rows_double);
HWY_EXPORT(shade_spheres_float);
HWY_EXPORT(circle_rows_float);
HWY_EXPORT(circle_rows_double);
HWY_EXPORT(inside_circle);
HWY_EXPORT(in_contact);
HWY_EXPORT(terms_float);
HWY_EXPORT(terms_double);
HWY_EXPORT(shaded_float);
HWY_EXPORT(shaded_double);
HWY_EXPORT(row_float);
HWY_EXPORT(row_double);

bool spheres_are_sound(const Vec3<float>* centers, const float* radii, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(sound_float)(centers, radii, count);
}
bool spheres_are_sound(const Vec3<double>* centers, const double* radii, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(sound_double)(centers, radii, count);
}

void sphere_rows(const Vec3<float>* centers, const float* radii, std::size_t count, int order, bool clip, float* rows,
                 Output output) {
    HWY_DYNAMIC_DISPATCH(sphere_rows_float)(centers, radii, count, static_cast<std::size_t>(order), clip, rows, output);
}
void sphere_rows(const Vec3<double>* centers, const double* radii, std::size_t count, int order, bool clip,
                 double* rows, Output output) {
    HWY_DYNAMIC_DISPATCH(sphere_rows_double)
    (centers, radii, count, static_cast<std::size_t>(order), clip, rows, output);
}

void shade_spheres_on_plane(const Vec3<float>* centers, const float* radii, std::size_t count, const float* lobe_terms,
                            int order, float* values) {
    HWY_DYNAMIC_DISPATCH(shade_spheres_float)
    (centers, radii, count, static_cast<std::size_t>(order), lobe_terms, values);
}

void circle_rows(const Circle* circles, std::size_t count, int order, bool clip, float* rows, Output output) {
    HWY_DYNAMIC_DISPATCH(circle_rows_float)(circles, count, static_cast<std::size_t>(order), clip, rows, output);
}
void circle_rows(const Circle* circles, std::size_t count, int order, bool clip, double* rows, Output output) {
    HWY_DYNAMIC_DISPATCH(circle_rows_double)(circles, count, static_cast<std::size_t>(order), clip, rows, output);
}

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
