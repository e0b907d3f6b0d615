// SPDX-License-Identifier: MIT
//
// Meshes whose faces are summed up, at many shading points of one material.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "emitters/face_sum.h"
#include "emitters/face_tree.h"
#include "lighting/lobe_integrator.h"
#include "lighting/local_lights.h"
#include "lighting/shading_points.h"
#include "lobes/material_views.h"
#include "shlight/types.h"

namespace shlight {

/// Keeps its memory from call to call; one per thread.
class FaceShading {
  public:
    /// Sets radiance[lobe · points + point], which lobes reflect if nothing blocks, at some[view] for each view.
    /// tolerance: relative to the sum over the lobes of a point; unit_tolerance: as of the views.
    void shade(const FaceTree& faces, const ShadingPoints& points, std::span<const std::uint32_t> some,
               MaterialViews& views, double tolerance, double unit_tolerance, std::span<Rgb> radiance);

  private:
    void shade(const FaceTree& faces, const ShadingPoints& points, std::uint32_t point, std::uint32_t view,
               MaterialViews& views, double tolerance, double scale, std::span<Rgb> radiance);
    /// Adds near_ to the radiance of a lobe at some[view].
    void add_near(LobeViews& lobe, std::span<const std::uint32_t> some, double tolerance, std::span<Rgb> radiance);

    FaceSum sum_;
    std::vector<SummedLobe> lobes_;         // of a point
    std::vector<std::size_t> numbers_;      // of these lobes in the material
    std::vector<NearFace> near_;            // as views see them
    std::vector<std::uint32_t> near_view_;  // the view of each of them
    LocalLights seen_;
    LobeIntegrator batch_;
};

}  // namespace shlight
