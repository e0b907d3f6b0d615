// SPDX-License-Identifier: MIT
#include "lobes/moments_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lobes/moments_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lobes/lobe_lanes-inl.h"
#include "math/legendre-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr std::size_t kLanes = kLaneCount<Doubles>;
static_assert(kMomentLanes % kLanes == 0);

/// The nodes of the rule over the azimuth: φ = 0 is the side of the view, which a rule counts from the other side.
struct Azimuths {
    std::vector<double> weights, cosines, sines;  ///< cosφ and sinφ
    std::vector<double> harmonics;                ///< cos mφ for m = 0 … 63, node by node

    explicit Azimuths(const QuadratureRule& rule) : weights(rule.weights) {
        std::array<double, kMaxOrder> multiples, others;
        for (const double node : rule.nodes) {
            complex_powers(-std::cos(node), std::sin(node), kMaxOrder, multiples.data(), others.data());
            cosines.push_back(multiples[1]);
            sines.push_back(others[1]);
            harmonics.insert(harmonics.end(), multiples.begin(), multiples.end());
        }
    }
};

/// One view of a lobe.
template <class Lobe>
class LobeView {
  public:
    LobeView(const Lobe& lobe, const LobeShape& shape, double cos_theta_o)
        : lobe_(lobe),
          cosine_(cos_theta_o),
          sine_(sine_of(cos_theta_o)),
          alpha2_(lobe_width(shape) * lobe_width(shape)),
          view_(lobe.view(Doubles(), all(Doubles(), cos_theta_o), all(Doubles(), lobe_parameter(shape)))) {}

    /// Weights times f·cos towards cosθ = cosine at all azimuths; returns their sum times f·cos.
    double weigh(double cosine, const Azimuths& phi, double* weighted) const {
        const Doubles d;
        const auto sine = all(d, sine_of(cosine));
        auto squares = hn::Zero(d);
        for (std::size_t j = 0; j < phi.weights.size(); j += kLanes) {
            const auto x = hn::MulAdd(sine, hn::LoadU(d, &phi.cosines[j]), all(d, sine_));
            const auto y = hn::Mul(sine, hn::LoadU(d, &phi.sines[j]));
            const auto [half, ndf] = half_vector(d, x, y, all(d, cosine + cosine_), alpha2_);
            const auto value = hn::Mul(ndf, lobe_.over_ndf(d, half, all(d, cosine), view_));
            const auto share = hn::Mul(value, hn::LoadU(d, &phi.weights[j]));
            squares = hn::MulAdd(value, share, squares);
            hn::StoreU(share, d, weighted + j);
        }
        return hn::GetLane(hn::SumOfLanes(d, squares));
    }

  private:
    static double sine_of(double cosine) { return std::sqrt((1 - cosine) * (1 + cosine)); }

    const Lobe& lobe_;
    double cosine_, sine_, alpha2_;
    typename Lobe::template View<Doubles> view_;
};

/// The sum of rows of 64 numbers times their weights. The sums of a part of the row stay in registers.
void add_rows(std::span<const double> weights, const double* rows, double* out) {
    const Doubles d;
    constexpr std::size_t kSums = 8, kPart = kSums * kLanes;
    static_assert(kMaxOrder % kPart == 0);
    for (std::size_t m = 0; m < kMaxOrder; m += kPart) {
        std::array<V<Doubles>, kSums> sums;
        sums.fill(hn::Zero(d));
        for (std::size_t j = 0; j < weights.size(); ++j) {
            const auto weight = hn::Set(d, weights[j]);
            for (std::size_t k = 0; k < kSums; ++k) {
                sums[k] = hn::MulAdd(weight, hn::LoadU(d, rows + j * kMaxOrder + m + k * kLanes), sums[k]);
            }
        }
        for (std::size_t k = 0; k < kSums; ++k) {
            hn::StoreU(sums[k], d, out + m + k * kLanes);
        }
    }
}

/// Numbers of as many θ as there are lanes.
using LaneRow = std::array<double, kLanes>;

/// Adds Σ P̂_l^m(cosθ) fourier[m] over lanes' θ to the sums at (l, m).
template <bool kAtPole>
void add_bands(const LaneRow& cosines, const LaneRow& squared_sines, const std::array<LaneRow, kMaxOrder>& fourier,
               std::vector<LaneRow>& sums) {
    const Doubles d;
    LegendreLanes<double, kAtPole> legendre(hn::LoadU(d, cosines.data()), hn::LoadU(d, squared_sines.data()));
    for (int l = 0; l < kMaxOrder; ++l) {
        for (int m = 0; m <= l; ++m) {
            LaneRow& sum = sums[at(l, m)];
            const auto here = hn::LoadU(d, fourier[m].data());
            hn::StoreU(hn::MulAdd(legendre[m], here, hn::LoadU(d, sum.data())), d, sum.data());
        }
        if (l + 1 < kMaxOrder) {
            legendre.advance();
        }
    }
}

template <class Lobe>
double integrate(const LobeView<Lobe>& lobe, const LobeRule& rule, double* moments) {
    const Azimuths phi(rule.phi);
    std::vector<double> weighted(phi.weights.size());
    std::vector<LaneRow> sums(kCosineMax, LaneRow{});
    std::array<double, kMaxOrder> row, powers_of_sine;
    std::array<LaneRow, kMaxOrder> fourier;
    LaneRow cosines, squared_sines;
    double norm_squared = 0;
    for (std::size_t i = 0; i < rule.theta.nodes.size(); i += kLanes) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const double sine = std::sin(rule.theta.nodes[i + lane]);
            cosines[lane] = std::cos(rule.theta.nodes[i + lane]);
            squared_sines[lane] = sine * sine;
            // Azimuths to either side of the plane of incidence are alike.
            const double weight = 2 * sine * rule.theta.weights[i + lane];
            norm_squared += weight * lobe.weigh(cosines[lane], phi, weighted.data());
            add_rows(weighted, phi.harmonics.data(), row.data());
            powers(sine, kMaxOrder, powers_of_sine.data());
            for (std::size_t m = 0; m < kMaxOrder; ++m) {
                fourier[m][lane] = weight * row[m] * powers_of_sine[m] * (m == 0 ? 1.0 : std::numbers::sqrt2);
            }
        }
        if (squared_sines[0] < kNearPole) {
            add_bands<true>(cosines, squared_sines, fourier, sums);
        } else {
            add_bands<false>(cosines, squared_sines, fourier, sums);
        }
    }
    const Doubles d;
    std::transform(sums.begin(), sums.end(), moments, [&](const LaneRow& sum) HWY_ATTR {
        return hn::GetLane(hn::SumOfLanes(d, hn::LoadU(d, sum.data())));
    });
    return norm_squared;
}

double integrate_in_lanes(const LobeShape& shape, double cos_theta_o, const LobeRule& rule, double* moments) {
    double norm_squared = 0;
    with_lobe_lanes(
        shape, [&](const auto& lobe) { norm_squared = integrate(LobeView(lobe, shape, cos_theta_o), rule, moments); });
    return norm_squared;
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(integrate_in_lanes);

double integrate_moments(const LobeShape& shape, double cos_theta_o, const LobeRule& rule, std::span<double> moments) {
    return HWY_DYNAMIC_DISPATCH(integrate_in_lanes)(shape, cos_theta_o, rule, moments.data());
}

}  // namespace shlight
#endif
