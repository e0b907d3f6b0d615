// SPDX-License-Identifier: MIT
#include "lobes/boundary_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lobes/boundary_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <hwy/contrib/math/math-inl.h>

#include "lobes/lobe_lanes-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

template <class D, class Lobe>
class SlopeNdfLanes {
  public:
    SlopeNdfLanes(const SlopeNdf& slope_ndf, const Lobe& lobe)
        : width_(lobe_width(slope_ndf.shape)),
          cos_o_(slope_ndf.cos_o),
          sin_o_(std::sqrt((1 - cos_o_) * (1 + cos_o_))),
          lobe_(lobe),
          view_(lobe.view(D(), all(D(), cos_o_), all(D(), lobe_parameter(slope_ndf.shape)))),
          rule_(*slope_ndf.rule) {}

    /// Derivative of the azimuth in the plane of slopes times ∫ f·cos over the radius up to the boundary.
    HWY_INLINE V<D> density(const BoundaryPath& path, V<D> parameter) const {
        const D d;
        const auto f = all(d, path.flatness);
        const auto s = hn::Sin(d, parameter);
        const auto c = hn::Cos(d, parameter);
        const auto fc = hn::Mul(f, c);
        const auto r = hn::Sqrt(hn::MulAdd(fc, fc, hn::Mul(s, s)));
        const auto slope = hn::Div(hn::Mul(all(d, 1 - path.flatness * path.flatness), hn::Mul(s, c)), r);
        const auto fs = hn::Mul(f, s);
        const auto half = [&](int i) HWY_ATTR {
            return hn::MulAdd(r, all(d, path.middle[i]),
                              hn::MulAdd(fc, all(d, path.cosine[i]), hn::Mul(s, all(d, path.sine[i]))));
        };
        const auto step = [&](int i) HWY_ATTR {
            return hn::MulAdd(slope, all(d, path.middle[i]),
                              hn::NegMulAdd(fs, all(d, path.cosine[i]), hn::Mul(c, all(d, path.sine[i]))));
        };
        const auto x = half(0);
        const auto y = half(1);
        const auto z = half(2);
        const auto square = hn::MulAdd(x, x, hn::Mul(y, y));
        const auto across = hn::Sqrt(square);
        const auto inverse = hn::Div(all(d, 1), across);
        const auto turn = hn::Mul(hn::MulSub(x, step(1), hn::Mul(y, step(0))), hn::Mul(inverse, inverse));
        const auto value = hn::Mul(turn, radial_integral(hn::Mul(x, inverse), hn::Mul(y, inverse), hn::Div(across, z)));
        const auto valid = hn::And(hn::Gt(square, hn::Zero(d)), hn::Gt(z, hn::Zero(d)));
        return hn::IfThenElseZero(valid, value);
    }

  private:
    /// ∫ over tan θ' = 0 … radius at one azimuth. In t = tan ½θ' the slope distribution is rational and the range
    /// short.
    HWY_INLINE V<D> radial_integral(V<D> cos_azimuth, V<D> sin_azimuth, V<D> radius) const {
        const D d;
        const auto one = all(d, 1);
        const auto end = hn::Div(radius, hn::Add(one, hn::Sqrt(hn::MulAdd(radius, radius, one))));
        // Nodes are denser towards the boundary, because a lobe that the horizon cuts ends steeply there; the shortest
        // rule does better without.
        const double crowding = rule_.nodes.size() > 4 ? 1 : 0;
        auto sum = hn::Zero(d);
        for (std::size_t i = 0; i < rule_.nodes.size(); ++i) {
            const double x = rule_.nodes[i];
            const auto t = hn::Mul(end, all(d, x * (1 + crowding * (1 - x))));
            const auto weight = all(d, rule_.weights[i] * (1 + crowding * (1 - 2 * x)));
            const auto scale = hn::Div(one, hn::MulAdd(t, t, one));
            const auto sine = hn::Mul(hn::Add(t, t), scale);
            const auto cosine = hn::Mul(hn::Mul(hn::Sub(one, t), hn::Add(one, t)), scale);
            sum =
                hn::MulAdd(hn::Mul(hn::Mul(weight, scale), sine), factors(cos_azimuth, sin_azimuth, sine, cosine), sum);
        }
        return hn::Mul(hn::Mul(all(d, 2 / std::numbers::pi), end), sum);
    }

    /// f·cos dω ÷ (cosθ' dω' / π), the slope distribution's solid angle: 4 f·cos / D times ω_o·h with the length of h
    /// divided out.
    HWY_INLINE V<D> factors(V<D> cos_azimuth, V<D> sin_azimuth, V<D> sine, V<D> cosine) const {
        const D d;
        const auto cos_o = all(d, cos_o_);
        const auto x = hn::Mul(all(d, width_), sine);
        const auto square = hn::MulAdd(x, x, hn::Mul(cosine, cosine));
        // (ω_o·h) √square
        const auto towards = hn::MulAdd(cos_o, cosine, hn::Mul(hn::Mul(all(d, sin_o_), x), cos_azimuth));
        const auto cos_i = hn::Sub(hn::Div(hn::Mul(hn::Add(towards, towards), cosine), square), cos_o);
        const auto inverse = hn::Div(all(d, 1), hn::Sqrt(square));
        const auto across = hn::Mul(x, inverse);
        const HalfVector<D> half = {hn::Mul(across, cos_azimuth), hn::Mul(across, sin_azimuth),
                                    hn::Mul(cosine, inverse), hn::Mul(towards, inverse)};
        const auto value = hn::Mul(lobe_.over_ndf(d, half, cos_i, view_), towards);
        return hn::IfThenElseZero(hn::Gt(cos_i, hn::Zero(d)), value);
    }

    double width_, cos_o_, sin_o_;
    Lobe lobe_;
    typename Lobe::template View<D> view_;
    const GaussRule& rule_;
};

/// f·cos in directions along an arc.
template <class Lobe>
class DirectionLanes {
  public:
    DirectionLanes(const LobeShape& shape, double cos_o, const Lobe& lobe)
        : alpha2_(lobe_width(shape) * lobe_width(shape)),
          cos_o_(cos_o),
          sin_o_(std::sqrt((1 - cos_o) * (1 + cos_o))),
          lobe_(lobe),
          view_(lobe.view(D(), all(D(), cos_o), all(D(), lobe_parameter(shape)))) {}

    /// The ArcDensity of each parameter.
    HWY_INLINE void densities(const DirectionPath& path, V<Doubles> parameter, std::array<V<Doubles>, 3>& out) const {
        const D d;
        const auto fc = hn::Mul(all(d, path.flatness), hn::Cos(d, parameter));
        const auto s = hn::Sin(d, parameter);
        const auto r = hn::Sqrt(hn::MulAdd(fc, fc, hn::Mul(s, s)));
        const auto row = [&](int i) HWY_ATTR {
            return hn::MulAdd(all(d, path.frame[i][0]), r,
                              hn::MulAdd(all(d, path.frame[i][1]), fc, hn::Mul(all(d, path.frame[i][2]), s)));
        };
        const auto inverse = hn::Div(all(d, 1), row(0));
        const auto c_psi = hn::Mul(row(1), inverse);
        const auto s_psi = hn::Mul(row(2), inverse);
        const auto component = [&](int i) HWY_ATTR {
            return hn::MulAdd(c_psi, all(d, path.cosine[i]),
                              hn::MulAdd(s_psi, all(d, path.sine[i]), all(d, path.axis[i])));
        };
        const auto step = hn::Div(hn::Mul(all(d, path.flatness), inverse), r);
        out[0] = hn::Mul(step, value(component(0), component(1), component(2)));
        out[1] = hn::Mul(out[0], c_psi);
        out[2] = hn::Mul(out[0], s_psi);
    }

  private:
    using D = Doubles;

    /// f·cos towards ω_i = (x, y, z), as its slowly varying factor times D(h) / 4.
    HWY_INLINE V<D> value(V<D> x, V<D> y, V<D> z) const {
        const D d;
        const auto half_x = hn::Add(x, all(d, sin_o_));
        const auto half_z = hn::Add(z, all(d, cos_o_));
        const auto across = hn::MulAdd(half_x, half_x, hn::Mul(y, y));
        const auto up = hn::Mul(half_z, half_z);
        const auto square = hn::Add(across, up);
        const auto inverse = hn::Div(all(d, 1), hn::Sqrt(square));
        const HalfVector<D> half = {hn::Mul(half_x, inverse), hn::Mul(y, inverse), hn::Mul(half_z, inverse),
                                    hn::Mul(all(d, 0.5), hn::Mul(square, inverse))};
        const auto sharpness = hn::Div(square, hn::MulAdd(all(d, alpha2_), up, across));
        const auto peak = all(d, alpha2_ / (4 * std::numbers::pi));
        const auto ndf = hn::Mul(hn::Mul(peak, sharpness), sharpness);
        return hn::IfThenElseZero(hn::Gt(z, hn::Zero(d)), hn::Mul(lobe_.over_ndf(d, half, z, view_), ndf));
    }

    double alpha2_, cos_o_, sin_o_;
    Lobe lobe_;
    typename Lobe::template View<D> view_;
};

template <class T, class Lobe>
void densities(const SlopeNdf& slope_ndf, const Lobe& lobe, const BoundaryPath& path,
               std::span<const double> parameters, std::span<double> values) {
    using D = hn::CappedTag<T, kBoundaryPoints>;
    const D d;
    const SlopeNdfLanes<D, Lobe> lanes(slope_ndf, lobe);
    alignas(64) std::array<T, kBoundaryPoints> buffer{};
    std::transform(parameters.begin(), parameters.end(), buffer.begin(), [](double x) { return static_cast<T>(x); });
    std::fill(buffer.begin() + parameters.size(), buffer.end(), buffer[0]);
    for (std::size_t i = 0; i < parameters.size(); i += kLaneCount<D>) {
        hn::Store(lanes.density(path, hn::Load(d, buffer.data() + i)), d, buffer.data() + i);
    }
    std::transform(buffer.begin(), buffer.begin() + values.size(), values.begin(),
                   [](T x) { return static_cast<double>(x); });
}

void boundary_densities_in_lanes(const SlopeNdf& slope_ndf, const BoundaryPath& path, bool f32,
                                 std::span<const double> parameters, std::span<double> values) {
    const auto fill = [&](const auto& lobe) {
        if (f32) {
            densities<float>(slope_ndf, lobe, path, parameters, values);
        } else {
            densities<double>(slope_ndf, lobe, path, parameters, values);
        }
    };
    if (slope_ndf.by_alpha) {
        with_lanes_by_alpha(std::get<GgxShape>(slope_ndf.shape), fill);
    } else {
        with_lobe_lanes(slope_ndf.shape, fill);
    }
}

void direction_densities_in_lanes(const LobeShape& shape, double cos_o, const DirectionPath& path,
                                  std::span<const double> parameters, std::span<ArcDensity> values) {
    const Doubles d;
    alignas(64) std::array<double, kBoundaryPoints> padded{};
    std::fill(std::copy(parameters.begin(), parameters.end(), padded.begin()), padded.end(), parameters[0]);
    with_lobe_lanes(shape, [&](const auto& lobe) {
        const DirectionLanes lanes(shape, cos_o, lobe);
        for (std::size_t i = 0; i < parameters.size(); i += kLaneCount<Doubles>) {
            std::array<V<Doubles>, 3> densities;
            lanes.densities(path, hn::Load(d, padded.data() + i), densities);
            alignas(64) std::array<double, 3 * kLaneCount<Doubles>> buffer;
            hn::StoreInterleaved3(densities[0], densities[1], densities[2], d, buffer.data());
            for (std::size_t k = 0; k < std::min(kLaneCount<Doubles>, parameters.size() - i); ++k) {
                std::copy_n(buffer.data() + 3 * k, 3, values[i + k].begin());
            }
        }
    });
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(boundary_densities_in_lanes);
HWY_EXPORT(direction_densities_in_lanes);

void boundary_densities(const SlopeNdf& slope_ndf, const BoundaryPath& path, bool f32,
                        std::span<const double> parameters, std::span<double> values) {
    HWY_DYNAMIC_DISPATCH(boundary_densities_in_lanes)(slope_ndf, path, f32, parameters, values);
}

void direction_densities(const LobeShape& shape, double cos_o, const DirectionPath& path,
                         std::span<const double> parameters, std::span<ArcDensity> values) {
    HWY_DYNAMIC_DISPATCH(direction_densities_in_lanes)(shape, cos_o, path, parameters, values);
}

}  // namespace shlight
#endif
