// SPDX-License-Identifier: MIT
//
// What the camera rays of a group of pixels have met: one array per property.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "shlight/scene.h"
#include "shlight/types.h"

namespace shlight {

/// Origin at the hit, z = shading normal, the viewer in the xz-plane at x ≥ 0.
struct ShadingFrame {
    Vec3d origin, x, y, z;

    Vec3d to_local(const Vec3d& world_vector) const {
        return {glm::dot(x, world_vector), glm::dot(y, world_vector), glm::dot(z, world_vector)};
    }
    Vec3d point_to_local(const Vec3d& world_point) const { return to_local(world_point - origin); }
    Vec3d to_world(const Vec3d& local_vector) const {
        return local_vector.x * x + local_vector.y * y + local_vector.z * z;
    }
};

/// The frame of a point with a normal, seen from direction `towards_viewer`; both unit vectors.
ShadingFrame shading_frame(const Vec3d& position, const Vec3d& normal, const Vec3d& towards_viewer);

/// Cosine of the angle between normal and viewer. A smooth normal may turn away from a grazing viewer; there the
/// surface is shaded as seen at a grazing angle.
float view_cosine(const ShadingFrame& frame, const Vec3d& towards_viewer);

/// Which of its camera rays each pixel of a group takes: those numbered first … first + count - 1.
struct SampleRange {
    std::uint32_t first, count;
    std::uint32_t shadow_rays;  ///< per camera ray and light, at most

    /// Those of each camera ray that go first: a quarter, but more where a pixel would get so few that they miss too
    /// much of a penumbra's rim, or of what stands in the way.
    std::uint32_t first_shadow_rays() const;
};

/// Hits in the order of pixels, and of samples within each.
struct Hits {
    std::vector<ShadingFrame> frame;
    std::vector<float> cos_theta_o;
    std::vector<Vec3d> shadow_origin;  ///< off the surface, on the viewer's side
    std::vector<double> error;         ///< see SurfacePoint
    std::vector<std::uint32_t> material;
    std::vector<std::uint32_t> sample;           ///< number of the camera ray within its pixel
    std::vector<Rgb> radiance;                   ///< towards the camera, summed up
    std::vector<Rgb> noise;                      ///< the part of its variance that comes from shadow rays
    std::vector<std::size_t> pixel_begin = {0};  ///< pixel p has the hits pixel_begin[p] … pixel_begin[p + 1] - 1

    std::size_t size() const { return frame.size(); }
    /// ω_o of a hit, in its shading frame.
    Vec3d view(std::size_t hit) const {
        const double cosine = cos_theta_o[hit];
        return {std::sqrt(1.0 - cosine * cosine), 0, cosine};
    }
    std::size_t pixel_count() const { return pixel_begin.size() - 1; }
    void clear();
    void add(const SurfacePoint& surface, const Vec3d& towards_viewer, const Rgb& emission, std::uint32_t sample_index);
    /// The hits added since the last call are those of one pixel.
    void end_pixel() { pixel_begin.push_back(size()); }
};

}  // namespace shlight
