// SPDX-License-Identifier: MIT
#include "regions/polygon_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "regions/polygon_rows.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/aligned_allocator.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "regions/moments-inl.h"
#include "regions/polygon_lists-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// Work of one call of polygon_rows.
template <class T>
class PolygonRows : public PolygonLists<PolygonRows<T>, T, false> {
    using Base = PolygonLists<PolygonRows<T>, T, false>;
    friend Base;

  public:
    PolygonRows(const PolygonArray& polygons, int order, T* rows)
        : Base(polygons, order, 1), numbers_(static_cast<std::size_t>(coefficient_count(order))), rows_(rows) {}

    void integrate(std::size_t first, std::size_t count, bool clip, std::vector<std::uint32_t>& narrowest) {
        first_ = first;
        std::fill_n(row(0), count * numbers_, T(0));
        this->take(count, clip);
        if constexpr (std::is_same_v<T, double>) {
            add_moments(this->double_arcs_, this->order_, [&](std::size_t i) { return row(i); });
        } else {
            add_moments(this->float_arcs_, this->order_, [&](std::size_t i) { return row(i); });
            add_narrow(count);
        }
        for (const std::uint32_t i : this->narrowest_) {
            narrowest.push_back(static_cast<std::uint32_t>(first + i));
        }
    }

  private:
    std::size_t polygon(std::size_t i) const { return first_ + i; }
    static std::uint32_t view(std::size_t) { return 0; }
    T* row(std::size_t i) const { return rows_ + (first_ + i) * numbers_; }

    template <class R>
    HWY_INLINE void low_bands(V<Lanes<R>> solid_angle, const Vectors3<R>& moment, const std::uint32_t* list,
                              std::size_t count) {
        const Lanes<R> d;
        std::array<LaneValues<R>, 4> values;
        // Rounding may leave less than nothing of thin polygons.
        put<R>(values[0], hn::Mul(all(d, Base::kBand0), hn::Max(solid_angle, hn::Zero(d))));
        put<R>(values[1], hn::Mul(all(d, Base::kBand1), moment.y));
        put<R>(values[2], hn::Mul(all(d, Base::kBand1), moment.z));
        put<R>(values[3], hn::Mul(all(d, Base::kBand1), moment.x));
        for (std::size_t lane = 0; lane < count; ++lane) {
            for (std::size_t c = 0; c < std::min(values.size(), numbers_); ++c) {
                row(list[lane])[c] = static_cast<T>(values[c][lane]);
            }
        }
    }

    /// Arcs in double cancel to what float can hold: their sum is rounded, not they.
    void add_narrow(std::size_t count) {
        slot_.assign(count, kNone);
        std::size_t slots = 0;
        const auto give_slots = [&](const auto& list) {
            for (std::size_t k = 0; k < list.size(); ++k) {
                std::size_t& slot = slot_[list.region(k)];
                slot = slot == kNone ? slots++ : slot;
            }
        };
        for (std::size_t points = 1; points <= kMaxGaussPoints; ++points) {
            give_slots(this->double_arcs_.arcs.rows(points));
        }
        give_slots(this->double_arcs_.horizon);  // a sliver may have no other arc
        if (room_ < slots * numbers_) {
            room_ = slots * numbers_;
            sums_ = hwy::AllocateAligned<double>(room_);
        }
        std::fill_n(sums_.get(), slots * numbers_, 0.0);
        add_moments(this->double_arcs_, this->order_, [&](std::size_t i) { return sums_.get() + slot_[i] * numbers_; });
        for (std::size_t i = 0; i < count; ++i) {
            if (slot_[i] != kNone) {
                const double* from = sums_.get() + slot_[i] * numbers_;
                std::transform(from, from + numbers_, row(i), row(i),
                               [](double more, T sum) { return static_cast<T>(static_cast<double>(sum) + more); });
            }
        }
    }

    static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
    std::size_t numbers_;
    T* rows_;
    std::size_t first_ = 0;  ///< first polygon of the present chunk
    std::vector<std::size_t> slot_;
    hwy::AlignedFreeUniquePtr<double[]> sums_;  // NOLINT(modernize-avoid-c-arrays): as Highway names it
    std::size_t room_ = 0;                      ///< in sums_
};

template <class T>
void rows_in_lanes(const PolygonArray& polygons, std::size_t count, int order, bool clip, T* rows,
                   std::vector<std::uint32_t>& narrowest) {
    PolygonRows<T> work(polygons, order, rows);
    // Rows stay in the cache while arcs of other numbers of points come back to them.
    const std::size_t chunk = std::clamp<std::size_t>(65536 / static_cast<std::size_t>(order * order), 128, 1024);
    for (std::size_t first = 0; first < count; first += chunk) {
        work.integrate(first, std::min(chunk, count - first), clip, narrowest);
    }
}

void float_rows(const PolygonArray& polygons, std::size_t count, int order, bool clip, float* rows,
                std::vector<std::uint32_t>& narrowest) {
    rows_in_lanes(polygons, count, order, clip, rows, narrowest);
}

void double_rows(const PolygonArray& polygons, std::size_t count, int order, bool clip, double* rows,
                 std::vector<std::uint32_t>& narrowest) {
    rows_in_lanes(polygons, count, order, clip, rows, narrowest);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(float_rows);
HWY_EXPORT(double_rows);

template <class T>
void polygon_rows(std::span<const Vec3d> vertices, int vertex_count, int order, bool clip, T* rows) {
    if (vertices.empty()) {
        return;
    }
    const auto k = static_cast<std::size_t>(vertex_count);
    const PolygonArray polygons = {&vertices.data()->x, k};
    std::vector<std::uint32_t> narrowest;
    if constexpr (std::is_same_v<T, float>) {
        HWY_DYNAMIC_DISPATCH(float_rows)(polygons, vertices.size() / k, order, clip, rows, narrowest);
    } else {
        HWY_DYNAMIC_DISPATCH(double_rows)(polygons, vertices.size() / k, order, clip, rows, narrowest);
    }
    for (const std::size_t i : narrowest) {
        polygon_by_cubature(vertices.subspan(i * k, k), order, clip,
                            rows + i * static_cast<std::size_t>(coefficient_count(order)));
    }
}

template void polygon_rows(std::span<const Vec3d>, int, int, bool, float*);
template void polygon_rows(std::span<const Vec3d>, int, int, bool, double*);

}  // namespace shlight
#endif
