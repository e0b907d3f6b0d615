// SPDX-License-Identifier: MIT
#include "unshadowed.h"

#include <algorithm>

#include "light_view.h"

namespace shlight {
namespace {

void count(const LobeRadiance& r, std::uint32_t hits, RenderReport& report) {
    if (r.order > 0) {
        report.order_counts[static_cast<std::size_t>(r.order)] += hits;
    } else if (r.points > 0) {
        report.cubature_count += hits;
    } else {
        report.mirror_count += hits;
    }
    report.over_tolerance += r.met ? 0 : hits;
}

}  // namespace

template <class Region>
void Unshadowed::shade(const Region& region, std::size_t light, std::size_t point, std::uint32_t hits,
                       RenderReport& report) {
    for (std::size_t lobe = 0; lobe < lobes_.size(); ++lobe) {
        if (lobes_[lobe]) {
            const LobeRadiance radiance = lobes_[lobe]->radiance(region);
            // What rings below zero is no light.
            values_[(light * lobe_stride_ + lobe) * point_count_ + point] = std::max(0.0F, radiance.value);
            count(radiance, hits, report);
        }
    }
}

void Unshadowed::compute(const ShadingPoints& points, std::span<const MaterialLobes> materials,
                         std::span<const Light> lights, RenderReport& report) {
    point_count_ = points.size();
    values_.assign(lights.size() * lobe_stride_ * point_count_, 0.0F);
    for (std::size_t point = 0; point < point_count_; ++point) {
        const MaterialLobes& material = materials[points.material[point]];
        lobes_.clear();
        for (std::size_t lobe = 0; lobe < material.lobes().size(); ++lobe) {
            lobes_.push_back(material.at(lobe, points.cos_theta_o[point]));
        }
        const ShadingFrame& frame = points.frame[point];
        for (std::size_t i = 0; i < lights.size(); ++i) {
            if (const auto* sphere = std::get_if<SphereLight>(&lights[i])) {
                if (const std::optional<CapView> cap = view(*sphere, frame)) {
                    shade(circle_of(*cap), i, point, points.hit_count(point), report);
                }
            } else if (const auto& polygon = std::get<PolygonLight>(lights[i]);
                       is_seen(polygon, frame, points.error[point])) {
                vertices_.clear();
                for (const Vec3d& v : polygon.vertices) {
                    vertices_.push_back(frame.point_to_local(v));
                }
                shade(SphericalPolygon<double>(vertices_, true), i, point, points.hit_count(point), report);
            }
        }
    }
}

}  // namespace shlight
