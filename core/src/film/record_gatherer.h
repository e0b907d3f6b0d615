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
#include "shlight/sampling.h"
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
    /// spread: what a pixel's width grows by along camera rays [1].
    RecordGatherer(const CompiledScene& scene, const LightingScene& lighting, const PathSettings& paths, bool shadows,
                   LightCells& cells, const LightParts& parts, double spread);

    /// A surface that gets a record.
    struct Place {
        SurfacePoint surface;
        WorldCell cell;  ///< that the record stands for
        double reach;    ///< see RecordRays::record()
        double pixel;    ///< the width of a pixel that sees the surface [m]
    };

    /// A record at each place by rays_across² rays, or at as many of the first as there is time for; seed: of them all;
    /// seconds_left: infinite without a time limit.
    /// Records of other places change what rays of a record see as little as can be. Throws RenderCancelled once
    /// stopped; the records that are `made` by then are whole.
    void gather(std::span<const Place> places, std::size_t rays_across, std::uint32_t seed, int threads,
                const Stopped& stopped, const std::function<double()>& seconds_left, std::vector<LightRecord>& made,
                RenderReport& report);

  private:
    /// The end of a ray.
    struct End {
        WorldCell cell;
        std::uint32_t rank;  // random; the lowest of a cell are shaded
        std::uint32_t ray;
        bool is_own;  // no other ray ends in this cell

        auto order() const { return std::tuple(cell.place, cell.kind, rank, ray); }
    };
    /// Rays that end in the same cell, on surfaces of the same kind.
    struct Cell {
        std::size_t first, count;          // of the ends
        std::size_t first_shaded, shaded;  // of the rays that are shaded
    };
    /// A ray that is shaded.
    struct Shaded {
        std::uint32_t end;     // a ray's that it tells of; kNone: there is no ray, and its group has no more
        std::uint32_t number;  // of the cell's samples
    };
    /// Shades rays; one per thread.
    struct Shader {
        explicit Shader(const RecordGatherer& gatherer);

        CameraSurfaces surfaces;
        DirectLighting lighting;
        Hits hits;
        std::vector<CameraRay> rays;
        std::vector<NeighbourRays> neighbours;
        std::vector<RayLight> light;  // by ray and number of bounces
        std::vector<std::uint32_t> seeds, penumbrae;
        std::vector<RayHit> met;
        std::vector<End> ends;
        RenderReport report;
    };

    void meet(std::size_t record, std::uint32_t seed, Shader& shader);
    void find_cells();
    void fill_group();
    std::uint32_t seed_of(const WorldCell& cell) const {
        return hash(seed_, static_cast<std::uint32_t>(WorldCellHash()(cell)));
    }
    Ray ray_of(const Shaded& shaded) const;
    void shade(std::size_t first, Shader& shader);
    void add(const Cell& cell);
    void spread(const Cell& cell);

    const CompiledScene* scene_;
    const LightingScene* lighting_;
    PathSettings paths_;
    LightCells* known_;
    const LightParts* parts_;
    std::size_t light_count_;    // numbers by which the light of a ray is told apart, see StoredLight
    std::uint32_t shadow_rays_;  // of each ray's hits, for each light
    double spread_;
    std::size_t rays_per_record_ = 0;
    std::uint32_t seed_ = 0;
    std::span<const Place> places_;  // of the records
    std::vector<RecordRays> records_;
    std::vector<double> distances_;  // that rays go
    std::vector<End> ends_;
    std::vector<Cell> cells_;
    std::vector<Shaded> shaded_;     // group by group
    std::vector<Rgb> shaded_light_;  // of each ray
    std::vector<Rgb> darkness_;      // of a ray
    std::vector<const Rgb*> light_;  // of all rays
    tbb::enumerable_thread_specific<Shader> shaders_;
};

}  // namespace shlight
