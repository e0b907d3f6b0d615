// SPDX-License-Identifier: MIT
//
// Camera rays of a group of pixels, shaded: sums from which a pixel's mean is made, and how far it may be wrong.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "film/surface_passes.h"
#include "lighting/direct_lighting.h"
#include "shlight/camera.h"
#include "shlight/render.h"
#include "shlight/scene.h"
#include "surfaces/camera_surfaces.h"
#include "tracing/hits.h"
#include "tracing/light_bits.h"

namespace shlight {

struct Pixel {
    int column, row;
    /// Lights, as in LightBits, that rays near it have found partly hidden; all if nothing is known.
    std::uint32_t penumbrae = LightBits::kAll;
    /// Radiance that surfaces reflect onto the path of a camera ray, at most, as one ray counts.
    float most_by_path = std::numeric_limits<float>::infinity();
};

/// Sums over the camera rays of one pixel. A ray that met no surface is transparent, unless there is a
/// background, and black but for lamps.
struct PixelSums {
    std::uint32_t rays = 0;
    double opacity = 0;  ///< of rays that met a surface or the background 1, if these let nothing through
    Vec3d radiance{0};
    Vec3d squares{0};              ///< of radiance, without the part that is noise of shadow rays
    Vec3d noise{0};                ///< that part
    Vec3d shared_noise{0};         ///< the variance of `radiance` by shadow rays that camera rays have in common
    Vec3d early{0};                ///< radiance of the camera rays in the first half of all that the pixel then has
    LightBits visibility;          ///< of lights, by the shadow rays
    Vec3d along_x{0}, along_y{0};  ///< of radiance times the ray's distance from the pixel's centre

    /// Variance over the pixel of what is not linear in the place: rays in even number, spread evenly, average that
    /// out.
    Vec3d variance() const;
    /// The part of one ray; too_much: the part of its radiance that the squares alone count; from_center: its distance
    /// from the pixel's centre; is_early: it counts in `early`.
    void add(const Rgb& ray_radiance, const Rgb& too_much, const Rgb& ray_noise, const glm::dvec2& from_center,
             float ray_opacity, bool is_early);
};

/// This is known from the first camera rays of some pixels.
struct Pilot {
    double reflected = 0;              ///< brightness of what surfaces reflect
    std::size_t hidden = 0, seen = 0;  ///< pixels from which the environment is hidden, or seen at all
};

/// Everything that the batches of one picture share and only read.
struct Picture {
    /// Throws RenderCancelled once it is to end.
    Picture(const CompiledScene& s, const Camera& c, int w, int h, const RenderSettings& r,
            std::vector<glm::dvec2> points, std::uint32_t preview_points, const Stopped& stopped);

    /// See StoredLight::parts.
    std::size_t stored_parts() const;
    /// Through a point of the window, in pixels, and one of the aperture; none: its middle.
    Ray ray(double column, double row, const std::optional<glm::dvec2>& lens) const;
    /// The width of a pixel in the picture's middle, at a distance [m].
    double pixel_width(double distance) const;
    /// Finds where the environment is open if it is hidden from much of the picture.
    void guide(const Pilot& pilot);
    /// Settings of paths that bounce; without stored light it is direct.
    PathSettings paths(const StoredLight* stored) const;

    const CompiledScene* scene;
    Camera camera;  ///< in the scene's frame
    RenderSettings settings;
    PassLayout layout;
    LightParts parts;  ///< that the passes need
    int width, height;
    Window window;
    std::vector<glm::dvec2> pixel_points;   ///< of each camera ray of a pixel, evenly over the unit square
    std::uint32_t previews = 0;             ///< the first of them, which do not count beside the others
    std::vector<glm::dvec2> filter_places;  ///< likewise as the filter spreads them, from the pixel's middle
    bool takes_differences;                 ///< whether any material looks at neighbouring camera rays
    std::vector<bool> doubled;              ///< find_doubled() of this picture
    LightingScene lighting;
    std::optional<LightingScene> filtered;  ///< see lighting_of_records(); none: as `lighting`

    /// Width of the narrowest lobes that rays of records meet.
    double filtered_width() const {
        return settings.filter_glossy > 0 ? least_width_after_diffuse(settings.filter_glossy) : 0.0;
    }
    /// The lights and materials that rays of records meet.
    const LightingScene& lighting_of_records() const { return filtered ? *filtered : lighting; }
};

/// The place of a part of the light among the passes of a pixel.
struct PartPlace {
    std::size_t first, part;
};

/// Renders one batch after another; one per thread.
class PixelBatch {
  public:
    /// paths: see follow().
    PixelBatch(const Picture& picture, const PathSettings& paths);

    /// Adds these rays of each pixel to its sums. second_half: the number of the first camera ray that PixelSums::early
    /// leaves out; pass_sums: pixels × layout.stride(), as PassImage::merge takes them.
    void add(std::span<const Pixel> pixels, const SampleRange& samples, std::uint32_t second_half,
             std::span<PixelSums> sums, std::span<double> pass_sums);
    /// Traces these camera rays of each pixel, and shades nothing. light: of each ray.
    void trace(std::span<const Pixel> pixels, const SampleRange& samples, Hits& hits, std::vector<RayLight>& light);
    /// One of each pixel of the last call, see DirectLighting.
    std::span<const std::uint32_t> pixel_seeds() const { return pixel_seeds_; }
    /// Lets light bounce from now on.
    void follow(const PathSettings& paths) { surfaces_.follow(paths); }
    /// Passes of the ray through the middle of each pixel. values: pixels × layout.stride().
    void write_middles(std::span<const Pixel> pixels, bool guides, std::span<float> values);
    Pilot pilot(std::span<const Pixel> pixels, std::uint32_t shadow_rays);
    /// The report of the work since the last call.
    RenderReport take_report() { return std::exchange(report_, {}); }

  private:
    /// A point of the unit square; none: the aperture's middle.
    using LensPoint = std::optional<glm::dvec2>;

    /// place: in pixels; step: to its neighbours.
    void add_ray(const glm::dvec2& place, const LensPoint& lens, std::uint32_t sample, std::uint32_t seed, double step);
    void seed_pixels(std::span<const Pixel> pixels);
    void add_up(std::span<const Pixel> pixels, const SampleRange& samples, std::uint32_t second_half,
                std::span<PixelSums> sums);
    /// Takes light that paths have brought from the parts of a pixel.
    void take_from_parts(std::size_t pixel, const Rgb& light);
    /// Parts of the light.
    void add_up_parts(std::span<double> pass_sums) const;
    LensPoint lens_point(std::uint32_t sample, std::uint32_t pixel_seed) const;

    const Picture* picture_;
    RenderReport report_;
    std::vector<CameraRay> rays_;
    std::vector<NeighbourRays> neighbours_;
    std::vector<RayLight> ray_light_;  // one for each
    CameraSurfaces surfaces_;
    SurfacePasses surface_passes_;
    Hits hits_;
    DirectLighting lighting_;
    std::vector<PartPlace> part_places_;
    std::vector<std::uint32_t> pixel_seeds_;  // one per pixel
    std::vector<std::uint32_t> penumbrae_;    // likewise
};

}  // namespace shlight
