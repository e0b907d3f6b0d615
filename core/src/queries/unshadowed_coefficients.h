// SPDX-License-Identifier: MIT
//
// Exact coefficients of lights of even radiance, seen from many points: Eq. 4 of Zhou & Wei 2020 in the frame of each.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "emitters/mesh_view.h"
#include "lights/local_light.h"
#include "shlight/cap.h"
#include "shlight/light.h"
#include "shlight/types.h"

namespace shlight {

/// Keeps its memory from light to light; one per thread.
class UnshadowedCoefficients {
  public:
    /// Whether a light of this kind has exact ones: it has extent, and the same radiance everywhere.
    static bool knows(const Light& light);

    /// Adds what a point sees of a light. row: of the point.
    void look(const Light& light, const ShadingFrame& frame, double error, std::uint32_t row);
    /// The half space above the horizon.
    void add_hemisphere(std::uint32_t row);
    /// Adds for unit radiance order² coefficients to the row of each point, and forgets all.
    void move_to(int order, std::span<double> rows);

  private:
    /// Corners of polygons with the same number of them.
    struct Polygons {
        std::vector<Vec3d> corners;
        std::vector<std::uint32_t> rows;
    };

    void look_at(const MeshLight& light, const ShadingFrame& frame, std::uint32_t row);
    void add_polygon(std::span<const Vec3d> corners, std::uint32_t row);
    /// Adds rows of values_.
    void add_values(std::span<const std::uint32_t> numbers, std::size_t width, std::span<double> rows) const;

    LocalLight seen_;
    MeshView mesh_view_;
    std::vector<SphericalCap> caps_;
    std::vector<std::uint32_t> cap_rows_;
    std::map<std::size_t, Polygons> polygons_;  // by the number of corners
    std::vector<Vec3d> centers_, half_axes_u_, half_axes_v_;
    std::vector<std::uint32_t> disk_rows_;
    std::vector<Vec3d> corners_;
    std::vector<double> values_;
};

}  // namespace shlight
