// SPDX-License-Identifier: MIT
#include "shaders/voronoi_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shaders/voronoi_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <limits>

#include "shaders/cell_hash-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr int kMostDetail = 15;

HWY_INLINE Number clamped(Number value, float low, float high) {
    // The bound comes second: on x86 it stands for NaN.
    return hn::Min(hn::Max(value, constant(low)), constant(high));
}

/// a + t (b - a).
HWY_INLINE Number between(Number a, Number b, Number t) {
    return hn::Add(a, hn::Mul(t, hn::Sub(b, a)));
}

template <std::size_t n>
HWY_INLINE Row<n> sum(const Row<n>& a, const Row<n>& b) {
    Row<n> result;
    for (std::size_t i = 0; i < n; ++i) {
        result[i] = hn::Add(a[i], b[i]);
    }
    return result;
}

template <std::size_t n>
HWY_INLINE Row<n> difference(const Row<n>& a, const Row<n>& b) {
    Row<n> result;
    for (std::size_t i = 0; i < n; ++i) {
        result[i] = hn::Sub(a[i], b[i]);
    }
    return result;
}

template <std::size_t n>
HWY_INLINE Row<n> scaled(const Row<n>& a, Number factor) {
    Row<n> result;
    for (std::size_t i = 0; i < n; ++i) {
        result[i] = hn::Mul(a[i], factor);
    }
    return result;
}

template <std::size_t n>
HWY_INLINE Row<n> chosen(M<Floats> condition, const Row<n>& a, const Row<n>& b) {
    Row<n> result;
    for (std::size_t i = 0; i < n; ++i) {
        result[i] = hn::IfThenElse(condition, a[i], b[i]);
    }
    return result;
}

template <std::size_t n>
HWY_INLINE Row<n> zero() {
    Row<n> result;
    result.fill(constant(0));
    return result;
}

/// base^exponent for bases from 0 on.
HWY_INLINE Number power(Number base, Number exponent) {
    const Floats d;
    const auto tiny = constant(std::numeric_limits<float>::min());
    const auto found = hn::Exp(d, hn::Min(hn::Mul(exponent, hn::Log(d, hn::Max(base, tiny))), constant(88)));
    const auto vanishes = hn::And(hn::Lt(base, tiny), hn::Gt(exponent, hn::Zero(d)));
    return hn::IfThenElse(vanishes, hn::Zero(d), found);
}

/// Cells whose points have coordinates and colours by Jenkins's hash of their floats.
struct JenkinsHash {
    template <std::size_t n>
    static HWY_INLINE Row<n> point(const Row<n>& key) {
        if constexpr (n == 1) {
            return {jenkins(key)};
        } else if constexpr (n == 2) {
            return {jenkins(key), jenkins(key, 1)};
        } else if constexpr (n == 3) {
            return {jenkins(key), jenkins(key, 1), jenkins(key, 2)};
        } else {
            const auto& [x, y, z, w] = key;
            return {jenkins(key), jenkins<4>({w, x, y, z}), jenkins<4>({z, w, x, y}), jenkins<4>({y, z, w, x})};
        }
    }
    template <std::size_t n>
    static HWY_INLINE Row<3> color(const Row<n>& key) {
        if constexpr (n == 4) {
            const auto& [x, y, z, w] = key;
            return {jenkins(key), jenkins<4>({z, x, w, y}), jenkins<4>({w, z, y, x})};
        } else {
            return {jenkins(key), jenkins(key, 1), jenkins(key, 2)};
        }
    }
};

/// The same by PCG of integers.
struct PcgHash {
    template <std::size_t n>
    static HWY_INLINE Row<n> point(const Row<n>& key) {
        return pcg(key);
    }
    template <std::size_t n>
    static HWY_INLINE Row<3> color(const Row<n>& key) {
        if constexpr (n == 2) {
            return pcg<3>({key[0], key[1], constant(0)});
        } else {
            const Row<n> numbers = pcg(key);
            return {numbers[0], numbers[1], numbers[2]};
        }
    }
};

/// Lengths of vectors by way of what grows with them and costs less.
class Metric {
  public:
    Metric(VoronoiMetric kind, Number exponent)
        : kind_(kind), exponent_(exponent), inverse_(hn::Div(constant(1), exponent)) {}

    template <std::size_t n>
    HWY_INLINE Number bound(const Row<n>& vector) const {
        if (n == 1) {
            return hn::Abs(vector[0]);
        }
        if (kind_ == VoronoiMetric::euclidean) {
            return dot(vector, vector);
        }
        Number total = term(vector[0]);
        for (std::size_t i = 1; i < n; ++i) {
            total =
                kind_ == VoronoiMetric::chebychev ? hn::Max(total, term(vector[i])) : hn::Add(total, term(vector[i]));
        }
        return total;
    }

    template <std::size_t n>
    HWY_INLINE Number length(Number bound) const {
        if (n > 1 && kind_ == VoronoiMetric::euclidean) {
            return hn::Sqrt(bound);
        }
        if (n > 1 && kind_ == VoronoiMetric::minkowski) {
            return power(bound, inverse_);
        }
        return bound;
    }

    /// The bound of a length.
    template <std::size_t n>
    HWY_INLINE Number of_length(float length) const {
        if (n > 1 && kind_ == VoronoiMetric::euclidean) {
            return constant(length * length);
        }
        return n > 1 ? term(constant(length)) : constant(length);
    }

  private:
    HWY_INLINE Number term(Number x) const {
        return kind_ == VoronoiMetric::minkowski ? power(hn::Abs(x), exponent_) : hn::Abs(x);
    }

    VoronoiMetric kind_;
    Number exponent_, inverse_;
};

/// Calls a function with the offsets of a place's cell's neighbours up to `reach` cells away, and of itself.
template <std::size_t n, class Function>
HWY_INLINE void for_neighbours(int reach, const Function& function) {
    std::array<int, n> at{};
    at.fill(-reach);
    std::size_t i = 0;
    while (i < n) {
        Row<n> offset;
        for (std::size_t k = 0; k < n; ++k) {
            offset[k] = constant(static_cast<float>(at[k]));
        }
        function(offset);
        for (i = 0; i < n && at[i] == reach; ++i) {
            at[i] = -reach;
        }
        if (i < n) {
            ++at[i];
        }
    }
}

struct Settings {
    VoronoiMode mode;
    Number detail, roughness, lacunarity, smoothness, exponent, randomness;
};

/// The results of an octave, or their sums.
template <std::size_t n>
struct Found {
    Number distance;
    Row<3> color;
    Row<n> point;
};

/// A point of which the distance, or what grows with it, is known; relative to the corner of the place's cell.
template <std::size_t n>
struct Candidate {
    Number bound;
    Row<n> offset, point;
};

template <std::size_t n>
HWY_INLINE Candidate<n> chosen(M<Floats> condition, const Candidate<n>& a, const Candidate<n>& b) {
    return {hn::IfThenElse(condition, a.bound, b.bound), chosen(condition, a.offset, b.offset),
            chosen(condition, a.point, b.point)};
}

/// The cells around a place.
template <class Hash, std::size_t n>
class Cells {
  public:
    Cells(const Settings& settings, const Row<n>& place) : settings_(settings) {
        for (std::size_t i = 0; i < n; ++i) {
            cell_[i] = hn::Floor(place[i]);
        }
        local_ = difference(place, cell_);
    }

    Found<n> nearest() const {
        const Metric metric = own_metric();
        return found(metric, nearest<1>(metric));
    }
    Found<n> second() const {
        const Metric metric = own_metric();
        return found(metric, nearest<2>(metric));
    }

    /// The smooth minimum over cells one after the other, with the mean of their points and colours that it weighs.
    Found<n> smooth() const {
        const Metric metric = own_metric();
        const Number width = settings_.smoothness, correction = hn::Add(constant(1), hn::Mul(constant(3), width));
        bool is_first = !is_early();
        Found<n> found{constant(8), zero<3>(), zero<n>()};
        for_neighbours<n>(2, [&](const Row<n>& offset) HWY_ATTR {
            const Row<n> point = point_of(offset);
            const Row<3> color = Hash::color(sum(cell_, offset));
            const Number distance = metric.template length<n>(metric.bound(difference(point, local_)));
            const Number ahead = hn::Div(hn::Mul(constant(0.5F), hn::Sub(found.distance, distance)), width);
            const Number t = is_first ? constant(1) : clamped(hn::Add(constant(0.5F), ahead), 0, 1);
            is_first = false;
            const Number h = hn::Mul(hn::Sub(constant(3), hn::Mul(constant(2), t)), hn::Mul(t, t));
            const Number dip = hn::Mul(hn::Mul(width, h), hn::Sub(constant(1), h));
            const Number less = hn::Div(dip, correction);
            found.distance = hn::Sub(between(found.distance, distance, h), dip);
            for (std::size_t i = 0; i < 3; ++i) {
                found.color[i] = hn::Sub(between(found.color[i], color[i], h), less);
            }
            for (std::size_t i = 0; i < n; ++i) {
                found.point[i] = hn::Sub(between(found.point[i], point[i], h), less);
            }
        });
        found.point = sum(found.point, cell_);
        return found;
    }

    /// The least distance to a plane half-way between the nearest point and another one (Quílez 2012, Voronoi Borders).
    Number edge() const {
        Number least = farthest();
        if constexpr (n == 1) {
            const Number middle = point_of({constant(0)})[0];
            for (const float side : {-1.0F, 1.0F}) {
                const Number half = hn::Mul(hn::Add(middle, point_of({constant(side)})[0]), constant(0.5F));
                least = hn::Min(least, hn::Abs(hn::Sub(half, local_[0])));
            }
        } else {
            const Candidate<n> closest = nearest<1>(Metric(VoronoiMetric::euclidean, constant(2)));
            const Row<n> to_closest = difference(closest.point, local_);
            for_neighbours<n>(1, [&](const Row<n>& offset) HWY_ATTR {
                const Row<n> to_point = difference(point_of(offset), local_);
                const Row<n> across = difference(to_point, to_closest);
                const Number square = dot(across, across);
                const Number projected = hn::Mul(dot(sum(to_closest, to_point), across), constant(0.5F));
                const auto is_other = hn::Gt(square, constant(0.0001F));
                const Number distance = hn::Div(projected, hn::Sqrt(square));
                least = hn::IfThenElse(is_other, hn::Min(least, distance), least);
            });
        }
        return least;
    }

    /// Half the distance from the nearest point to the one nearest to it.
    Number radius() const {
        const Metric metric(VoronoiMetric::euclidean, constant(2));
        const Candidate<n> closest = nearest<1>(metric);
        Number least = farthest();
        bool is_own = false;
        for_neighbours<n>(1, [&](const Row<n>& offset) HWY_ATTR {
            is_own = true;
            for (std::size_t i = 0; i < n; ++i) {
                is_own = is_own && hn::AllTrue(Floats(), hn::Eq(offset[i], constant(0)));
            }
            if (!is_own) {
                const Row<n> point = point_of(sum(closest.offset, offset));
                least = hn::Min(least, metric.bound(difference(closest.point, point)));
            }
        });
        return hn::Mul(constant(0.5F), metric.template length<n>(least));
    }

  private:
    bool is_early() const { return settings_.mode.version == VoronoiVersion::blender_3; }
    Number farthest() const { return is_early() ? constant(8) : constant(std::numeric_limits<float>::max()); }
    Metric own_metric() const { return {settings_.mode.metric, settings_.exponent}; }

    /// The point of the cell at an offset.
    HWY_INLINE Row<n> point_of(const Row<n>& offset) const {
        return sum(offset, scaled(Hash::point(sum(cell_, offset)), settings_.randomness));
    }

    /// The nearest point, or the one after it; of points as near the one that comes first.
    template <std::size_t kRank>
    Candidate<n> nearest(const Metric& metric) const {
        std::array<Candidate<n>, kRank> best;
        best.fill({is_early() ? metric.template of_length<n>(8) : farthest(), zero<n>(), zero<n>()});
        for_neighbours<n>(1, [&](const Row<n>& offset) HWY_ATTR {
            Candidate<n> next{constant(0), offset, point_of(offset)};
            next.bound = metric.bound(difference(next.point, local_));
            for (Candidate<n>& own : best) {
                const auto is_nearer = hn::Lt(next.bound, own.bound);
                const Candidate<n> farther = chosen(is_nearer, own, next);
                own = chosen(is_nearer, next, own);
                next = farther;
            }
        });
        return best.back();
    }

    Found<n> found(const Metric& metric, const Candidate<n>& own) const {
        return {metric.template length<n>(own.bound), Hash::color(sum(cell_, own.offset)), sum(own.point, cell_)};
    }

    const Settings& settings_;
    Row<n> cell_, local_;
};

template <class Hash, std::size_t n>
HWY_NOINLINE Found<n> octave(const Settings& settings, const Row<n>& place) {
    const Floats d;
    const Cells<Hash, n> cells(settings, place);
    switch (settings.mode.feature) {
        case VoronoiFeature::nearest:
            return cells.nearest();
        case VoronoiFeature::second:
            return cells.second();
        case VoronoiFeature::edge:
            return {cells.edge(), zero<3>(), zero<n>()};
        case VoronoiFeature::radius:
            return {cells.radius(), zero<3>(), zero<n>()};
        case VoronoiFeature::smooth:
            break;
    }
    const bool is_early = settings.mode.version == VoronoiVersion::blender_3;
    const auto sharp = hn::Eq(settings.smoothness, hn::Zero(d));
    if (!is_early && hn::AllTrue(d, sharp)) {
        return cells.nearest();
    }
    const Found<n> result = cells.smooth();
    if (!is_early && !hn::AllFalse(d, sharp)) {
        const Found<n> other = cells.nearest();
        return {hn::IfThenElse(sharp, other.distance, result.distance), chosen(sharp, other.color, result.color),
                chosen(sharp, other.point, result.point)};
    }
    return result;
}

/// The distance from a corner of a cell that its point reaches at most, twice that for the second nearest point.
template <std::size_t n>
HWY_INLINE Number largest_distance(const Settings& settings) {
    const Number half = hn::Add(constant(0.5F), hn::Mul(constant(0.5F), settings.randomness));
    if (settings.mode.feature == VoronoiFeature::edge) {
        return half;
    }
    const Metric metric(settings.mode.metric, settings.exponent);
    Row<n> corner;
    corner.fill(half);
    const Number length = metric.template length<n>(metric.bound(corner));
    return settings.mode.feature == VoronoiFeature::second ? hn::Mul(length, constant(2)) : length;
}

/// Octaves, of which the last may be a fraction. Those after the first have weights, by which their distances and
/// colours are summed; their points, and their distances to an edge if these are less, take the place of what was found
/// before.
template <class Hash, std::size_t n>
Found<n> octaves(const Settings& settings, const Row<n>& place) {
    const Floats d;
    Found<n> total = octave<Hash, n>(settings, place);
    const bool is_edge = settings.mode.feature == VoronoiFeature::edge;
    const Number largest = largest_distance<n>(settings);
    Number weights = is_edge ? largest : constant(1);
    Number amplitude = settings.roughness, scale = settings.lacunarity;
    for (int i = 0; i < kMostDetail; ++i) {
        const Number rest = hn::Sub(settings.detail, constant(static_cast<float>(i)));
        if (hn::AllTrue(d, hn::Le(rest, hn::Zero(d)))) {
            break;
        }
        const Found<n> own = octave<Hash, n>(settings, scaled(place, scale));
        const Number share = clamped(rest, 0, 1);
        const Number weight = hn::Mul(amplitude, share);
        const auto counts = hn::And(hn::Ne(weight, hn::Zero(d)), hn::Ne(scale, hn::Zero(d)));
        const auto add = [&](Number& sum, Number more) HWY_ATTR { sum = hn::IfThenElse(counts, more, sum); };
        if (is_edge) {
            add(weights, between(weights, hn::Div(largest, scale), weight));
            add(total.distance, between(total.distance, hn::Min(total.distance, hn::Div(own.distance, scale)), weight));
        } else {
            add(weights, hn::Add(weights, weight));
            add(total.distance, hn::Add(total.distance, hn::Mul(weight, own.distance)));
        }
        for (std::size_t k = 0; k < 3; ++k) {
            add(total.color[k], hn::Add(total.color[k], hn::Mul(weight, own.color[k])));
        }
        for (std::size_t k = 0; k < n; ++k) {
            add(total.point[k], between(total.point[k], hn::Div(own.point[k], scale), weight));
        }
        amplitude = hn::Mul(amplitude, settings.roughness);
        scale = hn::Mul(scale, settings.lacunarity);
    }
    if (settings.mode.normalized) {
        const Number most = is_edge ? weights : hn::Mul(weights, largest);
        total.distance = hn::IfThenElseZero(hn::Ne(most, constant(0)), hn::Div(total.distance, most));
        total.color = scaled(total.color, hn::Div(constant(1), weights));
    }
    return total;
}

template <class Hash, std::size_t n>
void run(VoronoiMode mode, const OperationLanes& lanes) {
    const Floats d;
    for (std::size_t i = 0; i < lanes.count; i += kLaneCount<Floats>) {
        const auto argument = [&](std::size_t k) HWY_ATTR { return hn::LoadU(d, lanes.arguments[k] + i); };
        Row<n> place;
        for (std::size_t k = 0; k < n; ++k) {
            place[k] = argument(k);
        }
        const bool has_octaves = mode.feature != VoronoiFeature::radius && mode.version != VoronoiVersion::blender_3;
        Settings settings{mode,
                          has_octaves ? clamped(argument(n), 0, kMostDetail) : constant(0),
                          clamped(argument(n + 1), 0, 1),
                          argument(n + 2),
                          clamped(hn::Mul(argument(n + 3), constant(0.5F)), 0, 0.5F),
                          argument(n + 4),
                          clamped(argument(n + 5), 0, 1)};
        settings.mode.normalized = mode.normalized && has_octaves;
        const Found<n> found = octaves<Hash, n>(settings, place);
        hn::StoreU(found.distance, d, lanes.results[0] + i);
        for (std::size_t k = 0; k < 3; ++k) {
            hn::StoreU(found.color[k], d, lanes.results[1 + k] + i);
        }
        for (std::size_t k = 0; k < n; ++k) {
            hn::StoreU(found.point[k], d, lanes.results[4 + k] + i);
        }
    }
}

template <std::size_t n>
void run(const OperationLanes& lanes) {
    const VoronoiMode mode = VoronoiMode::numbered(lanes.mode);
    // In one dimension all versions have Jenkins's hash.
    if constexpr (n > 1) {
        if (mode.version == VoronoiVersion::blender_5) {
            return run<PcgHash, n>(mode, lanes);
        }
    }
    run<JenkinsHash, n>(mode, lanes);
}

void voronoi_in_lanes(std::size_t dimensions, const OperationLanes& lanes) {
    switch (dimensions) {
        case 1:
            return run<1>(lanes);
        case 2:
            return run<2>(lanes);
        case 3:
            return run<3>(lanes);
        default:
            return run<4>(lanes);
    }
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(voronoi_in_lanes);

template <std::size_t kDimensions>
void voronoi(const OperationLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(voronoi_in_lanes)(kDimensions, lanes);
}
template void voronoi<1>(const OperationLanes& lanes);
template void voronoi<2>(const OperationLanes& lanes);
template void voronoi<3>(const OperationLanes& lanes);
template void voronoi<4>(const OperationLanes& lanes);

}  // namespace shlight
#endif
