// SPDX-License-Identifier: MIT
#include "surfaces/doubled_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <glm/geometric.hpp>

#include "surfaces/camera_surfaces.h"
#include "surfaces/round_places.h"

namespace shlight {
namespace {

/// Cosine between the normals of surfaces that lie on each other.
constexpr double kParallel = 1 - 1e-6;
/// Distance from a triangle's edges at which a point is inside ÷ the point's error.
constexpr double kClearOfEdges = 4;

/// The corners of the hit triangle in float, in the frame of the world, where Cycles has them.
std::array<Vec3f, 3> corners_in_float(const PlacedMeshes& placed, const RayHit& hit) {
    std::array<Vec3f, 3> rounded;
    std::ranges::transform(placed.corners(hit), rounded.begin(),
                           [&](const Vec3d& corner) { return Vec3f(corner + placed.origin()); });
    return rounded;
}

/// The normal of a triangle by its edges a, b and c as Embree rounds it: each component by the pair of edges whose
/// products are smaller.
Vec3f stable_normal(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3f first = glm::cross(a, b);
    const Vec3f second = glm::cross(b, c);
    const Vec3f first_size = glm::abs(Vec3f(a.z * b.y, a.x * b.z, a.y * b.x));
    const Vec3f second_size = glm::abs(Vec3f(b.z * c.y, b.x * c.z, b.y * c.x));
    return glm::mix(second, first, glm::lessThan(first_size, second_size));
}

}  // namespace

bool covers(const PlacedMeshes& placed, const RayHit& face, const RayHit& hit, const SurfacePoint& point) {
    const bool is_own = face.instance == hit.instance && face.triangle == hit.triangle;
    if (is_own || !placed.is_triangle(face)) {
        return false;
    }
    const std::array<Vec3d, 3> at = placed.corners(face);
    const Vec3d normal = normalized_or(glm::cross(at[1] - at[0], at[2] - at[0]), Vec3d(0));
    if (!(std::abs(glm::dot(normal, point.geometric_normal)) > kParallel &&
          std::abs(glm::dot(normal, point.position - at[0])) <= point.error)) {
        return false;
    }
    std::array<double, 3> distances{};  // from the edges, inwards
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d edge = at[(i + 1) % 3] - at[i];
        distances[i] = glm::dot(glm::cross(normal, edge), point.position - at[i]) / glm::length(edge);
    }
    return std::ranges::min(distances) > kClearOfEdges * point.error;
}

Cover cover_by(const PlacedMeshes& placed, const RayHit& face, const RayHit& hit, const Vec3d& way) {
    const auto [a, b, c] = corners_in_float(placed, hit);
    const Vec3f begin = a + hit.u * (b - a) + hit.v * (c - a);
    std::array<Vec3f, 3> corners = corners_in_float(placed, face);
    for (Vec3f& corner : corners) {
        corner -= begin;
    }
    const Vec3f normal = stable_normal(corners[2] - corners[0], corners[0] - corners[1], corners[1] - corners[2]);
    const float height = glm::dot(corners[0], normal);  // of the face above where the ray begins
    if (height == 0) {
        return Cover::in_plane;
    }
    return (glm::dot(Vec3d(normal), way) > 0) == (height > 0) ? Cover::by_rounding : Cover::none;
}

Cover CameraSurfaces::cover(const RayHit& hit, const SurfacePoint& point, const Vec3d& towards_viewer) {
    const PlacedMeshes& placed = scene_->placed();
    if (settings_.doubled == nullptr || !(*settings_.doubled)[hit.instance] || !placed.is_triangle(hit)) {
        return Cover::none;
    }
    near_.clear();
    scene_->rays().near_opaque(Vec3f(point.position), static_cast<float>(2 * point.error), near_);
    const auto lets_through = [&](const RayHit& face) {
        const std::uint32_t material = placed.surface(face, Vec3f(-towards_viewer)).material;
        const SurfaceShader* shader = scene_->materials()[material].shader.get();
        return (placed.seen_by(face) & kShadowRay) == 0 || (shader != nullptr && !shader->refractions.empty());
    };
    Cover found = Cover::none;
    for (const RayHit& face : near_) {
        if (covers(placed, face, hit, point) && !lets_through(face)) {
            found = std::max(found, cover_by(placed, face, hit, towards_viewer));
        }
    }
    return found;
}

/// Each face sends light towards the other. At every other place it meets that, elsewhere it leaves on the far side;
/// and what it meets is covered as often as not. So each way brings half the albedo, which both are taken to have.
void CameraSurfaces::leave_gap(std::size_t number, const Sink& sink) {
    find_lobes(surfaces_[number], lobes_);
    Rgb albedo(0);
    for (const SurfaceLobe& lobe : lobes_) {
        albedo += is_glossy(lobe.shape) || lobe.translucent ? Rgb(0) : lobe.weight;
    }
    Surface near = surfaces_[number];
    near.kind = near.kind_after(PathKind::diffuse);
    near.cover = Cover::none;
    Surface far = near;
    far.point = near.point.turned();
    far.towards_viewer = glm::reflect(near.towards_viewer, near.point.geometric_normal);
    std::array<Rgb, 2> shares{Rgb(0), Rgb(0)};
    Rgb share(1);
    for (std::uint32_t ways = 1; near.bounces + ways <= settings_.max_bounces; ++ways) {
        share *= glm::clamp(albedo / 2.0F, Rgb(0), Rgb(0.5F));
        shares[ways % 2] += share;
    }
    near.throughput *= shares[0];
    near.bounces += 2;
    far.throughput *= shares[1];
    far.bounces += 1;
    for (const Surface& side : {near, far}) {
        if (reflects(side)) {
            reflect(side, sink);
            surfaces_.push_back(side);
        }
    }
}

}  // namespace shlight
