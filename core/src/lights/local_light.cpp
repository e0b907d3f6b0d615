// SPDX-License-Identifier: MIT
#include "lights/local_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "emitters/emitter_levels.h"

namespace shlight {
namespace {

/// Least lit share of an edge. Thinner parts are not shaded; their rounding errors would dominate.
constexpr double kThinnestPart = 1e-9;

/// A cap of world directions that contains a light, seen from a point.
struct Bounds {
    Vec3d towards;  ///< unit
    double half_angle;
};

/// All directions, for points within a light.
constexpr Bounds kEverywhere = {{0, 0, 1}, std::numbers::pi};

Bounds sphere_bounds(const Vec3d& center, double radius, const Vec3d& position) {
    const Vec3d way = center - position;
    const double distance = glm::length(way);
    return distance > radius ? Bounds{way / distance, std::asin(radius / distance)} : kEverywhere;
}

struct BoundsFrom {
    const Vec3d& position;

    Bounds operator()(const SphereLight& light) const {
        if (!light.facing_disk) {
            return sphere_bounds(light.center, light.radius, position);
        }
        const Vec3d way = light.center - position;
        const double distance = glm::length(way);
        return distance > 0 ? Bounds{way / distance, std::atan(light.radius / distance)} : kEverywhere;
    }
    Bounds operator()(const PolygonLight& light) const { return sphere_bounds(light.center, light.radius, position); }
    Bounds operator()(const DiskLight& light) const { return sphere_bounds(light.center, light.radius, position); }
    Bounds operator()(const MeshLight& light) const {
        return sphere_bounds(light.shape->center, light.shape->radius, position);
    }
    Bounds operator()(const SunLight& light) const { return {light.direction, light.half_angle}; }
    Bounds operator()(const PointSource& light) const { return sphere_bounds(light.position, 0, position); }
    Bounds operator()(const ParallelSource& light) const { return {light.direction, 0}; }
};

Bounds bounds_from(const Light& light, const Vec3d& position) {
    return std::visit(BoundsFrom{position}, light);
}

bool surrounds(const Light& light, const Vec3d& position) {
    const auto* sphere = std::get_if<SphereLight>(&light);
    return sphere != nullptr && glm::length(sphere->center - position) <= (sphere->facing_disk ? 0.0 : sphere->radius);
}

/// The lit part of a rectangle with a spread, as ranges 0 … 1 along the two edges from its first vertex. Nothing beyond
/// them shines on the point.
struct LitEdges {
    std::array<double, 2> from, to;
    bool empty() const { return !(to[0] - from[0] > kThinnestPart && to[1] - from[1] > kThinnestPart); }
    bool whole() const { return from[0] == 0 && from[1] == 0 && to[0] == 1 && to[1] == 1; }
};

std::optional<LitEdges> lit_edges(const PolygonLight& light, const Vec3d& position) {
    const auto* spread = std::get_if<SpreadProfile>(&light.traits.profile);
    if (spread == nullptr || !light.rectangle) {
        return std::nullopt;
    }
    const Vec3d way = position - light.vertices[0];
    const double reach = std::max(0.0, glm::dot(way, light.normal)) * spread->tangent;
    LitEdges edges{};
    for (std::size_t i = 0; i < 2; ++i) {
        const Vec3d edge = light.vertices[i == 0 ? 1 : 3] - light.vertices[0];
        const double square = glm::dot(edge, edge);
        const double middle = glm::dot(way, edge) / square;
        const double share = reach / std::sqrt(square);
        edges.from[i] = std::clamp(middle - share, 0.0, 1.0);
        edges.to[i] = std::clamp(middle + share, 0.0, 1.0);
    }
    return edges;
}

/// Number of sides of the polygon that replaces a partly lit disk; the areas differ by 1e-6.
constexpr int kSidesOfDisk = 256;
/// Radius of a lit circle ÷ short half axis of the disk, below which only that part is shaded.
constexpr double kSmallPart = 0.5;

/// Cuts a convex polygon to its part with dot(normal, v) ≤ limit.
void clip(std::vector<Vec3d>& corners, const Vec3d& normal, double limit) {
    std::vector<Vec3d> kept;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d& from = corners[i];
        const Vec3d& to = corners[(i + 1) % corners.size()];
        const double a = limit - glm::dot(normal, from);
        const double b = limit - glm::dot(normal, to);
        if (a >= 0) {
            kept.push_back(from);
        }
        if ((a >= 0) != (b >= 0)) {
            kept.push_back(from + a / (a - b) * (to - from));
        }
    }
    corners = std::move(kept);
}

/// A part of a disk.
struct LitDisk {
    Ellipse ellipse;
    std::vector<Vec3d> corners;  ///< if there are any, the part is this convex polygon
};

/// Restricts a disk to a region that contains its part within `reach` of a point of its plane.
void restrict(const DiskLight& light, const Vec3d& middle, double reach, LitDisk& lit) {
    const Vec3d way = middle - light.center;
    const double area = glm::length(glm::cross(light.half_axis_u, light.half_axis_v));
    const double short_half_axis = area / light.radius;
    if (!(reach < kSmallPart * short_half_axis)) {
        return;
    }
    const Vec3d along = glm::normalize(light.half_axis_u);
    const Vec3d across = glm::cross(light.normal, along);
    // Coordinates in units of the half axes, in which the disk has radius 1.
    const double a = glm::dot(glm::cross(way, light.half_axis_v), light.normal) / area;
    const double b = glm::dot(glm::cross(light.half_axis_u, way), light.normal) / area;
    if (std::hypot(a, b) + reach / short_half_axis < 1) {
        lit.ellipse = {middle, reach * along, reach * across};
        return;
    }
    // A polygon with the disk's area.
    const double step = 2 * std::numbers::pi / kSidesOfDisk;
    const double scale = std::sqrt(step / std::sin(step));
    for (int i = 0; i < kSidesOfDisk; ++i) {
        lit.corners.push_back(
            light.center + scale * (std::cos(i * step) * light.half_axis_u + std::sin(i * step) * light.half_axis_v));
    }
    for (const Vec3d& side : {along, -along, across, -across}) {
        clip(lit.corners, side, glm::dot(side, middle) + reach);
    }
    if (lit.corners.size() < 3) {
        lit.corners.assign(3, middle);  // without area
    }
}

/// Corners of the lit part of a rectangle, in the world.
std::array<Vec3d, 4> lit_rectangle(const PolygonLight& light, const LitEdges& edges) {
    const Vec3d& corner = light.vertices[0];
    const Vec3d along = light.vertices[1] - corner;
    const Vec3d across = light.vertices[3] - corner;
    const auto at = [&](double a, double b) { return corner + a * along + b * across; };
    return {at(edges.from[0], edges.from[1]), at(edges.to[0], edges.from[1]), at(edges.to[0], edges.to[1]),
            at(edges.from[0], edges.to[1])};
}

/// A region, in the shading frame, that contains the part of a disk that shines on a point through its spread; the
/// whole disk if that part is large.
LitDisk lit_part(const DiskLight& light, const ShadingFrame& frame) {
    LitDisk lit = {{light.center, light.half_axis_u, light.half_axis_v}, {}};
    const auto* spread = std::get_if<SpreadProfile>(&light.traits.profile);
    const double height = glm::dot(frame.origin - light.center, light.normal);
    if (spread != nullptr && height > 0) {
        restrict(light, frame.origin - height * light.normal, height * spread->tangent, lit);
    }
    Ellipse& e = lit.ellipse;
    e = {frame.point_to_local(e.center), frame.to_local(e.half_axis_u), frame.to_local(e.half_axis_v)};
    for (Vec3d& corner : lit.corners) {
        corner = frame.point_to_local(corner);
    }
    return lit;
}

}  // namespace

std::optional<CapView> view_facing_disk(const SphereLight& light, const ShadingFrame& frame) {
    const Vec3d center = frame.point_to_local(light.center);
    const double distance = glm::length(center);
    // Height of the disk's upper rim: the centre's height plus the radius along the disk's steepest line.
    const double rim = center.z * distance + light.radius * std::hypot(center.x, center.y);
    if (distance > 0 && !(rim > 0)) {
        return std::nullopt;
    }
    return CapView{distance > 0 ? CapView::Kind::facing_disk : CapView::Kind::inside, center, light.radius};
}

std::optional<CapView> view(const SunLight& light, const ShadingFrame& frame) {
    const Vec3d direction = frame.to_local(light.direction);
    const double sine = std::sin(light.half_angle);
    if (!(direction.z + sine > 0)) {
        return std::nullopt;
    }
    return CapView{CapView::Kind::infinite, direction, sine};
}

std::optional<CapView> cap_view(const Light& light, const ShadingFrame& frame) {
    if (const auto* sphere = std::get_if<SphereLight>(&light)) {
        return view(*sphere, frame);
    }
    const auto* sun = std::get_if<SunLight>(&light);
    return sun != nullptr ? view(*sun, frame) : std::nullopt;
}

ProfileView::ProfileView(const Light& light, const ShadingFrame& frame) {
    const EmissionProfile& profile = traits_of(light).profile;
    // A point inside a sphere sees the sphere's surface shine inwards in all directions, without a profile.
    if (std::holds_alternative<EvenProfile>(profile) || surrounds(light, frame.origin)) {
        return;
    }
    profile_ = &profile;
    to_world_ = glm::dmat3(frame.x, frame.y, frame.z);
    const Bounds bounds = bounds_from(light, frame.origin);
    range_ = profile_range(profile, -bounds.towards, bounds.half_angle);
}

bool LocalLight::look_at(const PolygonLight& light) {
    const std::optional<LitEdges> edges = lit_edges(light, frame_->origin);
    if ((edges && edges->empty()) ||
        !is_lit_side(light, glm::dot(light.normal, frame_->origin - light.vertices[0]), error_)) {
        return false;
    }
    is_part_ = edges && !edges->whole();
    if (is_part_) {
        const auto part = lit_rectangle(light, *edges);
        corners_.assign(part.begin(), part.end());
    } else {
        corners_ = light.vertices;
    }
    bool above = false;
    for (Vec3d& corner : corners_) {
        corner = frame_->point_to_local(corner);
        above = above || corner.z > 0;
    }
    return above;
}

bool LocalLight::look_at(const DiskLight& light) {
    if (!is_lit_side(light, glm::dot(light.normal, frame_->origin - light.center), error_)) {
        return false;
    }
    const double rise = std::hypot(glm::dot(frame_->z, light.half_axis_u), glm::dot(frame_->z, light.half_axis_v));
    if (!(glm::dot(frame_->z, light.center - frame_->origin) + rise > 0)) {
        return false;
    }
    const LitDisk lit = lit_part(light, *frame_);
    ellipse_ = lit.ellipse;
    corners_ = lit.corners;
    is_part_ = !corners_.empty();
    return true;
}

bool LocalLight::look(const Light& light, const ShadingFrame& frame, double error) {
    light_ = &light;
    frame_ = &frame;
    error_ = error;
    cap_.reset();
    corners_.clear();
    is_part_ = false;
    bool seen = false;
    if (const auto* polygon = std::get_if<PolygonLight>(&light)) {
        seen = look_at(*polygon);
    } else if (const auto* disk = std::get_if<DiskLight>(&light)) {
        seen = look_at(*disk);
    } else if (const auto* mesh = std::get_if<MeshLight>(&light)) {
        seen = glm::dot(frame.z, mesh->shape->center - frame.origin) > -mesh->shape->radius;
    } else {
        cap_ = cap_view(light, frame);
        seen = cap_.has_value();
    }
    profile_ = seen ? ProfileView(light, frame) : ProfileView();
    return seen && profile_.range().high > 0;
}

double least_distance(const Light& light, const Vec3d& position) {
    if (const auto* sphere = std::get_if<SphereLight>(&light)) {
        return std::max(0.0, glm::length(sphere->center - position) - sphere->radius);
    }
    if (const auto* point = std::get_if<PointSource>(&light)) {
        return glm::length(point->position - position);
    }
    if (const auto* mesh = std::get_if<MeshLight>(&light)) {
        return std::max(0.0, glm::length(mesh->shape->center - position) - mesh->shape->radius);
    }
    const auto of_planar = [&](const auto& planar) {
        return std::max(std::abs(glm::dot(planar.normal, position - planar.center)),
                        glm::length(planar.center - position) - planar.radius);
    };
    if (const auto* disk = std::get_if<DiskLight>(&light)) {
        return of_planar(*disk);
    }
    const auto* polygon = std::get_if<PolygonLight>(&light);
    return polygon != nullptr ? of_planar(*polygon) : std::numeric_limits<double>::infinity();
}

double changing_distance(const Light& light, const Vec3d& position) {
    const EmissionProfile& profile = traits_of(light).profile;
    const double distance = least_distance(light, position);
    if (std::holds_alternative<EvenProfile>(profile) || !std::isfinite(distance)) {
        return distance;
    }
    return distance * profile_scale(profile, -bounds_from(light, position).towards);
}

SphericalCap circle_of(const CapView& cap) {
    switch (cap.kind) {
        case CapView::Kind::sphere:
            return cap_of_sphere(cap.center, cap.radius);
        case CapView::Kind::facing_disk:
            return cap_of_facing_disk(cap.center, cap.radius);
        case CapView::Kind::infinite:
            return {cap.center, std::sqrt(std::max(0.0, (1 - cap.radius) * (1 + cap.radius))), cap.radius};
        case CapView::Kind::inside:
            break;
    }
    return {{0, 0, 1}, 0, 1};
}

}  // namespace shlight
