// SPDX-License-Identifier: MIT
//
// Where records of light that bounces are made: in cells of the world that surfaces lie in which the camera sees,
// itself or in mirrors, so that most stay where they are as the camera moves. Cell by ever smaller cell, as wide as
// pixels of a grid are apart, a surface gets a record where those around it are too few, or where they are noisy or
// differ by more than the picture may err. A record that is wrong at the place of another then reaches less far.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "film/pixel_batch.h"
#include "film/record_gatherer.h"
#include "shlight/parallel.h"
#include "shlight/render_report.h"
#include "surfaces/stored_light.h"
#include "surfaces/world_lattice.h"

namespace shlight {

class RecordPlacement {
  public:
    /// image: of direct light, RGBA, or black; has_bounced: with the light that is stored already. picture, stored:
    /// must outlive this.
    RecordPlacement(const Picture& picture, std::span<const float> image, bool has_bounced, StoredLight& stored);

    /// Makes the records of cells as wide as pixels are apart by a step, after those of all wider ones, or some of them
    /// if there is no time for all. Returns what that took. Throws RenderCancelled once stopped; records that are whole
    /// by then are stored.
    RenderReport add_grid(int step, const Stopped& stopped, const std::function<double()>& seconds_left);
    /// Root mean square over the pixels that were last looked at of the errors by the records before, see
    /// RenderReport::noise.
    double error() const { return error_; }

  private:
    /// A surface that a pixel sees.
    struct Seen {
        WorldCell cell;
        int level;  // of the cell
        SurfacePoint point;
        double pixel;  // its width there [m]
        std::uint32_t bounces;
        Vec3d allowed;  // error of the light that a white diffuse surface reflects there
    };
    /// A record that is wanted.
    struct Wanted {
        RecordGatherer::Place place;
        int level;
        Vec3d allowed;
    };
    /// What is found in a row of pixels.
    struct Row {
        std::vector<Seen> seen;
        double errors = 0;  // squares, summed up over pixels
        std::size_t pixels = 0;
    };
    /// Traces rays; one per thread.
    struct Finder {
        Finder(const Picture& picture, const PathSettings& paths);

        CameraSurfaces surfaces;
        Hits hits;
        std::vector<CameraRay> rays;
        std::vector<std::size_t> pixels;  // of each ray
        std::vector<RayLight> light;
        std::vector<SurfaceLobe> lobes;
    };

    Row find(int row, int step, Finder& finder) const;
    void look_at(const CameraSurfaces::Surface& surface, int step, Finder& finder, Row& row) const;
    /// The records that cells want, in an order that has nothing to do with where they are.
    std::vector<Wanted> find_wanted(std::vector<Seen> seen, int step, const Stopped& stopped);
    /// The record that the cell of some surfaces wants, also if it has one; none: those around suffice.
    std::optional<Wanted> wanted(std::span<const Seen> seen, int step) const;
    void add(std::span<LightRecord> made, std::span<const Wanted> wanted);
    /// The radius of records that are wrong at the place of one of the last ones ends there.
    void shrink_wrong(std::span<const Wanted> wanted, int step);

    /// The number (StoredLight) of all light that a surface may reflect to a path that has bounced so often.
    std::size_t number_of_all(std::uint32_t bounces) const {
        return (paths_.max_bounces - bounces - 1) * stored_->parts;
    }

    const Picture* picture_;
    std::span<const float> image_;
    bool has_bounced_;
    StoredLight* stored_;
    PathSettings paths_;
    WorldLattice lattice_;
    double threshold_;
    double least_square_ = 0;  // 0.01 r̄², r̄ the mean of the image
    double error_ = 0;
    tbb::enumerable_thread_specific<Finder> finders_;
    RecordGatherer gatherer_;
};

}  // namespace shlight
