// SPDX-License-Identifier: MIT
//
// Makes records of light: many at once, whose rays meet the same surfaces again and again. What surfaces send to them
// is kept by cells of the world, as large as the rays are apart there, and only a few of the rays that meet a cell are
// shaded: light there comes from the lamps by Eq. 5, and light that has bounced before from records that are there
// already, or by paths.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <tuple>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "film/record_rays.h"
#include "lighting/direct_lighting.h"
#include "shlight/parallel.h"
#include "shlight/render_report.h"
#include "shlight/scene.h"
#include "surfaces/camera_surfaces.h"
#include "surfaces/light_cells.h"
#include "surfaces/light_records.h"
#include "tracing/hits.h"

namespace shlight {

/// Records that are made at once: enough that their rays meet in cells.
inline constexpr std::size_t kRecordsAtOnce = 1024;

class RecordGatherer {
  public:
    /// cells: to which light is added; parts: that records tell apart. All must outlive this.
    RecordGatherer(const CompiledScene& scene, const LightingScene& lighting, const PathSettings& paths, bool shadows,
                   LightCells& cells, const LightParts& parts);

    /// A record at each surface by rays_across² rays, or at as many of the first as there is time for; seed: of them
    /// all. Throws RenderCancelled once stopped.
    std::vector<LightRecord> gather(std::span<const SurfacePoint> surfaces, std::size_t rays_across, std::uint32_t seed,
                                    int threads, const Stopped& stopped, const std::function<bool()>& has_time,
                                    RenderReport& report);

  private:
    /// The end of a ray.
    struct End {
        LightCells::Key cell;
        std::uint32_t ray;
        bool is_own;  // no other ray ends in this cell

        auto order() const { return std::tuple(cell.place, cell.kind, ray); }
    };
    /// Rays that end in the same cell, on surfaces of the same kind.
    struct Cell {
        std::size_t first, count;          // of the ends
        std::size_t first_shaded, shaded;  // of the rays that are shaded
    };
    /// Shades rays; one per thread.
    struct Shader {
        explicit Shader(const RecordGatherer& gatherer);

        CameraSurfaces surfaces;
        DirectLighting lighting;
        Hits hits;
        std::vector<CameraRay> rays;
        std::vector<RayLight> light;  // by ray and number of bounces
        std::vector<std::uint32_t> seeds, penumbrae;
        std::vector<RayHit> met;
        std::vector<End> ends;
        RenderReport report;
    };

    void meet(std::size_t record, Shader& shader);
    void find_cells();
    void shade(std::size_t first, std::uint32_t seed, Shader& shader);
    void add(const Cell& cell);
    void spread(const Cell& cell);

    const CompiledScene* scene_;
    const LightingScene* lighting_;
    PathSettings paths_;
    LightCells* known_;
    const LightParts* parts_;
    std::size_t light_count_;    // numbers by which the light of a ray is told apart, see StoredLight
    std::uint32_t shadow_rays_;  // of each ray's hits, for each light
    std::size_t rays_per_record_ = 0;
    std::vector<RecordRays> records_;
    std::vector<double> distances_;  // that rays go
    std::vector<End> ends_;
    std::vector<Cell> cells_;
    std::vector<std::uint32_t> shaded_;  // rays
    std::vector<Rgb> shaded_light_;      // of each
    std::vector<Rgb> darkness_;          // of a ray
    std::vector<const Rgb*> light_;      // of all rays
    tbb::enumerable_thread_specific<Shader> shaders_;
};

}  // namespace shlight
