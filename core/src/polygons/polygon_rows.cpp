// SPDX-License-Identifier: MIT
#include "polygons/polygon_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "polygons/polygon_rows.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>

#include "polygons/moments-inl.h"
#include "polygons/polygon_lists-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// Work of one call of polygon_rows.
class PolygonRows : public PolygonLists<PolygonRows, false> {
    using Base = PolygonLists<PolygonRows, false>;
    friend Base;

  public:
    PolygonRows(const PolygonArray& polygons, int order, float* rows)
        : Base(polygons, order, 1), numbers_(static_cast<std::size_t>(coefficient_count(order))), rows_(rows) {}

    void integrate(std::size_t first, std::size_t count, bool clip, std::vector<std::uint32_t>& narrowest) {
        first_ = first;
        std::fill_n(row(0), count * numbers_, 0.0F);
        take(count, clip);
        add_moments<true>(float_arcs_, order_, [&](std::size_t i) { return row(i); });
        add_narrow(count);
        for (const std::uint32_t i : narrowest_) {
            narrowest.push_back(static_cast<std::uint32_t>(first + i));
        }
    }

  private:
    std::size_t polygon(std::size_t i) const { return first_ + i; }
    const double* vertex(std::size_t i) const { return polygons_.vertices + 3 * polygons_.vertex_count * polygon(i); }
    static std::uint32_t view(std::size_t) { return 0; }
    float* row(std::size_t i) const { return rows_ + (first_ + i) * numbers_; }

    template <class R>
    HWY_INLINE void low_bands(V<Lanes<R>> solid_angle, const Vectors3<R>& moment, const std::uint32_t* list,
                              std::size_t count) {
        const Lanes<R> d;
        std::array<LaneValues<R>, 4> values;
        put<R>(values[0], hn::Mul(all(d, kBand0), solid_angle));
        put<R>(values[1], hn::Mul(all(d, kBand1), moment.y));
        put<R>(values[2], hn::Mul(all(d, kBand1), moment.z));
        put<R>(values[3], hn::Mul(all(d, kBand1), moment.x));
        for (std::size_t lane = 0; lane < count; ++lane) {
            for (std::size_t c = 0; c < std::min(values.size(), numbers_); ++c) {
                row(list[lane])[c] = static_cast<float>(values[c][lane]);
            }
        }
    }

    /// Arcs in double cancel to what float can hold: their sum is rounded, not they.
    void add_narrow(std::size_t count) {
        slot_.assign(count, kNone);
        sums_.clear();
        std::size_t slots = 0;
        const auto find = [&](const auto& list) {
            for (std::size_t k = 0; k < list.size(); ++k) {
                std::size_t& slot = slot_[list.region(k)];
                slot = slot == kNone ? slots++ : slot;
            }
        };
        for (std::size_t points = 1; points <= kMaxGaussPoints; ++points) {
            find(double_arcs_.arcs(points));
        }
        sums_.resize(slots * numbers_);
        add_moments<true>(double_arcs_, order_, [&](std::size_t i) { return sums_.data() + slot_[i] * numbers_; });
        for (std::size_t i = 0; i < count; ++i) {
            if (slot_[i] != kNone) {
                const double* from = sums_.data() + slot_[i] * numbers_;
                std::transform(from, from + numbers_, row(i), row(i), [](double more, float sum) {
                    return static_cast<float>(static_cast<double>(sum) + more);
                });
            }
        }
    }

    static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
    static constexpr double kBand0 = 0.28209479177387814;  ///< 1 / √4π
    static constexpr double kBand1 = 0.48860251190291992;  ///< √(3 / 4π)

    std::size_t numbers_;
    float* rows_;
    std::size_t first_ = 0;  ///< of the present chunk
    std::vector<std::size_t> slot_;
    std::vector<double> sums_;
};

void rows_in_lanes(const PolygonArray& polygons, std::size_t count, int order, bool clip, float* rows,
                   std::vector<std::uint32_t>& narrowest) {
    PolygonRows work(polygons, order, rows);
    // Rows stay in the cache while arcs of other numbers of points come back to them.
    const std::size_t chunk = std::clamp<std::size_t>(65536 / static_cast<std::size_t>(order * order), 128, 1024);
    for (std::size_t first = 0; first < count; first += chunk) {
        work.integrate(first, std::min(chunk, count - first), clip, narrowest);
    }
}

template <class R>
void add_arcs(const ArcLists<R>& arcs, bool great, int order, R* coefficients) {
    const auto numbers = static_cast<std::size_t>(coefficient_count(order));
    const auto row = [&](std::size_t region) { return coefficients + region * numbers; };
    if (great) {
        add_moments<true>(arcs, order, row);
    } else {
        add_moments<false>(arcs, order, row);
    }
}

void add_float_arcs(const ArcLists<float>& arcs, bool great, int order, float* coefficients) {
    add_arcs(arcs, great, order, coefficients);
}

void add_double_arcs(const ArcLists<double>& arcs, bool great, int order, double* coefficients) {
    add_arcs(arcs, great, order, coefficients);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(rows_in_lanes);
HWY_EXPORT(add_float_arcs);
HWY_EXPORT(add_double_arcs);

std::vector<std::uint32_t> polygon_rows(std::span<const Vec3d> vertices, int vertex_count, int order, bool clip,
                                        float* rows) {
    std::vector<std::uint32_t> narrowest;
    const auto k = static_cast<std::size_t>(vertex_count);
    if (!vertices.empty()) {
        HWY_DYNAMIC_DISPATCH(rows_in_lanes)
        ({&vertices.data()->x, k}, vertices.size() / k, order, clip, rows, narrowest);
    }
    return narrowest;
}

void add_arc_coefficients(const ArcLists<float>& arcs, bool great, int order, float* coefficients) {
    HWY_DYNAMIC_DISPATCH(add_float_arcs)(arcs, great, order, coefficients);
}

void add_arc_coefficients(const ArcLists<double>& arcs, bool great, int order, double* coefficients) {
    HWY_DYNAMIC_DISPATCH(add_double_arcs)(arcs, great, order, coefficients);
}

}  // namespace shlight
#endif
