// SPDX-License-Identifier: MIT
//
// The hits of camera rays of a group of pixels, with one array per property.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/shading_frame.h"
#include "shlight/lobe_shape.h"
#include "shlight/surface_point.h"
#include "shlight/types.h"
#include "tracing/light_bits.h"
#include "tracing/light_parts.h"
#include "tracing/terminator.h"

namespace shlight {

/// Hits in the order of pixels, and of samples within each. A camera ray has several hits if it passes transparent
/// surfaces, or if lobes of a surface have different normals.
struct Hits {
    /// stride: largest number of lobes of a material. parts: must outlive this.
    explicit Hits(std::size_t stride, const LightParts& parts = kWholeLight) : lobe_stride(stride), apart(parts) {}

    std::size_t lobe_stride;
    std::vector<ShadingFrame> frame;
    std::vector<float> cos_theta_o;
    std::vector<Vec3d> shadow_origin;  ///< off the surface, on the viewer's side
    std::vector<Terminator> terminator;
    std::vector<double> error;  ///< see SurfacePoint
    std::vector<std::uint32_t> material;
    std::vector<PathKind> path;  ///< from the camera
    /// Weight of lobe i of hit h at h · lobe_stride + i: its colour as the viewer sees it. 0 for lobes that the
    /// material does not have.
    std::vector<Rgb> lobe_weight;
    std::vector<LobeForm> lobe_forms;     ///< likewise lobe_form() of lobes that vary
    std::vector<std::uint32_t> sample;    ///< number of the camera ray within its pixel
    std::vector<Rgb> radiance;            ///< reflected to the camera, summed up
    LightGroupBuffer apart;               ///< parts of that, and of what rays bring besides
    std::vector<std::uint32_t> in_apart;  ///< number of the hit's parts: one for all hits of a pixel, or for some
    std::vector<Rgb> noise;               ///< the part of its variance that comes from shadow rays
    /// For each pixel the variance of its sum of radiance from shadow rays that its hits share.
    std::vector<Rgb> shared_noise;
    std::vector<LightBits> visibility;           ///< by pixel: of its lights, by its shadow rays
    std::vector<std::size_t> pixel_begin = {0};  ///< pixel p has the hits pixel_begin[p] … pixel_begin[p + 1] - 1

    std::size_t size() const { return frame.size(); }
    const Rgb& weight(std::size_t hit, std::size_t lobe) const { return lobe_weight[hit * lobe_stride + lobe]; }
    /// The forms of all lobes of a hit, where they vary.
    std::span<const LobeForm> forms(std::size_t hit) const {
        return std::span(lobe_forms).subspan(hit * lobe_stride, lobe_stride);
    }
    /// ω_o of a hit, in its shading frame.
    Vec3d view(std::size_t hit) const {
        const double cosine = cos_theta_o[hit];
        return {std::sqrt(1.0 - cosine * cosine), 0, cosine};
    }
    /// The origin of a shadow ray. way: to the light, of any length.
    Vec3d shadow_start(std::size_t hit, const Vec3d& way) const {
        const Terminator& own = terminator[hit];
        return own.lifts() ? shadow_origin[hit] + own.share(glm::normalize(way)) * own.lift : shadow_origin[hit];
    }
    /// The part of light from a direction that its lobes take. way: to the light, of any length.
    double let_in(std::size_t hit, const Vec3d& way) const {
        const Terminator& own = terminator[hit];
        return own.dims() ? own.let_in(glm::dot(frame[hit].z, glm::normalize(way))) : 1.0;
    }
    std::size_t pixel_count() const { return pixel_begin.size() - 1; }
    void clear();
    /// Adds the light of a group that a lobe of a hit reflects.
    void reflect(std::size_t hit, std::size_t lobe, std::uint32_t group, const Rgb& light) {
        radiance[hit] += light;
        if (!apart.empty()) {
            apart.add(in_apart[hit], apart.parts().kind(material[hit], lobe, path[hit]), group, light);
        }
    }
    /// weights, forms: of the material's lobes.
    void add(const SurfacePoint& surface, const Terminator& terminator_there, const ShadingFrame& shading_frame,
             float view_cosine, std::span<const Rgb> weights, std::span<const LobeForm> forms,
             std::uint32_t sample_index, PathKind path_kind, std::uint32_t number_in_apart);
    /// The hits added since the last call are those of one pixel.
    void end_pixel() {
        pixel_begin.push_back(size());
        shared_noise.emplace_back(0);
        visibility.emplace_back();
    }
};

}  // namespace shlight
