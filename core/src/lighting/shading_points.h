// SPDX-License-Identifier: MIT
//
// Where light is integrated: hits of a pixel that would be shaded alike share one point.
//
// Antialiasing wants many hits in a pixel; Eq. 5 without shadows varies so little over most pixels that one evaluation
// at the mean of the hits does for all. Shadow rays still start from each hit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lights/delta_lights.h"
#include "lobes/material_lobes.h"
#include "shlight/light.h"
#include "tracing/hits.h"

namespace shlight {

class ShadingPoints {
  public:
    /// One point for hits of a pixel with the same material and kind of path whose normal, direction to the viewer,
    /// directions to lights and widths of lobes, in units of that distance, differ in sum by less than √(3 tolerance)
    /// times the least distance over which the material's f·cos changes. The mean of a lobe over so small a spread is
    /// its value at the mean up to a fraction of the tolerance: what is left is the second difference.
    void assign(const Hits& hits, std::span<const MaterialLobes> materials, std::span<const Light> lights,
                const DeltaLights& deltas, double tolerance);

    std::size_t size() const { return frame.size(); }
    /// Hits that share a point.
    std::uint32_t hit_count(std::size_t point) const { return first_hit_[point + 1] - first_hit_[point]; }
    const Rgb& weight(std::size_t point, std::size_t lobe) const { return lobe_weight[point * lobe_stride_ + lobe]; }
    std::span<const Rgb> weights(std::size_t point) const {
        return std::span(lobe_weight).subspan(point * lobe_stride_, lobe_stride_);
    }
    std::span<const LobeForm> forms(std::size_t point) const {
        return std::span(lobe_forms).subspan(point * lobe_stride_, lobe_stride_);
    }
    std::span<const std::size_t> hits_of(std::size_t point) const {
        return std::span(hits_by_point_).subspan(first_hit_[point], hit_count(point));
    }

    std::vector<ShadingFrame> frame;
    std::vector<float> cos_theta_o;
    std::vector<double> error;  ///< see SurfacePoint
    std::vector<std::uint32_t> material;
    std::vector<PathKind> path;
    std::vector<Rgb> lobe_weight;       ///< the mean over the point's hits of Hits::lobe_weight, lobe_stride × points
    std::vector<LobeForm> lobe_forms;   ///< likewise of Hits::lobe_forms
    std::vector<std::uint32_t> of_hit;  ///< the point of each hit
    std::vector<std::size_t> pixel_begin;  ///< pixel p has the points pixel_begin[p] … pixel_begin[p + 1] - 1

  private:
    /// The hits of a point: what the first one demands of the others, and their sum.
    struct Members {
        Vec3d first_towards_viewer;
        std::span<const LobeForm> first_forms;
        double narrowest;      // least distance over which f·cos changes
        double spread;         // allowed difference from the first
        double nearest_light;  // distance, found when a second hit asks for it
        bool knows_nearest;
        Vec3d position, normal, towards_viewer;
        std::uint32_t count;
    };

    void clear();
    /// The first point from this one on whose normal is not too far from the hit's; size() if there is none.
    std::size_t next_near(const Vec3f& normal, std::size_t point) const;
    bool joins(const Hits& hits, std::size_t hit, std::size_t point, std::span<const Light> lights,
               const DeltaLights& deltas);
    void start(const Hits& hits, std::size_t hit, const MaterialLobes& lobes, double tolerance);
    void add_member(const Hits& hits, std::size_t hit, std::size_t point);
    void finish(std::size_t point);
    void sort_hits();

    std::size_t lobe_stride_ = 1;
    std::vector<Members> members_;
    /// For each point the normal of its first hit, and the largest squared distance of another hit's normal, in float.
    std::vector<float> first_x_, first_y_, first_z_, nearness_;
    std::vector<std::uint32_t> first_hit_;    // of each point and of one more, in hits_by_point_
    std::vector<std::size_t> hits_by_point_;  // numbers of hits, in the order of their points
};

}  // namespace shlight
