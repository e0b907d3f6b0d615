// SPDX-License-Identifier: MIT
#include "lobes/lambert.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/legendre.h"
#include "shlight/lobe_shape.h"

namespace shlight {

using std::numbers::pi;

double LambertShape::value(const Vec3d& wi, const Vec3d& /*wo*/) const {
    return wi.z / pi;
}

double LambertShape::albedo(double /*cos_theta_o*/) const {
    return 1;
}

Vec3d LambertShape::sample(const Vec3d& /*wo*/, const glm::dvec2& point) const {
    const double sine = std::sqrt(point.x);
    const double azimuth = 2 * pi * point.y;
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), std::sqrt(1 - point.x)};
}

double LambertShape::density(const Vec3d& /*wo*/, const Vec3d& wi) const {
    return wi.z / pi;
}

double LambertShape::largest_density(const Vec3d& /*wo*/) const {
    return 1 / pi;
}

void fit_lambert(int order, float* cosine_terms) {
    std::fill_n(cosine_terms, cosine_count(order), 0.0F);
    if (order == 1) {
        cosine_terms[at(0, 0)] = static_cast<float>(std::sqrt(4 * pi) / (2 * pi));
    } else {
        cosine_terms[at(1, 0)] = static_cast<float>(std::sqrt(4 * pi / 3) / pi);
    }
}

double lambert_error(int order) {
    return order == 1 ? 0.5 : 0.0;  // the mean of cosθ holds three quarters of ∫ cos²θ
}

std::vector<double> lambert_moments() {
    // Bands 0 and 1 and the even ones (Ramamoorthi & Hanrahan 2001, Eq. 19).
    std::vector<double> terms(kCosineMax, 0.0);
    terms[at(0, 0)] = std::sqrt(1 / (4 * pi));
    terms[at(1, 0)] = 2.0 / 3 * std::sqrt(3 / (4 * pi));
    double binomial = 0.5;  // l! / (2^l (l/2)!²)
    for (int l = 2; l < kMaxOrder; l += 2) {
        const double sign = l % 4 == 2 ? 2.0 : -2.0;
        terms[at(l, 0)] = sign * binomial / ((l + 2) * (l - 1)) * std::sqrt((2 * l + 1) / (4 * pi));
        binomial *= (l + 1.0) / (l + 2.0);
    }
    return terms;
}

}  // namespace shlight
