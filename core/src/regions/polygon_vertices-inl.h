// SPDX-License-Identifier: MIT
//
// The vertices of polygons in lanes: loaded, scaled into the range of float, and the side of their plane that is seen.
// Included once per instruction set.
#if defined(SHLIGHT_KERNELS_POLYGON_VERTICES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_POLYGON_VERTICES_INL_H_
#undef SHLIGHT_KERNELS_POLYGON_VERTICES_INL_H_
#else
#define SHLIGHT_KERNELS_POLYGON_VERTICES_INL_H_
#endif

#include <hwy/aligned_allocator.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "regions/arc_points-inl.h"
#include "regions/polygon_array.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// One number for each lane.
template <class R>
struct alignas(64) LaneValues : std::array<R, kLaneCount<Lanes<R>>> {};

template <class R>
HWY_INLINE V<Lanes<R>> get(const LaneValues<R>& values) {
    return hn::Load(Lanes<R>(), values.data());
}

template <class R>
HWY_INLINE void put(LaneValues<R>& values, V<Lanes<R>> v) {
    hn::Store(v, Lanes<R>(), values.data());
}

/// The vertices of a vector of polygons.
class VertexLanes {
    using D = Doubles;

  public:
    static constexpr std::size_t kWidth = kLaneCount<D>;

    explicit VertexLanes(const PolygonArray& polygons)
        : polygons_(polygons), vertices_(hwy::AllocateAligned<double>(3 * polygons.vertex_count * kWidth)) {}

    std::size_t count() const { return polygons_.vertex_count; }

    /// index: which polygon each lane takes. Scales those far from the range of float.
    HWY_INLINE void load(const std::uint32_t* index) {
        const D d;
        const std::size_t numbers = 3 * polygons_.vertex_count;
        RowPointers<const double> rows;
        for (std::size_t lane = 0; lane < kWidth; ++lane) {
            rows[lane] = polygons_.vertices + numbers * index[lane];
        }
        auto largest = hn::Zero(d);
        for (std::size_t i = 0; i < numbers; i += kSquare<D>) {
            const std::size_t column = std::min(i, numbers - kSquare<D>);
            const auto columns = load_columns(d, rows.data(), column);
            for (std::size_t j = 0; j < kSquare<D>; ++j) {
                largest = hn::Max(largest, hn::Abs(columns[j]));
                hn::StoreU(columns[j], d, vertices_.get() + (column + j) * kWidth);
            }
        }
        const auto usual = hn::And(hn::Gt(largest, all(d, 1e-6)), hn::Lt(largest, all(d, 1e6)));
        if (!hn::AllTrue(d, usual)) {
            rescale(largest);
        }
    }

    HWY_INLINE Vectors3<double> vertex(std::size_t i) const {
        const double* at = vertices_.get() + 3 * i * kWidth;
        return {hn::LoadU(D(), at), hn::LoadU(D(), at + kWidth), hn::LoadU(D(), at + 2 * kWidth)};
    }

    struct Facing {
        V<D> side;                ///< of the polygon's plane that the origin is on; 0 if edge-on or without area
        Vectors3<double> normal;  ///< unit, to the polygon from the origin
    };
    HWY_INLINE Facing facing() const {
        const D d;
        const Vectors3<double> v0 = vertex(0);
        Vectors3<double> normal = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        Vectors3<double> sum = v0 + vertex(1);
        auto farthest = hn::Max(dot<double>(v0, v0), dot<double>(vertex(1), vertex(1)));
        Vectors3<double> before = vertex(1) - v0;
        for (std::size_t i = 2; i < polygons_.vertex_count; ++i) {
            const Vectors3<double> v = vertex(i);
            const Vectors3<double> after = v - v0;
            normal = normal + cross<double>(before, after);
            before = after;
            sum = sum + v;
            farthest = hn::Max(farthest, dot<double>(v, v));
        }
        constexpr double kEdgeOn = 64 * std::numeric_limits<double>::epsilon();
        const auto distance =
            hn::Mul(dot<double>(normal, sum), all(d, 1 / static_cast<double>(polygons_.vertex_count)));
        const auto least = hn::Mul(all(d, kEdgeOn * kEdgeOn), hn::Mul(farthest, dot<double>(normal, normal)));
        const auto seen = hn::Gt(hn::Mul(distance, distance), least);
        const auto side = hn::IfThenElseZero(seen, hn::CopySign(all(d, 1), distance));
        const auto length = hn::Sqrt(hn::Max(dot<double>(normal, normal), all(d, std::numeric_limits<double>::min())));
        return {side, scaled<double>(normal, hn::Div(side, length))};
    }

  private:
    /// By powers of two, which change no digit: squares of tiny and huge coordinates stay in the range of float.
    HWY_NOINLINE void rescale(V<D> largest) {
        const D d;
        const hn::RebindToUnsigned<D> du;
        // The exponent's bits of 1 ÷ largest.
        const auto power = hn::And(hn::BitCast(du, hn::Div(all(d, 1), largest)), hn::Set(du, 0x7FF0000000000000));
        const auto scale = hn::IfThenElse(hn::Gt(largest, all(d, 1e-300)), hn::BitCast(d, power), all(d, 1));
        for (std::size_t i = 0; i < 3 * polygons_.vertex_count; ++i) {
            double* v = vertices_.get() + i * kWidth;
            hn::StoreU(hn::Mul(hn::LoadU(d, v), scale), d, v);
        }
    }

    PolygonArray polygons_;
    hwy::AlignedFreeUniquePtr<double[]> vertices_;  // NOLINT(modernize-avoid-c-arrays): as Highway names it
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
