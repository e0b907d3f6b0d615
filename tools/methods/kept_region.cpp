// SPDX-License-Identifier: MIT
#include "kept_region.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace shlight::methods {
namespace {

using std::numbers::pi;

/// Edges are cut into pieces of at most this angle.
constexpr double kLongestEdge = 1;

double one_minus_cos(const SphericalCap& cap) {
    return cap.cosine > 0 ? cap.sine * cap.sine / (1 + cap.cosine) : 1 - cap.cosine;
}

/// Unit vectors perpendicular to a cap's axis and to each other, counter-clockwise: one towards the zenith, one level.
struct RimFrame {
    Vec3d up, level;

    explicit RimFrame(const Vec3d& axis) {
        const double tilt = std::hypot(axis.x, axis.y);
        if (tilt > 0) {
            level = Vec3d(axis.y, -axis.x, 0) / tilt;
            up = glm::cross(level, axis);
        } else {
            up = Vec3d(1, 0, 0);
            level = Vec3d(0, axis.z, 0);
        }
    }
};

/// Cuts a range into pieces of equal length.
template <class Add>
void cut(double from, double to, double longest, const Add& add) {
    const int count = std::max(1, static_cast<int>(std::ceil((to - from) / longest)));
    for (int i = 0; i < count; ++i) {
        add(from + (to - from) * i / count, from + (to - from) * (i + 1) / count);
    }
}

void add_rim(const SphericalCap& cap, const Vec3d& base, double half_turn, std::vector<Edge>& edges) {
    const RimFrame frame(cap.axis);
    const Vec3d offset = (cap.axis - base) - one_minus_cos(cap) * cap.axis;
    cut(-half_turn, half_turn, pi / 2, [&](double from, double to) {
        edges.push_back({false, offset, cap.sine * frame.up, cap.sine * frame.level, from, to});
    });
}

/// ∫ ω dω: half the sum of the edges' poles times their lengths (Lambert 1760).
Vec3d mean_direction(const SphericalPolygon& polygon) {
    const auto& v = polygon.directions();
    Vec3d sum(0);
    for (std::size_t i = 0; i < v.size(); ++i) {
        const double sine = glm::length(polygon.edge_cross(i));
        if (sine > 0) {
            sum += polygon.edge_cross(i) * (std::atan2(sine, glm::dot(v[i], v[(i + 1) % v.size()])) / sine);
        }
    }
    const double length = glm::length(sum);
    return length > 0 ? sum / length : v[0];
}

}  // namespace

Patch::Patch(const Vec3d& hub, double magnification, const Vec3d& base, const Edge& edge)
    : hub_(hub), magnification_(magnification), whole_(false), offset_((base - hub) + edge.offset), edge_(edge) {}

Patch::Patch(const SphericalCap& cap) : hub_(cap.axis), whole_(true), half_angle_(std::atan2(cap.sine, cap.cosine)) {
    const RimFrame frame(cap.axis);
    edge_ = {false, Vec3d(0), frame.up, frame.level, 0, 2 * pi};
}

Patch Patch::negative() const {
    Patch result = *this;
    result.sign_ = -sign_;
    return result;
}

Spoke Patch::spoke(double v) const {
    const double range = edge_.to - edge_.from;
    const double t = edge_.from + range * v;
    Vec3d step = t * edge_.x;
    Vec3d slope = edge_.x;
    if (!edge_.straight) {
        const double c = std::cos(t);
        const double s = std::sin(t);
        step = c * edge_.x + s * edge_.y;
        slope = c * edge_.y - s * edge_.x;
    }
    if (whole_) {
        return {step, half_angle_, sign_ * range};
    }
    const Vec3d way = offset_ + step;  // from the hub to the edge
    const Vec3d end = hub_ + way;
    const Vec3d normal = glm::cross(hub_, way);
    const double square = glm::dot(normal, normal);
    if (!(square > 0)) {
        return {Vec3d(0), 0, 0};
    }
    const double sine = std::sqrt(square);
    const double half_tangent = sine / (glm::length(end) + glm::dot(hub_, end));
    return {glm::cross(normal, hub_) / sine, 2 * std::atan(magnification_ * half_tangent),
            sign_ * range * glm::dot(hub_, glm::cross(way, slope)) / square};
}

WeightedDirection Patch::at(const Spoke& spoke, double u) const {
    const double spread = std::tan(u * spoke.reach / 2);
    const double half_tangent = spread / magnification_;
    const double scale = 1 / (1 + half_tangent * half_tangent);
    const double sine = 2 * half_tangent * scale;
    const double stretch = (1 + spread * spread) * scale / magnification_;
    return {(1 - half_tangent * half_tangent) * scale * hub_ + sine * spoke.across,
            sine * stretch * spoke.reach * spoke.turn};
}

KeptRegion KeptRegion::of_cap(const SphericalCap& cap, bool clip) {
    KeptRegion region;
    if (!clip) {
        region.add_cap(cap, 1);
    } else if (cap.cosine >= 0) {
        region.add_cut_cap(cap, 1);
    } else {
        // The hemisphere minus the rest of the sphere.
        region.add_cap({Vec3d(0, 0, 1), 0, 1}, 1);
        region.add_cut_cap({-cap.axis, -cap.cosine, cap.sine}, -1);
    }
    return region;
}

void KeptRegion::add_cap(const SphericalCap& cap, double sign) {
    base_ = cap.axis;
    caps_.push_back({cap, sign});
}

void KeptRegion::add_cut_cap(const SphericalCap& cap, double sign) {
    const double height = cap.axis.z;
    if (height >= cap.sine) {
        add_cap(cap, sign);
        return;
    }
    if (height <= -cap.sine) {
        return;
    }
    edge_sign_ = sign;
    const double tilt = std::hypot(cap.axis.x, cap.axis.y);
    const Vec3d level(cap.axis.x / tilt, cap.axis.y / tilt, 0);
    const double elevation = (std::atan2(height, tilt) + std::atan2(cap.sine, cap.cosine)) / 2;
    base_ = std::cos(elevation) * level + Vec3d(0, 0, std::sin(elevation));
    // The rim is above the horizon where tilt sinσ cosψ ≥ -height cosσ.
    const double half_turn = std::atan2(std::sqrt((cap.sine - height) * (cap.sine + height)), -height * cap.cosine);
    add_rim(cap, base_, half_turn, edges_);
    // The horizon closes the boundary through its middle, in two arcs of at most a quarter turn.
    const RimFrame frame(cap.axis);
    const Vec3d center = (cap.axis - base_) - one_minus_cos(cap) * cap.axis;
    const Vec3d lift = cap.sine * std::cos(half_turn) * frame.up;
    const Vec3d aside = cap.sine * std::sin(half_turn) * frame.level;
    Vec3d first = center + lift + aside;
    Vec3d last = center + lift - aside;
    first.z = last.z = -base_.z;
    const Vec3d drop(level.x * height * height / (1 + tilt), level.y * height * height / (1 + tilt), -height);
    const Vec3d middle = (cap.axis - base_) + drop;
    edges_.push_back({true, first, middle - first, Vec3d(0), 0, 1});
    edges_.push_back({true, middle, last - middle, Vec3d(0), 0, 1});
}

KeptRegion KeptRegion::of_polygon(const SphericalPolygon& polygon) {
    KeptRegion region;
    if (polygon.empty()) {
        return region;
    }
    region.base_ = mean_direction(polygon);
    const Vec3d& base = region.base_;
    const auto& v = polygon.directions();
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3d& a = v[i];
        const Vec3d& b = v[(i + 1) % v.size()];
        const double sine = glm::length(polygon.edge_cross(i));
        if (!(sine > 0)) {
            continue;
        }
        const Vec3d ahead = glm::cross(polygon.edge_cross(i) / sine, a);
        const double angle = std::atan2(sine, glm::dot(a, b));
        const int count = static_cast<int>(std::ceil(angle / kLongestEdge));
        Vec3d from = a;
        for (int k = 1; k <= count; ++k) {
            const double turn = angle * k / count;
            const Vec3d to = k == count ? b : std::cos(turn) * a + std::sin(turn) * ahead;
            region.edges_.push_back({true, from - base, to - from, Vec3d(0), 0, 1});
            from = to;
        }
    }
    return region;
}

double KeptRegion::extent() const {
    double largest = 0;
    for (const WholeCap& cap : caps_) {
        largest = std::max(largest, std::atan2(cap.circle.sine, cap.circle.cosine));
    }
    for (const Edge& edge : edges_) {
        const Patch patch(base_, 1, base_, edge);
        largest = std::max({largest, patch.spoke(0).reach, patch.spoke(1).reach});
    }
    return largest;
}

std::vector<Patch> KeptRegion::patches() const {
    std::vector<Patch> result;
    for (const WholeCap& cap : caps_) {
        const Patch patch(cap.circle);
        result.push_back(cap.sign > 0 ? patch : patch.negative());
    }
    for (const Edge& edge : edges_) {
        const Patch patch(base_, 1, base_, edge);
        result.push_back(edge_sign_ > 0 ? patch : patch.negative());
    }
    return result;
}

std::vector<Patch> KeptRegion::patches_about(const Vec3d& hub, double magnification) const {
    std::vector<Edge> edges = edges_;
    for (const WholeCap& cap : caps_) {
        add_rim(cap.circle, base_, pi, edges);
    }
    std::vector<Patch> result;
    result.reserve(edges.size());
    for (const Edge& edge : edges) {
        result.emplace_back(hub, magnification, base_, edge);
    }
    return result;
}

}  // namespace shlight::methods
