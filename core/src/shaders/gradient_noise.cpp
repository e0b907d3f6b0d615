// SPDX-License-Identifier: MIT
#include "shaders/gradient_noise.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shaders/gradient_noise.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "shaders/jenkins-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr Floats kFloats;
constexpr Words kWords;

using Number = V<Floats>;
template <std::size_t kCount>
using Place = std::array<Number, kCount>;

HWY_INLINE Number number(double value) {
    return all(kFloats, value);
}

constexpr std::size_t kMostCoordinates = 4;

/// What is known of the noise of a number of coordinates.
struct About {
    double scale;        ///< brings it to about -1 … 1, as in Open Shading Language
    double dip;          ///< a in its correlation over a distance r, which is (1 - a r²) exp(-2 r²) to 0.02
    double mean_size;    ///< of |noise|
    double mean_square;  ///< of noise²
};
/// The means of a million places; for 1 … 4 coordinates.
constexpr std::array<About, kMostCoordinates> kAbout = {{{0.25, 4.45, 0.2312, 0.0939},
                                                         {0.6616, 2.1, 0.2595, 0.1017},
                                                         {0.982, 1.4, 0.2164, 0.0704},
                                                         {0.8344, 1.04, 0.1984, 0.0597}}};
constexpr double kMostOctaves = 16;
/// The largest number of look-ups along the longer axis of a footprint. Each stands for more of a longer one.
constexpr double kMostProbes = 8;
/// Square of the shorter axis, in cells of the coarsest octave, beyond which that axis alone leaves next to nothing.
constexpr double kWidestSquared = 4;
/// The least place, where the pattern repeats, at which it is looked up between the lattice's points: floats have no
/// fractions there.
constexpr double kCoarse = 1e6;

/// The number, negated where a bit of the hash is set.
template <int kBit>
HWY_INLINE Number negated_by(V<Words> hash, Number x) {
    const auto sign = hn::And(hn::ShiftLeft<31 - kBit>(hash), hn::Set(kWords, 0x80000000U));
    return hn::Xor(x, hn::BitCast(kFloats, sign));
}

/// Scalar product of an offset from a point of the lattice and the gradient there, which the point's hash chooses: a
/// number of 1 … 8 with a sign for one coordinate, and for more the middles of the edges of a cube; for two coordinates
/// those of (±1, ±2).
template <std::size_t kCount>
HWY_INLINE Number along_gradient(V<Words> hash, const Place<kCount>& x) {
    const auto below = [&](V<Words> h, std::int32_t end) HWY_ATTR {
        const hn::RebindToSigned<Floats> d;
        return hn::RebindMask(kFloats, hn::Lt(hn::BitCast(d, h), hn::Set(d, end)));
    };
    if constexpr (kCount == 1) {
        const hn::RebindToSigned<Floats> d;
        const auto size = hn::ConvertTo(kFloats, hn::BitCast(d, hn::And(hash, hn::Set(kWords, 7))));
        return hn::Mul(negated_by<3>(hash, hn::Add(size, number(1))), x[0]);
    } else if constexpr (kCount == 2) {
        const auto h = hn::And(hash, hn::Set(kWords, 7));
        const auto u = hn::IfThenElse(below(h, 4), x[0], x[1]);
        const auto v = hn::IfThenElse(below(h, 4), x[1], x[0]);
        return hn::Add(negated_by<0>(h, u), negated_by<1>(h, hn::Add(v, v)));
    } else if constexpr (kCount == 3) {
        const auto h = hn::And(hash, hn::Set(kWords, 15));
        const auto again = hn::RebindMask(kFloats, hn::Eq(hn::And(h, hn::Set(kWords, 13)), hn::Set(kWords, 12)));
        const auto u = hn::IfThenElse(below(h, 8), x[0], x[1]);
        const auto v = hn::IfThenElse(below(h, 4), x[1], hn::IfThenElse(again, x[0], x[2]));
        return hn::Add(negated_by<0>(h, u), negated_by<1>(h, v));
    } else {
        const auto h = hn::And(hash, hn::Set(kWords, 31));
        const auto u = hn::IfThenElse(below(h, 24), x[0], x[1]);
        const auto v = hn::IfThenElse(below(h, 16), x[1], x[2]);
        const auto w = hn::IfThenElse(below(h, 8), x[2], x[3]);
        return hn::Add(hn::Add(negated_by<0>(h, u), negated_by<1>(h, v)), negated_by<2>(h, w));
    }
}

/// A cell of the lattice: its lowest corner, the place in it, and the weights of its upper corners.
template <std::size_t kCount>
struct Cell {
    std::array<V<Words>, kCount> corner;
    Place<kCount> inside, weight;
};

/// Interpolates between the corners of a cell along its first kAxes axes; the others are at their corners.
template <std::size_t kAxes, std::size_t kCount>
HWY_INLINE Number interpolated(const Cell<kCount>& cell, std::array<V<Words>, kCount>& corner, Place<kCount>& offset) {
    if constexpr (kAxes == 0) {
        return along_gradient(hash_of_words(corner), offset);
    } else {
        constexpr std::size_t kAxis = kAxes - 1;
        corner[kAxis] = cell.corner[kAxis];
        offset[kAxis] = cell.inside[kAxis];
        const auto low = interpolated<kAxis>(cell, corner, offset);
        corner[kAxis] = hn::Add(corner[kAxis], hn::Set(kWords, 1));
        offset[kAxis] = hn::Sub(offset[kAxis], number(1));
        const auto high = interpolated<kAxis>(cell, corner, offset);
        return hn::Add(low, hn::Mul(cell.weight[kAxis], hn::Sub(high, low)));
    }
}

/// A coordinate less multiples of the period, which is kept where it is 0. Where floats have no fractions, the middle
/// between points of the lattice is meant.
HWY_INLINE Number repeated(Number x, Number period) {
    const auto size = hn::Abs(x);
    const auto wraps = hn::And(hn::Gt(period, hn::Zero(kFloats)), hn::Ge(size, period));
    if (HWY_LIKELY(hn::AllFalse(kFloats, wraps))) {
        return x;
    }
    const auto turns = hn::Floor(hn::Div(size, period));
    auto rest = hn::Sub(size, hn::Mul(turns, period));
    rest = hn::IfThenElse(hn::Lt(rest, hn::Zero(kFloats)), hn::Add(rest, period), rest);
    rest = hn::IfThenElse(hn::Ge(rest, period), hn::Sub(rest, period), rest);
    const auto middle = hn::IfThenElseZero(hn::Ge(size, number(kCoarse)), number(0.5));
    return hn::IfThenElse(wraps, hn::Add(hn::CopySign(rest, x), middle), x);
}

template <std::size_t kCount>
HWY_NOINLINE Number gradient_noise(const Place<kCount>& place, Number period) {
    const hn::RebindToSigned<Floats> d;
    Cell<kCount> cell;
    for (std::size_t i = 0; i < kCount; ++i) {
        const auto x = repeated(hn::IfThenElseZero(hn::IsFinite(place[i]), place[i]), period);
        const auto low = hn::Floor(x);
        const auto t = hn::Sub(x, low);
        cell.corner[i] = hn::BitCast(kWords, hn::ConvertTo(d, low));
        cell.inside[i] = t;
        const auto inner = hn::Add(hn::Mul(t, hn::Sub(hn::Mul(t, number(6)), number(15))), number(10));
        cell.weight[i] = hn::Mul(hn::Mul(hn::Mul(t, t), t), inner);
    }
    std::array<V<Words>, kCount> corner;
    Place<kCount> offset;
    return hn::Mul(interpolated<kCount>(cell, corner, offset), number(kAbout[kCount - 1].scale));
}

/// The area that a value stands for, in units of the place: the trace and the determinant of the matrix of scalar
/// products of its two sides.
struct Area {
    Number trace, determinant;
};

/// How much of the noise is left in its mean over an area, at most 1 and at least 0: the mean of its correlation with
/// the noise in the middle, where places are spread as in a Gaussian with the variance of the area. That factor has the
/// least mean square error. It is raised a little, so that it is 1 where a side is up to a quarter of the lattice's
/// step.
template <std::size_t kCount>
HWY_INLINE Number resolved_share(const Area& area) {
    constexpr double kRaised = 1 / 0.965;
    const auto zero = hn::Zero(kFloats);
    const auto one = number(1);
    const auto spread = hn::Mul(area.trace, number(1.0 / 12));
    const auto square = hn::Mul(area.determinant, number(1.0 / 144));
    // The mean of exp(-2 r²) is z, and that of r² exp(-2 r²) is z³ (spread + 8 square).
    const auto inverse = hn::Add(one, hn::Add(hn::Mul(spread, number(4)), hn::Mul(square, number(16))));
    const auto z_squared = hn::Div(one, inverse);
    const auto dip = hn::Mul(z_squared, hn::Add(spread, hn::Mul(square, number(8))));
    const auto share = hn::Mul(hn::Sqrt(z_squared), hn::Sub(one, hn::Mul(dip, number(kAbout[kCount - 1].dip))));
    // An infinite area leaves nothing; a maximum with a NaN could be either.
    const auto some = hn::IfThenElseZero(hn::Gt(share, zero), share);
    return hn::Min(hn::Mul(some, number(kRaised)), one);
}

/// Arguments of a fractal beside the place.
struct Settings {
    Number octaves, roughness, lacunarity, offset, gain, period;
    Area area;
};

/// What is known after some octaves.
struct Sum {
    Number value;             ///< the result so far
    Number noise, strengths;  ///< sums over octaves
    Number strength, weight;  ///< of the next octave
};

/// (offset - |noise|)², where the share of it that is not resolved is the mean. Its correlation is about the square of
/// the noise's.
template <std::size_t kCount>
HWY_INLINE Number ridge_of(Number noise, Number offset, Number share) {
    constexpr About kKnown = kAbout[kCount - 1];
    const auto here = hn::Sub(offset, hn::Abs(noise));
    const auto left = hn::Mul(share, share);
    const auto linear = hn::Mul(offset, hn::Sub(offset, number(2 * kKnown.mean_size)));
    const auto mean = hn::Add(linear, number(kKnown.mean_square));
    return hn::Add(hn::Mul(left, hn::Mul(here, here)), hn::Mul(hn::Sub(number(1), left), mean));
}

/// Adds an octave. resolved: the share of it that the area leaves. share: of it that is asked for.
template <Fractal kFractal, std::size_t kCount>
HWY_INLINE void add_octave(Sum& sum, const Settings& settings, bool is_first, Number noise, Number resolved,
                           Number share) {
    const auto zero = hn::Zero(kFloats);
    const auto one = number(1);
    const auto left = hn::Mul(noise, resolved);
    if constexpr (kFractal == Fractal::fbm || kFractal == Fractal::fbm_loss) {
        sum.strengths = hn::Add(sum.strengths, sum.strength);
        const auto weight = hn::IfThenElseZero(hn::Gt(sum.strengths, zero), hn::Div(one, sum.strengths));
        auto next = number(0.5);
        if constexpr (kFractal == Fractal::fbm) {
            sum.noise = hn::Add(sum.noise, hn::Mul(left, sum.strength));
            next = hn::Add(hn::Mul(next, hn::Mul(sum.noise, weight)), next);
        } else {
            const auto lost =
                hn::Mul(hn::Sub(one, hn::Mul(resolved, resolved)), number(kAbout[kCount - 1].mean_square));
            sum.noise = hn::Add(sum.noise, hn::Mul(lost, hn::Mul(sum.strength, sum.strength)));
            next = hn::Mul(sum.noise, hn::Mul(weight, weight));
        }
        // The value goes from the mean of fewer octaves to that of one more.
        sum.value = hn::Add(hn::Mul(hn::Sub(one, share), sum.value), hn::Mul(share, next));
    } else if constexpr (kFractal == Fractal::fbm_sum || kFractal == Fractal::musgrave_sum) {
        sum.value = hn::Add(sum.value, hn::Mul(share, hn::Mul(left, sum.strength)));
    } else if constexpr (kFractal == Fractal::multifractal) {
        sum.value = hn::Mul(sum.value, hn::Add(hn::Mul(hn::Mul(share, sum.strength), left), one));
    } else if constexpr (kFractal == Fractal::hetero_terrain) {
        const auto raised = hn::Add(left, settings.offset);
        const auto step = hn::Mul(hn::Mul(raised, sum.strength), sum.value);
        sum.value = is_first ? raised : hn::Add(sum.value, hn::Mul(share, step));
    } else if constexpr (kFractal == Fractal::hybrid) {
        const auto weight = hn::IfThenElseZero(hn::Gt(sum.weight, number(0.001)), hn::Min(sum.weight, one));
        const auto signal = hn::Mul(hn::Add(left, settings.offset), sum.strength);
        sum.value = hn::Add(sum.value, hn::Mul(hn::Mul(share, weight), signal));
        sum.weight = hn::Mul(weight, hn::Mul(settings.gain, signal));
    } else {
        const auto grown = hn::Min(hn::Max(hn::Mul(sum.weight, settings.gain), zero), one);
        const auto signal = hn::Mul(is_first ? one : grown, ridge_of<kCount>(noise, settings.offset, resolved));
        // An octave that is asked for in part is left out.
        sum.value = hn::Add(sum.value, hn::IfThenElseZero(hn::Ge(share, one), hn::Mul(signal, sum.strength)));
        sum.weight = signal;
    }
    sum.strength = hn::Mul(sum.strength, settings.roughness);
}

template <Fractal kFractal, std::size_t kCount>
HWY_INLINE Number fractal_at(const Place<kCount>& start, const Settings& settings, int octaves) {
    constexpr bool kHasFirst = kFractal == Fractal::hetero_terrain || kFractal == Fractal::ridged;
    constexpr bool kRoundsFrequency = kFractal == Fractal::fbm || kFractal == Fractal::fbm_sum;
    const auto zero = hn::Zero(kFloats);
    const auto one = number(1);
    Sum sum = {kFractal == Fractal::multifractal ? one : zero, zero, zero, one, one};
    Place<kCount> place = start;
    Area area = settings.area;
    auto frequency = one;
    const auto square = hn::Mul(settings.lacunarity, settings.lacunarity);
    for (int octave = 0; octave < std::max(octaves, kHasFirst ? 1 : 0); ++octave) {
        const bool is_first = kHasFirst && octave == 0;
        const auto share = is_first ? one : hn::Min(hn::Sub(settings.octaves, number(octave)), one);
        Sum more = sum;
        const auto noise = kFractal == Fractal::fbm_loss ? zero : gradient_noise<kCount>(place, settings.period);
        add_octave<kFractal, kCount>(more, settings, is_first, noise, resolved_share<kCount>(area), share);
        more.value = hn::IfThenElse(hn::Gt(share, zero), more.value, sum.value);
        sum = more;
        frequency = hn::Mul(frequency, settings.lacunarity);
        for (std::size_t i = 0; i < kCount; ++i) {
            place[i] = kRoundsFrequency ? hn::Mul(frequency, start[i]) : hn::Mul(place[i], settings.lacunarity);
        }
        area = {hn::Mul(area.trace, square), hn::Mul(area.determinant, hn::Mul(square, square))};
    }
    return sum.value;
}

template <std::size_t kCount>
HWY_INLINE Number dot(const Place<kCount>& a, const Place<kCount>& b) {
    auto sum = hn::Mul(a[0], b[0]);
    for (std::size_t i = 1; i < kCount; ++i) {
        sum = hn::Add(sum, hn::Mul(a[i], b[i]));
    }
    return sum;
}

/// Number of places along the longer axis of an area at which a fractal is looked up, so that what each stands for is
/// about as long as wide. No more than four for a cell of the finest octave, and one if all octaves are finer than the
/// shorter axis.
HWY_INLINE Number probes_of(const Settings& settings, Number longest_squared, int octaves) {
    const auto one = number(1);
    const auto square = hn::Mul(settings.lacunarity, settings.lacunarity);
    auto finest = one;
    auto coarsest = one;
    auto frequency = one;
    for (int octave = 1; octave < octaves; ++octave) {
        frequency = hn::Mul(frequency, square);
        const auto is_asked = hn::Gt(settings.octaves, number(octave));
        finest = hn::IfThenElse(is_asked, hn::Max(finest, frequency), finest);
        coarsest = hn::IfThenElse(is_asked, hn::Min(coarsest, frequency), coarsest);
    }
    const auto& [trace, determinant] = settings.area;
    const auto aspect = hn::Div(longest_squared, hn::Sqrt(determinant));
    const auto cells = hn::Mul(number(4), hn::Sqrt(hn::Mul(longest_squared, finest)));
    const auto is_resolved = hn::Le(hn::Mul(determinant, coarsest), hn::Mul(number(kWidestSquared), longest_squared));
    const auto wanted = hn::Min(hn::Min(aspect, cells), number(kMostProbes));
    // NaN is not greater than 1.
    return hn::IfThenElse(hn::And(hn::Gt(wanted, one), is_resolved), hn::Ceil(wanted), one);
}

/// A fractal's mean over an area whose longer axis is `axis`; for no axis, at the place with the area taken for what it
/// stands for.
template <Fractal kFractal, std::size_t kCount>
HWY_INLINE Number fractal_over(const Place<kCount>& middle, const Place<kCount>& axis, Settings settings) {
    const auto one = number(1);
    const auto half = number(0.5);
    const auto octaves = static_cast<int>(hn::GetLane(hn::Ceil(hn::MaxOfLanes(kFloats, settings.octaves))));
    const auto longest = dot<kCount>(axis, axis);
    const auto probes = probes_of(settings, longest, octaves);
    const auto most = static_cast<int>(hn::GetLane(hn::MaxOfLanes(kFloats, probes)));
    const auto step = hn::Div(one, probes);
    if (most > 1) {
        const auto shorter = hn::Mul(step, step);
        auto& [trace, determinant] = settings.area;
        trace = hn::Max(hn::Sub(trace, hn::Mul(longest, hn::Sub(one, shorter))), hn::Zero(kFloats));
        determinant = hn::Mul(determinant, shorter);
    }
    auto sum = hn::Zero(kFloats);
    for (int probe = 0; probe < most; ++probe) {
        const auto along = hn::Sub(hn::Mul(hn::Add(number(probe), half), step), half);
        Place<kCount> place;
        for (std::size_t i = 0; i < kCount; ++i) {
            place[i] = hn::Add(middle[i], hn::Mul(along, axis[i]));
        }
        const auto value = fractal_at<kFractal, kCount>(place, settings, octaves);
        sum = hn::Add(sum, hn::IfThenElseZero(hn::Lt(number(probe), probes), value));
    }
    return hn::Mul(sum, step);
}

/// Arguments of some lanes, one after the other.
class Reader {
  public:
    Reader(const OperationLanes& lanes, std::size_t first) : arguments_(lanes.arguments), first_(first) {}

    Number next() { return hn::LoadU(kFloats, *arguments_++ + first_); }

    template <std::size_t kCount>
    Place<kCount> place() {
        Place<kCount> read;
        std::generate(read.begin(), read.end(), [this]() HWY_ATTR { return next(); });
        return read;
    }

  private:
    const float* const* arguments_;
    std::size_t first_;
};

template <Fractal kFractal, std::size_t kCount>
void fractal_lanes(const OperationLanes& lanes) {
    for (std::size_t first = 0; first < lanes.count; first += kLaneCount<Floats>) {
        Reader reader(lanes, first);
        const auto place = reader.place<kCount>();
        const auto [octaves, roughness, lacunarity, offset, gain, period] = reader.place<6>();
        const auto [trace, determinant] = reader.place<2>();
        const auto axis = reader.place<kCount>();
        // NaN becomes one of the ends.
        const auto clamped = hn::Min(hn::Max(octaves, hn::Zero(kFloats)), number(kMostOctaves));
        const Settings settings = {clamped, roughness, lacunarity, offset, gain, period, {trace, determinant}};
        hn::StoreU(fractal_over<kFractal, kCount>(place, axis, settings), kFloats, lanes.results[0] + first);
    }
}

template <std::size_t kCount>
void footprint_lanes(const OperationLanes& lanes) {
    const auto zero = hn::Zero(kFloats);
    for (std::size_t first = 0; first < lanes.count; first += kLaneCount<Floats>) {
        Reader reader(lanes, first);
        const auto right = reader.place<kCount>();
        const auto below = reader.place<kCount>();
        const auto a = dot<kCount>(right, right);
        const auto b = dot<kCount>(below, below);
        const auto mixed = dot<kCount>(right, below);
        const auto trace = hn::Add(a, b);
        hn::StoreU(trace, kFloats, lanes.results[0] + first);
        const auto determinant = hn::Max(hn::Sub(hn::Mul(a, b), hn::Mul(mixed, mixed)), zero);
        hn::StoreU(determinant, kFloats, lanes.results[1] + first);
        // The eigenvector of the larger eigenvalue, half the sum of the diagonal plus `radius`, of ((a, mixed), (mixed,
        // b)); the difference is added where it grows.
        const auto half = hn::Mul(hn::Sub(a, b), number(0.5));
        const auto radius = hn::Sqrt(hn::Add(hn::Mul(half, half), hn::Mul(mixed, mixed)));
        const auto grown = hn::Add(radius, hn::Abs(half));
        const auto is_right = hn::Ge(half, zero);
        const auto u = hn::IfThenElse(is_right, grown, mixed);
        const auto v = hn::IfThenElse(is_right, mixed, grown);
        const auto size = hn::Sqrt(hn::Add(hn::Mul(u, u), hn::Mul(v, v)));
        const auto scale = hn::IfThenElseZero(hn::Gt(size, zero), hn::Div(number(1), size));
        for (std::size_t i = 0; i < kCount; ++i) {
            const auto along = hn::Mul(scale, hn::Add(hn::Mul(u, right[i]), hn::Mul(v, below[i])));
            hn::StoreU(along, kFloats, lanes.results[2 + i] + first);
        }
    }
}

template <std::size_t kCount>
void noise_lanes(const OperationLanes& lanes) {
    static constexpr std::array<OperationLoop, kFractals> kLoops = {
        &fractal_lanes<Fractal::fbm, kCount>,          &fractal_lanes<Fractal::fbm_loss, kCount>,
        &fractal_lanes<Fractal::fbm_sum, kCount>,      &fractal_lanes<Fractal::musgrave_sum, kCount>,
        &fractal_lanes<Fractal::multifractal, kCount>, &fractal_lanes<Fractal::hetero_terrain, kCount>,
        &fractal_lanes<Fractal::hybrid, kCount>,       &fractal_lanes<Fractal::ridged, kCount>};
    kLoops[lanes.mode](lanes);
}

void noise_in_lanes(std::size_t count, const OperationLanes& lanes) {
    static constexpr std::array<OperationLoop, kMostCoordinates> kLoops = {&noise_lanes<1>, &noise_lanes<2>,
                                                                           &noise_lanes<3>, &noise_lanes<4>};
    kLoops[count - 1](lanes);
}

void footprint_in_lanes(std::size_t count, const OperationLanes& lanes) {
    static constexpr std::array<OperationLoop, kMostCoordinates> kLoops = {&footprint_lanes<1>, &footprint_lanes<2>,
                                                                           &footprint_lanes<3>, &footprint_lanes<4>};
    kLoops[count - 1](lanes);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(noise_in_lanes);
HWY_EXPORT(footprint_in_lanes);

template <std::size_t kCount>
void noise(const OperationLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(noise_in_lanes)(kCount, lanes);
}
template void noise<1>(const OperationLanes& lanes);
template void noise<2>(const OperationLanes& lanes);
template void noise<3>(const OperationLanes& lanes);
template void noise<4>(const OperationLanes& lanes);

template <std::size_t kCount>
void footprint(const OperationLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(footprint_in_lanes)(kCount, lanes);
}
template void footprint<1>(const OperationLanes& lanes);
template void footprint<2>(const OperationLanes& lanes);
template void footprint<3>(const OperationLanes& lanes);
template void footprint<4>(const OperationLanes& lanes);

}  // namespace shlight
#endif
