// SPDX-License-Identifier: MIT
#include "emitters/face_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/ray_rounding.h"

namespace shlight {
namespace {

/// Faces of a node that are worth asking whether to stop.
constexpr std::uint32_t kFacesBetweenStops = 1 << 12;

/// Whether the hit is level with each of the part's faces (FaceViewpoint::clearance). One by one they would be asked
/// for nothing but rounding.
bool is_level(const FacePart& part, const PartView& seen, double clearance) {
    const double height = std::abs(seen.facing) * seen.distance / part.shown;
    return height + part.thickness + part.bend * (seen.distance + part.radius) <= clearance;
}

}  // namespace

PartView::PartView(const FacePart& part, const ShadingFrame& frame, const FaceViewpoint& viewpoint, bool is_face)
    : way(part.center - frame.origin),
      distance(std::max({glm::length(way), 1e-3 * part.radius, std::numeric_limits<double>::min()})),
      nearness(1 / distance),
      width(part.radius * nearness),
      rise(glm::dot(frame.z, way) * nearness),
      facing(-glm::dot(part.area_vector, way) * nearness) {
    const double turn = part.bend + width;
    // All points of a plane have the hit on the same side.
    one_side = std::abs(facing) > turn * part.shown || (is_face && width < 1);
    const bool from_behind = viewpoint.front_only && facing < 0 && (one_side || is_face);
    hidden = rise < -width || from_behind || !(part.area > 0) || is_level(part, *this, viewpoint.clearance);
    unclear = std::min(1.0, turn) * part.shown + (part.area - part.shown);
}

FaceTree::FaceTree(std::span<const Vec3d> vertices, std::span<const Triangle> triangles, std::span<const Rgb> radiance,
                   bool closed, bool one_sided, const Stopped& stopped)
    : closed_(closed), one_sided_(one_sided) {
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        const Triangle& t = triangles[i];
        faces_.push_back({vertices[t.x], vertices[t.y], vertices[t.z], radiance[i], i});
    }
    nodes_.reserve(2 * faces_.size());
    nodes_.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(faces_.size()), stopped);
    leaf_of_.resize(faces_.size());
    for (std::uint32_t i = 0; i < faces_.size(); ++i) {
        leaf_of_[faces_[i].triangle] = i;
    }
    const std::vector<Vec3f> traced(vertices.begin(), vertices.end());
    auto tree = std::make_shared<const SurfaceTree>(traced, triangles, std::vector<std::uint32_t>(), stopped);
    rays_ = std::make_unique<const RayTracer>(std::vector<TracedInstance>{{std::move(tree), glm::dmat4(1)}}, stopped);
}

/// Halves the faces along their longest extent.
void FaceTree::build(std::uint32_t node, std::uint32_t first, std::uint32_t last, const Stopped& stopped) {
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
        const double area = glm::length(normal);
        made.part.area += area;
        made.part.turns += area > 0 ? glm::outerProduct(normal, normal / area) : glm::dmat3(0);
        radiance += area * Vec3d(f.radiance);
        moment += area / 3 * (f.a + f.b + f.c);
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
        const std::uint32_t middle = middle_of(first, last);
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

void FaceTree::find_variation(std::uint32_t first, std::uint32_t last, FacePart& part) const {
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
        const Vec3d difference = f.radiance - part.radiance;
        squares += area * largest_channel(difference) * largest_channel(difference);
        slopes += glm::outerProduct(area * ((f.a + f.b + f.c) / 3.0 - part.center), difference);
        part.bend = area > 0 ? std::max(part.bend, glm::length(normal / area - common)) : part.bend;
        for (const Vec3d& corner : {f.a, f.b, f.c}) {
            part.thickness = std::max(part.thickness, std::abs(glm::dot(common, corner - part.center)));
        }
    }
    part.deviation = std::sqrt(squares / part.area);
    part.slope = std::max({glm::length(slopes[0]), glm::length(slopes[1]), glm::length(slopes[2])}) /
                 (part.area * std::max(part.radius, std::numeric_limits<double>::min()));
    part.shown = length;
    part.brightness = std::hypot(largest_channel(part.radiance), part.deviation);
}

bool FaceTree::is_front(const Face& face, const Vec3d& direction) {
    return glm::dot(glm::cross(face.b - face.a, face.c - face.a), direction) < 0;
}

double FaceTree::height_over(const Face& face, const Vec3d& point) {
    return glm::dot(glm::normalize(glm::cross(face.b - face.a, face.c - face.a)), point - face.a);
}

const FaceTree::Face* FaceTree::next_face(Ray& ray) const {
    RayHit met;
    rays_->intersect({&ray, 1}, {&met, 1});
    if (met.missed()) {
        return nullptr;
    }
    ray.t_min = std::nextafter(met.distance, std::numeric_limits<float>::infinity());
    return &faces_[leaf_of_[met.triangle]];
}

Rgb FaceTree::from(const FaceViewpoint& viewpoint, const Vec3d& direction) const {
    Ray ray = {Vec3f(viewpoint.start), 0, Vec3f(direction)};
    const Face* face = next_face(ray);
    const bool shines = face != nullptr && (is_front(*face, direction) || !viewpoint.front_only);
    return shines ? face->radiance : Rgb(0);
}

FaceViewpoint FaceTree::viewpoint(const ShadingFrame& frame, double error) const {
    const double clearance = error + kMeshRounding * radius();
    const Vec3d start = frame.origin + clearance * frame.z;
    return {start, clearance, shows_front_only(start)};
}

bool FaceTree::shows_front_only(const Vec3d& point) const {
    if (one_sided_ || !closed_ || glm::length(point - center()) >= radius()) {
        return one_sided_ || closed_;
    }
    // A ray leaves each closed surface around the point once more than it enters it.
    int around = 0;
    Ray up = {Vec3f(point), 0, Vec3f(0, 0, 1)};
    while (const Face* face = next_face(up)) {
        around += is_front(*face, Vec3d(up.direction)) ? -1 : 1;
    }
    return around <= 0;
}

}  // namespace shlight
