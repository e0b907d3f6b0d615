// SPDX-License-Identifier: MIT
//
// The rays by which a record sees the half space above its surface, and the record that their light makes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shlight/ray_tracer.h"
#include "shlight/surface_point.h"
#include "shlight/types.h"
#include "surfaces/light_records.h"

namespace shlight {

class RecordRays {
  public:
    RecordRays() = default;
    /// across² rays, one in each cell of a grid over the square that directions are made of; seed: of places in cells.
    RecordRays(const SurfacePoint& surface, std::size_t across, std::uint32_t seed);

    /// Row by row of the grid; a ray that would begin inside the surface is empty.
    std::span<const Ray> rays() const { return rays_; }
    /// distances: that the rays go; light: of each ray, as StoredLight has it: `count` numbers. The record's radius is
    /// the harmonic mean of the distances. reach [m]: surfaces that are nearer change what is reflected as slowly as
    /// those at this distance. A grid of directions is too coarse to tell where a surface ends that begins at the
    /// record.
    LightRecord record(std::span<const double> distances, std::span<const Rgb* const> light, std::size_t count,
                       std::size_t parts, double reach) const;

  private:
    void find_free(std::span<const double> distances, LightRecord& record) const;
    /// How what a white diffuse surface reflects changes along the axes of the world, by the light of cells of the
    /// grid that are side by side (Ward & Heckbert 1992, "Irradiance Gradients").
    void find_gradients(std::span<const double> distances, std::span<const Rgb* const> light, std::size_t parts,
                        double reach, LightRecord& record) const;
    void add_up(std::span<const Rgb* const> light, std::size_t parts, LightRecord& record) const;

    std::size_t across_ = 0;
    Vec3d position_{0}, x_{0}, y_{0}, z_{0};  // of the frame of directions
    std::vector<Ray> rays_;                   // row by row
    std::vector<Vec3d> ways_;
    std::vector<float> solid_angles_;  // by which radiance counts
};

}  // namespace shlight
