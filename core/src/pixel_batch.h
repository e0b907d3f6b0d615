// SPDX-License-Identifier: MIT
//
// Camera rays of a group of pixels, shaded: sums from which a pixel's mean is made, and how far it may be wrong.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hits.h"
#include "material_lobes.h"
#include "shading_points.h"
#include "shlight/camera.h"
#include "shlight/render.h"
#include "shlight/scene.h"
#include "unshadowed.h"
#include "visibility.h"

namespace shlight {

struct Pixel {
    int column, row;
};

/// Sums over the camera rays of one pixel. A ray that met nothing is black.
struct PixelSums {
    std::uint32_t rays = 0, hits = 0;
    Vec3d radiance{0};
    Vec3d squares{0};              ///< of radiance, without the part that is noise of shadow rays
    Vec3d along_x{0}, along_y{0};  ///< of radiance times the ray's distance from the pixel's centre

    /// Variance over the pixel of what is not linear in the place: rays in even number, spread evenly, average that
    /// out.
    Vec3d variance() const;
};

/// Everything that the batches of one picture share and only read.
struct Picture {
    Picture(const CompiledScene& s, const Camera& c, int w, int h, const RenderSettings& r,
            std::vector<glm::dvec2> points);

    const CompiledScene* scene;
    const Camera* camera;
    RenderSettings settings;
    int width, height;
    Window window;
    std::vector<glm::dvec2> pixel_points;  ///< where each camera ray of a pixel goes through its unit square
    std::vector<MaterialLobes> materials;
    std::size_t lobe_stride = 1;
};

/// Renders one batch after another; one per thread.
class PixelBatch {
  public:
    explicit PixelBatch(const Picture& picture);

    /// Adds these rays of each pixel to its sums.
    void add(std::span<const Pixel> pixels, const SampleRange& samples, std::span<PixelSums> sums);
    RenderReport report() const;

  private:
    void trace_camera_rays(std::span<const Pixel> pixels, const SampleRange& samples);
    void add_lights(std::span<const Pixel> pixels, const SampleRange& samples);
    void add_up(const SampleRange& samples, std::span<PixelSums> sums) const;

    const Picture* picture_;
    RenderReport report_;
    std::vector<Ray> rays_;
    std::vector<RayHit> ray_hits_;
    Hits hits_;
    ShadingPoints points_;
    Unshadowed unshadowed_;
    ShadowedLight shadowed_;
    std::vector<std::uint32_t> pixel_seeds_;
};

}  // namespace shlight
