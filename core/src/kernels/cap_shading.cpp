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
namespace shlight {
namespace HWY_NAMESPACE {
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

HWY_INLINE CapLanes<Floats> narrowed_cap(const CapLanes<Doubles>& a, const CapLanes<Doubles>& b) {
    using T = float;
    return {narrowed<T>(a.cos_tilt, b.cos_tilt),
            narrowed<T>(a.sin_tilt, b.sin_tilt),
            narrowed<T>(a.cos_azimuth, b.cos_azimuth),
            narrowed<T>(a.sin_azimuth, b.sin_azimuth),
            narrowed<T>(a.cos_half, b.cos_half),
            narrowed<T>(a.sin_half, b.sin_half),
            narrowed<T>(a.arc, b.arc),
            narrowed<T>(a.cos_arc, b.cos_arc),
            narrowed<T>(a.sin_arc, b.sin_arc),
            narrowed<T>(a.edge, b.edge),
            narrowed<T>(a.solid_angle, b.solid_angle),
            narrowed<T>(a.height, b.height),
            narrowed<T>(a.horizon_sine, b.horizon_sine)};
}

/// Whether a circle crosses the plane z = 0; the same test as crossing_squared > 0.
HWY_INLINE bool crosses_plane(double x, double y, double z, double cosine, double sine) {
    const bool by_sine = sine < std::abs(cosine);
    return by_sine ? sine > std::abs(z) : x * x + y * y > cosine * cosine;
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
        const CircleArrays& c = job_.circles;
        for (std::size_t i = first; i < last; ++i) {
            const std::size_t k = job_.circle_of[i];
            const bool crossing = crosses_plane(c.x[k], c.y[k], c.z[k], c.cosine[k], c.sine[k]);
            const bool hidden = !crossing && c.z[k] < 0 && c.cosine[k] >= 0;
            job_.values[i] = 0;
            crossing_.add_if(crossing, i);
            uncrossed_.add_if(!crossing && !hidden, i);
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

    std::size_t term_count() const { return order_ * (order_ + 1) / 2; }

    template <bool kCrossing, bool kPlane>
    HWY_INLINE void run_group(const LightList& lights) {
        scaled_.clear();
        lights.for_each_vector<float>([&](const Lights& chosen) HWY_ATTR {
            const Floats d;
            const auto cap = load<kCrossing, kPlane>(chosen);
            const auto scaled = needs_scaling(d, cap, least_sine_);
            shade<kCrossing, kPlane, false>(cap, chosen);
            if (!hn::AllFalse(d, scaled)) {
                scaled_.add_marked(d, scaled, chosen);
            }
        });
        scaled_.for_each_vector<float>([&](const Lights& chosen) HWY_ATTR {
            shade<kCrossing, kPlane, true>(load<kCrossing, kPlane>(chosen), chosen);
        });
    }

    template <bool kCrossing, bool kPlane>
    HWY_NOINLINE CapLanes<Floats> load(const Lights& chosen) const {
        Lights circle_of;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            circle_of[lane] = job_.circle_of[chosen[lane]];
        }
        const std::uint32_t* high = circle_of.data() + kLanes - kHalf;
        const auto a = load_circle(job_.circles, circle_of.data());
        const auto b = load_circle(job_.circles, high);
        if constexpr (kPlane) {
            const auto circle = narrowed_circle<float>(a, b);
            return kCrossing ? cap_across_plane(Floats(), circle) : cap_off_plane(Floats(), circle);
        } else {
            Lights view_of;
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                view_of[lane] = job_.view_of[chosen[lane]];
            }
            return narrowed_cap(warped_cap(a, view_of.data()), warped_cap(b, view_of.data() + kLanes - kHalf));
        }
    }

    HWY_INLINE CapLanes<Doubles> warped_cap(const CircleLanes<Doubles>& circle, const std::uint32_t* views) const {
        const Doubles d;
        const auto warp = load_warp(job_.lobe.warps, views);
        return cap_of_image(d, circle, warped_circle(d, circle, warp), warp.horizon_height, warp.horizon_sine);
    }

    template <bool kCrossing, bool kPlane, bool kScaled>
    HWY_NOINLINE void shade(const CapLanes<Floats>& cap, const Lights& chosen) {
        if (job_.lobe.stride != 0) {
            load_lobes(chosen);
        }
        ShadingVisitor<float> visit(cap, order_, terms_.data());
        if constexpr (kCrossing) {
            add_bands(CrossedBands<float, kPlane, kScaled>(cap, order_), visit);
        } else {
            add_bands(UncrossedBands<float, kScaled>(cap, order_), visit);
        }
        alignas(64) std::array<float, kLanes> sums;
        hn::Store(visit.sum(), Floats(), sums.data());
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            job_.values[chosen[lane]] = sums[lane];
        }
    }

    template <class Bands>
    HWY_INLINE void add_bands(Bands&& bands, ShadingVisitor<float>& visit) const {
        for (std::size_t l = 1; l < order_; ++l) {
            visit.open(l);
            bands.solve(l, visit);
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
    LightList crossing_, uncrossed_, scaled_;
    alignas(64) std::array<float, (kCosineMax + kBlock) * kLanes> terms_;
};

void shade_caps_in_lanes(const CircleArrays& circles, const std::uint32_t* circle_of, const LobeArrays& lobe,
                         const std::uint32_t* view_of, std::size_t count, float* values) {
    ShadingBatch batch({circles, circle_of, lobe, view_of, values});
    for (std::size_t first = 0; first < count; first += LightList::kMost) {
        batch.run(first, std::min(count, first + LightList::kMost));
    }
}

/// Centres and radii of kHalf spheres, the last of them repeated beyond the end.
template <class T>
HWY_INLINE std::array<std::array<double, kHalf>, 4> load_spheres(const Vec3<T>* centers, const T* radii,
                                                                 std::size_t count) {
    std::array<std::array<double, kHalf>, 4> fields;
    for (std::size_t lane = 0; lane < kHalf; ++lane) {
        const std::size_t i = std::min(lane, count - 1);
        fields[0][lane] = static_cast<double>(centers[i].x);
        fields[1][lane] = static_cast<double>(centers[i].y);
        fields[2][lane] = static_cast<double>(centers[i].z);
        fields[3][lane] = static_cast<double>(radii[i]);
    }
    return fields;
}

template <class T>
void circles_in_lanes(const Vec3<T>* centers, const T* radii, std::size_t count, const CircleOutput& out) {
    const Doubles d;
    for (std::size_t first = 0; first < count; first += kHalf) {
        const std::size_t lanes = std::min(kHalf, count - first);
        const auto fields = load_spheres(centers + first, radii + first, lanes);
        const auto circle = circle_of_sphere_in_lanes(d, hn::LoadU(d, fields[0].data()), hn::LoadU(d, fields[1].data()),
                                                      hn::LoadU(d, fields[2].data()), hn::LoadU(d, fields[3].data()));
        const auto put = [&](V<Doubles> value, double* values) HWY_ATTR {
            if (lanes == kHalf) {
                hn::StoreU(value, d, values + first);
            } else {
                std::array<double, kHalf> own;
                hn::StoreU(value, d, own.data());
                std::copy_n(own.begin(), lanes, values + first);
            }
        };
        put(circle.x, out.x);
        put(circle.y, out.y);
        put(circle.z, out.z);
        put(circle.cosine, out.cosine);
        put(circle.sine, out.sine);
    }
}

void circles_of_float(const Vec3<float>* centers, const float* radii, std::size_t count, const CircleOutput& out) {
    circles_in_lanes(centers, radii, count, out);
}
void circles_of_double(const Vec3<double>* centers, const double* radii, std::size_t count, const CircleOutput& out) {
    circles_in_lanes(centers, radii, count, out);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace shlight
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
