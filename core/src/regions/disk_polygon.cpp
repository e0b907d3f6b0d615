// SPDX-License-Identifier: MIT
#include "regions/disk_polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace shlight {
namespace {

/// Vertices that a tolerance of 1e-4 takes, by the sine of the longer half angle (tests/core/test_disk_light.cpp).
constexpr double kTolerance = 1e-4;
struct Size {
    double up_to;
    int vertices;
};
constexpr std::array<Size, 5> kSizes = {Size{0.02, 8}, {0.1, 16}, {0.5, 24}, {0.8, 32}, {1, 40}};
/// Fewest vertices of a disk that the horizon cuts, or whose polygon it would cut.
constexpr int kLeastAtHorizon = 32;
constexpr double kMostOutside = 1.1;  ///< the farthest corner, from the middle
/// Vertices for each length of the boundary over which a lobe changes.
constexpr double kPerWidth = 2;
constexpr int kOfMirror = 128;
constexpr int kMost = 512;
/// Vertices that suffice where the horizon is far, by the longer half angle over the distance on which a lobe changes
/// there: measured over random lobes, views and disks (95th percentile of the error of what is reflected).
constexpr std::array<Size, 4> kSmallSizes = {
    Size{0.15, 8}, {0.5, 16}, {0.9, 24}, {std::numeric_limits<double>::infinity(), kMost}};

template <std::size_t kCount>
double vertices_for(const std::array<Size, kCount>& sizes, double size) {
    return std::find_if(sizes.begin(), sizes.end() - 1, [&](const Size& s) { return size <= s.up_to; })->vertices;
}

/// An angle from the ellipse's short axis to its long one, in units of both: a point of the unit circle.
struct Turn {
    double sine, cosine;
};

Turn turn_at(const SphericalEllipse& ellipse, double u) {
    const auto f = ellipse.functions().at(u);
    return {ellipse.cone().complement * f.sn / f.dn, f.cn / f.dn};
}

double sine_between(const Turn& a, const Turn& b) {
    return b.sine * a.cosine - b.cosine * a.sine;
}
double angle_between(const Turn& a, const Turn& b) {
    return std::atan2(sine_between(a, b), a.cosine * b.cosine + a.sine * b.sine);
}

/// Points of the plane across the cone's axis, at distance 1.
class AcrossAxis {
  public:
    explicit AcrossAxis(const Cone& cone)
        : cone_(cone),
          along_(cone.sin_long / cone.cos_long * cone.long_axis),
          across_(cone.sin_short / cone.cos_short * cone.short_axis) {}

    /// The ellipse's point at this angle, moved away from the middle.
    Vec3d at(const Turn& turn, double scale) const {
        return cone_.axis + (scale * turn.sine) * along_ + (scale * turn.cosine) * across_;
    }
    /// The one in the direction of the boundary.
    Vec3d towards(const Vec3d& direction) const {
        // No point of the boundary is farther from the axis than the long axis' end.
        return direction / std::max(cone_.cos_long, glm::dot(direction, cone_.axis));
    }

  private:
    const Cone& cone_;
    Vec3d along_, across_;
};

/// Two sides from the ellipse to a vertex and back, over the angles between these points, cover what the ellipse does.
double scale_over(const Turn& before, const Turn& middle, const Turn& after) {
    return (angle_between(before, middle) + angle_between(middle, after)) /
           (sine_between(before, middle) + sine_between(middle, after));
}

/// The same in each quarter.
void append_closed(const SphericalEllipse& ellipse, int size, std::vector<Vec3d>& vertices) {
    const AcrossAxis plane(ellipse.cone());
    const auto quarter = static_cast<std::size_t>(size / 4);
    std::array<Turn, kMost / 4 + 2> turns;  // the quarter's and a neighbour on both sides
    for (std::size_t i = 1; i <= quarter; ++i) {
        turns[i] = turn_at(ellipse, ellipse.functions().quarter_period() * (static_cast<double>(i) - 0.5) /
                                        static_cast<double>(quarter));
    }
    turns[0] = {-turns[1].sine, turns[1].cosine};
    turns[quarter + 1] = {turns[quarter].sine, -turns[quarter].cosine};
    const std::size_t first = vertices.size();
    vertices.resize(first + 4 * quarter);
    for (std::size_t i = 1; i <= quarter; ++i) {
        const Turn turn = turns[i];
        const double step = angle_between(turns[i - 1], turns[i + 1]) / 2;
        const double scale = std::sqrt(step / std::sin(step));
        Vec3d* const own = &vertices[first];
        own[i - 1] = plane.at(turn, scale);
        own[2 * quarter - i] = plane.at({turn.sine, -turn.cosine}, scale);
        own[2 * quarter + i - 1] = plane.at({-turn.sine, -turn.cosine}, scale);
        own[4 * quarter - i] = plane.at({-turn.sine, turn.cosine}, scale);
    }
}

/// Vertices from one end of the horizon's chord to the other; every other one is a point of the ellipse.
void append_cut(const SphericalEllipse& ellipse, int size, std::vector<Vec3d>& vertices) {
    const AcrossAxis plane(ellipse.cone());
    const HorizonCut& cut = *ellipse.cut();
    const int sides = size - 2;
    const double step = (cut.to - cut.from) / sides;
    Turn before = turn_at(ellipse, cut.from);
    vertices.push_back(plane.towards(cut.first));
    for (int i = 1; i < sides; i += 2) {
        const Turn middle = turn_at(ellipse, cut.from + i * step);
        const Turn after = turn_at(ellipse, cut.from + (i + 1) * step);
        vertices.push_back(plane.at(middle, scale_over(before, middle, after)));
        vertices.push_back(i + 1 < sides ? plane.at(after, 1) : plane.towards(cut.last));
        before = after;
    }
    vertices.push_back(vertices.back());
}

bool meets_horizon(const SphericalEllipse& ellipse) {
    const Cone& cone = ellipse.cone();
    const double rise = std::hypot(cone.sin_long / cone.cos_long * cone.long_axis.z,
                                   cone.sin_short / cone.cos_short * cone.short_axis.z);
    return ellipse.cut() || cone.axis.z < kMostOutside * rise;
}

}  // namespace

int disk_polygon_size(const SphericalEllipse& ellipse, double narrowest, double near, double tolerance) {
    if (narrowest == 0) {
        return kOfMirror;
    }
    const Cone& cone = ellipse.cone();
    double vertices = std::max(vertices_for(kSizes, cone.sin_long), kPerWidth * ellipse.boundary() / narrowest);
    if (meets_horizon(ellipse)) {
        vertices = std::max<double>(vertices, kLeastAtHorizon);
    } else {
        vertices = std::min(vertices, vertices_for(kSmallSizes, cone.sin_long / (cone.cos_long * near)));
    }
    vertices *= std::pow(kTolerance / std::clamp(tolerance, 1e-5, 1e-2), 0.25);
    const int size = kDiskPolygonStep * static_cast<int>(std::ceil(vertices / kDiskPolygonStep));
    return std::clamp(size, kDiskPolygonStep, kMost);
}

void append_disk_polygon(const SphericalEllipse& ellipse, int size, std::vector<Vec3d>& vertices) {
    if (ellipse.cut()) {
        append_cut(ellipse, size, vertices);
    } else {
        append_closed(ellipse, size, vertices);
    }
}

}  // namespace shlight
