// SPDX-License-Identifier: MIT
#include "quad_cap.h"

#include <algorithm>

namespace shlight::truth {

CapAngles cap_angles(const Vec3q& axis, quad half) {
    const quad across = sqrtf128(axis.x * axis.x + axis.y * axis.y);
    CapAngles angles{atan2f128(across, axis.z), half, 1, 0};
    if (across > 0) {
        angles.cos_azimuth = axis.x / across;
        angles.sin_azimuth = axis.y / across;
    }
    return angles;
}

namespace {

CapAngles cap_angles(const CapInput& input) {
    const Vec3q axis = quad_vector(input.axis);
    return cap_angles(axis, half_angle(input));
}

/// ∮ along the cap's edge, ψ = -reach … reach from its highest point, and along the horizon, φ = -arc … arc.
struct KeptEdge {
    quad reach, horizon_arc;
};

KeptEdge kept_edge(const CapAngles& cap, quad horizon) {
    const quad whole = cap.tilt + cap.half + horizon;
    const quad apart = cap.tilt - cap.half - horizon;
    const quad light_larger = cap.half - cap.tilt - horizon;
    const quad light_smaller = horizon - cap.tilt - cap.half;
    if (apart >= 0) {
        return {0, 0};
    }
    if (light_smaller >= 0) {
        return {pi(), 0};
    }
    if (light_larger >= 0) {
        return {0, pi()};
    }
    if (whole >= 2 * pi()) {
        return {pi(), pi()};
    }
    // The angles of the spherical triangle of both poles and a crossing, by the half-angle formulas.
    const quad s = sinf128(whole / 2);
    const quad s_tilt = sinf128(-apart / 2);
    const quad s_half = sinf128(-light_larger / 2);
    const quad s_horizon = sinf128(-light_smaller / 2);
    return {2 * atan2f128(sqrtf128(s_tilt * s_half), sqrtf128(s * s_horizon)),
            2 * atan2f128(sqrtf128(s_tilt * s_horizon), sqrtf128(s * s_half))};
}

/// Adds weight times the slice integrands at one edge point: step·dz and, for m = 0, x dy - y dx.
/// (1 - z²) P̄_l^0' / (l(l+1)) = ∫_z^1 P̄_l^0 dz' is Legendre's equation; its factor 1 - z² cancels that of dφ.
void add_edge_point(const OrderTables& tables, const Vec3q& p, quad dz, quad area, std::vector<quad>& legendre,
                    std::vector<quad>& sums) {
    reduced_legendre(tables, p.z, legendre);
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

/// A point on the cap's edge, with the axis in the xz-plane and ψ from the highest point; and its derivative.
struct EdgePoint {
    Vec3q p, dp;

    EdgePoint(const CapAngles& cap, quad psi) {
        const quad cos_tilt = cosf128(cap.tilt);
        const quad sin_tilt = sinf128(cap.tilt);
        const quad sin_half = sinf128(cap.half);
        const quad inward = cosf128(cap.half);
        const quad forward = -cosf128(psi) * sin_half;
        const quad side = -sinf128(psi) * sin_half;
        p = {inward * sin_tilt + forward * cos_tilt, side, inward * cos_tilt - forward * sin_tilt};
        dp = {-side * cos_tilt, forward, side * sin_tilt};
    }
    quad area() const { return p.x * dp.y - p.y * dp.x; }
};

/// The cap edge's part of the cosine terms of bands above 0.
void add_cap_edge(const CapAngles& cap, quad reach, int extra_nodes, const OrderTables& tables,
                  std::vector<quad>& sums) {
    const double wiggles = (tables.order + 1) * static_cast<double>(reach);
    const int count = 4 * static_cast<int>((0.27 * wiggles + 30) / 4) + extra_nodes;
    const GaussRule& rule = gauss_rule(count);
    std::vector<quad> legendre;
    for (int i = 0; i < count; ++i) {  // the mirror plane y = 0 leaves half of the edge
        const EdgePoint edge(cap, reach * (1 + rule.nodes[i]) / 2);
        const quad weight = reach * rule.weights[i];
        add_edge_point(tables, edge.p, weight * edge.dp.z, weight * edge.area(), legendre, sums);
    }
}

/// ∫ (1 - z) dφ along the cap's edge. The integrand changes fast where the edge is near the south pole, at ψ close to
/// π: panels shrink towards that point.
quad edge_area(const CapAngles& cap, quad reach, int extra_nodes) {
    const GaussRule& rule = gauss_rule(28 + extra_nodes);
    const auto panel = [&](quad from, quad to) {
        quad sum = 0;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const EdgePoint edge(cap, from + (to - from) * (1 + rule.nodes[i]) / 2);
            sum += (to - from) * rule.weights[i] * edge.area() / (1 + edge.p.z);
        }
        return sum;
    };
    quad area = 0;
    quad from = 0;
    for (quad rest = pi() / 2; rest > quad(1e-6) && pi() - rest < reach; rest /= 2) {
        area += panel(from, pi() - rest);
        from = pi() - rest;
    }
    return area + panel(from, reach);
}

/// Cosine terms about the axis' azimuth (without √2) to coefficients.
Coefficients turned(const CapAngles& angles, const std::vector<quad>& cosine_terms, int order) {
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

/// Full circles of latitude between two colatitudes.
void add_circles(const OrderTables& tables, quad from, quad to, std::vector<quad>& sums) {
    const GaussRule& rule = gauss_rule(2 * tables.order + 40);
    for (std::size_t i = 0; i < rule.nodes.size() && from < to; ++i) {
        add_slice(tables, from + (to - from) * (1 + rule.nodes[i]) / 2, (to - from) * rule.weights[i] / 2, pi(), sums);
    }
}

}  // namespace

quad half_angle(const CapInput& input) {
    const quad distance = length(quad_vector(input.axis));
    const quad size = input.size;
    switch (input.kind) {
        case CapInput::Kind::sphere:
            // Lengths that are equal in double may differ here.
            return size < distance ? atan2f128(size, sqrtf128((distance - size) * (distance + size))) : pi() / 2;
        case CapInput::Kind::facing_disk:
            return atan2f128(size, distance);
        case CapInput::Kind::angle:
            break;
    }
    return size;
}

Coefficients cap_above(const CapAngles& cap, quad horizon, int order, int extra_nodes) {
    const OrderTables& tables = order_tables(std::max(order, 2));
    const KeptEdge edge = kept_edge(cap, horizon);
    std::vector<quad> sums(cosine_count(tables.order));
    if (edge.reach > 0) {
        add_cap_edge(cap, edge.reach, extra_nodes, tables, sums);
    }
    if (edge.horizon_arc > 0) {
        std::vector<quad> at_horizon;
        reduced_legendre(tables, cosf128(horizon), at_horizon);
        const quad area = 2 * edge.horizon_arc * sinf128(horizon) * sinf128(horizon);
        for (int l = 1; l < tables.order; ++l) {
            sums[cosine_index(l, 0)] += area * at_horizon[cosine_index(l, 1)] / tables.derivative[l];
        }
    }
    if (horizon < pi()) {
        const quad s = sinf128(horizon / 2);
        const quad own = edge.reach > 0 ? edge_area(cap, edge.reach, extra_nodes) : quad(0);
        sums[0] = (own + 4 * edge.horizon_arc * s * s) * tables.diagonal[0];
    } else {  // Archimedes; the slices' own form is singular where the edge passes the south pole
        const quad s = sinf128(cap.half / 2);
        sums[0] = 4 * pi() * s * s * tables.diagonal[0];
    }
    return turned(cap, sums, order);
}

Coefficients cap_by_slices(const CapAngles& cap, quad horizon, int order) {
    const OrderTables& tables = order_tables(order);
    const quad tilt = cap.tilt;
    const quad half = cap.half;
    const bool southern = tilt + half > pi();  // the cap contains the south pole
    const quad low = fabsf128(tilt - half);    // colatitudes that the edge crosses
    const quad last = southern ? 2 * pi() - tilt - half : tilt + half;
    const quad high = std::min(last, horizon);
    std::vector<quad> sums(cosine_count(order));
    if (tilt < half) {
        add_circles(tables, 0, std::min(low, horizon), sums);
    }
    if (southern) {
        add_circles(tables, last, horizon, sums);
    }
    const quad step = quad(1) / 64;
    for (int k = -280; k <= 280 && low < high; ++k) {
        const quad up = expf128(k * step);
        const quad stretch = pi() / 2 * (up - 1 / up);
        const quad low_share = 1 / (1 + expf128(-stretch));
        const quad high_share = 1 / (1 + expf128(stretch));
        const quad from_low = (high - low) * low_share;  // distances from the ends carry no cancellation
        const quad from_last = (high - low) * high_share + (last - high);
        const quad colatitude = low + from_low;
        // Half-angle formula of the spherical triangle pole, axis, edge point; each sine is of s minus one side.
        const quad s_minus_tilt = tilt < half ? half + colatitude - tilt : from_low;
        const quad s_minus_half = tilt < half ? from_low : tilt + colatitude - half;
        const quad s_minus_colatitude = southern ? tilt + half - colatitude : from_last;
        const quad s =
            southern ? from_last : tilt + half + colatitude;  // of 2π less the perimeter, or of the perimeter
        const quad arc = 2 * atan2f128(sqrtf128(sinf128(s_minus_tilt / 2) * sinf128(s_minus_colatitude / 2)),
                                       sqrtf128(sinf128(s / 2) * sinf128(s_minus_half / 2)));
        const quad stride = pi() / 2 * (up + 1 / up) * step;
        add_slice(tables, colatitude, (high - low) * low_share * high_share * stride, arc, sums);
    }
    return turned(cap, sums, order);
}

Coefficients cap(const CapInput& input, int order, bool clip, int extra_nodes) {
    return cap_above(cap_angles(input), clip ? pi() / 2 : pi(), order, extra_nodes);
}

Coefficients cap_by_slices(const CapInput& input, int order, bool clip) {
    return cap_by_slices(cap_angles(input), clip ? pi() / 2 : pi(), order);
}

Coefficients cap_above(const CapInput& input, double height, double sine, int order, int extra_nodes) {
    return cap_above(cap_angles(input), atan2f128(sine, height), order, extra_nodes);
}

Coefficients cap_above_by_slices(const CapInput& input, double height, double sine, int order) {
    return cap_by_slices(cap_angles(input), atan2f128(sine, height), order);
}

}  // namespace shlight::truth
