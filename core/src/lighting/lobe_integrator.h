// SPDX-License-Identifier: MIT
//
// Many lights under one lobe: each integrated in the cheapest way that meets the tolerance. As a mirror image, by a few
// values of f·cos where it is small beside the lobe, by spherical harmonics in the lobe's boost, or along its outline.
// Lights that take the same way are sorted together, so that each way is one call.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lobes/boundary_integral.h"
#include "lobes/material_views.h"
#include "regions/boundary.h"
#include "regions/cap_kernels.h"
#include "regions/polygon_batch.h"
#include "shlight/types.h"

namespace shlight {

/// How a light's radiance was found; nothing: the light is hidden, or the lobe black.
enum class LobeMethod { nothing, mirror, harmonics, cubature };

/// Keeps its memory from call to call; one per thread.
class LobeIntegrator {
  public:
    /// SphericalCap i, clipped by the horizon, is seen by view view_of[i]. with_statistics: whether anything but
    /// values() will be asked for.
    void shade(LobeViews& lobe, const CapArrays& circles, std::span<const std::uint32_t> view_of, bool with_statistics);
    void shade(LobeViews& lobe, PolygonBatch& polygons, std::span<const std::uint32_t> view_of, bool with_statistics);
    /// The same as with their circles, with fewer steps. Precondition: shades_alike(lobe).
    void shade(LobeViews& lobe, const SphereArrays& spheres, std::span<const std::uint32_t> view_of,
               bool with_statistics);
    /// Whether all lights are integrated by harmonics of one order.
    static bool shades_alike(const LobeViews& lobe);

    // Results of the last call:
    /// The reflected radiance of each light of unit radiance, without the lobe's scale, ≥ 0.
    std::span<const float> values() const { return values_; }
    /// The order, or number of values of f·cos, that each took; 0 where it is hidden or mirrored, or the lobe black.
    std::span<const std::int32_t> efforts() const { return efforts_; }
    /// The order that all lights took which are not hidden; 0: they took different ways.
    int only_order() const { return only_order_; }
    LobeMethod method(std::size_t light) const;
    /// Whether a light kept within the tolerance, by what its way estimates; only if the lobe, as given, was judged.
    bool within_tolerance(const LobeViews& lobe, std::size_t light, std::size_t view) const;

  private:
    /// The method for a light: none, a cubature rule (1 …), another method, or harmonics of order key - kHarmonics.
    using Key = std::uint8_t;
    static constexpr Key kNothing = 0, kOutline = 5, kMirror = 6, kHarmonics = 7;
    static constexpr std::size_t kKeys = kHarmonics + kMaxOrder + 1;

    void begin(const LobeViews& lobe, std::size_t count);
    template <class Lights>
    void shade_any(LobeViews& lobe, Lights& lights, std::span<const std::uint32_t> view_of, bool with_statistics);
    /// All by harmonics of the only order.
    template <class Lights>
    void shade_alike(LobeViews& lobe, const Lights& lights, std::span<const std::uint32_t> view_of,
                     bool with_statistics);
    template <class Lights>
    void shade_sorted(LobeViews& lobe, Lights& lights, std::span<const std::uint32_t> view_of);

    static bool lies_below(const CapArrays& circles, std::size_t light);
    static bool lies_below(const SphereArrays& spheres, std::size_t light);
    static bool lies_below(const PolygonBatch& polygons, std::size_t light);
    static bool shows_mirrored(const CapArrays& circles, std::size_t light, const Vec3d& direction);
    static bool shows_mirrored(const PolygonBatch& polygons, std::size_t light, const Vec3d& direction);
    /// The rule of cubature of each light, as choose_cap_rules.
    void choose_rules(const LobeViews& lobe, const CapArrays& circles, std::span<const std::uint32_t> view_of);
    void choose_rules(const LobeViews& lobe, PolygonBatch& polygons, std::span<const std::uint32_t> view_of);

    template <class Lights>
    void find_keys(const LobeViews& lobe, Lights& lights, std::span<const std::uint32_t> view_of);
    void sort();
    template <class Lights>
    void integrate(LobeViews& lobe, Lights& lights, Key key);

    template <class Lights>
    void mirror(const LobeViews& lobe, Lights& lights);
    void by_harmonics(LobeViews& lobe, const CapArrays& circles, int order);
    void by_harmonics(LobeViews& lobe, const SphereArrays& spheres, int order);
    void by_harmonics(LobeViews& lobe, const PolygonBatch& polygons, int order);
    /// Anisotropic lobes: by order² coefficients of each item's light, in `rows`.
    void contract(LobeViews& lobe, int order, std::span<const float> rows);
    std::span<float> rows_of(int order);
    /// function(shape, first, count) for items that share a shape, whose lanes differ in their parameters alone.
    template <class Function>
    void for_each_shape(const LobeViews& lobe, const Function& function) const;
    void by_rule(const LobeViews& lobe, const CapArrays& circles, int rule);
    void by_rule(const LobeViews& lobe, const PolygonBatch& polygons, int rule);
    /// Outlines cost most: lights that are bright enough are left to harmonics of the largest order.
    template <class Lights>
    void by_largest_order(LobeViews& lobe, const Lights& lights);
    void by_outline(const LobeViews& lobe, const CapArrays& circles);
    void by_outline(const LobeViews& lobe, const PolygonBatch& polygons);
    /// Integrates one item along its outline.
    void integrate_outline(const LobeViews& lobe, std::size_t item, std::span<const Arc<double>> arcs);

    std::vector<float> values_;
    std::vector<std::int32_t> efforts_;

    bool same_lobe_ = false;
    int only_order_ = 0;                        // see only_order()
    std::vector<std::uint8_t> rules_, missed_;  // missed_: the tolerance
    std::vector<Key> keys_;
    std::vector<std::uint32_t> sorted_;             // lights by key
    std::array<std::uint32_t, kKeys + 1> begin_{};  // of each key in sorted_

    std::span<const std::uint32_t> items_;       // lights of the key at hand
    std::span<const std::uint32_t> item_views_;  // and their views
    std::span<float> item_values_;
    std::vector<std::uint32_t> all_, gathered_views_;
    std::vector<float> gathered_values_;
    CapBatch contracted_circles_;
    std::vector<Vec3d> contracted_vertices_;
    std::vector<float> rows_;  // coefficients of lights
};

}  // namespace shlight
