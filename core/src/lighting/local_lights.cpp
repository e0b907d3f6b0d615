// SPDX-License-Identifier: MIT
#include "lighting/local_lights.h"

#include <algorithm>
#include <numeric>

#include "emitters/emitter_levels.h"
#include "emitters/flat_outline.h"
#include "lobes/material_lobes.h"
#include "regions/disk_polygon.h"

namespace shlight {
namespace {

/// Polygons of any size are filled up to a multiple of this many vertices.
constexpr std::size_t kSizeStep = kDiskPolygonStep;

/// Largest tolerance of the polygons that replace disks.
constexpr double kDiskTolerance = 1e-4;

}  // namespace

void LocalLights::clear() {
    given_ = Given::none;
    caps_.clear();
    cap_numbers_.clear();
    vertices_.clear();
    polygons_.clear();
    disks_.clear();
    numbers_.clear();
    holds_all_ = false;
}

void LocalLights::look(const Light& light, const ShadingFrame& frame, double error, double tolerance,
                       std::uint32_t number) {
    if (const auto* mesh = std::get_if<MeshLight>(&light)) {
        look_at(*mesh, frame, tolerance, number);
    } else if (!seen_.look(light, frame, error)) {
        return;
    } else if (seen_.cap()) {
        caps_.push_back(*seen_.cap());
        cap_numbers_.push_back(number);
    } else if (seen_.corners().empty()) {
        add_disk(seen_.ellipse(), number);
    } else {
        const std::size_t first = vertices_.size();
        vertices_.insert(vertices_.end(), seen_.corners().begin(), seen_.corners().end());
        add_polygon(first, number, std::holds_alternative<DiskLight>(light));
    }
}

void LocalLights::look(const Light& light, std::span<const ShadingFrame> frames, std::span<const double> errors,
                       std::span<const std::uint32_t> some, double tolerance) {
    const auto* sphere = std::get_if<SphereLight>(&light);
    if (sphere != nullptr && !sphere->facing_disk && std::holds_alternative<EvenProfile>(sphere->traits.profile) &&
        look_from_outside(*sphere, frames, some)) {
        return;
    }
    for (std::uint32_t i = 0; i < some.size(); ++i) {
        look(light, frames[some[i]], errors[some[i]], tolerance, i);
    }
}

bool LocalLights::look_from_outside(const SphereLight& light, std::span<const ShadingFrame> frames,
                                    std::span<const std::uint32_t> some) {
    centers_.resize(some.size());
    cap_numbers_.resize(some.size());
    std::size_t count = 0;
    bool inside = false;
    for (std::uint32_t i = 0; i < some.size(); ++i) {
        const Vec3d center = frames[some[i]].point_to_local(light.center);
        inside |= glm::length(center) <= light.radius;
        centers_[count] = center;
        cap_numbers_[count] = i;
        count += center.z + light.radius > 0 ? 1 : 0;
    }
    cap_numbers_.resize(inside ? 0 : count);
    centers_.resize(count);
    radii_.assign(count, light.radius);
    if (!inside) {
        circles_.set_spheres(centers_, radii_.data());
    }
    return !inside;
}

void LocalLights::look_at(const MeshLight& light, const ShadingFrame& frame, double tolerance, std::uint32_t number) {
    const std::size_t first = vertices_.size();
    // The tolerance is relative to the emitter's light, which from afar is little of a surrounding surface's.
    const double share = shown_share(*light.shape, glm::length(light.shape->center - frame.origin));
    switch (mesh_view_.look(*light.shape, frame, tolerance * std::min(share, 1.0))) {
        case MeshView::Kind::hidden:
            break;
        case MeshView::Kind::outline:
            for (const FlatOutline::Vertex& v : mesh_view_.outline().line(0)) {
                vertices_.push_back(mesh_view_.outline().direction(v.at));
            }
            add_polygon(first, number, true);
            break;
        case MeshView::Kind::faces:
            for (std::size_t i = 0; i + 2 < mesh_view_.faces().size(); i += 3) {
                const std::span<const Vec3d> face = mesh_view_.faces().subspan(i, 3);
                vertices_.insert(vertices_.end(), face.begin(), face.end());
                add_polygon(first + i, number, false);
            }
            break;
        case MeshView::Kind::inside:
            caps_.push_back({CapView::Kind::inside, Vec3d(0, 0, 1), 1});
            cap_numbers_.push_back(number);
            break;
    }
}

void LocalLights::add_polygon(std::size_t first, std::uint32_t number, bool filled_up) {
    const std::size_t count = vertices_.size() - first;
    const std::size_t size = filled_up ? (count + kSizeStep - 1) / kSizeStep * kSizeStep : count;
    holds_all_ = false;
    polygons_.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count),
                         static_cast<std::uint32_t>(size), number});
}

void LocalLights::add_polygon(std::span<const Vec3d> corners, std::uint32_t number) {
    const std::size_t first = vertices_.size();
    vertices_.insert(vertices_.end(), corners.begin(), corners.end());
    add_polygon(first, number, false);
}

void LocalLights::add_disk(const Ellipse& disk, std::uint32_t number) {
    const SphericalEllipse ellipse(disk, true);
    if (!ellipse.empty()) {
        holds_all_ = false;
        polygons_.push_back({static_cast<std::uint32_t>(disks_.size()), 0, 0, number});
        disks_.push_back(ellipse);
    }
}

void LocalLights::set_spheres(std::span<const Vec3f> centers, const float* radii) {
    clear();
    given_ = Given::spheres;
    float_centers_ = centers;
    float_radii_ = radii;
}

void LocalLights::set_spheres(std::span<const Vec3d> centers, const double* radii) {
    clear();
    given_ = Given::spheres;
    float_centers_ = {};
    circles_.set_spheres(centers, radii);
}

void LocalLights::shade_spheres(LobeViews& lobe, std::span<const std::uint32_t> view_of, bool with_statistics,
                                LobeIntegrator& batch) {
    if (!float_centers_.empty() && LobeIntegrator::shades_alike(lobe)) {
        batch.shade(lobe, SphereArrays{float_centers_.data(), float_radii_}, view_of, with_statistics);
        return;
    }
    if (!float_centers_.empty()) {
        circles_.set_spheres(float_centers_, float_radii_);
        float_centers_ = {};
    }
    batch.shade(lobe, circles_.arrays(), view_of, with_statistics);
}

template <class T>
void LocalLights::set_polygons(std::span<const Vec3<T>> vertices, std::size_t vertex_count) {
    clear();
    gathered_.clear(vertex_count);
    gathered_.append(vertices.data(), vertices.size() / vertex_count);
    gathered_.prepare<T>();
    given_ = Given::polygons;
}

/// Finds the circles of spheres in lanes.
void LocalLights::find_circles() {
    if (caps_.empty()) {
        return;
    }
    centers_.resize(caps_.size());
    radii_.resize(caps_.size());
    for (std::size_t k = 0; k < caps_.size(); ++k) {
        const bool sphere = caps_[k].kind == CapView::Kind::sphere;
        centers_[k] = sphere ? caps_[k].center : Vec3d(0, 0, 1);
        radii_[k] = sphere ? caps_[k].radius : 1;
    }
    circles_.set_spheres(centers_, radii_.data());
    for (std::size_t k = 0; k < caps_.size(); ++k) {
        if (caps_[k].kind != CapView::Kind::sphere) {
            circles_.set(k, circle_of(caps_[k]));
        }
    }
    caps_.clear();  // the circles stand for them from now on
}

std::uint32_t LocalLights::size_of(const Polygon& polygon, const LobeViews& lobe,
                                   std::span<const std::uint32_t> view_of, double tolerance) const {
    if (polygon.count > 0) {
        return polygon.size;
    }
    const std::uint32_t view = view_of[polygon.number];
    const LobeShape shape = lobe.shape(view);
    const SphericalEllipse& disk = disks_[polygon.first];
    const Vec3d towards_viewer = lobe.positions().direction(view);
    return static_cast<std::uint32_t>(disk_polygon_size(disk, narrowest(shape, towards_viewer.z),
                                                        distance_of_change(shape, disk.cone().axis, towards_viewer),
                                                        std::min(tolerance, kDiskTolerance)));
}

void LocalLights::sort(const LobeViews& lobe, std::span<const std::uint32_t> view_of, double tolerance) {
    sizes_.clear();
    for (const Polygon& polygon : polygons_) {
        sizes_.push_back(size_of(polygon, lobe, view_of, tolerance));
    }
    order_.resize(polygons_.size());
    std::iota(order_.begin(), order_.end(), 0U);
    if (!std::is_sorted(sizes_.begin(), sizes_.end())) {
        std::stable_sort(order_.begin(), order_.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return sizes_[a] < sizes_[b]; });
    }
}

std::size_t LocalLights::gather(std::size_t first) {
    const std::uint32_t size = sizes_[order_[first]];
    gathered_.clear(size);
    numbers_.clear();
    for (; first < order_.size() && sizes_[order_[first]] == size; ++first) {
        const Polygon& polygon = polygons_[order_[first]];
        if (polygon.count == size) {
            gathered_.append(&vertices_[polygon.first], 1);
        } else {
            append_filled_up(polygon, size);
        }
        numbers_.push_back(polygon.number);
    }
    holds_all_ = numbers_.size() == polygons_.size() && disks_.empty();
    return first;
}

void LocalLights::append_filled_up(const Polygon& polygon, std::uint32_t size) {
    corners_.clear();
    if (polygon.count == 0) {
        append_disk_polygon(disks_[polygon.first], static_cast<int>(size), corners_);
    } else {
        const auto from = vertices_.begin() + polygon.first;
        corners_.assign(from, from + polygon.count);
        corners_.resize(size, corners_.back());
    }
    gathered_.append(corners_.data(), 1);
}

std::span<const std::uint32_t> LocalLights::views(std::span<const std::uint32_t> numbers,
                                                  std::span<const std::uint32_t> view_of) {
    views_.clear();
    for (const std::uint32_t number : numbers) {
        views_.push_back(view_of[number]);
    }
    return views_;
}

template void LocalLights::set_polygons(std::span<const Vec3<float>>, std::size_t);
template void LocalLights::set_polygons(std::span<const Vec3<double>>, std::size_t);

}  // namespace shlight
