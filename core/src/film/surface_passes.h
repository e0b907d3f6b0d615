// SPDX-License-Identifier: MIT
//
// AOVs of the surfaces that camera rays meet, independent of light: positions, numbers and colours.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "lobes/albedo_table.h"
#include "shlight/camera.h"
#include "shlight/render_passes.h"
#include "shlight/scene.h"
#include "surfaces/camera_surfaces.h"

namespace shlight {

/// Memory is reused from batch to batch; one per thread.
class SurfacePasses {
  public:
    /// The arguments must outlive this.
    SurfacePasses(const CompiledScene& scene, const Camera& camera, const PassSettings& settings,
                  const PassLayout& layout);

    /// Whether any AOV is a mean over rays, which add() sums.
    bool any_mean() const { return any_mean_; }
    /// Adds the surfaces that rays met to the sums of their pixels. sums: pixels × layout.stride().
    void add(const CameraSurfaces& surfaces, std::size_t rays, std::size_t rays_per_pixel, std::span<double> sums);
    /// Writes the AOVs of single rays through the pixels' middles. values: pixels × layout.stride().
    void write_middles(const CameraSurfaces& surfaces, std::size_t rays, std::span<float> values);
    /// The same for the guides of the denoiser.
    void write_guides(const CameraSurfaces& surfaces, std::size_t rays, std::span<float> values);

  private:
    using Surface = CameraSurfaces::Surface;
    static constexpr std::size_t kAbsent = ~std::size_t{0};

    bool has(Pass kind) const { return place_[static_cast<std::size_t>(kind)] != kAbsent; }
    template <class Number>
    Number* at(Pass kind, Number* pixel) const {
        return pixel + place_[static_cast<std::size_t>(kind)];
    }
    /// State of a ray while its surfaces are visited from front to back.
    struct RayState {
        bool found = false;     // a surface was opaque enough
        bool featured = false;  // a surface gave the denoising features
        double reached = 0;     // distance counted in denoising_depth
    };

    bool is_opaque_enough(const Rgb& transparency) const;
    // Contributions of one surface, whose lobes are in lobes_. share: the fraction of its light that reaches the
    // camera.
    void add_first(const Surface& surface, double share, double* pixel) const;
    void add_aovs(const CameraSurfaces& surfaces, const Surface& surface, double share, double* pixel) const;
    void add_mattes(const Surface& surface, double share, double* pixel) const;
    void add_colors(const Surface& surface, double* pixel);
    void add_denoising(const Surface& surface, double share, const Rgb& transparency, RayState& ray, double* pixel);
    /// Albedo of a lobe under a white sky, without the energy lost between microfacets.
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
    std::size_t matte_size_ = 0;  // floats per pixel
    std::vector<RayState> rays_;
    std::vector<SurfaceLobe> lobes_;
    std::vector<double> of_middles_;
    std::map<LobeShape, std::shared_ptr<const AlbedoTable>> tables_;  // keys have width 0
};

}  // namespace shlight
