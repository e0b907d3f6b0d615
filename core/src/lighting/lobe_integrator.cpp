// SPDX-License-Identifier: MIT
#include "lighting/lobe_integrator.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lighting/cubature_kernel.h"
#include "lighting/polygon_rule_kernel.h"
#include "lobes/boundary_integral.h"
#include "regions/polygon_kernels.h"
#include "regions/spherical_polygon.h"
#include "simd/dot_products.h"

namespace shlight {
namespace {

/// Rules up to these are cheaper than harmonics of the orders that glossy lobes take.
constexpr int kCheapCapRule = 3;
constexpr int kCheapPolygonRule = 2;
/// Largest number of vertices for a rule to be cheap, as a rule has points in each triangle.
constexpr int kMostCheapVertices = 8;

Vec3d axis_of(const CapArrays& circles, std::size_t i) {
    return {circles.x[i], circles.y[i], circles.z[i]};
}

/// The largest rule that is cheaper than harmonics of the orders that glossy lobes take.
int cheap_rule(const CapArrays&) {
    return kCheapCapRule;
}
int cheap_rule(const PolygonBatch& polygons) {
    return polygons.vertex_count() <= kMostCheapVertices ? kCheapPolygonRule : kNoRule;
}

/// Clamps negative values, which come from ringing.
void without_ringing(std::span<float> values) {
    std::transform(values.begin(), values.end(), values.begin(), [](float value) { return std::max(0.0F, value); });
}

}  // namespace

void LobeIntegrator::shade(LobeViews& lobe, const CapArrays& circles, std::span<const std::uint32_t> view_of,
                           bool with_statistics) {
    shade_any(lobe, circles, view_of, with_statistics);
}

void LobeIntegrator::shade(LobeViews& lobe, PolygonBatch& polygons, std::span<const std::uint32_t> view_of,
                           bool with_statistics) {
    shade_any(lobe, polygons, view_of, with_statistics);
}

void LobeIntegrator::shade(LobeViews& lobe, const SphereArrays& spheres, std::span<const std::uint32_t> view_of,
                           bool with_statistics) {
    begin(lobe, view_of.size());
    shade_alike(lobe, spheres, view_of, with_statistics);
}

bool LobeIntegrator::shades_alike(const LobeViews& lobe) {
    return !lobe.chooses() && !is_mirror(lobe.shape()) && !lobe.any_black();
}

void LobeIntegrator::begin(const LobeViews& lobe, std::size_t count) {
    values_.resize(count);
    efforts_.resize(count);
    same_lobe_ = shades_alike(lobe);
    only_order_ = same_lobe_ ? lobe.order(0) : 0;
}

template <class Lights>
void LobeIntegrator::shade_any(LobeViews& lobe, Lights& lights, std::span<const std::uint32_t> view_of,
                               bool with_statistics) {
    begin(lobe, view_of.size());
    if (view_of.empty()) {
        return;
    }
    if (same_lobe_) {
        shade_alike(lobe, lights, view_of, with_statistics);
    } else {
        shade_sorted(lobe, lights, view_of);
    }
}

template <class Lights>
void LobeIntegrator::shade_alike(LobeViews& lobe, const Lights& lights, std::span<const std::uint32_t> view_of,
                                 bool with_statistics) {
    const std::size_t count = view_of.size();
    if (const std::size_t known = all_.size(); known < count) {
        all_.resize(count);
        std::iota(all_.begin(), all_.end(), 0U);
    }
    items_ = std::span(all_).first(count);
    item_views_ = view_of;
    item_values_ = values_;
    const int order = lobe.order(0);
    by_harmonics(lobe, lights, order);
    without_ringing(values_);
    for (std::size_t i = 0; with_statistics && i < count; ++i) {
        efforts_[i] = lies_below(lights, i) ? 0 : order;
    }
}

template <class Lights>
void LobeIntegrator::shade_sorted(LobeViews& lobe, Lights& lights, std::span<const std::uint32_t> view_of) {
    std::fill(values_.begin(), values_.end(), 0.0F);
    std::fill(efforts_.begin(), efforts_.end(), 0);
    find_keys(lobe, lights, view_of);
    sort();
    gathered_views_.resize(view_of.size());
    gathered_values_.resize(view_of.size());
    for (std::size_t key = kNothing + 1; key < kKeys; ++key) {
        const std::size_t count = begin_[key + 1] - begin_[key];
        if (count == 0) {
            continue;
        }
        items_ = std::span(sorted_).subspan(begin_[key], count);
        std::transform(items_.begin(), items_.end(), gathered_views_.begin(),
                       [&](std::uint32_t light) { return view_of[light]; });
        item_views_ = std::span(gathered_views_).first(count);
        item_values_ = std::span(gathered_values_).first(count);
        integrate(lobe, lights, static_cast<Key>(key));
        for (std::size_t k = 0; k < count; ++k) {
            // Negative values come from ringing.
            values_[items_[k]] = std::max(0.0F, item_values_[k]);
        }
    }
}

LobeMethod LobeIntegrator::method(std::size_t light) const {
    if (same_lobe_) {
        return efforts_[light] > 0 ? LobeMethod::harmonics : LobeMethod::nothing;
    }
    const Key key = keys_[light];
    return key == kNothing    ? LobeMethod::nothing
           : key == kMirror   ? LobeMethod::mirror
           : key > kHarmonics ? LobeMethod::harmonics
                              : LobeMethod::cubature;
}

bool LobeIntegrator::within_tolerance(const LobeViews& lobe, std::size_t light, std::size_t view) const {
    switch (method(light)) {
        case LobeMethod::nothing:
        case LobeMethod::mirror:
            return true;
        case LobeMethod::harmonics:
            return lobe.within_tolerance(view);
        case LobeMethod::cubature:
            return keys_[light] != kOutline || missed_[light] == 0;
    }
    return true;
}

bool LobeIntegrator::lies_below(const CapArrays& circles, std::size_t light) {
    return circles.z[light] <= -circles.sine[light];
}

bool LobeIntegrator::lies_below(const SphereArrays& spheres, std::size_t light) {
    return spheres.centers[light].z <= -spheres.radii[light];
}

bool LobeIntegrator::lies_below(const PolygonBatch& polygons, std::size_t light) {
    return polygons.lies_below(light);
}

bool LobeIntegrator::shows_mirrored(const CapArrays& circles, std::size_t light, const Vec3d& direction) {
    return glm::dot(direction, axis_of(circles, light)) >= circles.cosine[light];
}

bool LobeIntegrator::shows_mirrored(const PolygonBatch& polygons, std::size_t light, const Vec3d& direction) {
    // The winding of the outline about the direction, as angles between neighbouring vertices.
    const SphericalPolygon polygon(polygons.polygon(light), true);
    const std::vector<Vec3d>& v = polygon.directions();
    double winding = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3d a = glm::cross(direction, v[i]);
        const Vec3d b = glm::cross(direction, v[(i + 1) % v.size()]);
        winding += std::atan2(glm::dot(direction, glm::cross(a, b)), glm::dot(a, b));
    }
    return winding > 1 && std::any_of(v.begin(), v.end(), [&](const Vec3d& d) { return glm::dot(d, direction) > 0; });
}

void LobeIntegrator::choose_rules(const LobeViews& lobe, const CapArrays& circles,
                                  std::span<const std::uint32_t> view_of) {
    choose_cap_rules(lobe.widths(), circles, lobe.positions().directions(), lobe.tolerances(), view_of, rules_);
}

void LobeIntegrator::choose_rules(const LobeViews& lobe, PolygonBatch& polygons,
                                  std::span<const std::uint32_t> view_of) {
    choose_polygon_rules(lobe.widths(), polygons.views(), lobe.positions().directions(), lobe.tolerances(), view_of,
                         rules_);
}

template <class Lights>
void LobeIntegrator::find_keys(const LobeViews& lobe, Lights& lights, std::span<const std::uint32_t> view_of) {
    keys_.resize(view_of.size());
    if (!lobe.chooses()) {
        const auto key = is_mirror(lobe.shape()) ? kMirror : static_cast<Key>(kHarmonics + lobe.order(0));
        for (std::size_t i = 0; i < view_of.size(); ++i) {
            keys_[i] = lies_below(lights, i) || lobe.is_black(view_of[i]) ? kNothing : key;
        }
        return;
    }
    rules_.resize(view_of.size());
    choose_rules(lobe, lights, view_of);
    const int cheap = cheap_rule(lights);
    // Rules would see light on one side of an edge alone.
    const bool has_edge = std::holds_alternative<ToonShape>(lobe.shape());
    for (std::size_t i = 0; i < view_of.size(); ++i) {
        const std::uint32_t view = view_of[i];
        const int order = lobe.order(view);
        const Key otherwise = order > 0 ? static_cast<Key>(kHarmonics + order) : kOutline;
        const bool by_rule = !has_edge && rules_[i] != kNoRule && (rules_[i] <= cheap || order == 0);
        const Key key = by_rule ? rules_[i] : otherwise;
        keys_[i] = rules_[i] == kHidden || lobe.is_black(view) ? kNothing : key;
    }
}

void LobeIntegrator::sort() {
    begin_.fill(0);
    for (const Key key : keys_) {
        ++begin_[key + std::size_t{1}];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    sorted_.resize(keys_.size());
    std::array<std::uint32_t, kKeys + 1> next = begin_;
    for (std::size_t i = 0; i < keys_.size(); ++i) {
        sorted_[next[keys_[i]]++] = static_cast<std::uint32_t>(i);
    }
}

template <class Lights>
void LobeIntegrator::integrate(LobeViews& lobe, Lights& lights, Key key) {
    if (key == kMirror) {
        mirror(lobe, lights);
    } else if (key == kOutline) {
        missed_.resize(values_.size());
        by_largest_order(lobe, lights);
        by_outline(lobe, lights);
    } else if (key > kHarmonics) {
        by_harmonics(lobe, lights, key - kHarmonics);
        for (const std::uint32_t light : items_) {
            efforts_[light] = key - kHarmonics;
        }
    } else {
        by_rule(lobe, lights, key);
    }
}

template <class Lights>
void LobeIntegrator::mirror(const LobeViews& lobe, Lights& lights) {
    for (std::size_t k = 0; k < items_.size(); ++k) {
        const Vec3d direction = mirrored(lobe.positions().direction(item_views_[k]));
        item_values_[k] = shows_mirrored(lights, items_[k], direction)
                              ? static_cast<float>(lobe_albedo(lobe.shape(), direction.z))
                              : 0.0F;
    }
}

std::span<float> LobeIntegrator::rows_of(int order) {
    rows_.resize(items_.size() * static_cast<std::size_t>(coefficient_count(order)));
    return rows_;
}

void LobeIntegrator::contract(LobeViews& lobe, int order, std::span<const float> rows) {
    const auto size = static_cast<std::size_t>(coefficient_count(order));
    for (std::size_t k = 0; k < items_.size(); ++k) {
        dot_products(lobe.coefficients(order, item_views_[k]), &rows[k * size], size, 1, &item_values_[k]);
    }
}

void LobeIntegrator::by_harmonics(LobeViews& lobe, const CapArrays& circles, int order) {
    if (lobe.is_anisotropic()) {
        contracted_circles_.resize(items_.size());
        for (std::size_t k = 0; k < items_.size(); ++k) {
            const std::uint32_t i = items_[k];
            contracted_circles_.set(k, {axis_of(circles, i), circles.cosine[i], circles.sine[i]});
        }
        const std::span<float> rows = rows_of(order);
        cap_rows(contracted_circles_.arrays(), items_.size(), order, true, rows.data(), Output::cached);
        contract(lobe, order, rows);
        return;
    }
    shade_caps(circles, items_, lobe.arrays(order, item_views_), item_views_, item_values_);
}

void LobeIntegrator::by_harmonics(LobeViews& lobe, const SphereArrays& spheres, int order) {
    if (lobe.is_anisotropic()) {
        const std::span<float> rows = rows_of(order);
        cap_rows(spheres, items_.size(), order, true, rows.data(), Output::cached);
        contract(lobe, order, rows);
        return;
    }
    shade_caps(spheres, lobe.arrays(order, item_views_), item_views_, item_values_);
}

void LobeIntegrator::by_harmonics(LobeViews& lobe, const PolygonBatch& polygons, int order) {
    if (lobe.is_anisotropic()) {
        contracted_vertices_.clear();
        for (const std::uint32_t i : items_) {
            const auto own = polygons.polygon(i);
            contracted_vertices_.insert(contracted_vertices_.end(), own.begin(), own.end());
        }
        const std::span<float> rows = rows_of(order);
        polygon_rows(std::span<const Vec3d>(contracted_vertices_), polygons.vertex_count(), order, true, rows.data());
        contract(lobe, order, rows);
        return;
    }
    shade_polygons(polygons.vertices(), polygons.vertex_count(), items_, lobe.arrays(order, item_views_), item_views_,
                   item_values_);
}

template <class Lights>
void LobeIntegrator::by_largest_order(LobeViews& lobe, const Lights& lights) {
    if (!(lobe.relative_tolerance() > 0) || lobe.has_two_widths()) {
        return;
    }
    const int order = lobe.largest_order();
    by_harmonics(lobe, lights, order);
    for (std::size_t k = 0; k < items_.size(); ++k) {
        if (lobe.error_of_largest_order(item_views_[k]) <= lobe.relative_tolerance() * item_values_[k]) {
            keys_[items_[k]] = static_cast<Key>(kHarmonics + order);
            efforts_[items_[k]] = order;
        }
    }
}

template <class Function>
void LobeIntegrator::for_each_shape(const LobeViews& lobe, const Function& function) const {
    if (!lobe.has_two_widths()) {
        function(lobe.shape(), 0, items_.size());
        return;
    }
    for (std::size_t k = 0; k < items_.size(); ++k) {
        function(lobe.shape(item_views_[k]), k, 1);
    }
}

void LobeIntegrator::by_rule(const LobeViews& lobe, const CapArrays& circles, int rule) {
    for_each_shape(lobe, [&](const LobeShape& shape, std::size_t first, std::size_t count) {
        integrate_caps(shape, lobe.parameters(), circles, items_.subspan(first, count), lobe.positions().directions(),
                       item_views_.subspan(first, count), rule, item_values_.subspan(first, count));
    });
    const int points = cap_rule_points(rule);
    for (const std::uint32_t light : items_) {
        efforts_[light] = points;
    }
}

void LobeIntegrator::by_rule(const LobeViews& lobe, const PolygonBatch& polygons, int rule) {
    for_each_shape(lobe, [&](const LobeShape& shape, std::size_t first, std::size_t count) {
        integrate_polygons(shape, lobe.parameters(), polygons.vertices(), polygons.vertex_count(),
                           items_.subspan(first, count), lobe.positions().directions(),
                           item_views_.subspan(first, count), rule, item_values_.subspan(first, count));
    });
    const int points = polygon_rule_points(rule, polygons.vertex_count());
    for (const std::uint32_t light : items_) {
        efforts_[light] = points;
    }
}

void LobeIntegrator::by_outline(const LobeViews& lobe, const CapArrays& circles) {
    for (std::size_t k = 0; k < items_.size(); ++k) {
        if (const std::uint32_t i = items_[k]; keys_[i] == kOutline) {
            integrate_outline(lobe, k, CapBoundary({axis_of(circles, i), circles.cosine[i], circles.sine[i]}).arcs());
        }
    }
}

void LobeIntegrator::by_outline(const LobeViews& lobe, const PolygonBatch& polygons) {
    for (std::size_t k = 0; k < items_.size(); ++k) {
        if (const std::uint32_t i = items_[k]; keys_[i] == kOutline) {
            integrate_outline(lobe, k, polygon_boundary(SphericalPolygon(polygons.polygon(i), true)));
        }
    }
}

void LobeIntegrator::integrate_outline(const LobeViews& lobe, std::size_t item, std::span<const Arc<double>> arcs) {
    const std::uint32_t view = item_views_[item];
    const double tolerance = lobe.absolute_tolerance(view);
    const BoundaryIntegral integral =
        boundary_integral(lobe.shape(view), lobe.positions().cosine()[view], arcs, tolerance, lobe.albedo(view));
    item_values_[item] = static_cast<float>(integral.value);
    efforts_[items_[item]] = integral.points;
    missed_[items_[item]] = integral.error <= tolerance ? 0 : 1;
}

}  // namespace shlight
