// SPDX-License-Identifier: MIT
//
// Lobes of tables in lanes (lobe_lanes-inl.h), which are looked up one after the other. Included once per instruction
// set.
#if defined(SHLIGHT_KERNELS_TABLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_TABLE_INL_H_
#undef SHLIGHT_KERNELS_TABLE_INL_H_
#else
#define SHLIGHT_KERNELS_TABLE_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "shlight/lobe_shape.h"
#include "shlight/lobe_table.h"
#include "simd/gather-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

class TableLanes {
  public:
    template <class D>
    struct View {
        V<D> cosine, azimuth;
    };

    /// shape: is kept by reference; its azimuth is not used.
    explicit TableLanes(const TableShape& shape) : shape_(&shape), sampled_(sampled_shape(shape)) {}

    template <class D>
    HWY_INLINE View<D> view(D /*d*/, V<D> cos_o, V<D> azimuth) const {
        return {cos_o, azimuth};
    }

    HWY_INLINE V<Floats> value(const HalfSum& sum, V<Floats> cos_i, const View<Floats>& view) const {
        return looked_up(sum, cos_i, view, [this](const Vec3d& wi, const Vec3d& wo, double azimuth) {
            return reflected(wi, wo, azimuth);
        });
    }

    HWY_INLINE V<Floats> density(const HalfSum& sum, V<Floats> cos_i, const View<Floats>& view) const {
        return looked_up(sum, cos_i, view, [this](const Vec3d& wi, const Vec3d& wo, double /*azimuth*/) {
            return lobe_density(sampled_, wo, wi);
        });
    }

    template <class D>
    HWY_INLINE V<D> over_ndf(D d, const HalfVector<D>& half, V<D> /*cos_i*/, const View<D>& view) const {
        const double alpha2 = shape_->width() * shape_->width();
        return each_lane(d, {half.x, half.y, half.z, half.cosine, view.cosine, view.azimuth}, [&](const auto& lane) {
            const auto [x, y, z, cosine, cos_o, azimuth] = lane;
            const Vec3d wo(sine(cos_o), 0, cos_o);
            const Vec3d wi = 2.0 * cosine * Vec3d(x, y, z) - wo;
            if (!(wi.z > 0)) {
                return 0.0;
            }
            // 1/D
            const double spread = alpha2 * z * z + x * x + y * y;
            return 4 * reflected(wi, wo, azimuth) * std::numbers::pi * spread * spread / alpha2;
        });
    }

  private:
    static double sine(double cosine) { return std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine))); }

    double reflected(const Vec3d& wi, const Vec3d& wo, double azimuth) const {
        return shape_->table->reflected(wi, wo, azimuth, shape_->channel);
    }

    template <class Function>
    HWY_INLINE V<Floats> looked_up(const HalfSum& sum, V<Floats> cos_i, const View<Floats>& view,
                                   const Function& function) const {
        return each_lane(Floats(), {sum.x, sum.y, cos_i, view.cosine, view.azimuth}, [&](const auto& lane) {
            const auto [x, y, cos_theta_i, cos_o, azimuth] = lane;
            if (!(cos_theta_i > 0 && cos_o > 0)) {
                return 0.0;
            }
            const Vec3d wo(sine(cos_o), 0, cos_o);
            return function(Vec3d(x - wo.x, y, cos_theta_i), wo, azimuth);
        });
    }

    /// function(numbers of a lane) for each lane.
    template <class D, std::size_t kCount, class Function>
    // NOLINTNEXTLINE(modernize-avoid-c-arrays): its size is found from braces, which std::array does not allow
    static HWY_INLINE V<D> each_lane(D d, const V<D> (&vectors)[kCount], const Function& function) {
        alignas(64) std::array<std::array<Scalar<D>, kLaneCount<D>>, kCount> lanes;
        for (std::size_t k = 0; k < kCount; ++k) {
            hn::Store(vectors[k], d, lanes[k].data());
        }
        alignas(64) std::array<Scalar<D>, kLaneCount<D>> results;
        for (std::size_t i = 0; i < kLaneCount<D>; ++i) {
            std::array<double, kCount> own;
            for (std::size_t k = 0; k < kCount; ++k) {
                own[k] = double{lanes[k][i]};
            }
            results[i] = static_cast<Scalar<D>>(function(own));
        }
        return hn::Load(d, results.data());
    }

    const TableShape* shape_;
    LobeShape sampled_;
};

template <class Function>
void with_lanes_of(const TableShape& shape, const Function& function) {
    function(TableLanes(shape));
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
