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

#include "hits.h"
#include "material_orders.h"
#include "shlight/light.h"
#include "shlight/render.h"

namespace shlight {

class ShadingPoints {
  public:
    /// One point for hits of a pixel with the same material whose normal, direction to the viewer and directions to
    /// lights differ by less than 8 √tolerance / (order + 4) in sum. The mean of a lobe of this order over so small a
    /// spread is its value at the mean up to a fraction of the tolerance: what is left is the second difference.
    /// lobe_stride: at least the number of lobes of any material. Adds to the report what the hits take.
    void assign(const Hits& hits, std::span<const OrderedMaterial> materials, std::size_t lobe_stride,
                std::span<const Light> lights, double tolerance, RenderReport& report);

    std::size_t size() const { return frame.size(); }
    /// The order of one lobe at a point; 0: black.
    int order(std::size_t point, std::size_t lobe) const { return orders_[point * lobe_stride_ + lobe]; }
    /// The largest of them.
    int largest_order(std::size_t point) const;

    std::vector<ShadingFrame> frame;
    std::vector<float> cos_theta_o;
    std::vector<double> error;  ///< see SurfacePoint
    std::vector<std::uint32_t> material;
    std::vector<std::uint32_t> of_hit;  ///< the point of each hit

  private:
    /// The hits of a point: what the first one demands of the others, and their sum.
    struct Members {
        Vec3d first_towards_viewer;
        double spread;         // allowed difference from the first
        double nearest_light;  // distance
        bool met;              // the tolerance, by the lobes' orders
        Vec3d position, normal, towards_viewer;
        std::uint32_t count;
    };

    void clear();
    bool joins(const Hits& hits, std::size_t hit, std::size_t point) const;
    void start(const Hits& hits, std::size_t hit, std::span<const OrderedMaterial> materials,
               std::span<const Light> lights, double tolerance);
    void add_member(const Hits& hits, std::size_t hit, std::size_t point);
    void finish(std::size_t point, RenderReport& report);

    std::size_t lobe_stride_ = 1;
    std::vector<std::uint8_t> orders_;  // points × lobe_stride
    std::vector<Members> members_;
};

}  // namespace shlight
