// SPDX-License-Identifier: MIT
#include "lighting/ray_sums.h"

namespace shlight {

RaySums& RaySums::operator+=(const RaySums& other) {
    all += other.all;
    seen += other.seen;
    squares += other.squares;
    seen_squares += other.seen_squares;
    return *this;
}

RaySums& RaySums::operator*=(const Vec3d& factor) {
    all *= factor;
    seen *= factor;
    squares *= factor * factor;
    seen_squares *= factor * factor;
    return *this;
}

Vec3d quotient(const Vec3d& a, const Vec3d& b) {
    return {b.x > 0 ? a.x / b.x : 0, b.y > 0 ? a.y / b.y : 0, b.z > 0 ? a.z / b.z : 0};
}

Rgb deviation(const Rgb& unblocked, const Vec3d& share, const RaySums& sums) {
    const Vec3d one_over_rays = quotient(sums.squares, sums.all * sums.all);
    return unblocked * Rgb(glm::sqrt(glm::max(share * (1.0 - share), Vec3d(0)) * one_over_rays));
}

Rgb deviation(const RaySums& sums, double rays) {
    return Rgb(glm::sqrt(glm::max(sums.seen_squares - sums.seen * sums.seen / rays, Vec3d(0))));
}

}  // namespace shlight
