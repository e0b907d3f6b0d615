// SPDX-License-Identifier: MIT
#include <algorithm>

#include "quad_math.h"

namespace shlight::truth {

namespace {

/// Tilt and half angle as angles, and the axis' azimuth.
struct Angles {
    quad tilt, half;
    quad cos_azimuth, sin_azimuth;
};

Angles angles_of(const CapInput& input) {
    const Vec3q axis = quad_vector(input.axis);
    const quad across = sqrtf128(axis.x * axis.x + axis.y * axis.y);
    const quad distance = length(axis);
    const quad size = input.size;
    Angles angles{atan2f128(across, axis.z), size, 1, 0};
    if (across > 0) {
        angles.cos_azimuth = axis.x / across;
        angles.sin_azimuth = axis.y / across;
    }
    if (input.kind == CapInput::Kind::sphere) {
        angles.half = atan2f128(size, sqrtf128((distance - size) * (distance + size)));
    } else if (input.kind == CapInput::Kind::facing_disk) {
        angles.half = atan2f128(size, distance);
    }
    return angles;
}

/// ∮ along the cap's own edge, ψ = -reach … reach from its highest point, and along the horizon, φ = -arc … arc.
struct KeptEdge {
    quad reach, horizon_arc;
};

KeptEdge kept_edge(const Angles& angles, bool clip) {
    if (!clip) {
        return {pi(), 0};
    }
    const quad tilt = angles.tilt;
    const quad half = angles.half;
    // The horizon cuts the edge where sin(half) sin(tilt) cosψ = -cos(half) cos(tilt); this is sin²(half) sin²(ψ)
    // there.
    const quad chord_squared = -cosf128(tilt + half) * cosf128(tilt - half);
    const quad inside = cosf128(half) * cosf128(tilt);
    if (chord_squared <= 0) {
        return {inside > 0 ? pi() : 0, -sinf128(tilt) >= cosf128(half) ? pi() : 0};
    }
    const quad chord = sqrtf128(chord_squared);
    return {atan2f128(chord, -inside), atan2f128(chord, cosf128(half))};
}

/// Adds weight times the slice integrands at one edge point: step·dz and, for m = 0, x dy - y dx.
/// (1 - z²) P̄_l^0' / (l(l+1)) = ∫_z^1 P̄_l^0 dz' is Legendre's equation; its factor 1 - z² cancels that of dφ.
void add_edge_point(const OrderTables& tables, const Vec3q& p, quad dz, quad area, std::vector<quad>& legendre,
                    std::vector<quad>& sums) {
    reduced_legendre(tables, p.z, legendre);
    sums[0] += area / (1 + p.z) * tables.diagonal[0];
    for (int l = 1; l < tables.order; ++l) {
        sums[cosine_index(l, 0)] += area * legendre[cosine_index(l, 1)] / tables.derivative[l];
    }
    quad cos_part = p.x;  // Re and Im of (x + iy)^m
    quad sin_part = p.y;
    for (int m = 1; m < tables.order; ++m) {
        const quad factor = sin_part * dz / m;
        for (int l = m; l < tables.order; ++l) {
            sums[cosine_index(l, m)] += factor * legendre[cosine_index(l, m)];
        }
        const quad turned = cos_part * p.x - sin_part * p.y;
        sin_part = cos_part * p.y + sin_part * p.x;
        cos_part = turned;
    }
}

/// The part of the cosine terms that the cap's own edge gives, axis in the xz-plane.
void add_cap_edge(const Angles& angles, quad reach, int extra_nodes, const OrderTables& tables,
                  std::vector<quad>& sums) {
    const quad cos_tilt = cosf128(angles.tilt);
    const quad sin_tilt = sinf128(angles.tilt);
    const quad cos_half = cosf128(angles.half);
    const quad sin_half = sinf128(angles.half);
    const double wiggles = (tables.order + 1) * static_cast<double>(reach);
    const int count = 4 * static_cast<int>((0.27 * wiggles + 30) / 4) + extra_nodes;
    const GaussRule& rule = gauss_rule(count);
    std::vector<quad> legendre;
    for (int i = 0; i < count; ++i) {  // the mirror plane y = 0 leaves half of the edge
        const quad psi = reach * (1 + rule.nodes[i]) / 2;
        const quad weight = reach * rule.weights[i];
        const quad forward = -cosf128(psi) * sin_half;
        const quad side = -sinf128(psi) * sin_half;
        const Vec3q p{cos_half * sin_tilt + forward * cos_tilt, side, cos_half * cos_tilt - forward * sin_tilt};
        const Vec3q dp{-side * cos_tilt, forward, side * sin_tilt};
        add_edge_point(tables, p, weight * dp.z, weight * (p.x * dp.y - p.y * dp.x), legendre, sums);
    }
}

/// Cosine terms about the axis' azimuth (without √2) to coefficients.
Coefficients turned(const Angles& angles, const std::vector<quad>& cosine_terms, int order) {
    std::vector<quad> result(coefficient_count(order));
    quad cos_m = 1;
    quad sin_m = 0;
    for (int m = 0; m < order; ++m) {
        const quad scale = m == 0 ? quad(1) : sqrtf128(2);
        for (int l = m; l < order; ++l) {
            const quad value = scale * cosine_terms[cosine_index(l, m)];
            result[coefficient_index(l, -m)] = value * sin_m;
            result[coefficient_index(l, m)] = value * cos_m;
        }
        const quad next = cos_m * angles.cos_azimuth - sin_m * angles.sin_azimuth;
        sin_m = cos_m * angles.sin_azimuth + sin_m * angles.cos_azimuth;
        cos_m = next;
    }
    return rounded(result);
}

/// Adds the circle of one colatitude, kept for longitudes -arc … arc.
void add_slice(const OrderTables& tables, quad colatitude, quad weight, quad arc, std::vector<quad>& sums) {
    std::vector<quad> legendre;
    reduced_legendre(tables, cosf128(colatitude), legendre);
    quad factor = weight * sinf128(colatitude);
    for (int m = 0; m < tables.order; ++m) {
        const quad longitude_integral = m == 0 ? 2 * arc : 2 * sinf128(m * arc) / m;
        for (int l = m; l < tables.order; ++l) {
            sums[cosine_index(l, m)] += factor * longitude_integral * legendre[cosine_index(l, m)];
        }
        factor *= sinf128(colatitude);
    }
}

}  // namespace

Coefficients cap(const CapInput& input, int order, bool clip, int extra_nodes) {
    const OrderTables& tables = order_tables(std::max(order, 2));
    const Angles angles = angles_of(input);
    const KeptEdge edge = kept_edge(angles, clip);
    std::vector<quad> sums(cosine_count(tables.order));
    if (edge.reach > 0) {
        add_cap_edge(angles, edge.reach, extra_nodes, tables, sums);
    }
    if (edge.horizon_arc > 0) {
        std::vector<quad> at_horizon;
        reduced_legendre(tables, 0, at_horizon);
        sums[0] += 2 * edge.horizon_arc * tables.diagonal[0];
        for (int l = 1; l < tables.order; ++l) {
            sums[cosine_index(l, 0)] += 2 * edge.horizon_arc * at_horizon[cosine_index(l, 1)] / tables.derivative[l];
        }
    }
    if (!clip) {  // Archimedes; the slices' own form is singular where the edge passes the south pole
        const quad s = sinf128(angles.half / 2);
        sums[0] = 4 * pi() * s * s * tables.diagonal[0];
    }
    return turned(angles, sums, order);
}

Coefficients cap_by_slices(const CapInput& input, int order, bool clip) {
    const OrderTables& tables = order_tables(order);
    const Angles angles = angles_of(input);
    const quad tilt = angles.tilt;
    const quad half = angles.half;
    const quad low = fabsf128(tilt - half);  // colatitudes that the edge crosses
    const quad high = clip ? std::min(tilt + half, pi() / 2) : tilt + half;
    std::vector<quad> sums(cosine_count(order));
    if (tilt < half) {  // full circles of latitude
        const GaussRule& rule = gauss_rule(2 * order + 40);
        const quad end = clip ? std::min(low, pi() / 2) : low;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            add_slice(tables, end * (1 + rule.nodes[i]) / 2, end * rule.weights[i] / 2, pi(), sums);
        }
    }
    const quad step = quad(1) / 64;
    for (int k = -280; k <= 280 && low < high; ++k) {
        const quad up = expf128(k * step);
        const quad stretch = pi() / 2 * (up - 1 / up);
        const quad low_share = 1 / (1 + expf128(-stretch));
        const quad high_share = 1 / (1 + expf128(stretch));
        const quad from_low = (high - low) * low_share;  // distances from the ends carry no cancellation
        const quad from_edge = (high - low) * high_share + (tilt + half - high);
        const quad colatitude = low + from_low;
        // Half-angle formula of the spherical triangle pole, axis, edge point; each sine is of s minus one side.
        const quad s_minus_tilt = tilt < half ? half + colatitude - tilt : from_low;
        const quad s_minus_half = tilt < half ? from_low : tilt + colatitude - half;
        const quad arc = 2 * atan2f128(sqrtf128(sinf128(s_minus_tilt / 2) * sinf128(from_edge / 2)),
                                       sqrtf128(sinf128((tilt + half + colatitude) / 2) * sinf128(s_minus_half / 2)));
        const quad stride = pi() / 2 * (up + 1 / up) * step;
        add_slice(tables, colatitude, (high - low) * low_share * high_share * stride, arc, sums);
    }
    return turned(angles, sums, order);
}

}  // namespace shlight::truth
