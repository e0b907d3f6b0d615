// SPDX-License-Identifier: MIT
#include "lobes/lobe_sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shlight {

using std::numbers::pi;

LobeSampler::LobeSampler(double alpha, const Vec3d& view)
    : alpha_(alpha), view_(view), stretched_view_(glm::normalize(Vec3d(alpha * view.x, alpha * view.y, view.z))) {
    // G₁ = 2 cosθ_o / (cosθ_o + √(α² + (1-α²) cos²θ_o)), finite at grazing angles once cosθ_o is gone.
    const double a2 = alpha * alpha;
    factor_ = 0.5 / (view.z + std::sqrt(a2 + (1 - a2) * view.z * view.z));
}

Vec3d LobeSampler::sample(const glm::dvec2& point) const {
    // A hemisphere reflects the parallel rays that it sees evenly into the cap of z > -cosine of the view.
    const double z = (1 - point.y) * (1 + stretched_view_.z) - stretched_view_.z;
    const double sine = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
    const double azimuth = 2 * pi * point.x;
    const Vec3d h = Vec3d(sine * std::cos(azimuth), sine * std::sin(azimuth), z) + stretched_view_;
    const Vec3d normal = glm::normalize(Vec3d(alpha_ * h.x, alpha_ * h.y, h.z));
    return glm::normalize(2 * glm::dot(view_, normal) * normal - view_);
}

double LobeSampler::density(const Vec3d& direction) const {
    const Vec3d sum = direction + view_;
    const double square = glm::dot(sum, sum);
    // As in f·cos: sin²θ_h rather than 1 - cos²θ_h.
    const double bell = alpha_ * alpha_ * sum.z * sum.z + (sum.x * sum.x + sum.y * sum.y);
    const double ratio = alpha_ * square / bell;
    return factor_ * ratio * ratio / pi;
}

double LobeSampler::largest_density() const {
    return factor_ / (pi * alpha_ * alpha_);
}

}  // namespace shlight
