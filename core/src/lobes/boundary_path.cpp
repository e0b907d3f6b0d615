// SPDX-License-Identifier: MIT
#include "lobes/boundary_path.h"

#include <algorithm>
#include <cmath>

namespace shlight {
namespace {

/// Speed of a boost after which another sweep would change the parameter of a boundary by little.
constexpr double kEvenEnough = 0.05;

}  // namespace

Vec3d resolved_view(double cos_theta_o) {
    const double cosine = std::max(cos_theta_o, kLeastViewCosine);
    return {std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine};
}

ArcPath::ArcPath(const Arc<double>& arc, const Vec3d& view, const glm::dvec2& alpha)
    : closed_(arc.half >= std::numbers::pi) {
    const Vec3d u = arc.sine * arc.middle;
    const Vec3d scale(1 / alpha.x, 1 / alpha.y, 1);
    columns_ = {(arc.cosine * arc.axis + view) * scale, u * scale, glm::cross(arc.axis, u) * scale};
    even_out();
    path_ = {columns_[0], columns_[1], columns_[2], flatness_};
    if (!is_closed()) {
        const double c = std::cos(arc.half);
        const double s = std::sin(arc.half);
        start_ = parameter(c, -s);
        length_ = parameter(c, s) - start_;
        length_ += length_ < 0 ? 2 * std::numbers::pi : 0;
    }
}

/// The vectors (1, cos τ, sin τ) are null vectors of the metric (+, -, -), and so are their images under its boosts
/// and turns. Like Jacobi's rotations, those are found that make the squared length in (h_x/α, h_y/α, h_z), a
/// quadratic form of them, diagonal. A few sweeps suffice, as the parameter need not be the best.
void ArcPath::even_out() {
    const auto form = [&](int i, int j) { return glm::dot(columns_[i], columns_[j]); };
    double largest = 1;
    for (int sweep = 0; sweep < 4 && largest > kEvenEnough; ++sweep) {
        largest = 0;
        for (int axis = 1; axis <= 2; ++axis) {
            const double ratio = -2 * form(0, axis) / (form(0, 0) + form(axis, axis));
            boost_by_half(axis, std::clamp(ratio, -1 + 1e-14, 1 - 1e-14));
            largest = std::max(largest, std::abs(ratio));
        }
        // Squares of the forms of a tiny circle would vanish.
        const double size = form(1, 1) + form(2, 2);
        if (size > 0) {
            turn_by_half((form(1, 1) - form(2, 2)) / size, 2 * form(1, 2) / size);
        }
    }
    if (form(2, 2) > form(1, 1)) {
        turn(0, 1);
    }
    flatness_ = std::min(1.0, std::sqrt((form(0, 0) + form(2, 2)) / form(1, 1)));
}

void ArcPath::boost_by_half(int axis, double speed) {
    const double whole = 1 / std::sqrt((1 - speed) * (1 + speed));  // cosh of the rapidity
    const double c = std::sqrt((whole + 1) / 2);
    const double s = speed * whole / (2 * c);
    mix(0, axis, c, s, s, c);
}

void ArcPath::turn_by_half(double x, double y) {
    const double length = std::sqrt(x * x + y * y);
    const double c = std::sqrt((length + std::abs(x)) / 2);
    if (c > 0) {
        const double other = y / (2 * c);
        const double unit = 1 / std::sqrt(length);
        x >= 0 ? turn(c * unit, other * unit) : turn(std::abs(other) * unit, std::copysign(c, y) * unit);
    }
}

void ArcPath::mix(int i, int j, double ii, double ij, double ji, double jj) {
    const auto apply = [&](auto& list) {
        const auto first = ii * list[i] + ij * list[j];
        list[j] = ji * list[i] + jj * list[j];
        list[i] = first;
    };
    apply(columns_);
    for (Triple& row : frame_) {
        apply(row);
    }
}

double ArcPath::parameter(double cosine, double sine) const {
    const auto component = [&](int column) {
        return frame_[1][column] * cosine + frame_[2][column] * sine - frame_[0][column];
    };
    return std::atan2(component(2), component(1) / flatness_);
}

}  // namespace shlight
