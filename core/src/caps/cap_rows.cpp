// SPDX-License-Identifier: MIT
#include "caps/cap_kernel.h"

#include <hwy/cache_control.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "caps/cap_rows.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "caps/cap_plane-inl.h"
#include "caps/cap_spheres-inl.h"
#include "caps/cap_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// Circles by index.
template <class T>
struct CircleSource {
    static constexpr bool kMayContainHorizon = true;

    const Circle* circles;

    HWY_INLINE CircleLanes<Lanes<T>> load(const Chosen<T>& chosen) const {
        constexpr std::size_t kLanes = kLaneCount<Lanes<T>>;
        constexpr std::size_t kHalf = kLaneCount<Doubles>;
        const Doubles dd;
        std::array<CircleLanes<Doubles>, kLanes / kHalf> halves;
        for (std::size_t first = 0; first < kLanes; first += kHalf) {
            alignas(64) std::array<std::array<double, kHalf>, 5> fields;
            for (std::size_t lane = 0; lane < kHalf; ++lane) {
                const Circle& circle = circles[chosen[first + lane]];
                fields[0][lane] = circle.axis.x;
                fields[1][lane] = circle.axis.y;
                fields[2][lane] = circle.axis.z;
                fields[3][lane] = circle.cosine;
                fields[4][lane] = circle.sine;
            }
            CircleLanes<Doubles>& half = halves[first / kHalf];
            half = {hn::Load(dd, fields[0].data()),
                    hn::Load(dd, fields[1].data()),
                    hn::Load(dd, fields[2].data()),
                    hn::Load(dd, fields[3].data()),
                    hn::Load(dd, fields[4].data()),
                    hn::Zero(dd),
                    hn::Zero(dd)};
            set_squares(dd, half);
        }
        return narrowed_circle<T>(halves.front(), halves.back());
    }

    std::uint32_t sides(std::size_t first, std::size_t count) const {
        std::uint32_t bits = 0;
        for (std::size_t j = 0; j < count; ++j) {
            const Circle& c = circles[first + j];
            const bool by_sine = c.sine < std::abs(c.cosine);
            const bool crossing =
                by_sine ? c.sine > std::abs(c.axis.z) : c.axis.x * c.axis.x + c.axis.y * c.axis.y > c.cosine * c.cosine;
            bits |= (crossing ? 1U : 0U) << j;
            bits |= (!crossing && c.axis.z < 0 && c.cosine >= 0 ? 1U : 0U) << (j + 16);
        }
        return bits;
    }
};

/// Writes coefficients to rows, order² values for each light.
template <class T>
class RowSink {
    using D = Lanes<T>;

  public:
    RowSink(std::size_t order, T* rows, Output output) : order_(order), rows_(rows), output_(output) {}

    std::size_t order() const { return order_; }
    void hide(std::size_t i) const { std::fill_n(rows_ + i * order_ * order_, order_ * order_, T(0)); }

    template <class Bands>
    HWY_NOINLINE void take(const CapLanes<D>& cap, const Chosen<T>& chosen) const {
        RowPointers<T> rows;
        for (std::size_t lane = 0; lane < rows.size(); ++lane) {
            rows[lane] = rows_ + chosen[lane] * order_ * order_;
        }
        CoefficientVisitor<T> visit(cap, order_, rows, output_);
        if (order_ > 1) {
            solve_bands(Bands(cap, order_), order_, visit);
        }
        visit.finish();
    }

  private:
    std::size_t order_;
    T* rows_;
    Output output_;
};

template <class T, class Source>
void rows_of(const Source& source, std::size_t count, std::size_t order, bool clip, T* rows, Output output) {
    run_batch<T>(source, count, clip, RowSink<T>(order, rows, output));
    if (output == Output::streamed) {
        hwy::FlushStream();
    }
}

void sphere_rows_float(const Vec3<float>* centers, const float* radii, std::size_t count, std::size_t order, bool clip,
                       float* rows, Output output) {
    rows_of(SphereSource<float>{centers, radii}, count, order, clip, rows, output);
}
void sphere_rows_double(const Vec3<double>* centers, const double* radii, std::size_t count, std::size_t order,
                        bool clip, double* rows, Output output) {
    rows_of(SphereSource<double>{centers, radii}, count, order, clip, rows, output);
}
void circle_rows_float(const Circle* circles, std::size_t count, std::size_t order, bool clip, float* rows,
                       Output output) {
    rows_of(CircleSource<float>{circles}, count, order, clip, rows, output);
}
void circle_rows_double(const Circle* circles, std::size_t count, std::size_t order, bool clip, double* rows,
                        Output output) {
    rows_of(CircleSource<double>{circles}, count, order, clip, rows, output);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(sphere_rows_float);
HWY_EXPORT(sphere_rows_double);
HWY_EXPORT(circle_rows_float);
HWY_EXPORT(circle_rows_double);

void sphere_rows(const Vec3<float>* centers, const float* radii, std::size_t count, int order, bool clip, float* rows,
                 Output output) {
    HWY_DYNAMIC_DISPATCH(sphere_rows_float)(centers, radii, count, static_cast<std::size_t>(order), clip, rows, output);
}
void sphere_rows(const Vec3<double>* centers, const double* radii, std::size_t count, int order, bool clip,
                 double* rows, Output output) {
    HWY_DYNAMIC_DISPATCH(sphere_rows_double)
    (centers, radii, count, static_cast<std::size_t>(order), clip, rows, output);
}

void circle_rows(const Circle* circles, std::size_t count, int order, bool clip, float* rows, Output output) {
    HWY_DYNAMIC_DISPATCH(circle_rows_float)(circles, count, static_cast<std::size_t>(order), clip, rows, output);
}
void circle_rows(const Circle* circles, std::size_t count, int order, bool clip, double* rows, Output output) {
    HWY_DYNAMIC_DISPATCH(circle_rows_double)(circles, count, static_cast<std::size_t>(order), clip, rows, output);
}

}  // namespace shlight
#endif
