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
#include <type_traits>

#include <hwy/contrib/math/math-inl.h>

#include "lobes/lobe_lanes-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// Points of a boundary: sine and cosine of the azimuth in the plane of slopes, the azimuth's derivative by the path's
/// parameter times 2/π, and tan ½θ'.
template <class D>
struct RadiusEnds {
    V<D> cosine, sine, turn, end;

    HWY_INLINE RadiusEnds(const BoundaryPath& path, V<D> parameter) {
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
        const auto valid = hn::Gt(square, hn::Zero(d));
        const auto across = hn::Sqrt(square);
        const auto inverse = hn::IfThenElseZero(valid, hn::Div(all(d, 1), across));
        cosine = hn::Mul(x, inverse);
        sine = hn::Mul(y, inverse);
        turn = hn::Mul(hn::MulSub(cosine, step(1), hn::Mul(sine, step(0))),
                       hn::Mul(inverse, all(d, 2 / std::numbers::pi)));
        end = hn::Div(across, hn::Add(z, hn::Sqrt(hn::MulAdd(z, z, square))));
    }
};

/// add(sinθ', cosθ', weight) at points of a rule over radii up to tan ½θ' = end, with weights that add up to those of
/// ½ sinθ' dθ'. In t = tan ½θ' the slope distribution is rational and the range short.
template <class D, class Add>
HWY_INLINE void along_radius(D d, const GaussRule& rule, V<D> end, const Add& add) {
    const auto one = all(d, 1);
    // Nodes are denser towards the boundary, because a lobe that the horizon cuts ends steeply there; the shortest
    // rule does better without.
    const double crowding = rule.nodes.size() > 4 ? 1 : 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double x = rule.nodes[i];
        const auto t = hn::Mul(end, all(d, x * (1 + crowding * (1 - x))));
        const auto weight = all(d, rule.weights[i] * (1 + crowding * (1 - 2 * x)));
        const auto scale = hn::Div(one, hn::MulAdd(t, t, one));
        const auto sine = hn::Mul(hn::Add(t, t), scale);
        const auto cosine = hn::Mul(hn::Mul(hn::Sub(one, t), hn::Add(one, t)), scale);
        add(sine, cosine, hn::Mul(hn::Mul(weight, scale), sine));
    }
}

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
        const RadiusEnds<D> points(path, parameter);
        auto sum = hn::Zero(d);
        along_radius(d, rule_, points.end, [&](V<D> sine, V<D> cosine, V<D> weight) HWY_ATTR {
            sum = hn::MulAdd(weight, factors(points.cosine, points.sine, sine, cosine), sum);
        });
        return hn::Mul(hn::Mul(points.turn, points.end), sum);
    }

  private:
    /// f·cos dω ÷ (cosθ' dω' / π), the slope distribution's solid angle: 4 f·cos / D times ω_o·h with the length of h
    /// divided out.
    HWY_INLINE V<D> factors(V<D> cos_azimuth, V<D> sin_azimuth, V<D> sine, V<D> cosine) const {
        const D d;
        if constexpr (std::is_same_v<Lobe, StretchedLanes>) {
            return weighed(lobe_.along_x(d, hn::Mul(sine, cos_azimuth)), lobe_.along_y(d, hn::Mul(sine, sin_azimuth)),
                           cosine);
        }
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
    /// The same of a stretched lobe, at the half vector (x, y, z) / √square in its axes.
    HWY_INLINE V<D> weighed(V<D> x, V<D> y, V<D> z) const {
        const D d;
        const auto square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
        const auto inverse = hn::Div(all(d, 1), hn::Sqrt(square));
        const auto towards = hn::MulAdd(view_.cosine, z, hn::MulAdd(view_.x, x, hn::Mul(view_.y, y)));
        const HalfVector<D> half = {hn::Mul(x, inverse), hn::Mul(y, inverse), hn::Mul(z, inverse),
                                    hn::Mul(towards, inverse)};
        const auto cos_i = hn::MulSub(hn::Add(half.cosine, half.cosine), half.z, view_.cosine);
        const auto value = hn::Mul(lobe_.over_ndf(d, half, cos_i, view_), towards);
        return hn::IfThenElseZero(hn::Gt(cos_i, hn::Zero(d)), value);
    }

    double width_, cos_o_, sin_o_;
    Lobe lobe_;
    typename Lobe::template View<D> view_;
    const GaussRule& rule_;
};

/// The integral of SlopeNdfLanes for ∂(f·cos)/∂α of all GGX lobes, which differ in their Fresnel factors. Radii begin
/// anywhere: the hemisphere of ω_i is a disk in the plane of slopes, so that a radius between two of its points lies
/// within.
class SlopeNdfByAlphaLanes {
  public:
    using D = Doubles;
    using Colors = std::array<V<D>, 3>;

    explicit SlopeNdfByAlphaLanes(const SlopeNdfByAlpha& slope_ndf)
        : of_(slope_ndf),
          sin_o_(std::sqrt((1 - of_.cos_o) * (1 + of_.cos_o))),
          view_(SmoothLobe({}).view(D(), all(D(), of_.cos_o), all(D(), of_.alpha))) {}

    HWY_INLINE Colors density(const BoundaryPath& path, V<D> parameter) const {
        const D d;
        const RadiusEnds<D> points(path, parameter);
        const auto column = [&](int k, int i) HWY_ATTR { return all(d, of_.frame[k][i]); };
        Colors outwards, sums = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        for (int i = 0; i < 3; ++i) {
            outwards[i] = hn::MulAdd(points.cosine, column(0, i), hn::Mul(points.sine, column(1, i)));
        }
        along_radius(d, *of_.rule, points.end, [&](V<D> sine, V<D> cosine, V<D> weight) HWY_ATTR {
            const auto axis = [&](int i)
                                  HWY_ATTR { return hn::MulAdd(sine, outwards[i], hn::Mul(cosine, column(2, i))); };
            add(axis(0), axis(1), axis(2), weight, sums);
        });
        for (V<D>& sum : sums) {
            sum = hn::Mul(hn::Mul(points.turn, points.end), sum);
        }
        return sums;
    }

  private:
    using SmoothLobe = GgxLanes<Fresnel::one>;

    /// Adds the factors of SlopeNdfLanes, derived by α, at the half vector (α x, α y, z) / √square.
    HWY_INLINE void add(V<D> x, V<D> y, V<D> z, V<D> weight, Colors& sums) const {
        const D d;
        const auto alpha = all(d, of_.alpha);
        const auto cos_o = all(d, of_.cos_o);
        const auto across = hn::MulAdd(x, x, hn::Mul(y, y));
        const auto square = hn::MulAdd(view_.alpha2, across, hn::Mul(z, z));
        const auto inverse = inverse_root(d, square);
        const auto towards = hn::MulAdd(cos_o, z, hn::Mul(all(d, of_.alpha * sin_o_), x));
        const auto cos_half = hn::Mul(towards, inverse);
        const auto cos_i = hn::MulSub(hn::Mul(hn::Add(cos_half, cos_half), z), inverse, cos_o);
        const auto derived = SmoothLobe::over_ndf_by_alpha(d, alpha, hn::Sub(across, hn::Mul(z, z)), cos_i, view_);
        const auto smooth = hn::IfThenElseZero(hn::Gt(cos_i, hn::Zero(d)), hn::Mul(hn::Mul(weight, towards), derived));
        for (const WeightedLobe& lobe : of_.lobes) {
            if (const auto* ggx = std::get_if<GgxShape>(&lobe.shape)) {
                const auto value = hn::Mul(smooth, fresnel_of(d, *ggx, cos_half));
                for (std::size_t k = 0; k < sums.size(); ++k) {
                    sums[k] = hn::MulAdd(value, all(d, lobe.weight[k]), sums[k]);
                }
            }
        }
    }

    const SlopeNdfByAlpha& of_;
    double sin_o_;
    SmoothLobe::View<D> view_;
};

/// f·cos of lobes of one width in directions along an arc.
class DirectionLanes {
  public:
    using Numbers = std::array<V<Doubles>, 9>;

    DirectionLanes(std::span<const WeightedLobe> lobes, double cos_o, const DirectionPath& path)
        : lobes_(lobes),
          alpha2_(lobe_width(lobes[0].shape) * lobe_width(lobes[0].shape)),
          cos_o_(cos_o),
          sin_o_(std::sqrt((1 - cos_o) * (1 + cos_o))),
          path_(path) {}

    /// The ArcDensity of each parameter.
    HWY_INLINE Numbers densities(V<Doubles> parameter) const {
        const D d;
        const auto fc = hn::Mul(all(d, path_.flatness), hn::Cos(d, parameter));
        const auto s = hn::Sin(d, parameter);
        const auto r = hn::Sqrt(hn::MulAdd(fc, fc, hn::Mul(s, s)));
        const auto row = [&](int i) HWY_ATTR {
            return hn::MulAdd(all(d, path_.frame[i][0]), r,
                              hn::MulAdd(all(d, path_.frame[i][1]), fc, hn::Mul(all(d, path_.frame[i][2]), s)));
        };
        const auto inverse = hn::Div(all(d, 1), row(0));
        const auto c_psi = hn::Mul(row(1), inverse);
        const auto s_psi = hn::Mul(row(2), inverse);
        const auto component = [&](int i) HWY_ATTR {
            return hn::MulAdd(c_psi, all(d, path_.cosine[i]),
                              hn::MulAdd(s_psi, all(d, path_.sine[i]), all(d, path_.axis[i])));
        };
        const auto step = hn::Div(hn::Mul(all(d, path_.flatness), inverse), r);
        std::array<V<D>, 3> colors = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        add_lobes(component(0), component(1), component(2), step, colors);
        Numbers numbers;
        for (std::size_t k = 0; k < colors.size(); ++k) {
            numbers[3 * k] = colors[k];
            numbers[3 * k + 1] = hn::Mul(colors[k], c_psi);
            numbers[3 * k + 2] = hn::Mul(colors[k], s_psi);
        }
        return numbers;
    }

  private:
    using D = Doubles;

    /// Adds `scale` times f·cos towards ω_i = (x, y, z), as slowly varying factors times D(h) / 4.
    HWY_INLINE void add_lobes(V<D> x, V<D> y, V<D> z, V<D> scale, std::array<V<D>, 3>& colors) const {
        const D d;
        const auto at = half_vector(d, hn::Add(x, all(d, sin_o_)), y, hn::Add(z, all(d, cos_o_)), alpha2_);
        const auto scaled = hn::IfThenElseZero(hn::Gt(z, hn::Zero(d)), hn::Mul(scale, at.quarter_ndf));
        for (const WeightedLobe& weighted : lobes_) {
            with_lobe_lanes(weighted.shape, [&](const auto& lobe) HWY_ATTR {
                const auto view = lobe.view(d, all(d, cos_o_), all(d, lobe_parameter(weighted.shape)));
                const auto value = hn::Mul(scaled, lobe.over_ndf(d, at.half, z, view));
                for (std::size_t k = 0; k < colors.size(); ++k) {
                    colors[k] = hn::MulAdd(value, all(d, weighted.weight[k]), colors[k]);
                }
            });
        }
    }

    std::span<const WeightedLobe> lobes_;
    double alpha2_, cos_o_, sin_o_;
    const DirectionPath& path_;
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

/// density(parameters) returns kNumbers vectors.
template <std::size_t kNumbers, class Density>
void per_parameter(std::span<const double> parameters, std::span<std::array<double, kNumbers>> values,
                   const Density& density) {
    const Doubles d;
    constexpr std::size_t kLanes = kLaneCount<Doubles>;
    alignas(64) std::array<double, kBoundaryPoints> padded{};
    std::fill(std::copy(parameters.begin(), parameters.end(), padded.begin()), padded.end(), parameters[0]);
    for (std::size_t i = 0; i < parameters.size(); i += kLanes) {
        const std::array<V<Doubles>, kNumbers> numbers = density(hn::Load(d, padded.data() + i));
        alignas(64) std::array<double, kLanes> lanes;
        for (std::size_t k = 0; k < kNumbers; ++k) {
            hn::Store(numbers[k], d, lanes.data());
            for (std::size_t lane = 0; lane < std::min(kLanes, parameters.size() - i); ++lane) {
                values[i + lane][k] = lanes[lane];
            }
        }
    }
}

void boundary_densities_in_lanes(const SlopeNdf& slope_ndf, const BoundaryPath& path, bool f32,
                                 std::span<const double> parameters, std::span<double> values) {
    with_lobe_lanes(slope_ndf.shape, [&](const auto& lobe) {
        if (f32) {
            densities<float>(slope_ndf, lobe, path, parameters, values);
        } else {
            densities<double>(slope_ndf, lobe, path, parameters, values);
        }
    });
}

void boundary_densities_by_alpha_in_lanes(const SlopeNdfByAlpha& slope_ndf, const BoundaryPath& path,
                                          std::span<const double> parameters, std::span<std::array<double, 3>> values) {
    const SlopeNdfByAlphaLanes lanes(slope_ndf);
    per_parameter(parameters, values, [&](V<Doubles> parameter) HWY_ATTR { return lanes.density(path, parameter); });
}

void direction_densities_in_lanes(std::span<const WeightedLobe> lobes, double cos_o, const DirectionPath& path,
                                  std::span<const double> parameters, std::span<ArcDensity> values) {
    const DirectionLanes lanes(lobes, cos_o, path);
    per_parameter(parameters, values, [&](V<Doubles> parameter) HWY_ATTR { return lanes.densities(parameter); });
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(boundary_densities_in_lanes);
HWY_EXPORT(boundary_densities_by_alpha_in_lanes);
HWY_EXPORT(direction_densities_in_lanes);

void boundary_densities(const SlopeNdf& slope_ndf, const BoundaryPath& path, bool f32,
                        std::span<const double> parameters, std::span<double> values) {
    HWY_DYNAMIC_DISPATCH(boundary_densities_in_lanes)(slope_ndf, path, f32, parameters, values);
}

void boundary_densities_by_alpha(const SlopeNdfByAlpha& slope_ndf, const BoundaryPath& path,
                                 std::span<const double> parameters, std::span<std::array<double, 3>> values) {
    HWY_DYNAMIC_DISPATCH(boundary_densities_by_alpha_in_lanes)(slope_ndf, path, parameters, values);
}

void direction_densities(std::span<const WeightedLobe> lobes, double cos_o, const DirectionPath& path,
                         std::span<const double> parameters, std::span<ArcDensity> values) {
    HWY_DYNAMIC_DISPATCH(direction_densities_in_lanes)(lobes, cos_o, path, parameters, values);
}

}  // namespace shlight
#endif
