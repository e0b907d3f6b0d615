// SPDX-License-Identifier: MIT
#include "emitters/face_sum.h"

#include <algorithm>
#include <cmath>

namespace shlight {
namespace {

/// Share of a lobe's width: over a smaller part f·cos is its value at the middle, except at the horizon.
constexpr double kBroad = 0.2;
/// Radius ÷ distance from which on a part is never good enough as a whole.
constexpr double kWide = 0.35;
/// Relative error of a part as a whole ÷ (its radius as a share of the least distance over which the light changes)².
/// Parts' errors have a common sign in part, so that their squares alone would add up to too little.
constexpr double kCurvature = 1;

constexpr auto has_less_error = [](const auto& a, const auto& b) { return a.error < b.error; };

/// The direction in which f·cos is largest, about.
Vec3d brightest(const LobeShape& lobe, const Vec3d& view) {
    return is_glossy(lobe) ? mirrored(view) : Vec3d(0, 0, 1);
}

}  // namespace

double FaceSum::most_value(const SummedLobe& lobe, const Vec3d& direction, double width, double value) const {
    const Vec3d to_brightest = brightest(lobe.shape, view_) - direction;
    const double share = std::min(1.0, width / std::max(glm::length(to_brightest), 1e-9));
    const Vec3d nearest = glm::normalize(direction + share * to_brightest);
    return std::max(value, nearest.z > 0 ? lobe_value(lobe.shape, nearest, view_) : 0.0);
}

/// A part's light follows from its power, which is exact if all its faces are seen from the same side. Errors: lobe and
/// distance change over the part by x, which matters for the part's slope of radiance and at the horizon, and by x² for
/// all else. If some faces look away, a part of unknown area is visible.
FaceSum::Part FaceSum::weigh(std::uint32_t node, const PartView& seen) {
    const FacePart& part = faces_->nodes_[node].part;
    const Vec3d direction = frame_->to_local(seen.way) / seen.distance;
    const double shown = front_only_ ? std::max(seen.facing, 0.0) : std::abs(seen.facing);
    const double square = std::max(seen.distance * seen.distance, part.radius * part.radius);
    const double area = seen.one_side ? shown : seen.unclear;
    const bool level = !(direction.z > seen.width);
    // Radiance may be negative; power is that of the side which the area vector shows.
    const double side = seen.facing > 0 ? -1 : 1;
    const Vec3d light = seen.one_side ? side / seen.distance * (seen.way * part.power) : shown * Vec3d(part.radiance);
    Part weighed = {light / square, 0, 0, values_.size(), node};
    for (const SummedLobe& lobe : lobes_) {
        const double value = direction.z > 0 ? lobe_value(lobe.shape, direction, view_) : 0.0;
        const double x = std::min(1.0, seen.width / lobe_width(lobe.shape));
        const double change = level ? x : x * x;
        const double unlike = seen.one_side ? change : std::max(change, std::min(1.0, part.bend));
        const double left_out = kCurvature * unlike * part.brightness + 0.5 * x * part.slope;
        const double most = x > kBroad || level ? most_value(lobe, direction, seen.width, value) : value;
        values_.push_back(static_cast<float>(value));
        weighed.value += lobe.weight * value;
        weighed.error += lobe.weight * area / square * most * left_out;
    }
    return weighed;
}

void FaceSum::open(std::uint32_t node) {
    const FacePart& part = faces_->nodes_[node].part;
    const bool is_leaf = faces_->nodes_[node].first_child == FaceTree::kLeaf;
    const PartView seen(part, *frame_, front_only_, is_leaf);
    if (seen.hidden) {
        return;
    }
    if (seen.width > kWide && !is_leaf) {
        open(faces_->nodes_[node].first_child);
        open(faces_->nodes_[node].first_child + 1);
        return;
    }
    const Part weighed = weigh(node, seen);
    if (weighed.error > 0 || weighed.value > 0) {
        light_ += weighed.value * weighed.light;
        squares_ += weighed.error * weighed.error;
        cut_.push_back(weighed);
        std::push_heap(cut_.begin(), cut_.end(), has_less_error);
    }
}

void FaceSum::refine(std::vector<NearFace>& near, double tolerance, double absolute) {
    Vec3d near_light(0);  // about
    while (!cut_.empty() && cut_.front().error > 0) {
        const double allowed = std::max(tolerance * largest_channel(light_ + near_light), absolute);
        if (squares_ <= allowed * allowed) {
            return;
        }
        std::pop_heap(cut_.begin(), cut_.end(), has_less_error);
        const Part part = cut_.back();
        cut_.pop_back();
        light_ -= part.value * part.light;
        squares_ -= part.error * part.error;
        const FaceTree::Node& node = faces_->nodes_[part.node];
        if (node.first_child == FaceTree::kLeaf) {
            near_light += part.value * part.light;
            add_near(faces_->faces_[node.face], near);
        } else {
            open(node.first_child);
            open(node.first_child + 1);
        }
    }
}

void FaceSum::add_near(const FaceTree::Face& face, std::vector<NearFace>& near) const {
    const Vec3d normal = glm::cross(face.b - face.a, face.c - face.a);
    const double height = -glm::dot(normal, face.a - frame_->origin);
    // The face that was hit, and others in its plane, would cover half of space or nothing, as rounding has it.
    if (!(std::abs(height) > clearance_ * glm::length(normal))) {
        return;
    }
    const std::array<Vec3d, 3> corners = {frame_->point_to_local(face.a), frame_->point_to_local(face.b),
                                          frame_->point_to_local(face.c)};
    const bool rises = std::ranges::any_of(corners, [](const Vec3d& corner) { return corner.z > 0; });
    if (rises && (height > 0 || !front_only_)) {
        near.push_back({corners, face.radiance});
    }
}

void FaceSum::add_up(const FaceTree& faces, const Vec3d& view, const ShadingFrame& frame,
                     const FaceViewpoint& viewpoint, double tolerance, double absolute, std::span<SummedLobe> lobes,
                     std::vector<NearFace>& near) {
    faces_ = &faces;
    frame_ = &frame;
    lobes_ = lobes;
    view_ = view;
    front_only_ = viewpoint.front_only;
    clearance_ = glm::distance(viewpoint.start, frame.origin);
    cut_.clear();
    values_.clear();
    light_ = Vec3d(0);
    squares_ = 0;
    open(0);
    refine(near, tolerance, absolute);
    for (std::size_t i = 0; i < lobes.size(); ++i) {
        lobes[i].light = Vec3d(0);
        for (const Part& part : cut_) {
            lobes[i].light += double{values_[part.first + i]} * part.light;
        }
    }
}

}  // namespace shlight
