// SPDX-License-Identifier: MIT
//
// Passes of what camera rays meet, before any light: places, numbers and colours of surfaces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "lobes/albedo_table.h"
#include "render/camera_surfaces.h"
#include "shlight/camera.h"
#include "shlight/render_passes.h"
#include "shlight/scene.h"

namespace shlight {

/// Keeps its memory from batch to batch; one per thread.
class SurfacePasses {
  public:
    /// All outlive this.
    SurfacePasses(const CompiledScene& scene, const Camera& camera, const PassSettings& settings,
                  const PassLayout& layout);

    /// Whether any pass is a mean that add() sums up.
    bool any_mean() const { return any_mean_; }
    /// Adds to the sums of pixels what their rays, of which each has as many, have met. sums: pixels × layout.stride().
    void add(const CameraSurfaces& surfaces, std::size_t rays, std::size_t rays_per_pixel, std::span<double> sums);
    /// Writes what the one ray of each pixel has met. values: pixels × layout.stride().
    void write_middles(const CameraSurfaces& surfaces, std::size_t rays, std::span<float> values);

  private:
    using Surface = CameraSurfaces::Surface;
    static constexpr std::size_t kAbsent = ~std::size_t{0};

    bool has(Pass kind) const { return place_[static_cast<std::size_t>(kind)] != kAbsent; }
    template <class Number>
    Number* at(Pass kind, Number* pixel) const {
        return pixel + place_[static_cast<std::size_t>(kind)];
    }
    /// What a ray has met so far.
    struct RayState {
        bool found = false;     // what is opaque enough
        bool featured = false;  // what the denoiser is told of
        double reached = 0;     // how far
    };

    bool is_opaque_enough(const Rgb& transparency) const;
    // Of a surface with the lobes in lobes_. share: of its light that reaches the camera.
    void add_first(const Surface& surface, double share, double* pixel) const;
    void add_aovs(const CameraSurfaces& surfaces, const Surface& surface, double share, double* pixel) const;
    void add_mattes(const Surface& surface, double share, double* pixel) const;
    void add_colors(const Surface& surface, double* pixel);
    void add_denoising(const Surface& surface, double share, const Rgb& transparency, RayState& ray, double* pixel);
    /// Of the light that the lobe reflects under a white sky, without what its microfacets lose to each other.
    Rgb color(const SurfaceLobe& lobe, const Surface& surface);
    const AlbedoTable& table(const LobeShape& shape);
    /// 1 - mist.
    double clearness(const Vec3d& position) const;

    const CompiledScene* scene_;
    const Camera* camera_;
    const PassSettings* settings_;
    const PassLayout* layout_;
    std::array<std::size_t, static_cast<std::size_t>(Pass::cryptomatte_asset) + 1> place_;
    bool any_mean_ = false, any_aov_ = false;
    std::size_t matte_size_ = 0;  // numbers
    std::vector<RayState> rays_;
    std::vector<SurfaceLobe> lobes_;
    std::map<LobeShape, std::shared_ptr<const AlbedoTable>> tables_;  // of shapes of width 0
};

}  // namespace shlight
