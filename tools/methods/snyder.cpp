// SPDX-License-Identifier: MIT
//
// zhou_wei with the boundary integrals B_l from powers of the height z: Snyder 1996 (MSR-TR-96-11), the comparison in
// Fig. 6 of Zhou & Wei 2020. Each Legendre polynomial is expanded in monomials, whose coefficients alternate and grow
// like 2.4^l.
#include <algorithm>
#include <array>
#include <cmath>

#include "arc_recurrence.h"
#include "cap_outline.h"
#include "method.h"

namespace shlight::methods {
namespace {

/// P_l(z) = Σ_k p_lk z^k, k = l, l-2, …
template <class T>
struct LegendrePowers {
    std::array<std::array<T, kMaxZonalOrder>, kMaxZonalOrder> coefficients{};

    LegendrePowers() {
        std::array<std::array<long double, kMaxZonalOrder>, kMaxZonalOrder> exact{};
        exact[0][0] = exact[1][1] = 1;
        for (std::size_t l = 2; l < exact.size(); ++l) {
            for (std::size_t k = 0; k <= l; ++k) {
                const long double raised = k > 0 ? exact[l - 1][k - 1] : 0;
                exact[l][k] =
                    (static_cast<long double>(2 * l - 1) * raised - static_cast<long double>(l - 1) * exact[l - 2][k]) /
                    static_cast<long double>(l);
            }
        }
        for (std::size_t l = 0; l < exact.size(); ++l) {
            std::transform(exact[l].begin(), exact[l].end(), coefficients[l].begin(),
                           [](long double x) { return static_cast<T>(x); });
        }
    }
    static const LegendrePowers& get() {
        static const LegendrePowers powers;
        return powers;
    }
};

/// An arc as in arc_recurrence.h. The moments I_k = ∫ z^k dφ follow from d(z^{k-1} b sinφ)/dφ,
///   k I_k = [z^{k-1} b sinφ] + (2k-1) a I_{k-1} + (k-1) (b² - a²) I_{k-2}.
/// Adds cosθ I_k - cosα I_{k+1}, the boundary integrals of z^k, to row k = 0 … order - 2. kWhole: a circle, without
/// ends.
template <class T, bool kWhole>
void add_moments(const CircleArc<T>& arc, const Vec3<T>& from, const Vec3<T>& to, int order, LobeTable<T>& moments) {
    const std::size_t columns = lobe_columns(order);
    const LobeAxes<T>& axes = LobeAxes<T>::get();
    LobeRow<T> along, from_height, to_height, from_edge, to_edge, before, moment;
    axes.dot(arc.axis, columns, along);
    if constexpr (!kWhole) {
        axes.dot(from, columns, from_height);
        axes.dot(to, columns, to_height);
        axes.dot(glm::cross(from, arc.axis), columns, from_edge);
        axes.dot(glm::cross(to, arc.axis), columns, to_edge);
    }
    std::fill_n(before.begin(), columns, T(0));
    std::fill_n(moment.begin(), columns, arc.angle);
    for (int k = 1; k < order; ++k) {
        LobeRow<T>& row = moments[static_cast<std::size_t>(k - 1)];
        const T ahead = kZonal<T>.forth[static_cast<std::size_t>(k)];
        const T back = kZonal<T>.back[static_cast<std::size_t>(k)];
        const T share = kZonal<T>.share[static_cast<std::size_t>(k - 1)];  // 1 / k
        for (std::size_t i = 0; i < columns; ++i) {
            const T h = along[i];
            const T a = arc.cosine * h;
            const T difference = arc.sine * arc.sine * (1 - h * h) - a * a;
            T next = ahead * a * moment[i] + back * difference * before[i];
            if constexpr (!kWhole) {
                next += share * (to_edge[i] - from_edge[i]);
                from_edge[i] *= from_height[i];
                to_edge[i] *= to_height[i];
            }
            row[i] += h * moment[i] - arc.cosine * next;
            before[i] = moment[i];
            moment[i] = next;
        }
    }
}

/// B_l in row l + 1.
template <class T>
void expand(const LobeTable<T>& moments, int order, LobeTable<T>& boundary) {
    const std::size_t columns = lobe_columns(order);
    for (int l = 0; l < order - 1; ++l) {
        LobeRow<T>& row = boundary[static_cast<std::size_t>(l + 1)];
        std::fill_n(row.begin(), columns, T(0));
        for (int k = l % 2; k <= l; k += 2) {
            const T factor =
                LegendrePowers<T>::get().coefficients[static_cast<std::size_t>(l)][static_cast<std::size_t>(k)];
            const LobeRow<T>& moment = moments[static_cast<std::size_t>(k)];
            for (std::size_t i = 0; i < columns; ++i) {
                row[i] += factor * moment[i];
            }
        }
    }
}

template <class T>
void cap(const CapLight& light, int order, bool clip, const Options& /*options*/, T* coefficients) {
    const CapAngles<T> angles(light);
    const CapBoundary<T> outline(angles, clip);
    if (!(outline.solid_angle > 0)) {
        std::fill_n(coefficients, coefficient_count(order), T(0));
        return;
    }
    LobeTable<T> moments;
    for (int k = 0; k < order - 1; ++k) {
        std::fill_n(moments[static_cast<std::size_t>(k)].begin(), lobe_columns(order), T(0));
    }
    const CircleArc<T> edge{angles.axis, angles.cos_half, angles.sin_half, outline.edge};
    const CircleArc<T> horizon{Vec3<T>(0, 0, 1), T(0), T(1), outline.horizon};
    if (outline.crossing) {
        add_moments<T, false>(edge, outline.right, outline.left, order, moments);
        add_moments<T, false>(horizon, outline.left, outline.right, order, moments);
    } else {
        for (const CircleArc<T>& circle : {edge, horizon}) {
            if (circle.angle > 0) {
                add_moments<T, true>(circle, {}, {}, order, moments);
            }
        }
    }
    LobeTable<T> integrals;
    expand(moments, order, integrals);
    zonal_coefficients(integrals, T(1), outline.solid_angle, order, coefficients);
}

}  // namespace

Method snyder() {
    return {"snyder",
            "Snyder 1996 as in Zhou & Wei 2020, Fig. 6: zonal factorization, monomials along the edge",
            kMaxZonalOrder,
            false,
            false,
            {&cap<float>, nullptr},
            {&cap<double>, nullptr}};
}

}  // namespace shlight::methods
