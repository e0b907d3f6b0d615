// SPDX-License-Identifier: MIT
#include "lights/face_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "regions/spherical_polygon.h"

namespace shlight {
namespace {

/// Distance of a face's middle ÷ the distance of its corners from there, below which the face is near.
constexpr double kNearFace = 3;
/// Radius ÷ distance from which on a node is split. From the root down a face at the hit's side would be drawn as
/// rarely as the tree is deep, however much it brings.
constexpr double kWide = 0.5;

}  // namespace

void FaceSampler::reset(const FaceTree& faces, const ShadingFrame& frame, double error) {
    faces_ = &faces;
    frame_ = frame;
    viewpoint_ = faces.viewpoint(frame, error);
    const Vec3d way = faces.center() - frame.origin;
    const double square = glm::dot(way, way);
    solid_angle_ = square > faces.radius() * faces.radius() ? std::min(faces.area() / square, 2 * std::numbers::pi)
                                                            : 2 * std::numbers::pi;
    parts_.clear();
    split(0, 0, static_cast<std::uint32_t>(faces.faces_.size()));
}

void FaceSampler::split(std::uint32_t node, std::uint32_t first, std::uint32_t last) {
    const FaceTree::Node& own = faces_->nodes_[node];
    const PartView seen = view(own);
    if (seen.hidden) {
        return;
    }
    if (seen.width > kWide && own.first_child != FaceTree::kLeaf) {
        const std::uint32_t middle = FaceTree::middle_of(first, last);
        split(own.first_child, first, middle);
        split(own.first_child + 1, middle, last);
        return;
    }
    const double before = parts_.empty() ? 0 : parts_.back().up_to;
    const double brings = importance(own, seen);
    if (before + brings > before) {
        parts_.push_back({before, before + brings, node, first, last});
    }
}

double FaceSampler::importance(const FaceTree::Node& node, const PartView& seen) const {
    const FacePart& part = node.part;
    if (seen.hidden) {
        return 0;
    }
    const bool is_face = node.first_child == FaceTree::kLeaf;
    if (is_face && seen.width > 1 / kNearFace) {
        return importance_of_near(node);
    }
    const double area = viewpoint_.front_only ? seen.facing : std::abs(seen.facing);
    const double shown = seen.one_side ? area : std::max(area, 0.5 * seen.unclear);
    const double square = std::max(seen.distance * seen.distance, part.radius * part.radius);
    return part.brightness * shown * std::min(1.0, seen.rise + seen.width) / square;
}

double FaceSampler::importance_of_near(const FaceTree::Node& node) const {
    const FaceTree::Face& face = faces_->faces_[node.face];
    if (!(std::abs(FaceTree::height_over(face, frame_.origin)) > viewpoint_.clearance)) {
        return 0;
    }
    const auto [a, b, c] = std::array{face.a - frame_.origin, face.b - frame_.origin, face.c - frame_.origin};
    const double highest = std::max({glm::dot(frame_.z, a), glm::dot(frame_.z, b), glm::dot(frame_.z, c)});
    return highest > 0 ? node.part.brightness * std::abs(triangle_solid_angle(a, b, c)) : 0;
}

double FaceSampler::share_of_first(std::uint32_t first_child) const {
    const double first = importance(faces_->nodes_[first_child]);
    const double second = importance(faces_->nodes_[first_child + 1]);
    return first + second > 0 ? first / (first + second) : -1;
}

std::optional<FaceSample> FaceSampler::sample(const glm::dvec2& point) {
    if (parts_.empty()) {
        return std::nullopt;
    }
    const double all = parts_.back().up_to;
    const auto part = std::upper_bound(parts_.begin(), parts_.end() - 1, point.x * all,
                                       [](double sought, const Part& each) { return sought < each.up_to; });
    const double own = part->up_to - part->from;
    double place = std::clamp((point.x * all - part->from) / own, 0.0, 1.0);
    double probability = own / all;
    std::uint32_t node = part->node;
    while (faces_->nodes_[node].first_child != FaceTree::kLeaf) {
        node = faces_->nodes_[node].first_child;
        const double share = share_of_first(node);
        if (share < 0) {
            return std::nullopt;
        }
        if (place < share) {
            place /= share;
            probability *= share;
        } else {
            place = std::min((place - share) / (1 - share), 1.0);
            probability *= 1 - share;
            ++node;
        }
    }
    const FaceTree::Face& face = faces_->faces_[faces_->nodes_[node].face];
    const auto [way, over_face] = way_to(face, {place, point.y});
    const double density = probability * over_face;
    const Vec3d direction = frame_.to_local(glm::normalize(way));
    if (!(density > 0) || !std::isfinite(density) || !(direction.z > 0)) {
        return std::nullopt;
    }
    Ray ray = {Vec3f(viewpoint_.start), 0, Vec3f(frame_.origin + way - viewpoint_.start)};
    const bool hidden = faces_->next_face(ray) != &face;
    return FaceSample{direction, density, face.radiance, hidden};
}

std::span<const FaceSample> FaceSampler::meet(const Vec3d& direction) {
    met_.clear();
    const Vec3d world = frame_.to_world(direction);
    Ray ray = {Vec3f(viewpoint_.start), 0, Vec3f(world)};
    bool hidden = false;
    while (const FaceTree::Face* face = faces_->next_face(ray)) {
        const double density = density_towards(*face, direction, world);
        if (density > 0 && std::isfinite(density)) {
            met_.push_back({direction, density, face->radiance, hidden});
        }
        hidden = true;
    }
    return met_;
}

double FaceSampler::density_towards(const FaceTree::Face& face, const Vec3d& direction, const Vec3d& world) {
    const Vec3d normal = glm::cross(face.b - face.a, face.c - face.a);
    const double along = glm::dot(normal, face.a - frame_.origin) / glm::dot(normal, world);
    double density = density_over(face, along * world);
    if (density > 0 && is_near(face)) {
        look_at(face);
        density = 1 / polygon_.weight(direction);
    }
    return density * probability(static_cast<std::uint32_t>(&face - faces_->faces_.data()));
}

double FaceSampler::probability(std::uint32_t leaf) const {
    const auto part = std::upper_bound(parts_.begin(), parts_.end(), leaf,
                                       [](std::uint32_t sought, const Part& each) { return sought < each.last; });
    if (part == parts_.end() || leaf < part->first) {
        return 0;
    }
    double probability = (part->up_to - part->from) / parts_.back().up_to;
    std::uint32_t node = part->node;
    std::uint32_t last = part->last;
    for (std::uint32_t first = part->first; last - first > 1;) {
        node = faces_->nodes_[node].first_child;
        const double share = share_of_first(node);
        const std::uint32_t middle = FaceTree::middle_of(first, last);
        if (leaf < middle) {
            last = middle;
            probability *= std::max(share, 0.0);
        } else {
            first = middle;
            probability *= share < 0 ? 0 : 1 - share;
            ++node;
        }
    }
    return probability;
}

bool FaceSampler::is_near(const FaceTree::Face& face) const {
    const Vec3d middle = (face.a + face.b + face.c) / 3.0;
    const Vec3d way = middle - frame_.origin;
    double radius = 0;
    for (const Vec3d& corner : {face.a, face.b, face.c}) {
        radius = std::max(radius, glm::length(corner - middle));
    }
    return glm::length(way) < kNearFace * radius || glm::dot(frame_.z, way) < radius;
}

void FaceSampler::look_at(const FaceTree::Face& face) {
    const std::array<Vec3d, 3> corners = {frame_.point_to_local(face.a), frame_.point_to_local(face.b),
                                          frame_.point_to_local(face.c)};
    polygon_.reset(corners, glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0])));
}

std::pair<Vec3d, double> FaceSampler::way_to(const FaceTree::Face& face, const glm::dvec2& point) {
    if (is_near(face)) {
        look_at(face);
        const LightSample drawn = polygon_.sample(point);
        const Vec3d way = drawn.distance * frame_.to_world(drawn.direction);
        return {way, drawn.weight > 0 && density_over(face, way) > 0 ? 1 / drawn.weight : 0};
    }
    const double root = std::sqrt(point.x);
    const Vec3d way = (1 - root) * face.a + root * (1 - point.y) * face.b + root * point.y * face.c - frame_.origin;
    return {way, density_over(face, way)};
}

double FaceSampler::density_over(const FaceTree::Face& face, const Vec3d& way) const {
    // The area times the cosine at the face times the distance.
    const double facing = -0.5 * glm::dot(glm::cross(face.b - face.a, face.c - face.a), way);
    const double shown = viewpoint_.front_only ? facing : std::abs(facing);
    const double distance = glm::length(way);
    return shown > 0 ? distance * distance * distance / shown : 0;
}

}  // namespace shlight
