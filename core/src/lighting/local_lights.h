// SPDX-License-Identifier: MIT
//
// Lights as views see them, each in the shading frame of its view, in the form that LobeIntegrator reads: caps as
// circles, all else as polygons, those with equally many vertices together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "emitters/mesh_view.h"
#include "lighting/lobe_integrator.h"
#include "lights/local_light.h"
#include "lobes/material_views.h"
#include "regions/cap_arrays.h"
#include "regions/polygon_batch.h"
#include "regions/spherical_ellipse.h"
#include "shlight/light.h"

namespace shlight {

/// Keeps its memory from call to call; one per thread.
class LocalLights {
  public:
    void clear();
    /// Adds what a hit sees of a light, which may be nothing, or several faces of a mesh. number: what the caller knows
    /// the light by; tolerance: of what a mesh gives.
    void look(const Light& light, const ShadingFrame& frame, double error, double tolerance, std::uint32_t number);
    /// The same of hits some[0], some[1] … by number 0, 1 …
    void look(const Light& light, std::span<const ShadingFrame> frames, std::span<const double> errors,
              std::span<const std::uint32_t> some, double tolerance);
    /// Corners in the shading frame, at least one above the horizon.
    void add_polygon(std::span<const Vec3d> corners, std::uint32_t number);
    /// A disk in the shading frame; what lies below the horizon or is seen edge-on is left out.
    void add_disk(const Ellipse& disk, std::uint32_t number);
    /// In the place of all others: spheres in the shading frame, numbered 0, 1, 2 … Those of floats are kept by
    /// reference.
    void set_spheres(std::span<const Vec3f> centers, const float* radii);
    void set_spheres(std::span<const Vec3d> centers, const double* radii);
    /// Likewise, planar polygons of so many vertices each. Throws as prepare_polygons does.
    template <class T>
    void set_polygons(std::span<const Vec3<T>> vertices, std::size_t vertex_count);

    /// Shades all with a lobe. Light `number` is seen by view view_of[number]. visit(numbers) after each call of the
    /// batch, which holds values of the lights with these numbers, or, if there are none, of 0, 1, 2 …; faces of a mesh
    /// follow each other.
    /// tolerance: of the polygon that stands for a disk.
    template <class Visit>
    void shade(LobeViews& lobe, std::span<const std::uint32_t> view_of, double tolerance, bool with_statistics,
               LobeIntegrator& batch, const Visit& visit) {
        if (given_ == Given::spheres) {
            shade_spheres(lobe, view_of, with_statistics, batch);
            visit(std::span<const std::uint32_t>());
            return;
        }
        if (given_ == Given::polygons) {
            batch.shade(lobe, gathered_, view_of, with_statistics);
            visit(std::span<const std::uint32_t>());
            return;
        }
        if (!cap_numbers_.empty()) {
            find_circles();
            batch.shade(lobe, circles_.arrays(), views(cap_numbers_, view_of), with_statistics);
            visit(std::span<const std::uint32_t>(cap_numbers_));
        }
        if (!holds_all_) {
            sort(lobe, view_of, tolerance);
        }
        for (std::size_t first = 0; first < polygons_.size();) {
            first = holds_all_ ? polygons_.size() : gather(first);
            batch.shade(lobe, gathered_, views(numbers_, view_of), with_statistics);
            visit(std::span<const std::uint32_t>(numbers_));
        }
    }

  private:
    /// A polygon, or a disk for which one of a size that depends on the lobe will stand.
    struct Polygon {
        std::uint32_t first, count;  // of vertices_; count is 0 for a disk, and first of disks_
        std::uint32_t size;          // of a polygon: the last vertex is repeated up to this number
        std::uint32_t number;
    };

    /// All lights of one kind that came at once.
    enum class Given { none, spheres, polygons };

    void shade_spheres(LobeViews& lobe, std::span<const std::uint32_t> view_of, bool with_statistics,
                       LobeIntegrator& batch);
    /// The circles of a sphere, unless a hit is within it: then it returns false.
    bool look_from_outside(const SphereLight& light, std::span<const ShadingFrame> frames,
                           std::span<const std::uint32_t> some);
    void look_at(const MeshLight& light, const ShadingFrame& frame, double tolerance, std::uint32_t number);
    /// The vertices from `first` on. filled_up: so that few sizes occur.
    void add_polygon(std::size_t first, std::uint32_t number, bool filled_up);
    void find_circles();
    std::uint32_t size_of(const Polygon& polygon, const LobeViews& lobe, std::span<const std::uint32_t> view_of,
                          double tolerance) const;
    void sort(const LobeViews& lobe, std::span<const std::uint32_t> view_of, double tolerance);
    /// Puts the polygons from this one in the order of sizes on, as far as they have as many vertices, into gathered_
    /// and numbers_; returns the next one.
    std::size_t gather(std::size_t first);
    void append_filled_up(const Polygon& polygon, std::uint32_t size);
    std::span<const std::uint32_t> views(std::span<const std::uint32_t> numbers,
                                         std::span<const std::uint32_t> view_of);

    LocalLight seen_;
    Given given_ = Given::none;
    std::vector<CapView> caps_;
    std::vector<std::uint32_t> cap_numbers_;
    std::vector<Vec3d> centers_;
    std::vector<double> radii_;
    CapBatch circles_;
    std::span<const Vec3f> float_centers_;  // of spheres whose circles are not found
    const float* float_radii_ = nullptr;

    MeshView mesh_view_;
    std::vector<Vec3d> vertices_;
    std::vector<Polygon> polygons_;
    std::vector<SphericalEllipse> disks_;
    std::vector<std::uint32_t> sizes_, order_;
    PolygonBatch gathered_;
    std::vector<std::uint32_t> numbers_;  // of gathered_
    bool holds_all_ = false;              // whether these are all polygons, whatever the lobe

    std::vector<std::uint32_t> views_;
    std::vector<Vec3d> corners_;
};

}  // namespace shlight
