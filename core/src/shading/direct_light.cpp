// SPDX-License-Identifier: MIT
#include "shading/direct_light.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "lights/seen_light.h"

namespace shlight {
namespace {

/// Points that are shaded at a time, as many as fit the cache with what is known of their views.
constexpr std::size_t kPointsPerChunk = 1024;

/// Error of a profile's mean ÷ the tolerance of a light's radiance, at most.
constexpr double kProfileTolerance = 10;

void count(LobeMethod way, int order, std::uint32_t hits, RenderReport& report) {
    switch (way) {
        case LobeMethod::nothing:
            break;
        case LobeMethod::mirror:
            report.mirror_count += hits;
            break;
        case LobeMethod::harmonics:
            report.order_counts[static_cast<std::size_t>(order)] += hits;
            break;
        case LobeMethod::cubature:
            report.cubature_count += hits;
            break;
    }
}

bool reflects(const LightTraits& traits, const LobeShape& shape) {
    return std::holds_alternative<GgxShape>(shape) ? traits.lights_glossy : traits.lights_diffuse;
}

}  // namespace

void DirectLight::compute(const ShadingPoints& points, std::span<const MaterialLobes> materials,
                          std::span<const Light* const> lights, RenderReport& report) {
    point_count_ = points.size();
    values_.assign(lights.size() * lobe_stride_ * point_count_, 0.0F);
    by_material_.resize(point_count_);
    std::iota(by_material_.begin(), by_material_.end(), 0U);
    std::stable_sort(by_material_.begin(), by_material_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return points.material[a] < points.material[b]; });
    const std::span<const std::uint32_t> sorted(by_material_);
    for (std::size_t first = 0; first < point_count_;) {
        const std::uint32_t material = points.material[sorted[first]];
        std::size_t last = first + 1;
        while (last < point_count_ && last < first + kPointsPerChunk && points.material[sorted[last]] == material) {
            ++last;
        }
        shade(points, sorted.subspan(first, last - first), materials[material], lights, report);
        first = last;
    }
}

void DirectLight::shade(const ShadingPoints& points, std::span<const std::uint32_t> some, const MaterialLobes& material,
                        std::span<const Light* const> lights, RenderReport& report) {
    cosines_.resize(some.size());
    std::transform(some.begin(), some.end(), cosines_.begin(),
                   [&](std::uint32_t point) { return double{points.cos_theta_o[point]}; });
    weights_.clear();
    for (const std::uint32_t point : some) {
        const std::span<const Rgb> own = points.weights(point);
        weights_.insert(weights_.end(), own.begin(), own.end());
    }
    views_.assign(material, cosines_, {weights_, lobe_stride_}, true);
    tolerance_ = material.tolerance();
    if (views_.lobe_count() == 0) {
        return;
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        integrate(points, some, *lights[i], i, report);
    }
}

void DirectLight::see(const Light& light, const ShadingPoints& points, std::span<const std::uint32_t> some) {
    const auto* polygon = std::get_if<PolygonLight>(&light);
    if (polygon != nullptr) {
        polygons_.clear(polygon->vertices.size());
    } else {
        caps_.clear();
    }
    for (std::size_t i = 0; i < some.size(); ++i) {
        const ShadingFrame& frame = points.frame[some[i]];
        if (polygon != nullptr) {
            if (!is_seen(light, frame, points.error[some[i]])) {
                continue;
            }
            for_lit_corners(*polygon, frame, [&](const Vec3d& corner) { polygons_.push_back(corner); });
        } else {
            const std::optional<CapView> cap = cap_view(light, frame);
            if (!cap || !(ProfileView(light, frame).range().high > 0)) {
                continue;
            }
            caps_.push_back(*cap);
        }
        seen_by_.push_back(static_cast<std::uint32_t>(i));
    }
    if (polygon == nullptr) {
        find_circles();
    }
}

void DirectLight::find_circles() {
    circles_.resize(caps_.size());
    centers_.resize(caps_.size());
    radii_.resize(caps_.size());
    for (std::size_t k = 0; k < caps_.size(); ++k) {
        const bool sphere = caps_[k].kind == CapView::Kind::sphere;
        centers_[k] = sphere ? caps_[k].center : Vec3d(0, 0, 1);
        radii_[k] = sphere ? caps_[k].radius : 1;
    }
    circles_of_spheres(std::span<const Vec3d>(centers_), radii_.data(), circles_.output());
    for (std::size_t k = 0; k < caps_.size(); ++k) {
        if (caps_[k].kind != CapView::Kind::sphere) {
            circles_.set(k, circle_of(caps_[k]));
        }
    }
}

void DirectLight::integrate(const ShadingPoints& points, std::span<const std::uint32_t> some, const Light& light,
                            std::size_t light_index, RenderReport& report) {
    if (const auto* mesh = std::get_if<MeshLight>(&light)) {
        integrate_mesh(points, some, *mesh, light_index, report);
        return;
    }
    if (std::holds_alternative<DiskLight>(light)) {
        integrate_disk(points, some, light, light_index, report);
        return;
    }
    seen_by_.clear();
    see(light, points, some);
    if (std::holds_alternative<PolygonLight>(light)) {
        shade_seen(points, some, light, light_index, polygons_, report);
    } else {
        shade_seen(points, some, light, light_index, circles_.arrays(), report);
    }
}

void DirectLight::integrate_mesh(const ShadingPoints& points, std::span<const std::uint32_t> some,
                                 const MeshLight& light, std::size_t light_index, RenderReport& report) {
    outlines_.clear();
    for (std::size_t i = 0; i < some.size(); ++i) {
        outlines_.look(*light.shape, points.frame[some[i]], tolerance_, static_cast<std::uint32_t>(i));
    }
    outlines_.for_each_size(polygons_, seen_by_,
                            [&] { shade_seen(points, some, light, light_index, polygons_, report); });
    seen_by_.assign(outlines_.inside().begin(), outlines_.inside().end());
    circles_.resize(seen_by_.size());
    for (std::size_t k = 0; k < seen_by_.size(); ++k) {
        circles_.set(k, circle_of(CapView{CapView::Kind::inside, Vec3d(0, 0, 1), 1}));
    }
    shade_seen(points, some, light, light_index, circles_.arrays(), report);
}

void DirectLight::integrate_disk(const ShadingPoints& points, std::span<const std::uint32_t> some, const Light& light,
                                 std::size_t light_index, RenderReport& report) {
    disks_.clear();
    for (std::uint32_t i = 0; i < some.size(); ++i) {
        const ShadingFrame& frame = points.frame[some[i]];
        if (is_seen(light, frame, points.error[some[i]])) {
            const LitDisk lit = lit_part(std::get<DiskLight>(light), frame);
            if (lit.corners.empty()) {
                disks_.add(lit.ellipse, i, i);
            } else {
                disks_.add(lit.corners, i, i);
            }
        }
    }
    for (std::size_t lobe = 0; lobe < views_.lobe_count(); ++lobe) {
        disks_.for_each_size(views_.lobe(lobe), tolerance_, [&] {
            seen_by_.assign(disks_.views().begin(), disks_.views().end());
            shade_seen(points, some, light, light_index, lobe, disks_.polygons(), report);
        });
    }
}

template <class Lights>
void DirectLight::shade_seen(const ShadingPoints& points, std::span<const std::uint32_t> some, const Light& light,
                             std::size_t light_index, Lights&& lights, RenderReport& report) {
    for (std::size_t lobe = 0; lobe < views_.lobe_count() && !seen_by_.empty(); ++lobe) {
        shade_seen(points, some, light, light_index, lobe, lights, report);
    }
}

template <class Lights>
void DirectLight::shade_seen(const ShadingPoints& points, std::span<const std::uint32_t> some, const Light& light,
                             std::size_t light_index, std::size_t lobe, Lights& lights, RenderReport& report) {
    const LightTraits& traits = traits_of(light);
    if (!reflects(traits, views_.lobe(lobe).shape())) {
        return;
    }
    batch_.shade(views_.lobe(lobe), lights, seen_by_, true);
    float* values = values_of(light_index, lobe);
    for (std::size_t k = 0; k < seen_by_.size(); ++k) {
        const std::uint32_t point = some[seen_by_[k]];
        values[point] += batch_.values()[k];
        if (k > 0 && seen_by_[k] == seen_by_[k - 1]) {
            continue;  // another face of the same mesh
        }
        count(batch_.method(k), batch_.efforts()[k], points.hit_count(point), report);
        report.over_tolerance +=
            batch_.within_tolerance(views_.lobe(lobe), k, seen_by_[k]) ? 0 : points.hit_count(point);
        if (!std::holds_alternative<EvenProfile>(traits.profile) && values[point] > 0) {
            apply_profile(lobe, k, points, point, light, values[point]);
        }
    }
}

void DirectLight::apply_profile(std::size_t lobe, std::size_t k, const ShadingPoints& points, std::uint32_t point,
                                const Light& light, float& value) {
    const LobeViews& views = views_.lobe(lobe);
    profile_.reset(light, points.frame[point]);
    const std::size_t view = seen_by_[k];
    // A small light's radiance keeps within the tolerance whatever its profile, but a spot's rim should look right.
    const double tolerance =
        std::min(views.absolute_tolerance(view) / double{value}, kProfileTolerance * double{views.tolerances()[view]});
    const double mean = profile_.mean(views.shape(), points.cos_theta_o[point], tolerance * profile_.range().high);
    value = static_cast<float>(value * mean);
}

}  // namespace shlight
