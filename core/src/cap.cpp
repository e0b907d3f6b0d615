// SPDX-License-Identifier: MIT
#include "shlight/cap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "checks.h"
#include "light_checks.h"
#include "safe_length.h"

namespace shlight {
namespace {

constexpr double kPi = std::numbers::pi;

/// 1 - x for x = cos α, without cancellation.
double one_minus(double cosine, double sine) {
    return cosine > 0 ? sine * sine / (1 + cosine) : 1 - cosine;
}

/// The sine of a unit vector's angle to z.
double sine_of_tilt(const Vec3d& unit) {
    return std::sqrt(unit.x * unit.x + unit.y * unit.y);
}

/// The circles of a light and of the horizon, and the triangle of their poles and a point where they cross. Each pair
/// (`chord`, cosine) is the product of two sides' sines times the (sine, cosine) of the angle between those sides.
struct Contact {
    Circle light;
    double height, sine;  // the horizon
    double chord;         // 0 where the circles do not cross
    double corner;        // cosθ - cosσ z_0: at the crossing
    double arc;           // cosσ - z_0 cosθ: at the horizon's pole
    double edge;          // z_0 - cosσ cosθ: at the light's pole
};

/// `arc` and `edge` from `corner`, as the form whose terms are smaller gives them. The first keeps every digit of small
/// lights and of the plane z_0 = 0; the second that of nearly equal or nearly opposite circles, where it is
/// arc ± edge = (cosσ ± z_0)(1 ∓ cosθ) that must be right.
void complete(Contact& contact) {
    const double c = contact.light.cosine;
    const double z = contact.height;
    const double cos_tilt = contact.light.axis.z;
    const double sin_tilt = sine_of_tilt(contact.light.axis);
    const double own = c * contact.sine * contact.sine;
    const double other = z * contact.light.sine * contact.light.sine;
    const double sum = (c + z) * one_minus(cos_tilt, sin_tilt);
    const double difference = (c - z) * one_minus(-cos_tilt, sin_tilt);
    const double size = std::abs(own) + std::abs(other) + (std::abs(c) + std::abs(z)) * std::abs(contact.corner);
    if (size <= std::abs(sum) + std::abs(difference)) {
        contact.arc = own - z * contact.corner;
        contact.edge = other - c * contact.corner;
    } else {
        contact.arc = (sum + difference) / 2;
        contact.edge = (sum - difference) / 2;
    }
}

/// What a horizon keeps of a light, as angles.
struct Kept {
    double arc = 0, edge = 0, solid_angle = 0;
};

/// Circles that do not cross: they are nested, or apart, or together they cover the sphere. `corner` decides whether
/// they are nested; which of the two others holds is a question of size, continuous where they touch.
Kept kept_without_crossing(const Contact& contact) {
    const double light = 2 * kPi * one_minus(contact.light.cosine, contact.light.sine);
    const double above = 2 * kPi * one_minus(contact.height, contact.sine);
    if (contact.corner >= 0) {
        return contact.light.cosine >= contact.height ? Kept{0, kPi, light} : Kept{kPi, 0, above};
    }
    const double rest = -2 * kPi * (contact.light.cosine + contact.height);
    return rest > 0 ? Kept{kPi, kPi, rest} : Kept{};
}

/// Area of the lens that two crossing circles enclose. Gauss–Bonnet for caps up to hemispheres, others are turned
/// inside out; with E the excess of the triangle and β the exterior angle at the crossing,
///   Ω/2 = ψ_0 (1 - cosσ) + φ_a (1 - z_0) - E = ψ_0 (1 - cosσ) + (β - ψ_0) - φ_a z_0.
/// The first form is for high horizons, where E is small; the second for low ones, where β - ψ_0 is one arctangent of
/// numbers as small as the light.
double lens_area(Contact contact, double arc, double edge) {
    const double lack = one_minus(contact.light.cosine, contact.light.sine);
    const double short_of_pole = one_minus(contact.height, contact.sine);
    double& cos_tilt = contact.light.axis.z;
    if (contact.light.cosine < 0) {
        cos_tilt = -cos_tilt;
        contact.light.cosine = -contact.light.cosine;
        contact.corner = -contact.corner;
        return 2 * kPi * short_of_pole - lens_area(contact, kPi - arc, edge);
    }
    if (contact.height < 0) {
        cos_tilt = -cos_tilt;
        contact.height = -contact.height;
        contact.corner = -contact.corner;
        contact.edge = -contact.edge;
        return 2 * kPi * lack - lens_area(contact, arc, kPi - edge);
    }
    if (contact.height > 0.5) {
        const double excess = 2 * std::atan2(contact.chord, 1 + cos_tilt + contact.light.cosine + contact.height);
        return 2 * (edge * lack + arc * short_of_pole - excess);
    }
    const double turn = std::atan2(contact.chord * (contact.height + cos_tilt) * lack,
                                   contact.chord * contact.chord - contact.edge * contact.corner);
    return 2 * (edge * lack + turn - arc * contact.height);
}

Kept kept_with_crossing(const Contact& contact) {
    const double arc = std::atan2(contact.chord, contact.arc);
    const double edge = std::atan2(contact.chord, contact.edge);
    return {arc, edge, std::max(0.0, lens_area(contact, arc, edge))};
}

template <class T>
Cap<T> make_cap(const Contact& contact) {
    const auto r = [](double x) { return static_cast<T>(x); };
    const Vec3d& axis = contact.light.axis;
    const double sin_tilt = sine_of_tilt(axis);
    const bool crossing = contact.chord > 0;
    const Kept kept = crossing ? kept_with_crossing(contact) : kept_without_crossing(contact);
    const double across = crossing ? 1 / safe_length({contact.chord, contact.arc, 0}) : 0;
    return {r(axis.z),
            r(sin_tilt),
            r(sin_tilt > 0 ? axis.x / sin_tilt : 1.0),
            r(sin_tilt > 0 ? axis.y / sin_tilt : 0.0),
            r(contact.light.cosine),
            r(contact.light.sine),
            r(kept.arc),
            r(crossing ? contact.arc * across : 1.0),
            r(contact.chord * across),
            r(kept.edge),
            r(kept.solid_angle),
            crossing};
}

/// The warp is a Lorentz transform of the circles' 4-vectors (cosine; axis): their product is invariant, so where a
/// light crosses the horizon is known from before the warp, with all digits. crossing_squared: sin²σ - L_z² there.
template <class T>
Cap<T> warped_cap(const Circle& light, double crossing_squared, const Warp& warp) {
    Contact contact{
        warp.is_identity() ? light : warp.warped(light), warp.horizon_height(), warp.horizon_sine(), 0, 0, 0, 0};
    const double shrink = light.sine > 0 ? contact.light.sine / light.sine : 1.0;
    const double scale = shrink * contact.sine;
    contact.chord = std::sqrt(std::max(0.0, crossing_squared)) * scale;
    contact.corner = light.axis.z * scale;
    if (contact.chord > 0) {
        complete(contact);
    }
    return make_cap<T>(contact);
}

}  // namespace

template <class T>
Cap<T> Cap<T>::of_sphere(const Vec3d& center, double radius, const Warp& warp) {
    const Circle light = circle_of_sphere(center, radius);
    const double distance = safe_length(center);
    const double crossing_squared = (radius - center.z) * (radius + center.z) / (distance * distance);
    return warped_cap<T>(light, crossing_squared, warp);
}

template <class T>
Cap<T> Cap<T>::of_facing_disk(const Vec3d& center, double radius, const Warp& warp) {
    return inside(circle_of_facing_disk(center, radius), warp);
}

template <class T>
Cap<T> Cap<T>::about_axis(const Vec3d& axis, double half_angle, const Warp& warp) {
    return inside(circle_about_axis(axis, half_angle), warp);
}

template <class T>
Cap<T> Cap<T>::inside(const Circle& circle, const Warp& warp) {
    // sin²σ - L_z² = sin²θ - cos²σ, from the smaller pair: near hemispheres may be seen straight above or below.
    const double sin_tilt = sine_of_tilt(circle.axis);
    const double crossing_squared = circle.sine < std::abs(circle.cosine)
                                        ? (circle.sine - circle.axis.z) * (circle.sine + circle.axis.z)
                                        : (sin_tilt - circle.cosine) * (sin_tilt + circle.cosine);
    return warped_cap<T>(circle, crossing_squared, warp);
}

template <class T>
Cap<T> Cap<T>::against(double horizon_height, double horizon_sine, const Vec3d& axis, double half_angle) {
    const double sigma = std::min(half_angle, kPi);
    const double theta = std::atan2(std::hypot(axis.x, axis.y), axis.z);
    const double eta = std::atan2(horizon_sine, horizon_height);
    // The half-angle formulas of the triangle with the sides θ, σ, η: four sines give everything.
    const double whole = std::sin((theta + sigma + eta) / 2);
    const double less_theta = std::sin((sigma + eta - theta) / 2);
    const double less_sigma = std::sin((theta + eta - sigma) / 2);
    const double less_eta = std::sin((theta + sigma - eta) / 2);
    const double nested = whole * less_theta;
    const double apart = less_sigma * less_eta;
    const double chord = 2 * std::sqrt(std::max(0.0, nested * apart));
    return make_cap<T>({{axis / safe_length(axis), std::cos(sigma), std::sin(sigma)},
                        horizon_height,
                        horizon_sine,
                        chord,
                        nested - apart,
                        whole * less_sigma - less_theta * less_eta,
                        whole * less_eta - less_theta * less_sigma});
}

template <class T>
Cap<T> Cap<T>::unclipped() const {
    Cap whole = *this;
    const T lack = cos_half > 0 ? sin_half * sin_half / (1 + cos_half) : 1 - cos_half;
    whole.arc = 0;
    whole.edge = std::numbers::pi_v<T>;
    whole.solid_angle = 2 * std::numbers::pi_v<T> * lack;
    whole.crossing = false;
    return whole;
}

template <class T>
void sphere_coefficients(std::span<const Vec3<T>> centers, std::span<const T> radii, int order, bool clip,
                         std::span<T> coefficients) {
    check_order(order);
    check_size("radii", radii.size(), centers.size());
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("coefficients", coefficients.size(), centers.size() * row);
    for (std::size_t i = 0; i < centers.size(); ++i) {
        const Vec3d center(centers[i]);
        check_sphere(center, radii[i], std::numeric_limits<T>::epsilon());
        cap_coefficients(Cap<T>::of_sphere(center, radii[i]), order, clip, coefficients.data() + i * row);
    }
}

template <class T>
void cap_coefficients(std::span<const Vec3<T>> axes, std::span<const T> half_angles, int order, bool clip,
                      std::span<T> coefficients) {
    check_order(order);
    check_size("half_angles", half_angles.size(), axes.size());
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("coefficients", coefficients.size(), axes.size() * row);
    for (std::size_t i = 0; i < axes.size(); ++i) {
        const Vec3d axis(axes[i]);
        check_cap(axis, half_angles[i]);
        cap_coefficients(Cap<T>::about_axis(axis, half_angles[i]), order, clip, coefficients.data() + i * row);
    }
}

template struct Cap<float>;
template struct Cap<double>;
template void sphere_coefficients(std::span<const Vec3<float>>, std::span<const float>, int, bool, std::span<float>);
template void sphere_coefficients(std::span<const Vec3<double>>, std::span<const double>, int, bool, std::span<double>);
template void cap_coefficients(std::span<const Vec3<float>>, std::span<const float>, int, bool, std::span<float>);
template void cap_coefficients(std::span<const Vec3<double>>, std::span<const double>, int, bool, std::span<double>);

}  // namespace shlight
