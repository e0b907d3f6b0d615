// SPDX-License-Identifier: MIT
#include "disks/disk_polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace shlight {
namespace {

using std::numbers::pi;

/// Vertices that a tolerance of 1e-4 takes, by the sine of the longer half angle (tests/core/test_disk_light.cpp).
constexpr double kTolerance = 1e-4;
struct Size {
    double up_to;
    int vertices;
};
constexpr std::array<Size, 5> kSizes = {Size{0.02, 8}, {0.1, 16}, {0.5, 24}, {0.8, 32}, {1, 40}};
/// Where the horizon cuts, or would cut off corners.
constexpr int kLeastAtHorizon = 32;
constexpr double kMostOutside = 1.1;  ///< the farthest corner, from the middle
/// Of the outline over which a lobe changes.
constexpr double kPerWidth = 2;
constexpr int kOfMirror = 128;
constexpr int kMost = 512;

/// Points of the plane across the cone's axis, at distance 1.
class AcrossAxis {
  public:
    explicit AcrossAxis(const Cone<double>& cone)
        : cone_(cone),
          along_(cone.sin_long / cone.cos_long * cone.long_axis),
          across_(cone.sin_short / cone.cos_short * cone.short_axis) {}

    /// The ellipse's point at this angle, from the short axis to the long one, moved away from the middle.
    Vec3d at(double angle, double scale) const {
        return cone_.axis + scale * (std::sin(angle) * along_ + std::cos(angle) * across_);
    }
    /// The one in the direction of the outline.
    Vec3d towards(const Vec3d& direction) const {
        // No point of the outline is farther from the axis than the long axis' end.
        return direction / std::max(cone_.cos_long, glm::dot(direction, cone_.axis));
    }

  private:
    const Cone<double>& cone_;
    Vec3d along_, across_;
};

double angle_at(const SphericalEllipse<double>& ellipse, double u) {
    const auto f = ellipse.functions().at(u);
    return std::atan2(ellipse.cone().complement * f.sn, f.cn);
}

/// Two sides from the ellipse to a vertex and back, over these angles, cover what the ellipse does.
double scale_over(double first, double second) {
    return (first + second) / (std::sin(first) + std::sin(second));
}

/// The same in each quarter.
void append_closed(const SphericalEllipse<double>& ellipse, int size, std::vector<Vec3d>& vertices) {
    const AcrossAxis plane(ellipse.cone());
    const int quarter = size / 4;
    std::array<double, kMost / 4 + 2> angles{};  // with the neighbours
    for (int i = 1; i <= quarter; ++i) {
        angles[static_cast<std::size_t>(i)] =
            angle_at(ellipse, ellipse.functions().quarter_period() * (i - 0.5) / quarter);
    }
    angles[0] = -angles[1];
    angles[static_cast<std::size_t>(quarter) + 1] = pi - angles[static_cast<std::size_t>(quarter)];
    for (int i = 0; i < size; ++i) {
        const int turn = i / quarter;
        const bool backwards = turn % 2 == 1;
        const auto k = static_cast<std::size_t>(backwards ? quarter - i % quarter : 1 + i % quarter);
        const double step = (angles[k + 1] - angles[k - 1]) / 2;
        const double start = pi / 2 * (turn + (backwards ? 1 : 0));
        vertices.push_back(
            plane.at(backwards ? start - angles[k] : start + angles[k], std::sqrt(step / std::sin(step))));
    }
}

/// From one end of the horizon's chord to the other; every other vertex is a point of the ellipse.
void append_cut(const SphericalEllipse<double>& ellipse, int size, std::vector<Vec3d>& vertices) {
    const AcrossAxis plane(ellipse.cone());
    const HorizonCut<double>& cut = *ellipse.cut();
    const int sides = size - 2;
    const double step = (cut.to - cut.from) / sides;
    const auto angle = [&](int i) { return angle_at(ellipse, cut.from + i * step); };
    const auto turn = [](double from, double to) { return std::remainder(to - from, 2 * pi); };
    double before = angle(0);
    vertices.push_back(plane.towards(cut.first));
    for (int i = 1; i < sides; i += 2) {
        const double middle = angle(i);
        const double after = angle(i + 1);
        vertices.push_back(plane.at(middle, scale_over(turn(before, middle), turn(middle, after))));
        vertices.push_back(i + 1 < sides ? plane.at(after, 1) : plane.towards(cut.last));
        before = after;
    }
    vertices.push_back(vertices.back());
}

bool meets_horizon(const SphericalEllipse<double>& ellipse) {
    const Cone<double>& cone = ellipse.cone();
    const double rise = std::hypot(cone.sin_long / cone.cos_long * cone.long_axis.z,
                                   cone.sin_short / cone.cos_short * cone.short_axis.z);
    return ellipse.cut() || cone.axis.z < kMostOutside * rise;
}

}  // namespace

int disk_polygon_size(const SphericalEllipse<double>& ellipse, double narrowest, double tolerance) {
    if (narrowest == 0) {
        return kOfMirror;
    }
    const double sine = ellipse.cone().sin_long;
    double vertices =
        std::find_if(kSizes.begin(), kSizes.end() - 1, [&](const Size& s) { return sine <= s.up_to; })->vertices;
    if (meets_horizon(ellipse)) {
        vertices = std::max<double>(vertices, kLeastAtHorizon);
    }
    vertices = std::max(vertices, kPerWidth * ellipse.outline() / narrowest);
    vertices *= std::pow(kTolerance / std::clamp(tolerance, 1e-5, 1e-2), 0.25);
    const int size = kDiskPolygonStep * static_cast<int>(std::ceil(vertices / kDiskPolygonStep));
    return std::clamp(size, kDiskPolygonStep, kMost);
}

void append_disk_polygon(const SphericalEllipse<double>& ellipse, int size, std::vector<Vec3d>& vertices) {
    if (ellipse.cut()) {
        append_cut(ellipse, size, vertices);
    } else {
        append_closed(ellipse, size, vertices);
    }
}

}  // namespace shlight
