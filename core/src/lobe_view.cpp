// SPDX-License-Identifier: MIT
#include "lobe_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "light_cubature.h"
#include "light_outline.h"
#include "lobe_outline.h"
#include "polygon_region.h"
#include "polygon_shading.h"
#include "shlight/cap.h"

namespace shlight {
namespace {

/// Rules up to these are cheaper than harmonics of the orders that glossy lobes take.
constexpr int kCheapCapRule = 3;
constexpr int kCheapPolygonRule = 2;

/// Of a polygon of one radian, as a relative size: the projection of the sphere onto a plane varies as a lobe does.
constexpr double kFlatness = 1.2;

/// The middle of a polygon and the greatest distance of a vertex from it, as directions.
struct Extent {
    Vec3d middle;
    double half_angle;
};

Extent extent_of(const SphericalPolygon<double>& polygon) {
    Extent e{Vec3d(0), 0};
    for (const Vec3d& v : polygon.directions()) {
        e.middle += v;
    }
    e.middle = glm::normalize(e.middle);
    for (const Vec3d& v : polygon.directions()) {
        e.half_angle = std::max(e.half_angle, glm::length(v - e.middle));
    }
    return e;
}

}  // namespace

LobeAtView::LobeAtView(const LobeShape& shape, const WarpedFit* fit, double cos_theta_o, double tolerance,
                       bool auto_order)
    : shape_(shape),
      view_(std::sqrt((1 - cos_theta_o) * (1 + cos_theta_o)), 0, cos_theta_o),
      choose_(auto_order && std::holds_alternative<GgxShape>(shape)) {
    if (fit == nullptr) {
        return;
    }
    tolerance_ = tolerance;
    albedo_ = fit->albedo(cos_theta_o);
    order_ = auto_order ? fit->order_for(cos_theta_o, tolerance) : fit->orders().front();
    if (order_ > 0) {
        met_ = fit->shading_error(cos_theta_o, order_) <= tolerance;
        warp_ = fit->warp(cos_theta_o);
        horizon_.emplace(warp_, order_);
        terms_.resize(static_cast<std::size_t>(cosine_count(order_)));
        fit->coefficients(cos_theta_o, order_, terms_.data());
    }
}

float LobeAtView::mirrored() const {
    return static_cast<float>(fresnel_factor(ggx(), view_.z));
}

LobeRadiance LobeAtView::radiance(const Circle& cap) const {
    if (cap.axis.z <= -cap.sine) {
        return {0, 0, 0, true};
    }
    if (is_mirror(shape_)) {
        const Vec3d mirrored_view(-view_.x, 0, view_.z);
        return {glm::dot(mirrored_view, cap.axis) >= cap.cosine ? mirrored() : 0.0F, 0, 0, true};
    }
    if (choose_ && cap.axis.z >= cap.sine) {
        const double size = relative_size(ggx(), view_, cap.axis, std::atan2(cap.sine, cap.cosine));
        const int rule = cap_rule_number(size, tolerance_);
        if (rule > 0 && (rule <= kCheapCapRule || order_ == 0)) {
            const CubatureSum sum = cap_cubature(ggx(), view_, cap, rule);
            return {static_cast<float>(sum.value), 0, sum.points, true};
        }
    }
    if (order_ > 0) {
        return {shade_cap(Cap<float>::inside(cap, warp_), *horizon_, terms_.data(), order_), order_, 0, met_};
    }
    const OutlineIntegral integral = outline_integral(ggx(), view_.z, CapOutline(cap).arcs(), tolerance_ * albedo_);
    return {static_cast<float>(integral.value), 0, integral.points, integral.error <= tolerance_ * albedo_};
}

bool LobeAtView::reflects_into(const SphericalPolygon<double>& polygon) const {
    const Vec3d mirrored_view(-view_.x, 0, view_.z);
    // The winding of the outline about the direction, as angles between neighbouring vertices.
    const std::vector<Vec3d>& v = polygon.directions();
    double winding = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3d a = glm::cross(mirrored_view, v[i]);
        const Vec3d b = glm::cross(mirrored_view, v[(i + 1) % v.size()]);
        winding += std::atan2(glm::dot(mirrored_view, glm::cross(a, b)), glm::dot(a, b));
    }
    return winding > 1 &&
           std::any_of(v.begin(), v.end(), [&](const Vec3d& d) { return glm::dot(d, mirrored_view) > 0; });
}

LobeRadiance LobeAtView::radiance(const SphericalPolygon<double>& polygon) const {
    if (polygon.empty()) {
        return {0, 0, 0, true};
    }
    if (is_mirror(shape_)) {
        return {reflects_into(polygon) ? mirrored() : 0.0F, 0, 0, true};
    }
    if (choose_) {
        const Extent extent = extent_of(polygon);
        const double size =
            std::max(relative_size(ggx(), view_, extent.middle, extent.half_angle), kFlatness * extent.half_angle);
        const int rule = polygon_rule_number(size, tolerance_);
        if (rule > 0 && (rule <= kCheapPolygonRule || order_ == 0)) {
            const CubatureSum sum = polygon_cubature(ggx(), view_, polygon, rule);
            return {static_cast<float>(sum.value), 0, sum.points, true};
        }
    }
    if (order_ > 0) {
        const float value = warp_.is_identity()
                                ? shade_polygon(polygon, warp_, terms_.data(), order_)
                                : shade_region(PolygonRegion<double>(polygon, warp_), terms_.data(), order_);
        return {value, order_, 0, met_};
    }
    const std::vector<OutlineArc> outline = polygon_outline(polygon);
    const OutlineIntegral integral = outline_integral(ggx(), view_.z, outline, tolerance_ * albedo_);
    return {static_cast<float>(integral.value), 0, integral.points, integral.error <= tolerance_ * albedo_};
}

}  // namespace shlight
