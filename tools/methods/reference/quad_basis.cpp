// SPDX-License-Identifier: MIT
#include "quad_math.h"

namespace shlight::truth {

namespace {

/// ((l+m)! (l-m)!)^½ / l!, what is left of the factorials in K_l^m and in Laplace's integral.
quad factorial_ratio(int l, int m) {
    quad square = 1;
    for (int k = 1; k <= m; ++k) {
        square *= quad(l + k) / (l - m + k);
    }
    return sqrtf128(square);
}

}  // namespace

Coefficients basis(const Vec3d& direction, int order) {
    const Vec3q p = normalized(quad_vector(direction));
    const quad across = sqrtf128(p.x * p.x + p.y * p.y);
    const int points = 2 * order;  // the integrand's highest frequency is l + m < 2·order
    // Re and Im of (z + i·across·cos t)^l cos(mt), averaged over one turn; i^{-m} picks the part that is not zero.
    std::vector<quad> sums(cosine_count(order));
    for (int k = 0; k < points; ++k) {
        const quad slope = across * cosf128(2 * pi() * k / points);
        std::vector<quad> cosines(order);
        for (int m = 0; m < order; ++m) {
            cosines[m] = cosf128(2 * pi() * ((m * k) % points) / points);
        }
        quad re = 1;
        quad im = 0;
        for (int l = 0; l < order; ++l) {
            for (int m = 0; m <= l; ++m) {
                const quad part = m % 2 == 0 ? re : im;
                sums[cosine_index(l, m)] += (m % 4 < 2 ? part : -part) * cosines[m] / points;
            }
            const quad next = re * p.z - im * slope;
            im = re * slope + im * p.z;
            re = next;
        }
    }
    std::vector<quad> values(coefficient_count(order));
    quad cos_m = 1;
    quad sin_m = 0;
    for (int m = 0; m < order; ++m) {
        for (int l = m; l < order; ++l) {
            const quad scale = sqrtf128((2 * l + 1) / (4 * pi()) * (m == 0 ? 1 : 2)) * factorial_ratio(l, m);
            values[coefficient_index(l, -m)] = scale * sums[cosine_index(l, m)] * sin_m;
            values[coefficient_index(l, m)] = scale * sums[cosine_index(l, m)] * cos_m;
        }
        const quad x = across > 0 ? p.x / across : quad(1);
        const quad y = across > 0 ? p.y / across : quad(0);
        const quad next = cos_m * x - sin_m * y;
        sin_m = cos_m * y + sin_m * x;
        cos_m = next;
    }
    return rounded(values);
}

}  // namespace shlight::truth
