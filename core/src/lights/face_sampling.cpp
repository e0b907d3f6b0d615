// SPDX-License-Identifier: MIT
#include "lights/face_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace shlight {
namespace {

/// Distance of a face's middle ÷ the distance of its corners from there, below which the face is near.
constexpr double kNearFace = 3;

}  // namespace

void FaceSampler::reset(const FaceTree& faces, const ShadingFrame& frame, double error) {
    faces_ = &faces;
    frame_ = frame;
    viewpoint_ = faces.viewpoint(frame, error);
    const Vec3d way = faces.center() - frame.origin;
    const double square = glm::dot(way, way);
    solid_angle_ = square > faces.radius() * faces.radius() ? std::min(faces.area() / square, 2 * std::numbers::pi)
                                                            : 2 * std::numbers::pi;
}

double FaceSampler::importance(const FaceTree::Node& node) const {
    const FacePart& part = node.part;
    const PartView seen(part, frame_, viewpoint_.front_only, node.first_child == FaceTree::kLeaf);
    if (seen.hidden) {
        return 0;
    }
    const double area = viewpoint_.front_only ? seen.facing : std::abs(seen.facing);
    const double shown = seen.one_side ? area : std::max(area, 0.5 * seen.unclear);
    const double square = std::max(seen.distance * seen.distance, part.radius * part.radius);
    return part.brightness * shown * std::min(1.0, seen.rise + seen.width) / square;
}

double FaceSampler::share_of_first(std::uint32_t first_child) const {
    const double first = importance(faces_->nodes_[first_child]);
    const double second = importance(faces_->nodes_[first_child + 1]);
    return first + second > 0 ? first / (first + second) : -1;
}

std::optional<FaceSample> FaceSampler::sample(const glm::dvec2& point) {
    double place = point.x;
    double probability = 1;
    std::uint32_t node = 0;
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
    const bool hidden = faces_->face_at(viewpoint_.start, frame_.origin + way - viewpoint_.start) != &face;
    return FaceSample{direction, density, face.radiance, hidden};
}

std::optional<FaceSample> FaceSampler::meets(const Vec3d& direction) {
    const Vec3d world = frame_.to_world(direction);
    const FaceTree::Face* face = faces_->face_at(viewpoint_.start, world);
    if (face == nullptr || !(direction.z > 0)) {
        return std::nullopt;
    }
    const Vec3d normal = glm::cross(face->b - face->a, face->c - face->a);
    const double along = glm::dot(normal, face->a - frame_.origin) / glm::dot(normal, world);
    double density = density_over(*face, along * world);
    if (density > 0 && is_near(*face)) {
        look_at(*face);
        density = 1 / polygon_.weight(direction);
    }
    if (!(density > 0) || !std::isfinite(density)) {
        return std::nullopt;
    }
    const auto leaf = static_cast<std::uint32_t>(face - faces_->faces_.data());
    return FaceSample{direction, probability(leaf) * density, face->radiance, false};
}

double FaceSampler::probability(std::uint32_t leaf) const {
    double probability = 1;
    std::uint32_t node = 0;
    auto last = static_cast<std::uint32_t>(faces_->faces_.size());
    for (std::uint32_t first = 0; last - first > 1;) {
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
