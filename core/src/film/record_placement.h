// SPDX-License-Identifier: MIT
//
// Where records of light that bounces are made: at surfaces that the camera sees, itself or in mirrors. Grid by grid of
// ever nearer pixels, a surface gets a record where those around it are too few, or where they are noisy or differ by
// more than the picture may err. A record that is wrong at the place of another then reaches less far.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "film/pixel_batch.h"
#include "film/pixel_order.h"
#include "film/record_gatherer.h"
#include "shlight/parallel.h"
#include "shlight/render_report.h"
#include "surfaces/stored_light.h"

namespace shlight {

class RecordPlacement {
  public:
    /// image: of direct light, RGBA, or black. picture, stored: must outlive this.
    RecordPlacement(const Picture& picture, std::span<const float> image, StoredLight& stored);

    /// Makes the records of a grid of pixels, after those of all wider ones, or some of them if there is no time for
    /// all. Returns what that took. Throws RenderCancelled once stopped.
    RenderReport add_grid(const Grid& grid, const Stopped& stopped, const std::function<bool()>& has_time);
    /// Root mean square over the last grid's pixels of the errors by the records before, see RenderReport::noise.
    double error() const { return error_; }

  private:
    /// A surface that wants a record.
    struct Wanted {
        SurfacePoint point;
        double pixel, to_next;  // width of a pixel, and distance to the next surface on the grid, about [m]
        Rgb allowed;            // error of the light that a white diffuse surface reflects there
    };
    /// What is found in a row of pixels.
    struct Row {
        std::vector<Wanted> wanted;
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

    Row find(int row, const Grid& grid, Finder& finder) const;
    void look_at(const CameraSurfaces::Surface& surface, int step, Finder& finder, Row& row) const;
    /// The radius of records that are wrong at the place of one of the last ones ends there.
    void shrink_wrong(std::span<const Wanted> wanted);

    const Picture* picture_;
    std::span<const float> image_;
    StoredLight* stored_;
    PathSettings paths_;
    double threshold_;
    double least_square_ = 0;  // 0.01 r̄², r̄ the mean of the image
    double error_ = 0;
    tbb::enumerable_thread_specific<Finder> finders_;
    RecordGatherer gatherer_;
};

}  // namespace shlight
