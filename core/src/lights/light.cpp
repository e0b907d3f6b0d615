// SPDX-License-Identifier: MIT
#include "shlight/light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "base/checks.h"
#include "base/ray_rounding.h"
#include "base/scene_range.h"
#include "base/unit_direction.h"

namespace shlight {
namespace {

constexpr double kPlanar = 1e-4;         // ÷ extent: above rounding of float vertices, invisible
constexpr double kNarrowestSun = 1e-6;   // [rad]
constexpr double kWidestTangentSun = 3;  // [rad]
constexpr double kRepeated = 1e-9;       // ÷ extent: distance within which vertices are merged
constexpr double kRightAngle = 1e-6;     // largest cosine: above the rounding of float vertices
constexpr double kSmallestArea = 1e-9;   // ÷ squared extent

double extent_of(const std::vector<Vec3d>& vertices) {
    double extent = 0;
    for (const Vec3d& v : vertices) {
        extent = std::max(extent, glm::length(v - vertices[0]));
    }
    return extent;
}

/// Twice the vector area (Newell): right for any simple polygon, convex or not.
Vec3d doubled_area(const std::vector<Vec3d>& vertices) {
    Vec3d sum(0);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        sum += glm::cross(vertices[i] - vertices[0], vertices[(i + 1) % vertices.size()] - vertices[0]);
    }
    return sum;
}

Vec3d mean(const std::vector<Vec3d>& vertices) {
    Vec3d sum(0);
    for (const Vec3d& v : vertices) {
        sum += v;
    }
    return sum / static_cast<double>(vertices.size());
}

void merge_repeated(std::vector<Vec3d>& vertices, double extent) {
    const auto same = [extent](const Vec3d& a, const Vec3d& b) { return glm::length(a - b) <= kRepeated * extent; };
    vertices.erase(std::unique(vertices.begin(), vertices.end(), same), vertices.end());
    while (vertices.size() > 1 && same(vertices.front(), vertices.back())) {
        vertices.pop_back();
    }
}

void flatten(std::vector<Vec3d>& vertices, const Vec3d& normal, double extent) {
    const Vec3d center = mean(vertices);
    for (Vec3d& v : vertices) {
        const double height = glm::dot(v - center, normal);
        if (!(std::abs(height) <= kPlanar * extent)) {
            reject("vertices are not planar");
        }
        v -= height * normal;
    }
}

/// Ear clipping (Meisters 1975). Collinear vertices are dropped with ears of no area.
class EarClipper {
  public:
    EarClipper(const std::vector<Vec3d>& vertices, const Vec3d& normal, double extent)
        : vertices_(vertices), normal_(normal), tolerance_(1e-12 * extent * extent), left_(vertices.size()) {
        std::iota(left_.begin(), left_.end(), 0U);
    }

    std::vector<Triangle> run() {
        std::vector<Triangle> triangles;
        while (left_.size() >= 3) {
            const std::size_t ear = find_ear();
            const Triangle triangle = corner(ear);
            if (area(triangle) > tolerance_) {
                triangles.push_back(triangle);
            }
            left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(ear));
        }
        return triangles;
    }

  private:
    Triangle corner(std::size_t i) const {
        const std::size_t n = left_.size();
        return {left_[(i + n - 1) % n], left_[i], left_[(i + 1) % n]};
    }

    double area(const Triangle& t) const {
        return glm::dot(normal_, glm::cross(vertices_[t.y] - vertices_[t.x], vertices_[t.z] - vertices_[t.x]));
    }

    bool contains_vertex(const Triangle& t) const {
        return std::any_of(left_.begin(), left_.end(), [&](std::uint32_t p) {
            return p != t.x && p != t.y && p != t.z && area({t.x, t.y, p}) >= -tolerance_ &&
                   area({t.y, t.z, p}) >= -tolerance_ && area({t.z, t.x, p}) >= -tolerance_;
        });
    }

    std::size_t find_ear() const {
        for (std::size_t i = 0; i < left_.size(); ++i) {
            const Triangle triangle = corner(i);
            const double size = area(triangle);
            if (std::abs(size) <= tolerance_ || (size > 0 && !contains_vertex(triangle))) {
                return i;
            }
        }
        reject("vertices: the polygon crosses itself");
    }

    const std::vector<Vec3d>& vertices_;
    Vec3d normal_;
    double tolerance_;
    std::vector<std::uint32_t> left_;
};

struct Strength {
    const Rgb& operator()(const PointSource& light) const { return light.intensity; }
    const Rgb& operator()(const ParallelSource& light) const { return light.irradiance; }
    template <class AreaLight>
    const Rgb& operator()(const AreaLight& light) const {
        return light.radiance;
    }
};

/// Whether all four corners are right angles, within rounding.
bool is_rectangle(const std::vector<Vec3d>& vertices) {
    if (vertices.size() != 4) {
        return false;
    }
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3d a = vertices[(i + 1) % 4] - vertices[i];
        const Vec3d b = vertices[(i + 2) % 4] - vertices[(i + 1) % 4];
        if (!(std::abs(glm::dot(a, b)) <= kRightAngle * glm::length(a) * glm::length(b))) {
            return false;
        }
    }
    return true;
}

}  // namespace

const LightTraits& traits_of(const Light& light) {
    return std::visit([](const auto& shape) -> const LightTraits& { return shape.traits; }, light);
}

const Rgb& strength_of(const Light& light) {
    return std::visit(Strength{}, light);
}

bool is_delta(const Light& light) {
    return std::holds_alternative<PointSource>(light) || std::holds_alternative<ParallelSource>(light);
}

Light moved(const Light& light, const Vec3d& way) {
    Light result = light;
    if (auto* sphere = std::get_if<SphereLight>(&result)) {
        sphere->center += way;
    } else if (auto* point = std::get_if<PointSource>(&result)) {
        point->position += way;
    } else if (auto* polygon = std::get_if<PolygonLight>(&result)) {
        std::vector<Vec3d> vertices = polygon->vertices;
        for (Vec3d& vertex : vertices) {
            vertex += way;
        }
        return make_polygon_light(std::move(vertices), polygon->radiance, polygon->two_sided, polygon->traits);
    } else if (const auto* disk = std::get_if<DiskLight>(&light)) {
        return make_disk_light(disk->center + way, disk->half_axis_u, disk->half_axis_v, disk->radiance,
                               disk->two_sided, disk->traits);
    }
    return result;
}

SphereLight make_sphere_light(const Vec3d& center, double radius, const Rgb& radiance, bool facing_disk,
                              const LightTraits& traits) {
    check_position("center", center);
    if (!(std::isfinite(radius) && radius > 0)) {
        reject("radius must be positive and finite");
    }
    check_reach("radius", radius);
    check_strength("radiance", radiance);
    return {center, radius, radiance, facing_disk, traits};
}

bool MeshLight::shines_at(const RayHit& hit, const Vec3f& direction) const {
    auto own = std::ranges::lower_bound(meshes, hit.instance, {}, &EmissiveMesh::instance);
    while (own != meshes.end() && own->instance == hit.instance && !own->shines_at(hit, direction)) {
        ++own;
    }
    return own != meshes.end() && own->instance == hit.instance;
}

bool EmissiveMesh::shines_at(const RayHit& hit, const Vec3f& direction) const {
    const MeshShape& own = *mesh->shape;
    if (hit.instance != instance || mesh->emitted(own.material_index(hit.triangle)).part(side) == Rgb(0)) {
        return false;
    }
    if (side == FaceSide::both) {
        return true;
    }
    const Triangle& t = own.triangles[hit.triangle];
    const Vec3d origin(own.vertices[t.x]);
    const Vec3d normal = glm::cross(Vec3d(own.vertices[t.y]) - origin, Vec3d(own.vertices[t.z]) - origin);
    return (glm::dot(normal, to_mesh * Vec3d(direction)) < 0) == (side == FaceSide::front);
}

PolygonLight make_polygon_light(std::vector<Vec3d> vertices, const Rgb& radiance, bool two_sided,
                                const LightTraits& traits) {
    if (vertices.size() < 3) {
        reject("vertices: a polygon needs at least three");
    }
    for (const Vec3d& v : vertices) {
        check_position("vertices", v);
    }
    check_strength("radiance", radiance);
    const double extent = extent_of(vertices);
    merge_repeated(vertices, extent);
    const Vec3d area = doubled_area(vertices);
    if (vertices.size() < 3 || !(glm::length(area) > kSmallestArea * extent * extent)) {
        reject("vertices: the polygon has no area");
    }
    const Vec3d normal = glm::normalize(area);
    flatten(vertices, normal, extent);
    std::vector<Triangle> triangles = EarClipper(vertices, normal, extent).run();
    // The triangles' area differs from the polygon's if the polygon crosses itself in a way that ear clipping misses.
    double covered = 0;
    for (const Triangle& t : triangles) {
        covered += glm::length(glm::cross(vertices[t.y] - vertices[t.x], vertices[t.z] - vertices[t.x]));
    }
    if (!(std::abs(covered - glm::length(area)) <= 1e-6 * covered)) {
        reject("vertices: the polygon crosses itself");
    }
    double largest = 0;
    double radius = 0;
    const Vec3d center = mean(vertices);
    for (const Vec3d& v : vertices) {
        largest = std::max(largest, largest_component(v));
        radius = std::max(radius, glm::length(v - center));
    }
    const double error = kRayRounding * (largest + extent);
    const bool rectangle = is_rectangle(vertices);
    return {std::move(vertices),
            std::move(triangles),
            normal,
            radiance,
            two_sided,
            center,
            radius,
            error,
            rectangle,
            traits};
}

DiskLight make_disk_light(const Vec3d& center, const Vec3d& half_axis_u, const Vec3d& half_axis_v, const Rgb& radiance,
                          bool two_sided, const LightTraits& traits) {
    check_position("center", center);
    check_position("half_axis_u", half_axis_u);
    check_position("half_axis_v", half_axis_v);
    check_strength("radiance", radiance);
    const double u = glm::length(half_axis_u);
    const double v = glm::length(half_axis_v);
    if (!(u > 0)) {
        reject("half_axis_u must not be zero");
    }
    if (!(v > 0)) {
        reject("half_axis_v must not be zero");
    }
    const Vec3d across = glm::cross(half_axis_u / u, half_axis_v / v);
    if (!(glm::length(across) > kSmallestArea)) {
        reject("half_axis_v: the half axes are parallel");
    }
    // The squares of the principal half axes are the eigenvalues of the half axes' Gram matrix.
    const double radius =
        std::sqrt((u * u + v * v + std::hypot(u * u - v * v, 2 * glm::dot(half_axis_u, half_axis_v))) / 2);
    const double error = kRayRounding * (largest_component(center) + 2 * radius);
    return {center, half_axis_u, half_axis_v, glm::normalize(across), radiance, two_sided, radius, error, traits};
}

PolygonLight make_polygon_lamp(std::vector<Vec3d> vertices, const Rgb& radiance, double spread,
                               const LightTraits& traits) {
    PolygonLight light = make_polygon_light(std::move(vertices), radiance, false, traits);
    light.traits.profile = make_spread_profile(light.normal, spread);
    return light;
}

DiskLight make_disk_lamp(const Vec3d& center, const Vec3d& half_axis_u, const Vec3d& half_axis_v, const Rgb& radiance,
                         double spread, const LightTraits& traits) {
    DiskLight light = make_disk_light(center, half_axis_u, half_axis_v, radiance, false, traits);
    light.traits.profile = make_spread_profile(light.normal, spread);
    return light;
}

PointSource make_point_source(const Vec3d& position, const Rgb& intensity, const LightTraits& traits) {
    check_position("position", position);
    check_strength("intensity", intensity, kMostIntense);
    return {position, intensity, traits};
}

Light make_spot_light(const Vec3d& position, const SpotProfile& profile, const Rgb& intensity, double radius,
                      bool facing_disk, LightTraits traits) {
    if (!(std::isfinite(radius) && radius >= 0)) {
        reject("radius must be finite and not negative");
    }
    check_reach("radius", radius);
    traits.profile = profile;
    PointSource source = make_point_source(position, intensity, traits);
    if (radius == 0) {
        return source;
    }
    const Rgb radiance = intensity / static_cast<float>(std::numbers::pi * radius * radius);
    check_finite("intensity", radiance);
    return SphereLight{position, radius, radiance, facing_disk, traits};
}

Light make_sun_light(const Vec3d& direction, double angle, const Rgb& irradiance, bool tangent,
                     const LightTraits& traits) {
    const Vec3d away = unit_direction(direction);
    if (!(angle >= 0 && angle <= (tangent ? kWidestTangentSun : std::numbers::pi * (1 + 1e-6)))) {
        reject(std::string("angle must be 0 … ") + (tangent ? "3 for a tangent sun" : "pi"));
    }
    check_strength("irradiance", irradiance);
    if (angle < kNarrowestSun) {
        return ParallelSource{-away, irradiance, traits};
    }
    const double half = std::min(angle / 2, std::numbers::pi / 2);
    const double ratio = tangent ? std::tan(half) : std::sin(half);
    const Rgb radiance = irradiance * static_cast<float>(1 / (std::numbers::pi * ratio * ratio));
    check_finite("irradiance", radiance);
    SunLight sun = {-away, half, radiance, traits};
    if (tangent) {
        sun.traits.profile = TangentProfile{away};
    }
    return sun;
}

}  // namespace shlight
