// SPDX-License-Identifier: MIT
#include "quad_polygon.h"

#include <algorithm>

#include "quad_boost.h"
#include "quad_math.h"
#include "quad_slices.h"

namespace shlight::truth {

void add_arc_point(const OrderTables& tables, const Vec3q& p, quad dz, quad area, std::vector<quad>& legendre,
                   std::vector<quad>& sums) {
    reduced_legendre(tables, p.z, legendre);
    for (int l = 1; l < tables.order; ++l) {
        sums[coefficient_index(l, 0)] += area * legendre[cosine_index(l, 1)] / tables.derivative[l];
    }
    quad cos_part = p.x * dz;
    quad sin_part = p.y * dz;
    for (int m = 1; m < tables.order; ++m) {
        const quad cosine_factor = sin_part / m;
        const quad sine_factor = -cos_part / m;
        for (int l = m; l < tables.order; ++l) {
            sums[coefficient_index(l, m)] += cosine_factor * legendre[cosine_index(l, m)];
            sums[coefficient_index(l, -m)] += sine_factor * legendre[cosine_index(l, m)];
        }
        const quad turned = cos_part * p.x - sin_part * p.y;
        sin_part = cos_part * p.y + sin_part * p.x;
        cos_part = turned;
    }
}

Coefficients finished(std::vector<quad> sums, int order) {
    const quad sign = sums[0] < 0 ? -1 : 1;
    for (int l = 0; l < order; ++l) {
        for (int m = -l; m <= l; ++m) {
            sums[coefficient_index(l, m)] *= m == 0 ? sign : sign * sqrtf128(2);
        }
    }
    sums.resize(coefficient_count(order));
    return rounded(sums);
}

namespace {

std::vector<Vec3q> kept_part(std::span<const Vec3d> vertices, bool clip) {
    std::vector<Vec3q> kept;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3q a = quad_vector(vertices[i]);
        const Vec3q b = quad_vector(vertices[(i + 1) % vertices.size()]);
        if (!clip || a.z >= 0) {
            kept.push_back(a);
        }
        if (clip && ((a.z < 0 && b.z > 0) || (a.z > 0 && b.z < 0))) {
            Vec3q crossing = a + (a.z / (a.z - b.z)) * (b - a);
            crossing.z = 0;
            kept.push_back(crossing);
        }
    }
    return kept;
}

/// Twice the vector area.
Vec3q area_vector(const std::vector<Vec3q>& vertices) {
    Vec3q sum{0, 0, 0};
    for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
        sum = sum + cross(vertices[i] - vertices[0], vertices[i + 1] - vertices[0]);
    }
    return sum;
}

/// A great-circle edge, parametrised so that nodes crowd where the boost enlarges: tan(s/2) = tan(t/2) / crowding, s
/// the angle from the point nearest to the boost's axis.
struct CrowdedEdge {
    Vec3q start, along;
    quad crowding, first, last;

    CrowdedEdge(const PointwiseBoost& boost, const Vec3q& a, const Vec3q& pole, quad length_of_edge) {
        start = boost.axis() - dot(boost.axis(), pole) * pole;
        start = normalized(length(start) > 1e-20 ? start : a);
        along = cross(pole, start);
        const quad cosine = dot(start, boost.axis());
        const quad squared = (1 - cosine) / (1 + cosine);  // of the stereographic plane's radius at `start`
        const quad stretch = boost.stretch() * boost.stretch();
        crowding = sqrtf128((squared + stretch) / (1 + stretch * squared));
        const quad from = atan2f128(dot(a, along), dot(a, start));
        first = parameter(from);
        last = parameter(from + length_of_edge);
    }
    quad parameter(quad s) const {
        const quad half = atan2f128(crowding * sinf128(s / 2), cosf128(s / 2));
        return 2 * (s > pi() && half < 0 ? half + 2 * pi() : half);
    }
    struct Node {
        Vec3q point, step;
        quad speed;  ///< ds/dt
    };
    Node at(quad t) const {
        const quad c = cosf128(t / 2);
        const quad s = sinf128(t / 2);
        const quad square = crowding * crowding * c * c + s * s;
        const quad cosine = (crowding * crowding * c * c - s * s) / square;
        const quad sine = 2 * crowding * c * s / square;
        return {cosine * start + sine * along, cosine * along - sine * start, crowding / square};
    }
};

/// ∫ f over [first, last]; f(x, weight), smooth on the scale of 1 / wiggles.
template <class Function>
void gauss_integral(quad first, quad last, double wiggles, int extra_nodes, Function f) {
    const int count = 4 * static_cast<int>((0.27 * wiggles + 30) / 4) + extra_nodes;
    const GaussRule& rule = gauss_rule(count);
    for (int i = 0; i < count; ++i) {
        f(first + (last - first) * (1 + rule.nodes[i]) / 2, (last - first) * rule.weights[i] / 2);
    }
}

/// The image of the edge from a to b. `facing` is a unit vector that every point of the edge faces: slices about it
/// give the area before the boost.
void add_edge(const OrderTables& tables, const PointwiseBoost& boost, const Vec3q& a, const Vec3q& b,
              const Vec3q& facing, int extra_nodes, std::vector<quad>& sums) {
    const Vec3q normal = cross(a, b - a);
    if (!(length(normal) > 0)) {
        return;
    }
    const quad angle = atan2f128(length(normal), dot(a, b));
    const Vec3q pole = normalized(normal);
    const Vec3q start = normalized(a);
    const Vec3q along = cross(pole, start);
    gauss_integral(0, angle, (tables.order + 1) * static_cast<double>(angle), extra_nodes, [&](quad s, quad weight) {
        const Vec3q p = cosf128(s) * start + sinf128(s) * along;
        sums[0] += weight * tables.diagonal[0] * dot(facing, pole) / (1 + dot(facing, p));
    });
    const CrowdedEdge edge(boost, a, pole, angle);
    const double wiggles = (tables.order + 1) * static_cast<double>(edge.last - edge.first);
    std::vector<quad> legendre;
    gauss_integral(edge.first, edge.last, wiggles, extra_nodes, [&](quad t, quad weight) {
        const CrowdedEdge::Node node = edge.at(t);
        const PointwiseBoost::Image image = boost.image(node.point, node.step);
        const Vec3q& u = image.point;
        weight *= node.speed;
        sums[0] += weight * tables.diagonal[0] * image.area * dot(boost.axis(), pole);
        add_arc_point(tables, u, weight * image.step.z, weight * (u.x * image.step.y - u.y * image.step.x), legendre,
                      sums);
    });
}

/// Σ over the points of a fan, before the order-dependent part: direction and solid angle.
template <class Add>
void product_cubature(const std::vector<Vec3q>& vertices, int nodes, Add add) {
    const GaussRule& rule = gauss_rule(nodes);
    for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
        const Vec3q& a = vertices[0];
        const Vec3q u = vertices[i] - a;
        const Vec3q v = vertices[i + 1] - vertices[i];
        const Vec3q normal = cross(u, v);
        for (int j = 0; j < nodes * nodes; ++j) {
            const quad r = (1 + rule.nodes[j % nodes]) / 2;  // Duffy's map of the square to the triangle
            const quad t = (1 + rule.nodes[j / nodes]) / 2;
            const Vec3q point = a + r * (u + t * v);
            const quad distance = length(point);
            const quad weight = rule.weights[j % nodes] * rule.weights[j / nodes] / 4 * r;
            add((1 / distance) * point, weight * dot(normal, point) / (distance * distance * distance));
        }
    }
}

Coefficients by_edges(std::span<const Vec3d> vertices, const PointwiseBoost& boost, int order, bool clip,
                      int extra_nodes) {
    const OrderTables& tables = order_tables(std::max(order, 2));
    const std::vector<Vec3q> kept = kept_part(vertices, clip);
    std::vector<quad> sums(coefficient_count(tables.order));
    Vec3q facing = area_vector(kept);
    if (kept.size() >= 3 && length(facing) > 0) {
        facing = normalized(dot(facing, kept[0]) < 0 ? -1 * facing : facing);
        for (std::size_t i = 0; i < kept.size(); ++i) {
            add_edge(tables, boost, kept[i], kept[(i + 1) % kept.size()], facing, extra_nodes, sums);
        }
    }
    return finished(std::move(sums), order);
}

Coefficients by_cubature(std::span<const Vec3d> vertices, const PointwiseBoost& boost, int order, bool clip,
                         int nodes) {
    const OrderTables& tables = order_tables(order);
    const std::vector<Vec3q> kept = kept_part(vertices, clip);
    std::vector<quad> sums(coefficient_count(order));
    std::vector<quad> legendre;
    product_cubature(kept, nodes, [&](const Vec3q& direction, quad weight) {
        const PointwiseBoost::Image image = boost.image(direction);
        const Vec3q& p = image.point;
        reduced_legendre(tables, p.z, legendre);
        quad cos_part = weight * image.scale * image.scale;
        quad sin_part = 0;
        for (int m = 0; m < order; ++m) {
            for (int l = m; l < order; ++l) {
                const quad value = legendre[cosine_index(l, m)];
                sums[coefficient_index(l, -m)] += sin_part * value;  // nothing for m = 0
                sums[coefficient_index(l, m)] += cos_part * value;
            }
            const quad turned = cos_part * p.x - sin_part * p.y;
            sin_part = cos_part * p.y + sin_part * p.x;
            cos_part = turned;
        }
    });
    return finished(std::move(sums), order);
}

}  // namespace

Coefficients polygon(std::span<const Vec3d> vertices, int order, bool clip, int extra_nodes) {
    return by_edges(vertices, PointwiseBoost(), order, clip, extra_nodes);
}

Coefficients polygon_by_cubature(std::span<const Vec3d> vertices, int order, bool clip, int nodes) {
    return by_cubature(vertices, PointwiseBoost(), order, clip, nodes);
}

Coefficients boosted_polygon(std::span<const Vec3d> vertices, const BoostInput& boost, int order, int extra_nodes) {
    return by_edges(vertices, PointwiseBoost(boost), order, true, extra_nodes);
}

Coefficients boosted_polygon_by_cubature(std::span<const Vec3d> vertices, const BoostInput& boost, int order,
                                         int nodes) {
    return by_cubature(vertices, PointwiseBoost(boost), order, true, nodes);
}

}  // namespace shlight::truth
