// SPDX-License-Identifier: MIT
//
// What the camera rays of a batch meet: surfaces, one behind the other as long as they let light through, and at last
// the background. Shader programs run here, over all surfaces of a material at once.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lobes/material_lobes.h"
#include "shlight/scene.h"
#include "shlight/types.h"
#include "tracing/hits.h"

namespace shlight {

/// A camera ray of a picture.
struct CameraRay {
    Ray ray;
    std::uint32_t sample;  ///< its number within its pixel
};

/// Camera rays beside another, as far away as its share of the pixel is wide.
struct NeighbourRays {
    Ray right, below;
};

/// Light of a camera ray that surfaces do not reflect: their emission, lamps, and the background.
struct RayLight {
    Rgb radiance{0};
    float opacity = 0;
};

/// A lobe as a camera ray meets it.
struct SurfaceLobe {
    LobeShape shape;
    Vec3d normal;                  ///< unit
    Rgb weight;                    ///< colour, as of a surface that nothing stands before
    bool several_bounces = false;  ///< see ShadedLobe
};

/// Keeps its memory from batch to batch; one per thread.
class CameraSurfaces {
  public:
    /// transparent_bounces: as Cycles counts them, a camera ray passes through one surface more, and of the next one
    /// it sees the emission alone.
    CameraSurfaces(const CompiledScene& scene, std::span<const MaterialLobes> materials,
                   std::uint32_t transparent_bounces)
        : scene_(&scene), materials_(materials), transparent_bounces_(transparent_bounces) {}

    /// rays: those of a pixel, rays_per_pixel, follow each other. neighbours: of each ray, or none if no program takes
    /// differences. light: one for each ray. Clears the hits first.
    void trace(std::span<const CameraRay> rays, std::span<const NeighbourRays> neighbours, std::size_t rays_per_pixel,
               Hits& hits, std::vector<RayLight>& light);

    /// A surface that a camera ray has met.
    struct Surface {
        std::size_t ray;
        std::uint32_t depth;  ///< surfaces that the ray has passed through
        RayHit hit;
        SurfacePoint point;
        Vec3d towards_viewer;
        double distance;      ///< from the ray's origin
        double ray_length;    ///< from its beginning
        Rgb throughput;       ///< share of its light that reaches the camera
        std::size_t results;  ///< of its program: where the first is
        std::size_t stride;   ///< and from result to result
    };

    // Results of the last call:
    /// All surfaces; those of one ray are ordered by distance.
    std::span<const Surface> surfaces() const { return surfaces_; }
    void find_lobes(const Surface& surface, std::vector<SurfaceLobe>& lobes) const;
    /// The share of light that goes on straight through, not negative.
    Rgb transparency(const Surface& surface) const;
    /// A result of its program.
    float result(const Surface& surface, std::uint32_t number) const {
        return results_[surface.results + number * surface.stride];
    }

  private:
    /// Destination of the light of a call's rays.
    struct Sink {
        std::vector<RayLight>& light;  // of each ray
        LightGroupBuffer& apart;
        std::size_t rays_per_pixel;
    };
    void meet(std::span<const CameraRay> rays, std::uint32_t depth, const Sink& sink);
    void leave_scene(const CameraRay& ray, std::size_t index, const Sink& sink);
    void add_lamps(std::size_t index, const Ray& segment, const std::optional<double>& surface, const Sink& sink);
    static void add_light(std::size_t index, LightKind kind, std::uint32_t group, const Rgb& radiance,
                          const Sink& sink);
    void run_programs(std::span<const NeighbourRays> neighbours, std::size_t first);
    void run_program(std::span<const NeighbourRays> neighbours, std::span<const std::uint32_t> surfaces);
    /// neighbours: null where the program takes no differences.
    ShadedPlace place_of(const Surface& surface, const NeighbourRays* neighbours) const;
    void pass_on(std::span<const CameraRay> rays, std::size_t first, const Sink& sink);
    void add_hits(std::span<const CameraRay> rays, std::size_t rays_per_pixel, Hits& hits);
    void add_hit(const CameraRay& ray, const Surface& surface, Hits& hits);
    /// Unit.
    Vec3d normal(const Surface& surface, const ShadedLobe& lobe) const;
    void add_shaded(const CameraRay& ray, const Surface& surface, const SurfaceShader& shader, Hits& hits);
    /// Adds the lobes from `first` on that share its normal.
    template <class Shares>
    void add_lobes(const CameraRay& ray, const Surface& surface, const SurfaceShader& shader, const Shares& shares,
                   std::size_t first, Hits& hits);
    Vec3d vector(const Surface& surface, std::uint32_t result) const;
    /// A colour in which components that are not finite are 0.
    Rgb color(const Surface& surface, std::uint32_t result) const;
    float width(const Surface& surface, std::uint32_t result) const;

    const CompiledScene* scene_;
    std::span<const MaterialLobes> materials_;
    std::uint32_t transparent_bounces_;
    std::vector<std::size_t> active_;  // rays that go on
    std::vector<Ray> segments_;        // what is left of them
    std::vector<Rgb> throughput_;      // of each ray
    std::vector<Rgb> by_group_;        // of lamps along a ray
    std::vector<RayHit> met_;
    std::vector<Surface> surfaces_;
    std::vector<std::uint32_t> order_;
    std::vector<ShadedPlace> places_;
    std::vector<float> results_;
    ShaderProgram::Registers registers_;
    std::vector<Vec3d> normals_;
    std::vector<Rgb> weights_;
    std::vector<float> widths_;
};

}  // namespace shlight
