// SPDX-License-Identifier: MIT
#include "emitters/face_sum.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "lobes/lobe_rays.h"

namespace shlight {
namespace {

/// Share of a lobe's width: over a smaller part f·cos is its value at the middle, except at the horizon.
constexpr double kBroad = 0.2;
/// Radius ÷ distance from which on a part is never good enough as a whole.
constexpr double kWide = 0.35;
/// Relative error of a part as a whole ÷ (its radius as a share of the least distance over which the light changes)².
/// Parts' errors have a common sign in part, so that their squares alone would add up to too little.
constexpr double kCurvature = 1;
/// Error of shown_area() ÷ area: a cube has the largest, as its faces look straight to and away from the hit.
constexpr double kTurned = 0.17;

/// The direction in which f·cos is largest, about.
Vec3d brightest(const LobeShape& lobe, const Vec3d& view) {
    return is_glossy(lobe) ? mirrored(view) : Vec3d(0, 0, 1);
}

/// The area that faces show on both sides, about, if some of them look away: their cosines are taken to be spread
/// evenly about their mean with the variance that they have, as those of zones of a sphere are (Archimedes). An
/// estimate that was always too low would add up over the parts.
double shown_area(const FacePart& part, const PartView& seen) {
    const Vec3d direction = seen.nearness * seen.way;
    const double mean = std::abs(seen.facing);
    const double squares = part.area * glm::dot(direction, part.turns * direction);
    const double spread = std::sqrt(3 * std::max(squares - mean * mean, 0.0));
    return spread <= mean ? mean : 0.5 * (mean * mean / spread + spread);
}

}  // namespace

void FaceSum::Ways::resize(std::size_t count) {
    const std::size_t padded = (count + kLobeRayLanes - 1) / kLobeRayLanes * kLobeRayLanes;
    for (std::vector<float>* each : {&x, &y, &z, &values}) {
        each->resize(padded);
    }
    for (std::size_t i = count; i < padded; ++i) {
        set(i, Vec3d(0, 0, 1));
    }
}

void FaceSum::Ways::set(std::size_t i, const Vec3d& way) {
    x[i] = static_cast<float>(way.x);
    y[i] = static_cast<float>(way.y);
    z[i] = static_cast<float>(way.z);
}

void FaceSum::Ways::weigh(const LobeShape& shape, const ShadingFrame& frame, const Vec3d& view, std::size_t count) {
    weigh_lobe_rays(shape, frame, view, {x.data(), y.data(), z.data()}, count, values.data(), nullptr);
}

void FaceSum::open(std::uint32_t node) {
    opened_.push_back(faces_->nodes_[node].first_child);
    opened_.push_back(faces_->nodes_[node].first_child + 1);
}

void FaceSum::look() {
    seen_.clear();
    while (!opened_.empty()) {
        const std::uint32_t node = opened_.back();
        opened_.pop_back();
        const bool is_leaf = faces_->nodes_[node].first_child == FaceTree::kLeaf;
        const PartView seen(faces_->nodes_[node].part, *frame_, *viewpoint_, is_leaf);
        if (seen.hidden) {
            continue;
        }
        if (seen.width > kWide && !is_leaf) {
            open(node);
            continue;
        }
        seen_.push_back(seen_part(node, seen));
    }
}

/// A part's light follows from its power, which is exact if all its faces are seen from the same side.
FaceSum::SeenPart FaceSum::seen_part(std::uint32_t node, const PartView& seen) const {
    const FacePart& part = faces_->nodes_[node].part;
    const double both = seen.one_side ? std::abs(seen.facing) : shown_area(part, seen);
    const double shown = viewpoint_->front_only ? 0.5 * (both + seen.facing) : both;
    const double limit = seen.width > 1 ? 1 / (seen.width * seen.width) : 1;  // no nearer than the part's radius
    const double scale = limit * seen.nearness * seen.nearness;
    // Radiance may be negative; power is that of the side which the area vector shows.
    const double side = seen.facing > 0 ? -1 : 1;
    const Vec3d light = seen.one_side ? side * seen.nearness * (seen.way * part.power) : shown * Vec3d(part.radiance);
    const double area = seen.one_side ? shown : seen.unclear;
    return {seen.nearness * seen.way,  scale * light, scale * area, seen.width,
            !(seen.rise > seen.width), seen.one_side, node};
}

void FaceSum::weigh() {
    ways_.resize(seen_.size());
    const std::size_t first = cut_.size();
    for (std::size_t i = 0; i < seen_.size(); ++i) {
        ways_.set(i, seen_[i].direction);
        cut_.push_back({seen_[i].light, 0, 0, values_.size(), seen_[i].node});
        values_.resize(values_.size() + lobes_.size());
    }
    for (std::size_t lobe = 0; lobe < lobes_.size(); ++lobe) {
        weigh(lobe, cut_.data() + first);
    }
    const auto is_dark = [](const Part& part) { return part.value == 0 && part.error == 0; };
    cut_.erase(std::remove_if(cut_.begin() + static_cast<std::ptrdiff_t>(first), cut_.end(), is_dark), cut_.end());
}

/// Errors: lobe and distance change over the part by x, which matters for the part's slope of radiance and at the
/// horizon, and by x² for all else.
void FaceSum::weigh(std::size_t lobe, Part* parts) {
    const SummedLobe& own = lobes_[lobe];
    const double lobe_size = lobe_width(own.shape);
    ways_.weigh(own.shape, *frame_, view_, seen_.size());
    find_most(own);
    for (std::size_t i = 0; i < seen_.size(); ++i) {
        const SeenPart& seen = seen_[i];
        const FacePart& part = faces_->nodes_[seen.node].part;
        const double x = std::min(1.0, seen.width / lobe_size);
        const double change = seen.level ? x : x * x;
        const double turned = std::hypot(kTurned * largest_channel(part.radiance), part.deviation);
        const double unlike = seen.one_side ? 0 : std::min(1.0, part.bend) * turned;
        const double left_out = kCurvature * std::max(change * part.brightness, unlike) + 0.5 * x * part.slope;
        values_[parts[i].first + lobe] = ways_.values[i];
        parts[i].value += own.weight * double{ways_.values[i]};
        parts[i].error += own.weight * seen.brought * double{most_[i]} * left_out;
    }
}

void FaceSum::find_most(const SummedLobe& lobe) {
    const double broad = kBroad * lobe_width(lobe.shape);
    const Vec3d top = frame_->to_world(brightest(lobe.shape, view_));
    most_.assign(ways_.values.begin(), ways_.values.end());
    some_.clear();
    for (std::uint32_t i = 0; i < seen_.size(); ++i) {
        if (seen_[i].width > broad || seen_[i].level) {
            some_.push_back(i);
        }
    }
    nearest_.resize(some_.size());
    for (std::size_t k = 0; k < some_.size(); ++k) {
        const SeenPart& seen = seen_[some_[k]];
        const Vec3d to_top = top - seen.direction;
        const double length = std::max(glm::length(to_top), 1e-9);
        nearest_.set(k, length > seen.width ? seen.direction + seen.width / length * to_top : top);
    }
    nearest_.weigh(lobe.shape, *frame_, view_, some_.size());
    for (std::size_t k = 0; k < some_.size(); ++k) {
        most_[some_[k]] = std::max(most_[some_[k]], nearest_.values[k]);
    }
}

void FaceSum::open_worst(double allowed, Vec3d& near_light, std::vector<NearFace>& near) {
    const double most = allowed * allowed / static_cast<double>(cut_.size());
    std::erase_if(cut_, [&](const Part& part) {
        if (part.error * part.error <= most) {
            return false;
        }
        const FaceTree::Node& node = faces_->nodes_[part.node];
        if (node.first_child == FaceTree::kLeaf) {
            near_light += part.value * part.light;
            add_near(faces_->faces_[node.face], near);
        } else {
            open(part.node);
        }
        return true;
    });
}

void FaceSum::add_near(const FaceTree::Face& face, std::vector<NearFace>& near) const {
    const double height = FaceTree::height_over(face, frame_->origin);
    if (!(std::abs(height) > viewpoint_->clearance)) {
        return;
    }
    const std::array<Vec3d, 3> corners = {frame_->point_to_local(face.a), frame_->point_to_local(face.b),
                                          frame_->point_to_local(face.c)};
    const bool rises = std::ranges::any_of(corners, [](const Vec3d& corner) { return corner.z > 0; });
    if (rises && (height > 0 || !viewpoint_->front_only)) {
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
    viewpoint_ = &viewpoint;
    cut_.clear();
    values_.clear();
    opened_.assign(1, 0);
    Vec3d near_light(0);  // about
    while (!opened_.empty()) {
        look();
        weigh();
        Vec3d light = near_light;
        double squares = 0;
        for (const Part& part : cut_) {
            light += part.value * part.light;
            squares += part.error * part.error;
        }
        const double allowed = std::max(tolerance * largest_channel(light), absolute);
        if (squares > allowed * allowed) {
            open_worst(allowed, near_light, near);
        }
    }
    for (std::size_t i = 0; i < lobes.size(); ++i) {
        lobes[i].light = Vec3d(0);
        for (const Part& part : cut_) {
            lobes[i].light += double{values_[part.first + i]} * part.light;
        }
    }
}

}  // namespace shlight
