// SPDX-License-Identifier: MIT
#include "quad_ellipse.h"

#include <algorithm>
#include <utility>

#include "quad_math.h"
#include "quad_slices.h"

namespace shlight::truth {

namespace {

struct Outline {
    Vec3q center, u, v;

    Vec3q at(quad t) const { return center + cosf128(t) * u + sinf128(t) * v; }
    Vec3q slope(quad t) const { return cosf128(t) * v - sinf128(t) * u; }
};

class Slices {
  public:
    Slices(const OrderTables& tables, const Vec3q& facing, int extra_nodes)
        : tables_(tables), facing_(facing), extra_nodes_(extra_nodes), sums_(coefficient_count(tables.order)) {}

    /// The outline from t = first … last; pieces turn by at most about half of its distance from the origin.
    void add(const Outline& outline, quad first, quad last) {
        const quad half = (last - first) / 2;
        const quad middle = first + half;
        const quad speed = length(outline.u) + length(outline.v);
        if (half > quad(0.8) || half * speed > length(outline.at(middle)) / 2) {
            add(outline, first, middle);
            add(outline, middle, last);
            return;
        }
        const GaussRule& rule = gauss_rule(36 + 4 * (tables_.order / 16) + extra_nodes_);
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const quad t = middle + half * rule.nodes[i];
            const Vec3q from = outline.at(t);
            const quad over = 1 / length(from);
            const Vec3q p = over * from;
            const Vec3q slope = over * outline.slope(t);
            add_point(p, slope - dot(slope, p) * p, half * rule.weights[i]);
        }
    }

    /// The horizon counter-clockwise from one direction by an angle.
    void add_horizon(const Vec3q& from, quad angle) {
        const GaussRule& rule = gauss_rule(60 + extra_nodes_);
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const quad t = angle * (1 + rule.nodes[i]) / 2;
            const quad c = cosf128(t);
            const quad s = sinf128(t);
            const Vec3q p = {from.x * c - from.y * s, from.y * c + from.x * s, 0};
            add_point(p, {-p.y, p.x, 0}, angle / 2 * rule.weights[i]);
        }
    }

    std::vector<quad> take() { return std::move(sums_); }

  private:
    /// Slices about `facing`, which every point faces, give the area.
    void add_point(const Vec3q& p, const Vec3q& step, quad weight) {
        sums_[0] += weight * tables_.diagonal[0] * dot(facing_, cross(p, step)) / (1 + dot(facing_, p));
        add_arc_point(tables_, p, weight * step.z, weight * (p.x * step.y - p.y * step.x), legendre_, sums_);
    }

    const OrderTables& tables_;
    Vec3q facing_;
    int extra_nodes_;
    std::vector<quad> sums_, legendre_;
};

}  // namespace

Coefficients ellipse(const EllipseInput& input, int order, bool clip, int extra_nodes) {
    const OrderTables& tables = order_tables(std::max(order, 2));
    Outline outline = {quad_vector(input.center), quad_vector(input.half_axis_u), quad_vector(input.half_axis_v)};
    Vec3q normal = cross(outline.u, outline.v);
    if (dot(normal, outline.center) < 0) {  // counter-clockwise as seen from the origin's far side
        std::swap(outline.u, outline.v);
        normal = -1 * normal;
    }
    Slices slices(tables, normalized(normal), extra_nodes);
    const quad rise = sqrtf128(outline.u.z * outline.u.z + outline.v.z * outline.v.z);
    const quad height = outline.center.z;
    if (!clip || height >= rise) {
        slices.add(outline, 0, 2 * pi());
    } else if (height > -rise) {
        const quad reach = atan2f128(sqrtf128((rise - height) * (rise + height)), -height);
        const quad highest = atan2f128(outline.v.z, outline.u.z);
        slices.add(outline, highest - reach, highest + reach);
        const Vec3q from = outline.at(highest + reach);
        const Vec3q to = outline.at(highest - reach);
        const Vec3q start = normalized({from.x, from.y, 0});
        const quad angle =
            atan2f128(from.x * (to.y - from.y) - from.y * (to.x - from.x), from.x * to.x + from.y * to.y);
        slices.add_horizon(start, angle);
    }
    return finished(slices.take(), order);
}

}  // namespace shlight::truth
