// SPDX-License-Identifier: MIT
#include "kernels/cap_shading.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/cap_shading.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "kernels/cap_batch-inl.h"
#include "kernels/cap_spheres-inl.h"
#include "kernels/cap_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr std::size_t kLanes = kLaneCount<Floats>;
constexpr std::size_t kHalf = kLaneCount<Doubles>;
constexpr std::size_t kBlock = kSquare<Floats>;

/// Eight or so numbers of an array: those of a vector's lights.
HWY_INLINE V<Doubles> gathered(const double* values, const std::uint32_t* indices, bool in_a_row) {
    const Doubles d;
    if (in_a_row) {
        return hn::LoadU(d, values + indices[0]);
    }
    alignas(64) std::array<double, kHalf> lanes;
    for (std::size_t i = 0; i < kHalf; ++i) {
        lanes[i] = values[indices[i]];
    }
    return hn::Load(d, lanes.data());
}

HWY_INLINE bool all_in_a_row(const std::uint32_t* indices) {
    bool result = true;
    for (std::size_t i = 1; i < kHalf; ++i) {
        result = result & (indices[i] == indices[0] + i);
    }
    return result;
}

HWY_INLINE CircleLanes<Doubles> load_circle(const CircleArrays& circles, const std::uint32_t* indices) {
    const Doubles d;
    const bool in_a_row = all_in_a_row(indices);
    CircleLanes<Doubles> circle{gathered(circles.x, indices, in_a_row),
                                gathered(circles.y, indices, in_a_row),
                                gathered(circles.z, indices, in_a_row),
                                gathered(circles.cosine, indices, in_a_row),
                                gathered(circles.sine, indices, in_a_row),
                                hn::Zero(d),
                                hn::Zero(d)};
    set_squares(d, circle);
    return circle;
}

HWY_INLINE WarpLanes<Doubles> load_warp(const WarpArrays& warps, const std::uint32_t* indices) {
    const bool in_a_row = all_in_a_row(indices);
    const auto get = [&](const double* values) HWY_ATTR { return gathered(values, indices, in_a_row); };
    return {get(warps.sin_tilt),        get(warps.cos_tilt),       get(warps.speed),
            get(warps.one_minus_speed), get(warps.gamma),          get(warps.horizon_x),
            get(warps.horizon_z),       get(warps.horizon_height), get(warps.horizon_sine)};
}

struct Job {
    const CircleArrays& circles;
    const std::uint32_t* circle_of;
    const LobeArrays& lobe;
    const std::uint32_t* view_of;
    float* values;
};

class ShadingBatch {
  public:
    explicit ShadingBatch(const Job& job)
        : job_(job), order_(static_cast<std::size_t>(job.lobe.order)), least_sine_(least_unscaled_sine<float>(order_)) {
        if (job.lobe.stride == 0) {
            const Floats d;
            for (std::size_t k = 0; k < term_count(); ++k) {
                hn::Store(hn::Set(d, job.lobe.terms[k]), d, terms_.data() + k * kLanes);
            }
        }
    }

    void run(std::size_t first, std::size_t last) {
        crossing_.clear();
        uncrossed_.clear();
        scaled_[0].clear();
        scaled_[1].clear();
        std::fill(job_.values + first, job_.values + last, 0.0F);
        for (std::size_t i = first; i < last; i += kLanes) {
            const std::size_t count = std::min(kLanes, last - i);
            if (job_.lobe.warped) {
                sort<false>(i, count);
            } else {
                sort<true>(i, count);
            }
        }
        if (job_.lobe.warped) {
            run_group<true, false>(crossing_);
            run_group<false, false>(uncrossed_);
        } else {
            run_group<true, true>(crossing_);
            run_group<false, true>(uncrossed_);
        }
    }

  private:
    using Lights = Chosen<float>;

    /// The circles of a vector's lights.
    struct Circles {
        CircleLanes<Doubles> low, high;
    };

    /// Lights that lie side by side and need the same are shaded at once, others are put on lists.
    template <bool kPlane>
    HWY_INLINE void sort(std::size_t first, std::size_t count) {
        const Doubles d;
        Lights chosen;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            chosen[lane] = static_cast<std::uint32_t>(first + std::min(lane, count - 1));
        }
        const auto circles = load_circles(chosen);
        const auto sides = [&](const CircleLanes<Doubles>& circle) HWY_ATTR {
            const auto zero = hn::Zero(d);
            const auto crossing = hn::Gt(circle.crossing_squared, zero);
            const auto hidden = hn::AndNot(crossing, hn::And(hn::Lt(circle.z, zero), hn::Ge(circle.cosine, zero)));
            return bits_of(d, crossing) | bits_of(d, hidden) << 16;
        };
        const std::uint32_t bits = sides(circles.low) | sides(circles.high) << (kLanes - kHalf);
        const std::uint32_t all_lanes = (1U << count) - 1;
        const std::uint32_t crossing = bits & all_lanes;
        if (crossing == (1U << kLanes) - 1) {
            shade_unscaled<true, kPlane>(circles, chosen);
            return;
        }
        crossing_.add_block(first, count, crossing);
        uncrossed_.add_block(first, count, ~(bits | bits >> 16) & all_lanes);
    }

    std::size_t term_count() const { return order_ * (order_ + 1) / 2; }

    template <bool kCrossing, bool kPlane>
    HWY_INLINE void run_group(const LightList& lights) {
        lights.for_each_vector<float>(
            [&](const Lights& chosen) HWY_ATTR { shade_unscaled<kCrossing, kPlane>(load_circles(chosen), chosen); });
        scaled_[kCrossing].for_each_vector<float>([&](const Lights& chosen) HWY_ATTR {
            const auto circles = load_circles(chosen);
            shade<kCrossing, kPlane, true>(prepare<kCrossing, kPlane>(circles, chosen), chosen);
        });
    }

    /// Lanes that need scaling are put on a list, to be shaded again.
    template <bool kCrossing, bool kPlane>
    HWY_INLINE void shade_unscaled(const Circles& circles, const Lights& chosen) {
        const Floats d;
        const auto cap = prepare<kCrossing, kPlane>(circles, chosen);
        const auto scaled = needs_scaling(d, cap, least_sine_);
        shade<kCrossing, kPlane, false>(cap, chosen);
        if (!hn::AllFalse(d, scaled)) {
            scaled_[kCrossing].add_marked(d, scaled, chosen);
        }
    }

    HWY_INLINE Circles load_circles(const Lights& chosen) const {
        Lights circle_of;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            circle_of[lane] = job_.circle_of[chosen[lane]];
        }
        return {load_circle(job_.circles, circle_of.data()),
                load_circle(job_.circles, circle_of.data() + kLanes - kHalf)};
    }

    template <bool kCrossing, bool kPlane>
    HWY_INLINE CapLanes<Floats> prepare(const Circles& circles, const Lights& chosen) const {
        if constexpr (kPlane) {
            const auto circle = narrowed_circle<float>(circles.low, circles.high);
            return kCrossing ? cap_across_plane(Floats(), circle) : cap_off_plane(Floats(), circle);
        } else {
            Lights view_of;
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                view_of[lane] = job_.view_of[chosen[lane]];
            }
            const auto low = contact(circles.low, view_of.data());
            const auto high = contact(circles.high, view_of.data() + kLanes - kHalf);
            return cap_in_contact(Floats(), narrowed_contact<float>(low, high));
        }
    }

    HWY_INLINE ContactLanes<Doubles> contact(const CircleLanes<Doubles>& circle, const std::uint32_t* views) const {
        return warped_contact(Doubles(), circle, load_warp(job_.lobe.warps, views));
    }

    template <bool kCrossing, bool kPlane, bool kScaled>
    HWY_NOINLINE void shade(const CapLanes<Floats>& cap, const Lights& chosen) {
        if (job_.lobe.stride != 0) {
            load_lobes(chosen);
        }
        ShadingVisitor<float> visit(cap, order_, terms_.data());
        if constexpr (kCrossing) {
            solve_bands(CrossedBands<float, kPlane, kScaled>(cap, order_), order_, visit);
        } else {
            solve_bands(UncrossedBands<float, kScaled, true>(cap, order_), order_, visit);
        }
        alignas(64) std::array<float, kLanes> sums;
        hn::Store(visit.sum(), Floats(), sums.data());
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            job_.values[chosen[lane]] = sums[lane];
        }
    }

    /// Each lane's own terms.
    HWY_INLINE void load_lobes(const Lights& chosen) {
        const Floats d;
        std::array<const float*, kLanes> rows;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            rows[lane] = job_.lobe.terms + job_.view_of[chosen[lane]] * job_.lobe.stride;
        }
        for (std::size_t k = 0; k < term_count(); k += kBlock) {
            const auto columns = load_columns(d, rows.data(), k);
            for (std::size_t j = 0; j < kBlock; ++j) {
                hn::Store(columns[j], d, terms_.data() + (k + j) * kLanes);
            }
        }
    }

    Job job_;
    std::size_t order_;
    double least_sine_;
    LightList crossing_, uncrossed_;
    std::array<LightList, 2> scaled_;  // of circles that do not cross the horizon, and that do
    alignas(64) std::array<float, (kCosineMax + kBlock) * kLanes> terms_;
};

void shade_caps_in_lanes(const CircleArrays& circles, const std::uint32_t* circle_of, const LobeArrays& lobe,
                         const std::uint32_t* view_of, std::size_t count, float* values) {
    ShadingBatch batch({circles, circle_of, lobe, view_of, values});
    for (std::size_t first = 0; first < count; first += LightList::kMost) {
        batch.run(first, std::min(count, first + LightList::kMost));
    }
}

template <class T>
struct SphereLanes {
    V<Doubles> x, y, z, r;
};

/// kHalf spheres.
template <class T>
HWY_INLINE SphereLanes<T> load_spheres(const Vec3<T>* centers, const T* radii) {
    const Doubles d;
    const hn::Rebind<T, Doubles> own;
    V<decltype(own)> x, y, z;
    hn::LoadInterleaved3(own, &centers->x, x, y, z);
    const auto r = hn::LoadU(own, radii);
    if constexpr (sizeof(T) == 4) {
        return {hn::PromoteTo(d, x), hn::PromoteTo(d, y), hn::PromoteTo(d, z), hn::PromoteTo(d, r)};
    } else {
        return {x, y, z, r};
    }
}

template <class T>
HWY_INLINE CircleLanes<Doubles> circle_of(const SphereLanes<T>& sphere) {
    const Doubles d;
    if constexpr (sizeof(T) == 4) {
        const HalfSpheres half(sphere.x, sphere.y, sphere.z, sphere.r);
        return {hn::Mul(sphere.x, half.inverse),
                hn::Mul(sphere.y, half.inverse),
                half.z,
                root(d, half.tangent_squared),
                hn::Min(all(d, 1), hn::Mul(sphere.r, half.inverse)),
                half.tilt_squared,
                half.crossing_squared};
    } else {
        return circle_of_sphere_in_lanes(d, sphere.x, sphere.y, sphere.z, sphere.r);
    }
}

template <class T>
void circles_in_lanes(const Vec3<T>* centers, const T* radii, std::size_t count, const CircleOutput& out) {
    const Doubles d;
    const auto write = [&](const CircleLanes<Doubles>& circle, const CircleOutput& o) HWY_ATTR {
        hn::StoreU(circle.x, d, o.x);
        hn::StoreU(circle.y, d, o.y);
        hn::StoreU(circle.z, d, o.z);
        hn::StoreU(circle.cosine, d, o.cosine);
        hn::StoreU(circle.sine, d, o.sine);
    };
    std::size_t first = 0;
    for (; first + kHalf <= count; first += kHalf) {
        write(circle_of<T>(load_spheres(centers + first, radii + first)),
              {out.x + first, out.y + first, out.z + first, out.cosine + first, out.sine + first});
    }
    if (first == count) {
        return;
    }
    std::array<Vec3<T>, kHalf> last_centers;
    std::array<T, kHalf> last_radii;
    std::fill(std::copy(centers + first, centers + count, last_centers.begin()), last_centers.end(), centers[first]);
    std::fill(std::copy(radii + first, radii + count, last_radii.begin()), last_radii.end(), radii[first]);
    std::array<std::array<double, kHalf>, 5> fields;
    write(circle_of<T>(load_spheres(last_centers.data(), last_radii.data())),
          {fields[0].data(), fields[1].data(), fields[2].data(), fields[3].data(), fields[4].data()});
    const std::array<double*, 5> arrays = {out.x, out.y, out.z, out.cosine, out.sine};
    for (std::size_t k = 0; k < arrays.size(); ++k) {
        std::copy_n(fields[k].begin(), count - first, arrays[k] + first);
    }
}

void circles_of_float(const Vec3<float>* centers, const float* radii, std::size_t count, const CircleOutput& out) {
    circles_in_lanes(centers, radii, count, out);
}
void circles_of_double(const Vec3<double>* centers, const double* radii, std::size_t count, const CircleOutput& out) {
    circles_in_lanes(centers, radii, count, out);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(shade_caps_in_lanes);
HWY_EXPORT(circles_of_float);
HWY_EXPORT(circles_of_double);

void circles_of_spheres(std::span<const Vec3<float>> centers, const float* radii, const CircleOutput& circles) {
    HWY_DYNAMIC_DISPATCH(circles_of_float)(centers.data(), radii, centers.size(), circles);
}
void circles_of_spheres(std::span<const Vec3<double>> centers, const double* radii, const CircleOutput& circles) {
    HWY_DYNAMIC_DISPATCH(circles_of_double)(centers.data(), radii, centers.size(), circles);
}

void shade_caps(const CircleArrays& circles, std::span<const std::uint32_t> circle_of, const LobeArrays& lobe,
                std::span<const std::uint32_t> view_of, std::span<float> values) {
    HWY_DYNAMIC_DISPATCH(shade_caps_in_lanes)
    (circles, circle_of.data(), lobe, view_of.data(), values.size(), values.data());
}

}  // namespace shlight
#endif
