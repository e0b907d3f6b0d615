// SPDX-License-Identifier: MIT
#include "lobe_batch.h"

#include <algorithm>
#include <cmath>

#include "kernels/cap_cubature_kernel.h"
#include "kernels/polygon_shading_kernel.h"
#include "light_cubature.h"
#include "lobe_outline.h"

namespace shlight {
namespace {

/// Rules up to these are cheaper than harmonics of the orders that glossy lobes take.
constexpr int kCheapCapRule = 3;
constexpr int kCheapPolygonRule = 2;

/// Of a polygon of one radian, as a relative size: the projection of the sphere onto a plane varies as a lobe does.
constexpr double kFlatness = 1.2;

/// The middle of a polygon and the greatest distance of a vertex from it, as directions.
struct Extent {
    Vec3d middle;
    double half_angle;
};

Extent extent_of(const SphericalPolygon<double>& polygon) {
    Extent e{Vec3d(0), 0};
    for (const Vec3d& v : polygon.directions()) {
        e.middle += v;
    }
    e.middle = glm::normalize(e.middle);
    for (const Vec3d& v : polygon.directions()) {
        e.half_angle = std::max(e.half_angle, glm::length(v - e.middle));
    }
    return e;
}

Vec3d axis_of(const CircleArrays& circles, std::size_t i) {
    return {circles.x[i], circles.y[i], circles.z[i]};
}

Vec3d mirrored(const Vec3d& view) {
    return {-view.x, 0, view.z};
}

std::size_t count_of(const CircleArrays&, std::span<const std::uint32_t> view_of) {
    return view_of.size();
}
std::size_t count_of(const PolygonLights& polygons, std::span<const std::uint32_t>) {
    return polygons.size();
}

}  // namespace

void LobeBatch::shade(LobeViews& lobe, const CircleArrays& circles, std::span<const std::uint32_t> view_of) {
    shade_any(lobe, circles, view_of);
}

void LobeBatch::shade(LobeViews& lobe, const PolygonLights& polygons, std::span<const std::uint32_t> view_of) {
    shade_any(lobe, polygons, view_of);
}

template <class Lights>
void LobeBatch::shade_any(LobeViews& lobe, const Lights& lights, std::span<const std::uint32_t> view_of) {
    const std::size_t count = count_of(lights, view_of);
    values_.assign(count, 0.0F);
    taken_.assign(count, {Taken::Way::nothing, true, 0});
    if (is_mirror(lobe.shape())) {
        mirror(lobe, lights, view_of);
        return;
    }
    sort(lobe, lights, view_of);
    for (std::size_t key = kNothing + 1; key < kKeys; ++key) {
        items_ = std::span(sorted_).subspan(begin_[key], begin_[key + 1] - begin_[key]);
        if (items_.empty()) {
            continue;
        }
        item_views_.resize(items_.size());
        std::transform(items_.begin(), items_.end(), item_views_.begin(), [&](std::uint32_t i) { return view_of[i]; });
        integrate(lobe, lights, static_cast<Key>(key));
    }
}

bool LobeBatch::is_hidden(const CircleArrays& circles, std::size_t light) const {
    return circles.z[light] <= -circles.sine[light];
}

bool LobeBatch::is_hidden(const PolygonLights& polygons, std::size_t light) const {
    return polygons.kept[light].empty();
}

bool LobeBatch::shows_mirrored(const CircleArrays& circles, std::size_t light, const Vec3d& direction) const {
    return glm::dot(direction, axis_of(circles, light)) >= circles.cosine[light];
}

bool LobeBatch::shows_mirrored(const PolygonLights& polygons, std::size_t light, const Vec3d& direction) const {
    // The winding of the outline about the direction, as angles between neighbouring vertices.
    const std::vector<Vec3d>& v = polygons.kept[light].directions();
    double winding = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3d a = glm::cross(direction, v[i]);
        const Vec3d b = glm::cross(direction, v[(i + 1) % v.size()]);
        winding += std::atan2(glm::dot(direction, glm::cross(a, b)), glm::dot(a, b));
    }
    return winding > 1 && std::any_of(v.begin(), v.end(), [&](const Vec3d& d) { return glm::dot(d, direction) > 0; });
}

template <class Lights>
void LobeBatch::mirror(const LobeViews& lobe, const Lights& lights, std::span<const std::uint32_t> view_of) {
    for (std::size_t i = 0; i < values_.size(); ++i) {
        const std::uint32_t view = view_of[i];
        if (is_hidden(lights, i) || lobe.is_black(view)) {
            continue;
        }
        const Vec3d direction = mirrored(lobe.positions().direction(view));
        taken_[i].way = Taken::Way::mirror;
        if (shows_mirrored(lights, i, direction)) {
            values_[i] = static_cast<float>(fresnel_factor(lobe.ggx(), direction.z));
        }
    }
}

void LobeBatch::choose_rules(const LobeViews& lobe, const CircleArrays& circles,
                             std::span<const std::uint32_t> view_of) {
    choose_cap_rules(lobe.ggx(), circles, lobe.positions().directions(), lobe.tolerances(), view_of, rules_);
}

void LobeBatch::choose_rules(const LobeViews& lobe, const PolygonLights& polygons,
                             std::span<const std::uint32_t> view_of) {
    for (std::size_t i = 0; i < rules_.size(); ++i) {
        if (is_hidden(polygons, i)) {
            rules_[i] = kCapHidden;
            continue;
        }
        const Extent extent = extent_of(polygons.kept[i]);
        const double size =
            std::max(relative_size(lobe.ggx(), lobe.positions().direction(view_of[i]), extent.middle, extent.half_angle),
                     kFlatness * extent.half_angle);
        rules_[i] = static_cast<std::uint8_t>(polygon_rule_number(size, lobe.tolerances()[view_of[i]]));
    }
}

int LobeBatch::cheap_rule(const CircleArrays&) {
    return kCheapCapRule;
}
int LobeBatch::cheap_rule(const PolygonLights&) {
    return kCheapPolygonRule;
}

template <class Lights>
void LobeBatch::sort(const LobeViews& lobe, const Lights& lights, std::span<const std::uint32_t> view_of) {
    const std::size_t count = values_.size();
    keys_.resize(count);
    if (lobe.chooses()) {
        rules_.resize(count);
        choose_rules(lobe, lights, view_of);
        const int cheap = cheap_rule(lights);
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t view = view_of[i];
            const int order = lobe.order(view);
            const Key otherwise = static_cast<Key>(order > 0 ? kHarmonics + order : kOutline);
            const bool by_rule = rules_[i] != kNoCapRule && (rules_[i] <= cheap || order == 0);
            const Key key = by_rule ? rules_[i] : otherwise;
            keys_[i] = rules_[i] == kCapHidden || lobe.is_black(view) ? kNothing : key;
        }
    } else {
        for (std::size_t i = 0; i < count; ++i) {
            const bool nothing = is_hidden(lights, i) || lobe.is_black(view_of[i]);
            keys_[i] = nothing ? kNothing : static_cast<Key>(kHarmonics + lobe.order(view_of[i]));
        }
    }
    begin_.fill(0);
    for (const Key key : keys_) {
        ++begin_[key + std::size_t{1}];
    }
    for (std::size_t key = 1; key < begin_.size(); ++key) {
        begin_[key] += begin_[key - 1];
    }
    sorted_.resize(count);
    std::array<std::uint32_t, kKeys + 1> next = begin_;
    for (std::size_t i = 0; i < count; ++i) {
        sorted_[next[keys_[i]]++] = static_cast<std::uint32_t>(i);
    }
}

template <class Lights>
void LobeBatch::integrate(LobeViews& lobe, const Lights& lights, Key key) {
    if (key == kOutline) {
        by_outline(lobe, lights);
        return;
    }
    item_values_.resize(items_.size());
    Taken taken{Taken::Way::cubature, true, 0};
    if (key > kHarmonics) {
        by_harmonics(lobe, lights, key - kHarmonics);
        taken = {Taken::Way::harmonics, true, key - kHarmonics};
    } else {
        by_rule(lobe, lights, key);
    }
    for (std::size_t k = 0; k < items_.size(); ++k) {
        // What rings below zero is no light.
        values_[items_[k]] = std::max(0.0F, item_values_[k]);
    }
    if (key > kHarmonics) {
        for (std::size_t k = 0; k < items_.size(); ++k) {
            taken_[items_[k]] = {taken.way, lobe.met(item_views_[k]), taken.effort};
        }
    }
}

void LobeBatch::by_harmonics(LobeViews& lobe, const CircleArrays& circles, int order) {
    shade_caps(circles, items_, lobe.arrays(order, item_views_), item_views_, item_values_);
}

void LobeBatch::by_harmonics(LobeViews& lobe, const PolygonLights& polygons, int order) {
    shade_polygons(polygons.vertices, polygons.vertex_count, items_, lobe.arrays(order, item_views_), item_views_,
                   item_values_);
}

void LobeBatch::by_rule(const LobeViews& lobe, const CircleArrays& circles, int rule) {
    integrate_caps(lobe.ggx(), circles, items_, lobe.positions().directions(), item_views_, rule, item_values_);
    const Taken taken{Taken::Way::cubature, true, cap_rule_points(rule)};
    for (const std::uint32_t light : items_) {
        taken_[light] = taken;
    }
}

void LobeBatch::by_rule(const LobeViews& lobe, const PolygonLights& polygons, int rule) {
    for (std::size_t k = 0; k < items_.size(); ++k) {
        const CubatureSum sum = polygon_cubature(lobe.ggx(), lobe.positions().direction(item_views_[k]),
                                                 polygons.kept[items_[k]], rule);
        item_values_[k] = static_cast<float>(sum.value);
        taken_[items_[k]] = {Taken::Way::cubature, true, sum.points};
    }
}

OutlineIntegral LobeBatch::outline(const LobeViews& lobe, std::span<const OutlineArc> arcs, std::size_t view) {
    return outline_integral(lobe.ggx(), lobe.positions().cosine()[view], arcs, lobe.absolute_tolerance(view));
}

void LobeBatch::finish_outline(const LobeViews& lobe, std::size_t item, const OutlineIntegral& integral) {
    const std::uint32_t light = items_[item];
    const bool met = integral.error <= lobe.absolute_tolerance(item_views_[item]);
    values_[light] = std::max(0.0F, static_cast<float>(integral.value));
    taken_[light] = {Taken::Way::cubature, met, integral.points};
}

void LobeBatch::by_outline(const LobeViews& lobe, const CircleArrays& circles) {
    for (std::size_t k = 0; k < items_.size(); ++k) {
        const std::uint32_t i = items_[k];
        const CapOutline cap({axis_of(circles, i), circles.cosine[i], circles.sine[i]});
        finish_outline(lobe, k, outline(lobe, cap.arcs(), item_views_[k]));
    }
}

void LobeBatch::by_outline(const LobeViews& lobe, const PolygonLights& polygons) {
    for (std::size_t k = 0; k < items_.size(); ++k) {
        finish_outline(lobe, k, outline(lobe, polygon_outline(polygons.kept[items_[k]]), item_views_[k]));
    }
}

}  // namespace shlight
