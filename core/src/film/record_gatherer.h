// SPDX-License-Identifier: MIT
//
// Makes records: sends rays into the half space above a surface, and shades what they meet. Light there comes from the
// lamps by Eq. 5, and light that has bounced before from records that are there already, or by paths.
#pragma once

#include <cstdint>
#include <vector>

#include "lighting/direct_lighting.h"
#include "shlight/render_report.h"
#include "shlight/scene.h"
#include "surfaces/camera_surfaces.h"
#include "surfaces/light_records.h"
#include "tracing/hits.h"

namespace shlight {

/// Neighbouring rays share shadow rays; along each side of a square of directions.
inline constexpr std::size_t kGroupAcross = 4;

/// Keeps its memory from record to record; one per thread.
class RecordGatherer {
  public:
    RecordGatherer(const CompiledScene& scene, const LightingScene& lighting, const PathSettings& paths, bool shadows);

    /// A record at a surface, by rays_across² rays, a multiple of kGroupAcross; seed: of their directions. The radius
    /// is the harmonic mean of the distances that the rays go.
    LightRecord gather(const SurfacePoint& surface, std::size_t rays_across, std::uint32_t seed, RenderReport& report);

  private:
    /// A ray's direction, and what its radiance counts, by its solid angle.
    struct Direction {
        Vec3d way;
        float solid_angle;
    };

    void aim(const SurfacePoint& surface, std::size_t rays_across, std::uint32_t seed);
    void shade(std::uint32_t seed, RenderReport& report);
    double mean_distance() const;
    void find_distances();
    void find_free(LightRecord& record) const;
    /// How what a white diffuse surface reflects changes along the axes of the world, by the light of cells of the
    /// grid of directions that are side by side (Ward & Heckbert 1992, "Irradiance Gradients").
    void find_gradients(std::size_t rays_across, LightRecord& record) const;
    void add_up(std::size_t rays_across, LightRecord& record) const;

    std::uint32_t max_bounces_;
    std::uint32_t shadow_rays_;  // of each ray's hits, for each light
    CameraSurfaces surfaces_;
    DirectLighting lighting_;
    Hits hits_;
    std::vector<CameraRay> rays_;
    std::vector<Direction> directions_;
    std::vector<double> distances_;     // that the rays go
    std::vector<std::size_t> by_cell_;  // the ray of each cell of the grid, row by row
    Vec3d x_, y_;                       // of the frame of directions
    std::vector<RayLight> light_;       // by ray and number of bounces
    std::vector<std::uint32_t> seeds_;  // of groups of rays
    std::vector<std::uint32_t> penumbrae_;
};

}  // namespace shlight
