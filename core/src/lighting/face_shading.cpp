// SPDX-License-Identifier: MIT
#include "lighting/face_shading.h"

#include "shlight/lobe_shape.h"

namespace shlight {

void FaceShading::shade(const FaceTree& faces, const ShadingPoints& points, std::span<const std::uint32_t> some,
                        MaterialViews& views, double tolerance, double unit_tolerance, std::span<Rgb> radiance) {
    near_.clear();
    near_view_.clear();
    const double scale = tolerance / unit_tolerance * largest_channel(Vec3d(faces.mean()));
    for (std::uint32_t view = 0; view < some.size(); ++view) {
        shade(faces, points, some[view], view, views, tolerance, scale, radiance);
        near_view_.resize(near_.size(), view);
    }
    seen_.clear();
    for (std::uint32_t i = 0; i < near_.size(); ++i) {
        seen_.add_polygon(near_[i].corners, i);
    }
    for (std::size_t lobe = 0; lobe < views.lobe_count() && !near_.empty(); ++lobe) {
        if (!views.lobe(lobe).is_black()) {
            add_near(views.lobe(lobe), some, unit_tolerance, radiance.subspan(lobe * points.size(), points.size()));
        }
    }
}

void FaceShading::shade(const FaceTree& faces, const ShadingPoints& points, std::uint32_t point, std::uint32_t view,
                        MaterialViews& views, double tolerance, double scale, std::span<Rgb> radiance) {
    const ShadingFrame& frame = points.frame[point];
    const FaceViewpoint viewpoint = faces.viewpoint(frame, points.error[point]);
    const Vec3d towards_viewer = views.positions().direction(view);
    lobes_.clear();
    numbers_.clear();
    double absolute = 0;
    for (std::size_t i = 0; i < views.lobe_count(); ++i) {
        const LobeViews& lobe = views.lobe(i);
        if (lobe.is_black() || lobe.is_black(view)) {
            continue;
        }
        if (is_mirror(lobe.shape(view))) {
            radiance[i * points.size() + point] =
                static_cast<float>(lobe.albedo(view)) * faces.from(viewpoint, frame.to_world(mirrored(towards_viewer)));
            continue;
        }
        lobes_.push_back({lobe.shape(view), largest_channel(Vec3d(lobe.weight(view)))});
        numbers_.push_back(i);
        absolute += scale * lobes_.back().weight * lobe.absolute_tolerance(view);
    }
    if (lobes_.empty()) {
        return;
    }
    sum_.add_up(faces, towards_viewer, frame, viewpoint, tolerance, absolute, lobes_, near_);
    for (std::size_t k = 0; k < lobes_.size(); ++k) {
        radiance[numbers_[k] * points.size() + point] = Rgb(lobes_[k].light);
    }
}

void FaceShading::add_near(LobeViews& lobe, std::span<const std::uint32_t> some, double tolerance,
                           std::span<Rgb> radiance) {
    seen_.shade(lobe, near_view_, tolerance, false, batch_, [&](std::span<const std::uint32_t> numbers) {
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            const std::uint32_t face = numbers[k];
            if (!is_mirror(lobe.shape(near_view_[face]))) {
                radiance[some[near_view_[face]]] += batch_.values()[k] * near_[face].radiance;
            }
        }
    });
}

}  // namespace shlight
