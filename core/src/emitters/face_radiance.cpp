// SPDX-License-Identifier: MIT
#include "emitters/face_radiance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shlight/scene_rays.h"

namespace shlight {
namespace {

/// Maximum number of times that a near face is quartered.
constexpr int kMostQuarterings = 4;
/// Share of the light: parts that bring less are allowed the error of a part that brings this.
constexpr double kLeastShare = 1.0 / 256;
/// Share of the lobe's width: over a smaller part f·cos is its value at the middle, except at the horizon.
constexpr double kBroad = 0.2;
/// Faces of a node that are worth asking whether to stop.
constexpr std::uint32_t kFacesBetweenStops = 1 << 12;

double largest(const Rgb& color) {
    return std::max({std::abs(color.x), std::abs(color.y), std::abs(color.z)});
}

}  // namespace

FaceRadiance::FaceRadiance(std::span<const Vec3d> vertices, std::span<const Triangle> triangles,
                           std::vector<Rgb> radiance, bool only_outer, const Stopped& stopped)
    : only_outer_(only_outer), of_triangle_(std::move(radiance)) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Triangle& t = triangles[i];
        faces_.push_back({vertices[t.x], vertices[t.y], vertices[t.z], of_triangle_[i]});
    }
    nodes_.reserve(2 * faces_.size());
    nodes_.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(faces_.size()), stopped);
    for (Node& node : nodes_) {
        node.part.difference = largest(node.part.radiance - mean());
    }
    const std::vector<Vec3f> traced(vertices.begin(), vertices.end());
    for (const Triangle& t : triangles) {
        normals_.push_back(glm::cross(traced[t.y] - traced[t.x], traced[t.z] - traced[t.x]));
    }
    auto tree = std::make_shared<const TriangleTree>(traced, triangles, std::vector<std::uint32_t>(), stopped);
    rays_ = std::make_unique<const RayTracer>(std::vector<TracedInstance>{{std::move(tree), glm::dmat4(1)}}, stopped);
}

/// Halves the faces along their longest extent.
void FaceRadiance::build(std::uint32_t node, std::uint32_t first, std::uint32_t last, const Stopped& stopped) {
    if (last - first >= kFacesBetweenStops) {
        end_if(stopped);
    }
    Vec3d low(faces_[first].a);
    Vec3d high = low;
    Node made{};
    Vec3d radiance(0);
    Vec3d moment(0);
    for (std::uint32_t i = first; i < last; ++i) {
        const Face& f = faces_[i];
        const Vec3d normal = 0.5 * glm::cross(f.b - f.a, f.c - f.a);
        made.part.area_vector += normal;
        made.part.power += glm::outerProduct(normal, Vec3d(f.radiance));
        made.part.area += glm::length(normal);
        radiance += glm::length(normal) * Vec3d(f.radiance);
        moment += glm::length(normal) / 3 * (f.a + f.b + f.c);
        for (const Vec3d& corner : {f.a, f.b, f.c}) {
            low = glm::min(low, corner);
            high = glm::max(high, corner);
        }
    }
    made.part.center = made.part.area > 0 ? moment / made.part.area : 0.5 * (low + high);
    made.part.radius = glm::length(glm::max(high - made.part.center, made.part.center - low));
    made.part.radiance = made.part.area > 0 ? Rgb(radiance / made.part.area) : faces_[first].radiance;
    find_variation(first, last, made.part);
    made.face = first;
    made.first_child = kLeaf;
    if (last - first > 1) {
        const Vec3d size = high - low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::uint32_t middle = first + (last - first) / 2;
        std::nth_element(faces_.begin() + first, faces_.begin() + middle, faces_.begin() + last,
                         [axis](const Face& p, const Face& q) {
                             return p.a[axis] + p.b[axis] + p.c[axis] < q.a[axis] + q.b[axis] + q.c[axis];
                         });
        made.first_child = static_cast<std::uint32_t>(nodes_.size());
        nodes_.resize(nodes_.size() + 2);
        build(made.first_child, first, middle, stopped);
        build(made.first_child + 1, middle, last, stopped);
    }
    nodes_[node] = made;
}

void FaceRadiance::find_variation(std::uint32_t first, std::uint32_t last, FacePart& part) const {
    if (!(part.area > 0)) {
        return;
    }
    const double length = glm::length(part.area_vector);
    const Vec3d common = length > 0 ? part.area_vector / length : Vec3d(0);
    double squares = 0;
    glm::dmat3 slopes(0);
    for (std::uint32_t i = first; i < last; ++i) {
        const Face& f = faces_[i];
        const Vec3d normal = 0.5 * glm::cross(f.b - f.a, f.c - f.a);
        const double area = glm::length(normal);
        const Rgb difference = f.radiance - part.radiance;
        squares += area * largest(difference) * largest(difference);
        slopes += glm::outerProduct(area * ((f.a + f.b + f.c) / 3.0 - part.center), Vec3d(difference));
        part.bend = area > 0 ? std::max(part.bend, glm::length(normal / area - common)) : part.bend;
    }
    part.deviation = std::sqrt(squares / part.area);
    part.slope = std::max({glm::length(slopes[0]), glm::length(slopes[1]), glm::length(slopes[2])}) /
                 (part.area * std::max(part.radius, std::numeric_limits<double>::min()));
    part.unlike = 1 - length / part.area;
}

void FaceRadiance::along(std::span<const Ray> rays, std::vector<Rgb>& radiance) const {
    std::vector<RayHit> met(rays.size());
    rays_->intersect(rays, met);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        RayHit hit = met[i];
        while (only_outer_ && !hit.missed() && glm::dot(normals_[hit.triangle], rays[i].direction) > 0) {
            const Ray rest = behind(rays[i], hit);
            rays_->intersect({&rest, 1}, {&hit, 1});
        }
        radiance.push_back(hit.missed() ? mean() : of_triangle_[hit.triangle]);
    }
}

/// A part's light follows from its power, which is exact if all its faces are seen from the same side. Errors: lobe and
/// distance change over the part by x, which matters for the part's slope of radiance, and by x² for other differences,
/// or for the difference from the emitter's mean. If faces look away, a part of unknown radiance is visible.
FaceMean::Weighed FaceMean::weigh(const FacePart& part) const {
    const Vec3d way = part.center - frame_->origin;
    const double distance = std::max(glm::length(way), 1e-3 * part.radius);
    const Vec3d direction = frame_->to_local(way) / distance;
    const double facing = -glm::dot(part.area_vector, way) / distance;
    const double shown = faces_->only_outer_ ? std::max(facing, 0.0) : std::abs(facing);
    const double square = std::max(distance * distance, part.radius * part.radius);
    const double width = part.radius / distance;
    const double value = direction.z > 0 ? lobe_value(*lobe_, direction, view_) : 0.0;
    const double x = std::min(1.0, width / width_);
    const bool one_side = std::abs(facing) > (part.bend + width) * glm::length(part.area_vector);
    double most = value;
    if (x > kBroad || !(direction.z > width)) {
        const double share = std::min(1.0, width / std::max(glm::length(brightest_ - direction), 1e-9));
        const Vec3d nearest = glm::normalize(direction + share * (brightest_ - direction));
        most = std::max(value, nearest.z > 0 ? lobe_value(*lobe_, nearest, view_) : 0.0);
    }
    const double solid_angle = std::max(shown, 0.5 * part.unlike * part.area) / square;
    const double left_out = one_side ? 0.5 * x * part.slope + 0.25 * x * x * (part.deviation + part.difference)
                                     : 0.5 * std::max(x, part.unlike) * part.deviation +
                                           0.25 * std::max(x * x, part.unlike) * part.difference;
    // The mean stands for parts of which some faces look away.
    const Vec3d light = one_side && shown > 0 ? glm::abs(way * part.power) / distance : shown * Vec3d(part.radiance);
    return {shown / square * value, value / square * light, solid_angle * most * left_out};
}

/// Whether a part may count as a whole: the squares of the errors add up to that of the permitted one, of which each
/// part of the light has its share.
bool FaceMean::suffices(const Weighed& weighed) const {
    const double share = std::max(largest(Rgb(weighed.light)) / light_, kLeastShare);
    return weighed.error * weighed.error <= allowed_ * allowed_ * share;
}

void FaceMean::add(const Weighed& weighed) {
    sum_ += weighed.light;
    weights_ += weighed.weight;
}

void FaceMean::add_face(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Rgb& radiance, int quarterings) {
    const Vec3d center = (a + b + c) / 3.0;
    const Vec3d normal = 0.5 * glm::cross(b - a, c - a);
    const double radius = std::max({glm::length(a - center), glm::length(b - center), glm::length(c - center)});
    const double difference = largest(radiance - faces_->mean());
    const Weighed weighed = weigh({center, radius, normal, glm::outerProduct(normal, Vec3d(radiance)),
                                   glm::length(normal), radiance, 0, 0, difference, 0, 0});
    if (quarterings == 0 || suffices(weighed)) {
        add(weighed);
        return;
    }
    const Vec3d ab = 0.5 * (a + b);
    const Vec3d bc = 0.5 * (b + c);
    const Vec3d ca = 0.5 * (c + a);
    add_face(a, ab, ca, radiance, quarterings - 1);
    add_face(ab, b, bc, radiance, quarterings - 1);
    add_face(ca, bc, c, radiance, quarterings - 1);
    add_face(ab, bc, ca, radiance, quarterings - 1);
}

Rgb FaceMean::of(const FaceRadiance& faces, const LobeShape& shape, const Vec3d& view, const ShadingFrame& frame,
                 double value, double tolerance) {
    faces_ = &faces;
    lobe_ = &shape;
    frame_ = &frame;
    view_ = view;
    brightest_ = is_glossy(shape) ? mirrored(view) : Vec3d(0, 0, 1);
    width_ = lobe_width(shape);
    light_ = value * largest(faces.mean());
    allowed_ = tolerance * light_;
    sum_ = Vec3d(0);
    weights_ = 0;
    open_.assign(1, 0);
    while (!open_.empty()) {
        const FaceRadiance::Node& node = faces.nodes_[open_.back()];
        open_.pop_back();
        if (!(node.part.area > 0)) {
            continue;
        }
        if (node.first_child == FaceRadiance::kLeaf) {
            const FaceRadiance::Face& face = faces.faces_[node.face];
            add_face(face.a, face.b, face.c, face.radiance, kMostQuarterings);
            continue;
        }
        const Weighed weighed = weigh(node.part);
        if (suffices(weighed)) {
            add(weighed);
        } else {
            open_.push_back(node.first_child);
            open_.push_back(node.first_child + 1);
        }
    }
    return weights_ > 0 ? Rgb(sum_ / weights_) : faces.mean();
}

}  // namespace shlight
