// SPDX-License-Identifier: MIT
//
// What shadow rays tell, in each colour channel.
#pragma once

#include "shlight/types.h"

namespace shlight {

/// Sums over the rays of a hit: of their weights times radiance times a lobe's f·cos, and of its squares; of all rays,
/// and of those that nothing blocks.
struct RaySums {
    Vec3d all{0}, seen{0}, squares{0}, seen_squares{0};

    /// visible: the share of it that is not hidden.
    void add(const Vec3d& value, const Rgb& visible) {
        all += value;
        squares += value * value;
        if (visible == Rgb(1)) {
            seen += value;
            seen_squares += value * value;
        } else if (visible != Rgb(0)) {
            seen += value * Vec3d(visible);
            seen_squares += value * value * Vec3d(visible);
        }
    }
    RaySums& operator+=(const RaySums& other);
    /// Multiplies each weight.
    RaySums& operator*=(const Vec3d& factor);
};

/// The same of rays whose values are alike in all channels, and of which each is hidden or not.
struct GreySums {
    double all = 0, seen = 0, squares = 0, seen_squares = 0;

    void add(double value, bool visible) {
        const double own = visible ? value : 0.0;
        all += value;
        squares += value * value;
        seen += own;
        seen_squares += own * own;
    }
    explicit operator RaySums() const { return {Vec3d(all), Vec3d(seen), Vec3d(squares), Vec3d(seen_squares)}; }
};

inline double mean(const Vec3d& color) {
    return (color.x + color.y + color.z) / 3;
}
inline Vec3d squared(const Rgb& color) {
    return Vec3d(color) * Vec3d(color);
}
/// a / b, 0 where b is not positive.
Vec3d quotient(const Vec3d& a, const Vec3d& b);

/// Standard deviation of the share of the light that a hit's rays see, times `unblocked`. share: what rays of the whole
/// pixel see, since the few of one hit often agree by chance.
Rgb deviation(const Rgb& unblocked, const Vec3d& share, const RaySums& sums);

/// Standard deviation of the sum of what so many rays of a hit see, by themselves.
Rgb deviation(const RaySums& sums, double rays);

}  // namespace shlight
