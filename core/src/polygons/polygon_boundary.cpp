// SPDX-License-Identifier: MIT
#include "polygons/polygon_boundary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "math/legendre.h"
#include "polygons/band_system.h"

namespace shlight {
namespace {

/// Cosine and sine terms P̄_l^m cos mφ, P̄_l^m sin mφ (no √2) of one band, with two zeros behind them.
struct BandTerms {
    std::array<double, kMaxOrder + 2> cosine, sine;
};

/// The terms at one end of an arc, band after band.
class EndPoint {
  public:
    template <class Real>
    EndPoint(const Vec3<Real>& u, int order)
        : legendre_(static_cast<double>(u.z), static_cast<double>(u.x * u.x + u.y * u.y)) {
        complex_powers(static_cast<double>(u.x), static_cast<double>(u.y), order, cos_.data(), sin_.data());
    }
    void advance() { legendre_.advance(); }
    double cosine(int m) const { return legendre_[m] * cos_[m]; }
    double sine(int m) const { return legendre_[m] * sin_[m]; }

  private:
    LegendreRows<double> legendre_;
    std::array<double, kMaxOrder> cos_, sin_;
};

/// P_1(c), P_2(c), …
class LegendrePolynomials {
  public:
    explicit LegendrePolynomials(double c) : c_(c), value_(c) {}
    double next() {
        const double result = value_;
        const double l = ++l_;
        value_ = ((2 * l + 1) * c_ * value_ - l * before_) / (l + 1);
        before_ = result;
        return result;
    }

  private:
    double c_, value_;
    double before_ = 1;
    int l_ = 0;
};

/// An arc in the frame turned about z so that its axis is (sinθ, 0, cosθ).
template <class Real>
struct TurnedArc {
    Real cosine, angle, cos_tilt, sin_tilt, cos_azimuth, sin_azimuth;
    Vec3<Real> from, to;

    explicit TurnedArc(const Arc<Real>& arc)
        : cosine(arc.cosine),
          angle(arc.angle),
          cos_tilt(arc.axis.z),
          sin_tilt(std::hypot(arc.axis.x, arc.axis.y)),
          cos_azimuth(sin_tilt > 0 ? arc.axis.x / sin_tilt : Real(1)),
          sin_azimuth(sin_tilt > 0 ? arc.axis.y / sin_tilt : Real(0)),
          from(turned(arc.from)),
          to(turned(arc.to)) {}

  private:
    Vec3<Real> turned(const Vec3<Real>& v) const {
        return {cos_azimuth * v.x + sin_azimuth * v.y, cos_azimuth * v.y - sin_azimuth * v.x, v.z};
    }
};

/// ∫ P̄_l^m cos mφ dψ and ∫ P̄_l^m sin mφ dψ over an arc, ψ the angle about its axis. A turn about the axis moves along
/// the arc, so the generator's right sides are plain differences of the end points.
class ArcIntegrals {
  public:
    template <class Real>
    ArcIntegrals(const TurnedArc<Real>& arc, int order)
        : angle_(static_cast<double>(arc.angle)),
          cos_tilt_(static_cast<double>(arc.cos_tilt)),
          sin_tilt_(static_cast<double>(arc.sin_tilt)),
          legendre_(cos_tilt_, sin_tilt_ * sin_tilt_),
          along_circle_(static_cast<double>(arc.cosine)),
          from_(arc.from, order),
          to_(arc.to, order) {
        powers(sin_tilt_, order, sin_powers_.data());
        terms_.cosine[0] = legendre_[0] * angle_;
        terms_.sine[0] = 0;
        end_with_zeros();
    }

    const BandTerms& terms() const { return terms_; }

    void advance() {
        legendre_.advance();
        from_.advance();
        to_.advance();
        const int l = legendre_.band();
        std::array<double, kMaxOrder> null, sine_rise, cosine_fall;
        for (int m = 0; m <= l; ++m) {
            null[m] = legendre_[m] * sin_powers_[m];
            sine_rise[m] = to_.sine(m) - from_.sine(m);
            cosine_fall[m] = from_.cosine(m) - to_.cosine(m);
        }
        const BandSystem<double> system(l, cos_tilt_, sin_tilt_, legendre_.row());
        system.solve(sine_rise.data(), terms_.cosine.data());
        set_null_component(l, null.data(), along_circle_.next() * angle_, terms_.cosine.data());
        system.solve(cosine_fall.data(), terms_.sine.data());
        fix_sine_part(l, cosine_fall[0], null.data());
        end_with_zeros();
    }

  private:
    /// The sine part obeys two conditions more (Y_0 = 0 and the row m = 0) for its one free multiple of the null
    /// vector: least squares of both, because either alone becomes singular for some axis.
    void fix_sine_part(int l, double cosine_fall, const double* null) {
        const double ladder = LegendreConstants<double>::get().ladder[at(l, 0)];
        double* z = terms_.sine.data();
        const double alpha = -(z[0] * null[0] + cosine_fall * legendre_[1] / ladder + z[1] * null[1]) /
                             (null[0] * null[0] + null[1] * null[1]);
        for (int m = 0; m <= l; ++m) {
            z[m] += alpha * null[m];
        }
        z[0] = 0;
    }

    void end_with_zeros() {
        for (const int m : {legendre_.band() + 1, legendre_.band() + 2}) {
            terms_.cosine[m] = 0;
            terms_.sine[m] = 0;
        }
    }

    double angle_, cos_tilt_, sin_tilt_;
    LegendreRows<double> legendre_;
    LegendrePolynomials along_circle_;
    EndPoint from_, to_;
    std::array<double, kMaxOrder> sin_powers_;
    BandTerms terms_;
};

/// The factors of `normal_derivative`, the same for every arc; zero where there is no term.
struct GradientFactors {
    std::array<double, kCosineMax> same;  ///< g √(l²-m²),  g = √((2l+1)/(2l-1))
    std::array<double, kCosineMax> up;    ///< -g/2 √((l-m)(l-m-1))
    std::array<double, kCosineMax> down;  ///< g/2 √((l+m)(l+m-1))

    GradientFactors() {
        same.fill(0);
        up.fill(0);
        down.fill(0);
        for (int l = 1; l < kMaxOrder; ++l) {
            const double g = std::sqrt((2.0 * l + 1) / (2.0 * l - 1));
            for (int m = 0; m <= l; ++m) {
                same[at(l, m)] = g * std::sqrt(static_cast<double>(l * l - m * m));
                up[at(l, m)] = -g / 2 * std::sqrt(static_cast<double>((l - m) * (l - m - 1)));
                down[at(l, m)] = g / 2 * std::sqrt(static_cast<double>((l + m) * (l + m - 1)));
            }
        }
    }
    static const GradientFactors& get() {
        static const GradientFactors factors;
        return factors;
    }
};

/// ∫ L·∇Y dψ of band l ≥ 2 from the arc integrals of band l-1: L is a constant vector, and the gradient of a solid
/// harmonic lies one band lower.
void gradient_along_axis(int l, double cos_tilt, double sin_tilt, const BandTerms& below, BandTerms& out) {
    const double* same = &GradientFactors::get().same[at(l, 0)];
    const double* up = &GradientFactors::get().up[at(l, 0)];
    const double* down = &GradientFactors::get().down[at(l, 0)];
    // Y^{-1} = -conj Y^1
    out.cosine[0] = cos_tilt * same[0] * below.cosine[0] + sin_tilt * (up[0] - down[0]) * below.cosine[1];
    out.sine[0] = 0;
    const auto row = [&](const double* x, double* result) {
        for (int m = 1; m <= l; ++m) {
            result[m] = cos_tilt * same[m] * x[m] + sin_tilt * (up[m] * x[m + 1] + down[m] * x[m - 1]);
        }
    };
    row(below.cosine.data(), out.cosine.data());
    row(below.sine.data(), out.sine.data());
}

/// ∮ ∂_ν Y over one arc, in its own frame: use(l, terms) for the bands 2 … order-1.
template <class Real, class Use>
void for_each_band(const TurnedArc<Real>& turned, int order, Use use) {
    const auto cosine = static_cast<double>(turned.cosine);
    const auto cos_tilt = static_cast<double>(turned.cos_tilt);
    const auto sin_tilt = static_cast<double>(turned.sin_tilt);
    const bool great_circle = cosine == 0;
    ArcIntegrals arc(turned, order);
    arc.advance();
    BandTerms e;
    for (int l = 2; l < order; ++l) {
        gradient_along_axis(l, cos_tilt, sin_tilt, arc.terms(), e);
        if (l + 1 < order || !great_circle) {
            arc.advance();
        }
        if (!great_circle) {
            // ν ds = (L - c u) dψ, and u·∇ of a solid harmonic of degree l is l times it.
            const double lc = l * cosine;
            for (int m = 0; m <= l; ++m) {
                e.cosine[m] -= lc * arc.terms().cosine[m];
                e.sine[m] -= lc * arc.terms().sine[m];
            }
        }
        use(l, e);
    }
}

/// The same for every arc; use(l, terms, cos_m, sin_m) gets the multiples of the arc's azimuth, too.
template <class Real, class Use>
void for_each_arc_and_band(const PolygonRegion<Real>& region, int order, Use use) {
    if (order <= 2) {
        return;
    }
    for (const Arc<Real>& arc : region.arcs()) {
        const TurnedArc<Real> turned(arc);
        std::array<double, kMaxOrder> cos_m, sin_m;
        complex_powers(static_cast<double>(turned.cos_azimuth), static_cast<double>(turned.sin_azimuth), order,
                       cos_m.data(), sin_m.data());
        for_each_band(turned, order, [&](int l, const BandTerms& e) { use(l, e, cos_m.data(), sin_m.data()); });
    }
}

double stokes_factor(int l) {
    return 1 / static_cast<double>(l * (l + 1));
}

}  // namespace

template <class T>
void boundary_coefficients(const PolygonRegion<Wider<T>>& region, int order, T* coefficients) {
    // In double for either T: what the sum over the arcs loses grows as 1/Ω, and most lights are small.
    std::array<double, coefficient_count(kMaxOrder)> sum;
    std::fill_n(sum.begin(), coefficient_count(order), 0.0);
    for_each_arc_and_band(region, order, [&](int l, const BandTerms& e, const double* cos_m, const double* sin_m) {
        const double scale = stokes_factor(l);
        const double pair = scale * std::numbers::sqrt2;
        double* band = sum.data() + coefficient_index(l, 0);
        band[0] += scale * e.cosine[0];
        for (int m = 1; m <= l; ++m) {
            band[m] += pair * (e.cosine[m] * cos_m[m] - e.sine[m] * sin_m[m]);
            band[-m] += pair * (e.cosine[m] * sin_m[m] + e.sine[m] * cos_m[m]);
        }
    });
    const auto to_result = [](auto c) { return static_cast<T>(c); };
    std::transform(sum.begin(), sum.begin() + coefficient_count(order), coefficients, to_result);
    const auto low = region.low_bands();
    std::transform(low.begin(), low.begin() + std::min(4, coefficient_count(order)), coefficients, to_result);
}

template <class T>
T shade_by_boundary(const PolygonRegion<Wider<T>>& region, const T* lobe_terms, int order) {
    const auto low = region.low_bands();
    auto sum = static_cast<double>(low[0]) * static_cast<double>(lobe_terms[0]);
    if (order > 1) {
        sum += static_cast<double>(low[2]) * static_cast<double>(lobe_terms[1]) +
               static_cast<double>(low[3]) * static_cast<double>(lobe_terms[2]);
    }
    for_each_arc_and_band(region, order, [&](int l, const BandTerms& e, const double* cos_m, const double* sin_m) {
        const T* f = lobe_terms + cosine_index(l, 0);
        double pairs = 0;
        for (int m = 1; m <= l; ++m) {
            pairs += static_cast<double>(f[m]) * (e.cosine[m] * cos_m[m] - e.sine[m] * sin_m[m]);
        }
        sum += stokes_factor(l) * (static_cast<double>(f[0]) * e.cosine[0] + std::numbers::sqrt2 * pairs);
    });
    return static_cast<T>(sum);
}

template void boundary_coefficients(const PolygonRegion<double>&, int, float*);
template void boundary_coefficients(const PolygonRegion<long double>&, int, double*);
template float shade_by_boundary(const PolygonRegion<double>&, const float*, int);
template double shade_by_boundary(const PolygonRegion<long double>&, const double*, int);

}  // namespace shlight
