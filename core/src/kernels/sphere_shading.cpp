// SPDX-License-Identifier: MIT
#include "kernels/sphere_shading.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/sphere_shading.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "kernels/cap_spheres-inl.h"
#include "kernels/lobe_caps-inl.h"
#include "kernels/view_terms-inl.h"
#include "kernels/views-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr std::size_t kLanes = kLaneCount<Floats>;
constexpr std::size_t kHalf = kLaneCount<Doubles>;

struct Spheres {
    V<Floats> x, y, z, r;

    /// The circles of half of them.
    template <class Half>
    HWY_INLINE CircleLanes<Doubles> circles(const Half& half) const {
        const Doubles d;
        return circle_of_floats(hn::PromoteTo(d, half(x)), hn::PromoteTo(d, half(y)), hn::PromoteTo(d, half(z)),
                                hn::PromoteTo(d, half(r)));
    }
};

/// What sources of spheres have in common.
class SphereList {
  public:
    static constexpr bool kPlane = false;
    using Loaded = Spheres;

    SphereList(const Vec3<float>* centers, const float* radii) : centers_(centers), radii_(radii) {}

    HWY_INLINE Spheres load(const Lights& chosen) const {
        const Floats d;
        Spheres s;
        if (are_in_a_row(chosen)) {
            hn::LoadInterleaved3(d, &centers_[chosen.front()].x, s.x, s.y, s.z);
            s.r = hn::LoadU(d, radii_ + chosen.front());
            return s;
        }
        alignas(64) std::array<Vec3<float>, kLanes> centers;
        alignas(64) std::array<float, kLanes> radii;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            centers[lane] = centers_[chosen[lane]];
            radii[lane] = radii_[chosen[lane]];
        }
        hn::LoadInterleaved3(d, &centers.front().x, s.x, s.y, s.z);
        s.r = hn::Load(d, radii.data());
        return s;
    }

    static HWY_INLINE std::uint32_t sides(const Spheres& s) {
        const Floats d;
        return bits_of(d, hn::Lt(hn::Abs(s.z), s.r)) | bits_of(d, hn::Le(s.z, hn::Neg(s.r))) << 16;
    }

    static HWY_INLINE CapLanes<Floats> cap(const Spheres& spheres, const WarpPair& warps) {
        const Doubles d;
        const hn::Half<Floats> half;
        const auto low =
            warped_contact(d, spheres.circles([&](V<Floats> v) HWY_ATTR { return hn::LowerHalf(half, v); }), warps.low);
        const auto high = warped_contact(
            d, spheres.circles([&](V<Floats> v) HWY_ATTR { return hn::UpperHalf(half, v); }), warps.high);
        return cap_in_contact(Floats(), narrowed_contact<float>(low, high));
    }

  private:
    const Vec3<float>* centers_;
    const float* radii_;
};

/// Each at a view of its own.
class SpheresAtViews : public SphereList {
  public:
    SpheresAtViews(const Vec3<float>* centers, const float* radii, const double* cos_theta_o, const TabulatedLobe& lobe)
        : SphereList(centers, radii), cos_theta_o_(cos_theta_o), lobe_(lobe) {}

    int order() const { return lobe_.order; }
    void share(TermLanes& /*terms*/) const {}

    template <bool kCrossing>
    HWY_INLINE void prepare(const Spheres& spheres, const Lights& chosen, CapLanes<Floats>& result,
                            TermLanes& terms) const {
        const ViewLanes view = view_in_lanes(load_cosines(chosen));
        write_terms(lobe_, view, static_cast<std::size_t>(lobe_.order * (lobe_.order + 1) / 2), terms.data());
        result = cap(spheres, warps_in_lanes(lobe_.alpha, view.log_cosine, view.sine, view.cosine));
    }

  private:
    HWY_INLINE DoublePair load_cosines(const Lights& chosen) const {
        if (are_in_a_row(chosen)) {
            return Neighbours(chosen.front()).pair(cos_theta_o_);
        }
        alignas(64) std::array<double, kLanes> cosines;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            cosines[lane] = cos_theta_o_[chosen[lane]];
        }
        return Neighbours(0).pair(cosines.data());
    }

    const double* cos_theta_o_;
    TabulatedLobe lobe_;
};

/// All at one view.
class SpheresAtView : public SphereList {
  public:
    SpheresAtView(const Vec3<float>* centers, const float* radii, const LobeArrays& lobe)
        : SphereList(centers, radii), lobe_(lobe) {}

    int order() const { return lobe_.order; }
    HWY_INLINE void share(TermLanes& terms) const {
        repeat_terms(lobe_.terms, static_cast<std::size_t>(lobe_.order * (lobe_.order + 1) / 2), terms);
    }

    template <bool kCrossing>
    HWY_INLINE void prepare(const Spheres& spheres, const Lights& /*chosen*/, CapLanes<Floats>& result,
                            TermLanes& /*terms*/) const {
        const auto get = [](const double* values) HWY_ATTR { return hn::Set(Doubles(), *values); };
        const WarpArrays& w = lobe_.warps;
        const WarpLanes<Doubles> warp{get(w.sin_tilt),        get(w.cos_tilt),       get(w.speed),
                                      get(w.one_minus_speed), get(w.gamma),          get(w.horizon_x),
                                      get(w.horizon_z),       get(w.horizon_height), get(w.horizon_sine)};
        result = cap(spheres, {warp, warp});
    }

  private:
    LobeArrays lobe_;
};

void at_views(const Vec3<float>* centers, const float* radii, const double* cos_theta_o, std::size_t count,
              const TabulatedLobe& lobe, float* values) {
    ShadingBatch<SpheresAtViews>({centers, radii, cos_theta_o, lobe}, values).run(count);
}

void at_view(const Vec3<float>* centers, const float* radii, std::size_t count, const LobeArrays& lobe, float* values) {
    ShadingBatch<SpheresAtView>({centers, radii, lobe}, values).run(count);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(at_views);
HWY_EXPORT(at_view);

void shade_spheres_at_views(const Vec3<float>* centers, const float* radii, const double* cos_theta_o,
                            std::size_t count, const TabulatedLobe& lobe, float* values) {
    HWY_DYNAMIC_DISPATCH(at_views)(centers, radii, cos_theta_o, count, lobe, values);
}

void shade_spheres_at_view(const Vec3<float>* centers, const float* radii, std::size_t count, const LobeArrays& lobe,
                           float* values) {
    HWY_DYNAMIC_DISPATCH(at_view)(centers, radii, count, lobe, values);
}

}  // namespace shlight
#endif
