// SPDX-License-Identifier: MIT
#include "arc_recurrence.h"

#include <algorithm>

namespace shlight::methods {
namespace {

enum class ArcKind { partial, circle, great };

/// C_l, D_l, E_l and F_l of one arc, band after band. C, E and F refer to l - 2: each step overwrites the row of the
/// same parity.
template <class T, ArcKind kKind>
class ArcRecurrence {
  public:
    ArcRecurrence(const CircleArc<T>& arc, const LobePoint<T>* from, const LobePoint<T>* to, int order)
        : columns_(lobe_columns(order)), cosine_(arc.cosine), from_(from), to_(to) {
        const LobeAxes<T>& axes = LobeAxes<T>::get();
        axes.dot(arc.axis, columns_, along_);
        if constexpr (kKind != ArcKind::circle) {
            axes.dot(glm::cross(from->point, arc.axis), columns_, from_sine_);
            axes.dot(glm::cross(to->point, arc.axis), columns_, to_sine_);
        }
        const T sine2 = arc.sine * arc.sine;
        for (std::size_t i = 0; i < columns_; ++i) {
            const T h = along_[i];
            middle_[i] = arc.cosine * h;
            factor_[i] = sine2 * (1 - h * h) - middle_[i] * middle_[i] - 1;
            d_[i] = middle_[i] * arc.angle;
            if constexpr (kKind != ArcKind::circle) {
                d_[i] += to_sine_[i] - from_sine_[i];
            }
            c_even_[i] = arc.angle;
            c_odd_[i] = e_even_[i] = e_odd_[i] = f_even_[i] = f_odd_[i] = 0;
        }
    }

    void add_to(LobeTable<T>& boundary, int order) {
        for (std::size_t i = 0; i < columns_; ++i) {
            boundary[1][i] += along_[i] * c_even_[i] - cosine_ * d_[i];
        }
        for (int l = 1; l < order - 1; ++l) {
            if (l % 2 == 1) {
                step(l, c_even_, c_odd_, e_odd_, f_odd_, boundary[static_cast<std::size_t>(l + 1)]);
            } else {
                step(l, c_odd_, c_even_, e_even_, f_even_, boundary[static_cast<std::size_t>(l + 1)]);
            }
        }
    }

  private:
    /// c, e and f hold band l - 2 and get band l; d_ holds band l - 1 and gets band l.
    void step(int l, const LobeRow<T>& c_before, LobeRow<T>& c, LobeRow<T>& e, LobeRow<T>& f, LobeRow<T>& boundary) {
        const auto row = static_cast<std::size_t>(l);
        const auto degree = static_cast<T>(l);
        const T twice = static_cast<T>(2 * l - 1);
        const T forth = kZonal<T>.forth[row];
        const T back = kZonal<T>.back[row];
        const T share = kZonal<T>.share[row];
        for (std::size_t i = 0; i < columns_; ++i) {
            const T before = c_before[i];
            c[i] = forth * d_[i] - back * c[i];  // Eq. 15
            e[i] += twice * before;              // Eq. 18
            T sum = degree * before + factor_[i] * e[i];
            if constexpr (kKind != ArcKind::circle) {
                sum += to_->legendre[row][i] * to_sine_[i] - from_->legendre[row][i] * from_sine_[i];
            }
            if constexpr (kKind == ArcKind::great) {
                d_[i] = share * sum;
                boundary[i] += along_[i] * c[i];
            } else {
                f[i] += twice * d_[i];
                d_[i] = share * (sum + middle_[i] * (c[i] + 2 * f[i]));  // Eq. 16
                boundary[i] += along_[i] * c[i] - cosine_ * d_[i];       // Eq. 13
            }
        }
    }

    std::size_t columns_;
    T cosine_;
    const LobePoint<T>* from_;
    const LobePoint<T>* to_;
    LobeRow<T> along_, middle_, factor_;  // A·ω_d, a, b² - a² - 1
    LobeRow<T> from_sine_, to_sine_;      // b sin(φ - φ_d) at the ends
    LobeRow<T> c_even_, c_odd_, d_, e_even_, e_odd_, f_even_, f_odd_;
};

}  // namespace

template <class T>
void LobePoint<T>::set(const Vec3<T>& unit, int order) {
    point = unit;
    if (order < 3) {
        return;
    }
    const std::size_t columns = lobe_columns(order);
    LobeRow<T> height, before, present;  // rows of their own: the compiler need not fear that rows of a table overlap
    LobeAxes<T>::get().dot(unit, columns, height);
    std::fill_n(before.begin(), columns, T(1));
    std::copy_n(height.begin(), columns, present.begin());
    std::copy_n(height.begin(), columns, legendre[1].begin());
    for (std::size_t l = 2; l + 1 < static_cast<std::size_t>(order); ++l) {
        LobeRow<T>& row = legendre[l];
        const T forth = kZonal<T>.forth[l];
        const T back = kZonal<T>.back[l];
        for (std::size_t i = 0; i < columns; ++i) {
            const T next = forth * height[i] * present[i] - back * before[i];
            before[i] = present[i];
            present[i] = next;
            row[i] = next;
        }
    }
}

template <class T>
void clear_boundary(LobeTable<T>& boundary, int order) {
    for (int l = 1; l < order; ++l) {
        std::fill_n(boundary[static_cast<std::size_t>(l)].begin(), lobe_columns(order), T(0));
    }
}

template <class T>
void add_arc(const CircleArc<T>& arc, const LobePoint<T>& from, const LobePoint<T>& to, int order,
             LobeTable<T>& boundary) {
    if (order > 1) {
        ArcRecurrence<T, ArcKind::partial>(arc, &from, &to, order).add_to(boundary, order);
    }
}

template <class T>
void add_circle(const CircleArc<T>& circle, int order, LobeTable<T>& boundary) {
    if (order > 1) {
        ArcRecurrence<T, ArcKind::circle>(circle, nullptr, nullptr, order).add_to(boundary, order);
    }
}

template <class T>
void add_great_arc(const CircleArc<T>& arc, const LobePoint<T>& from, const LobePoint<T>& to, int order,
                   LobeTable<T>& boundary) {
    if (order > 1) {
        ArcRecurrence<T, ArcKind::great>(arc, &from, &to, order).add_to(boundary, order);
    }
}

#define SHLIGHT_INSTANTIATE(T)                                                                                \
    template struct LobePoint<T>;                                                                             \
    template void clear_boundary(LobeTable<T>&, int);                                                         \
    template void add_arc(const CircleArc<T>&, const LobePoint<T>&, const LobePoint<T>&, int, LobeTable<T>&); \
    template void add_circle(const CircleArc<T>&, int, LobeTable<T>&);                                        \
    template void add_great_arc(const CircleArc<T>&, const LobePoint<T>&, const LobePoint<T>&, int, LobeTable<T>&);
SHLIGHT_INSTANTIATE(float)
SHLIGHT_INSTANTIATE(double)
#undef SHLIGHT_INSTANTIATE

}  // namespace shlight::methods
