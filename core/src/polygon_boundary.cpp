// SPDX-License-Identifier: MIT
#include "polygon_boundary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "band_system.h"
#include "legendre.h"

namespace shlight {
namespace {

/// Cosine and sine terms P̄_l^m cos mφ, P̄_l^m sin mφ (no √2) of one band.
template <class T>
struct BandTerms {
    std::array<T, kMaxOrder + 1> cosine, sine;
};

/// The terms at one end of an arc, band after band.
template <class T>
class EndPoint {
  public:
    template <class Real>
    EndPoint(const Vec3<Real>& direction, int order)
        : legendre_(static_cast<T>(direction.z),
                    static_cast<T>(direction.x * direction.x + direction.y * direction.y)) {
        complex_powers(static_cast<T>(direction.x), static_cast<T>(direction.y), order, cos_.data(), sin_.data());
    }
    void advance() { legendre_.advance(); }
    T cosine(int m) const { return legendre_[m] * cos_[m]; }
    T sine(int m) const { return legendre_[m] * sin_[m]; }

  private:
    LegendreRows<T> legendre_;
    std::array<T, kMaxOrder> cos_, sin_;
};

/// An edge in the frame turned about z so that its pole is (sinθ, 0, cosθ).
template <class Real>
struct Edge {
    Real length, cos_tilt, sin_tilt, cos_azimuth, sin_azimuth;
    Vec3<Real> from, to;

    /// cross: a × b ≠ 0.
    Edge(const Vec3<Real>& a, const Vec3<Real>& b, const Vec3<Real>& cross) {
        const Real sine = glm::length(cross);
        const Real radial = std::hypot(cross.x, cross.y);
        length = std::atan2(sine, glm::dot(a, b));
        cos_tilt = cross.z / sine;
        sin_tilt = radial / sine;
        cos_azimuth = radial > 0 ? cross.x / radial : Real(1);
        sin_azimuth = radial > 0 ? cross.y / radial : Real(0);
        from = turned(a);
        to = turned(b);
    }

  private:
    Vec3<Real> turned(const Vec3<Real>& v) const {
        return {cos_azimuth * v.x + sin_azimuth * v.y, cos_azimuth * v.y - sin_azimuth * v.x, v.z};
    }
};

/// P_l(0) for l = 0, 1, 2, … : along a great circle ω·N = 0.
template <class T>
T legendre_at_zero(int l) {
    T p = l % 2 == 0 ? T(1) : T(0);
    for (int k = 2; k <= l && l % 2 == 0; k += 2) {
        p *= -static_cast<T>(k - 1) / static_cast<T>(k);
    }
    return p;
}

/// ∫ P̄_l^m cos mφ ds and ∫ P̄_l^m sin mφ ds along an edge. A turn about the pole moves along the edge, so the
/// generator's right sides are plain differences of the end points.
template <class T>
class ArcIntegrals {
  public:
    template <class Real>
    ArcIntegrals(const Edge<Real>& edge, int order)
        : length_(static_cast<T>(edge.length)),
          cos_tilt_(static_cast<T>(edge.cos_tilt)),
          sin_tilt_(static_cast<T>(edge.sin_tilt)),
          legendre_(cos_tilt_, sin_tilt_ * sin_tilt_),
          from_(edge.from, order),
          to_(edge.to, order) {
        powers(sin_tilt_, order, sin_powers_.data());
        terms_.cosine[0] = legendre_[0] * length_;
        terms_.sine[0] = 0;
    }

    const BandTerms<T>& terms() const { return terms_; }

    void advance() {
        legendre_.advance();
        from_.advance();
        to_.advance();
        const int l = legendre_.band();
        std::array<T, kMaxOrder> null, sine_rise, cosine_fall;
        for (int m = 0; m <= l; ++m) {
            null[m] = legendre_[m] * sin_powers_[m];
            sine_rise[m] = to_.sine(m) - from_.sine(m);
            cosine_fall[m] = from_.cosine(m) - to_.cosine(m);
        }
        const BandSystem<T> system(l, cos_tilt_, sin_tilt_, legendre_.row());
        system.solve(sine_rise.data(), terms_.cosine.data());
        set_null_component(l, null.data(), legendre_at_zero<T>(l) * length_, terms_.cosine.data());
        system.solve(cosine_fall.data(), terms_.sine.data());
        fix_sine_part(l, cosine_fall[0], null.data());
    }

  private:
    /// The sine part obeys two conditions more (Y_0 = 0 and the row m = 0) for its one free multiple of the null
    /// vector: least squares of both, because either alone becomes singular for some pole.
    void fix_sine_part(int l, T cosine_fall, const T* null) {
        const T ladder = LegendreConstants<T>::get().ladder[at(l, 0)];
        T* z = terms_.sine.data();
        const T alpha = -(z[0] * null[0] + cosine_fall * legendre_[1] / ladder + z[1] * null[1]) /
                        (null[0] * null[0] + null[1] * null[1]);
        for (int m = 0; m <= l; ++m) {
            z[m] += alpha * null[m];
        }
        z[0] = 0;
    }

    T length_, cos_tilt_, sin_tilt_;
    LegendreRows<T> legendre_;
    EndPoint<T> from_, to_;
    std::array<T, kMaxOrder> sin_powers_;
    BandTerms<T> terms_;
};

/// ∫ N·∇Y ds of band l from the arc integrals of band l-1: N is a constant vector, and the gradient of a solid
/// harmonic lies one band lower.
template <class T>
BandTerms<T> normal_derivative(int l, T cos_tilt, T sin_tilt, const BandTerms<T>& below) {
    const T g = std::sqrt(static_cast<T>(2 * l + 1) / static_cast<T>(2 * l - 1));
    const auto root = [](int product) { return std::sqrt(static_cast<T>(std::max(0, product))); };
    BandTerms<T> out;
    for (int m = 0; m <= l; ++m) {
        const T same = m < l ? cos_tilt * root(l * l - m * m) : T(0);
        const T up = m + 1 < l ? -sin_tilt / 2 * root((l - m) * (l - m - 1)) : T(0);
        const T down = sin_tilt / 2 * root((l + m) * (l + m - 1));
        T c = 0;
        T s = 0;
        if (m < l) {
            c += same * below.cosine[m];
            s += same * below.sine[m];
        }
        if (m + 1 < l) {
            c += up * below.cosine[m + 1];
            s += up * below.sine[m + 1];
        }
        if (m >= 1) {
            c += down * below.cosine[m - 1];
            s += down * below.sine[m - 1];
        } else if (l > 1) {
            c -= down * below.cosine[1];  // Y^{-1} = -conj Y^1
        }
        out.cosine[m] = g * c;
        out.sine[m] = g * s;
    }
    return out;
}

template <class T, class Real>
void add_edge(const Edge<Real>& edge, int order, T* coefficients) {
    const auto cos_tilt = static_cast<T>(edge.cos_tilt);
    const auto sin_tilt = static_cast<T>(edge.sin_tilt);
    std::array<T, kMaxOrder> cos_m, sin_m;
    complex_powers(static_cast<T>(edge.cos_azimuth), static_cast<T>(edge.sin_azimuth), order, cos_m.data(),
                   sin_m.data());
    ArcIntegrals<T> arc(edge, order);
    arc.advance();
    for (int l = 2; l < order; ++l) {
        const BandTerms<T> e = normal_derivative(l, cos_tilt, sin_tilt, arc.terms());
        const T scale = 1 / static_cast<T>(l * (l + 1));
        const T pair = scale * std::numbers::sqrt2_v<T>;
        T* band = coefficients + coefficient_index(l, 0);
        band[0] += scale * e.cosine[0];
        for (int m = 1; m <= l; ++m) {
            band[m] += pair * (e.cosine[m] * cos_m[m] - e.sine[m] * sin_m[m]);
            band[-m] += pair * (e.cosine[m] * sin_m[m] + e.sine[m] * cos_m[m]);
        }
        if (l + 1 < order) {
            arc.advance();
        }
    }
}

/// Bands 0 and 1: the solid angle and the vector irradiance, ∫ ω dω = ½ Σ length · pole over the edges (Lambert 1760).
/// In the wider type their cancellation leaves every digit of T, for polygons of any size.
template <class T>
void low_bands(const SphericalPolygon<Wider<T>>& polygon, int order, T* coefficients) {
    using Real = Wider<T>;
    coefficients[0] = static_cast<T>(polygon.solid_angle() * std::sqrt(1 / (4 * std::numbers::pi_v<Real>)));
    if (order == 1) {
        return;
    }
    const std::vector<Vec3<Real>>& v = polygon.directions();
    Vec3<Real> sum(0);
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3<Real>& cross = polygon.edge_cross(i);
        const Real sine = glm::length(cross);
        if (sine > 0) {
            sum += std::atan2(sine, glm::dot(v[i], v[(i + 1) % v.size()])) / sine * cross;
        }
    }
    sum *= std::sqrt(3 / (4 * std::numbers::pi_v<Real>)) / 2;
    coefficients[1] = static_cast<T>(sum.y);
    coefficients[2] = static_cast<T>(sum.z);
    coefficients[3] = static_cast<T>(sum.x);
}

}  // namespace

template <class T>
void polygon_by_boundary(const SphericalPolygon<Wider<T>>& polygon, int order, T* coefficients) {
    using Real = Wider<T>;
    // The recurrences run in double for either T: what they lose grows as 1/Ω, and most lights are small.
    std::array<double, coefficient_count(kMaxOrder)> sum;
    std::fill_n(sum.begin(), coefficient_count(order), 0.0);
    const std::vector<Vec3<Real>>& v = polygon.directions();
    for (std::size_t i = 0; i < v.size() && order > 2; ++i) {
        const Vec3<Real>& cross = polygon.edge_cross(i);
        if (cross != Vec3<Real>(0)) {
            add_edge(Edge<Real>(v[i], v[(i + 1) % v.size()], cross), order, sum.data());
        }
    }
    std::transform(sum.begin(), sum.begin() + coefficient_count(order), coefficients,
                   [](double c) { return static_cast<T>(c); });
    low_bands(polygon, order, coefficients);
}

template void polygon_by_boundary(const SphericalPolygon<double>&, int, float*);
template void polygon_by_boundary(const SphericalPolygon<long double>&, int, double*);

}  // namespace shlight
