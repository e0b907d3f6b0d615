// SPDX-License-Identifier: MIT
#include "lights/profile_rings.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <variant>

#include "base/perpendicular.h"

namespace shlight {
namespace {

using std::numbers::pi;

constexpr double kRound = 1e-6;       // relative deviation of a map, or a disk, from a round one
constexpr double kLeastSine = 1e-4;   // of a cap's half angle; the cosines of smaller ones have too few digits
constexpr double kSlack = 1e-9;       // tolerance of points that lie on a side
constexpr double kLeastPiece = 1e-9;  // [rad]
constexpr int kScan = 32;             // steps around an ellipse in search of its extremal distances
constexpr double kFlat = 0.4;         // slope of the distance that is nearly an extremum
constexpr int kMostSteps = 60;
constexpr double kRootError = 1e-12;
/// Ends of pieces next to a focus, in units of its width.
constexpr std::array kFocusEnds = {-6.0, -1.5, 1.5, 6.0};

/// A root between two arguments with different signs of the function, by regula falsi with halved end values
/// (Illinois).
template <class Function>
double root_between(double from, double to, const Function& f) {
    double at_from = f(from);
    double at_to = f(to);
    double middle = from;
    for (int i = 0; i < kMostSteps && std::abs(to - from) > kRootError; ++i) {
        middle = at_to == at_from ? (from + to) / 2 : to - at_to * (to - from) / (at_to - at_from);
        const double value = f(middle);
        if (std::abs(value) < kRootError * kRootError) {
            break;
        }
        if ((value > 0) != (at_to > 0)) {
            from = to;
            at_from = at_to;
        } else {
            at_from /= 2;
        }
        to = middle;
        at_to = value;
    }
    return middle;
}

double angle_to_axis(const Vec3d& direction) {
    return std::atan2(std::hypot(direction.x, direction.y), direction.z);
}

/// World direction opposite to the lamp's axis, about which the rings lie, and the angles to it at which the profile
/// has kinks. No direction if lines of equal factor are not circles.
struct Axis {
    std::optional<Vec3d> direction;
    std::array<double, 2> kinks{};
};

Axis axis_of(const EmissionProfile& profile) {
    if (const auto* spot = std::get_if<SpotProfile>(&profile); spot != nullptr && spot->stretch < 1 + kRound) {
        const double inner = spot->cosine + (1 - spot->cosine) * spot->blend;
        // The third row of the map gives the coordinate along the cone.
        const Vec3d along(spot->to_local[0].z, spot->to_local[1].z, spot->to_local[2].z);
        return {-glm::normalize(along), {std::acos(spot->cosine), std::acos(std::min(1.0, inner))}};
    }
    if (const auto* spread = std::get_if<SpreadProfile>(&profile)) {
        return {-spread->normal, {spread->half_angle, spread->half_angle}};
    }
    return {};
}

}  // namespace

bool ProfileRings::Disk::holds(const glm::dvec2& point) const {
    const glm::dvec2 p = point - center;
    const double area = u.x * v.y - u.y * v.x;
    const double a = (p.x * v.y - p.y * v.x) / area;
    const double b = (u.x * p.y - u.y * p.x) / area;
    return a * a + b * b <= 1 + kSlack;
}

void ProfileRings::Disk::find_turns() {
    turns.clear();
    near_turns.clear();
    if (radius > 0) {
        const double far = std::atan2(glm::dot(center, v), glm::dot(center, u));
        turns = {far, far + pi};
        return;
    }
    // Half the first and second derivatives of the squared distance.
    const auto slope = [&](double t) { return glm::dot(at(t), v * std::cos(t) - u * std::sin(t)); };
    const auto bend = [&](double t) {
        const glm::dvec2 along = v * std::cos(t) - u * std::sin(t);
        return glm::dot(along, along) - glm::dot(at(t), at(t) - center);
    };
    const double flat = kFlat * (glm::dot(u, u) + glm::dot(v, v));
    for (int i = 0; i < kScan; ++i) {
        const double from = 2 * pi / kScan * i;
        const double to = 2 * pi / kScan * (i + 1);
        if ((slope(from) > 0) != (slope(to) > 0)) {
            turns.push_back(root_between(from, to, slope));
        } else if ((bend(from) > 0) != (bend(to) > 0)) {
            if (const double t = root_between(from, to, bend); std::abs(slope(t)) < flat) {
                near_turns.push_back(t);
            }
        }
    }
}

void ProfileRings::Disk::add_cuts(double circle, std::vector<double>& cuts) const {
    if (radius > 0) {
        const double away = glm::length(center);
        const double cosine = (circle * circle + (away - radius) * (away + radius)) / (2 * circle * away);
        if (std::abs(cosine) < 1) {
            const double middle = std::atan2(center.y, center.x);
            const double half = std::acos(cosine);
            cuts.push_back(middle + half);
            cuts.push_back(middle - half);
        }
        return;
    }
    const auto beyond = [&](double t) {
        const glm::dvec2 p = at(t);
        return glm::dot(p, p) / (circle * circle) - 1;
    };
    for (std::size_t i = 0; i < turns.size(); ++i) {
        const double from = turns[i];
        const double to = i + 1 < turns.size() ? turns[i + 1] : turns[0] + 2 * pi;
        if ((beyond(from) > 0) != (beyond(to) > 0)) {
            const glm::dvec2 point = at(root_between(from, to, beyond));
            cuts.push_back(std::atan2(point.y, point.x));
        }
    }
}

bool ProfileRings::reset(const LocalLight& seen) {
    sides_.clear();
    corner_sides_ = 0;
    disk_.reset();
    events_.clear();
    focus_width_ = 0;
    const Axis axis = axis_of(traits_of(seen.light()).profile);
    if (!axis.direction) {
        return false;
    }
    const Vec3d z = seen.frame().to_local(*axis.direction);
    const Vec3d x = perpendicular(z);
    to_shading_ = {x, glm::cross(z, x), z};
    if (!seen.corners().empty()) {
        if (!add_polygon(seen.corners())) {
            return false;
        }
    } else if (std::holds_alternative<DiskLight>(seen.light())) {
        add_disk(seen.ellipse());
    } else if (!seen.cap() || !add_cap(*seen.cap())) {
        return false;
    }
    find_events(axis.kinks);
    return true;
}

void ProfileRings::add_side(const Vec3d& normal, double offset) {
    sides_.push_back({normal, offset, std::hypot(normal.x, normal.y), std::atan2(normal.y, normal.x)});
}

bool ProfileRings::add_cap(const CapView& cap) {
    if (cap.kind != CapView::Kind::sphere && cap.kind != CapView::Kind::facing_disk) {
        return false;
    }
    const SphericalCap circle = circle_of(cap);
    if (!(circle.sine >= kLeastSine)) {
        return false;
    }
    add_side(to_rings(circle.axis), circle.cosine);
    if (circle.axis.z < circle.sine) {
        add_horizon();
    }
    return true;
}

bool ProfileRings::add_polygon(std::span<const Vec3d> corners) {
    std::vector<Vec3d> directions;
    for (const Vec3d& corner : corners) {
        directions.push_back(to_rings(glm::normalize(corner)));
    }
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const Vec3d normal = glm::cross(directions[i], directions[(i + 1) % directions.size()]);
        if (const double length = glm::length(normal); length > kSlack) {
            add_side(normal / length, 0);
        }
    }
    const auto on = [&](double sign) {
        return std::all_of(directions.begin(), directions.end(), [&](const Vec3d& direction) {
            return std::all_of(sides_.begin(), sides_.end(),
                               [&](const Side& side) { return sign * glm::dot(side.normal, direction) >= -kSlack; });
        });
    };
    if (!on(1)) {
        if (!on(-1)) {
            return false;  // it is not convex
        }
        for (Side& side : sides_) {
            side.normal = -side.normal;
            side.azimuth += pi;
        }
    }
    if (sides_.size() < 3) {
        return false;
    }
    corner_sides_ = sides_.size();
    if (std::any_of(corners.begin(), corners.end(), [](const Vec3d& corner) { return corner.z < 0; })) {
        add_horizon();
    }
    for (const Vec3d& direction : directions) {
        add_event(direction);
    }
    return true;
}

void ProfileRings::add_disk(const Ellipse& ellipse) {
    const Vec3d center = to_rings(ellipse.center);
    const Vec3d u = to_rings(ellipse.half_axis_u);
    const Vec3d v = to_rings(ellipse.half_axis_v);
    const double square = glm::dot(u, u);
    const bool round =
        std::abs(glm::dot(v, v) - square) <= kRound * square && std::abs(glm::dot(u, v)) <= kRound * square;
    disk_ = {center.z, {center.x, center.y}, {u.x, u.y}, {v.x, v.y}, round ? std::sqrt(square) : 0.0, {}, {}};
    disk_->find_turns();
    if (ellipse.center.z < std::hypot(ellipse.half_axis_u.z, ellipse.half_axis_v.z)) {
        add_horizon();
    }
}

bool ProfileRings::holds(const Vec3d& direction) const {
    const bool within = std::all_of(sides_.begin(), sides_.end(), [&](const Side& side) {
        return glm::dot(side.normal, direction) >= side.offset - kSlack;
    });
    if (!within || !disk_) {
        return within;
    }
    return direction.z > 0 && disk_->holds(glm::dvec2(direction.x, direction.y) * (disk_->height / direction.z));
}

void ProfileRings::add_event(const Vec3d& direction) {
    if (holds(direction)) {
        events_.push_back(angle_to_axis(direction));
    }
}

/// Adds the points of a side's circle that are nearest to the axis and farthest from it.
void ProfileRings::add_touching(const Side& side) {
    const Vec3d inwards = side.across > 0 ? Vec3d(-side.normal.z * side.normal.x, -side.normal.z * side.normal.y,
                                                  side.across * side.across) /
                                                side.across
                                          : Vec3d(1, 0, 0);
    const double reach = std::sqrt(std::max(0.0, (1 - side.offset) * (1 + side.offset)));
    add_event(side.offset * side.normal + reach * inwards);
    add_event(side.offset * side.normal - reach * inwards);
}

/// Adds the two points in which the circles of two sides cross.
void ProfileRings::add_crossings(const Side& a, const Side& b) {
    const Vec3d along = glm::cross(a.normal, b.normal);
    const double square = glm::dot(along, along);
    if (!(square > kSlack * kSlack)) {
        return;
    }
    const double c = glm::dot(a.normal, b.normal);
    const Vec3d foot = ((a.offset - b.offset * c) * a.normal + (b.offset - a.offset * c) * b.normal) / square;
    const double rest = 1 - glm::dot(foot, foot);
    if (rest >= 0) {
        const Vec3d way = std::sqrt(rest / square) * along;
        add_event(foot + way);
        add_event(foot - way);
    }
}

void ProfileRings::add_disk_events() {
    const auto add = [&](double t) {
        const glm::dvec2 point = disk_->at(t);
        add_event(glm::normalize(Vec3d(point.x, point.y, disk_->height)));
    };
    add(0);  // needed for a disk centred on the axis, which has no extremal distances
    for (const std::vector<double>* turns : {&disk_->turns, &disk_->near_turns}) {
        std::for_each(turns->begin(), turns->end(), add);
    }
    for (const Side& side : sides_) {
        // n · (c + u cos t + v sin t) = 0
        const double a = side.normal.x * disk_->u.x + side.normal.y * disk_->u.y;
        const double b = side.normal.x * disk_->v.x + side.normal.y * disk_->v.y;
        const double c =
            side.normal.x * disk_->center.x + side.normal.y * disk_->center.y + side.normal.z * disk_->height;
        const double size = std::hypot(a, b);
        if (std::abs(c) <= size) {
            const double middle = std::atan2(b, a);
            const double half = std::acos(std::clamp(-c / size, -1.0, 1.0));
            add(middle + half);
            add(middle - half);
        }
    }
}

void ProfileRings::focus(const Vec3d& direction, double width) {
    if (events_.empty()) {
        return;
    }
    const Vec3d there = to_rings(direction);
    focus_azimuth_ = std::atan2(there.y, there.x);
    focus_width_ = width;
    std::array<double, kFocusEnds.size()> angles;
    std::transform(kFocusEnds.begin(), kFocusEnds.end(), angles.begin(),
                   [&](double end) { return angle_to_axis(there) + end * width; });
    add_between(angles);
}

void ProfileRings::find_events(std::span<const double> kinks) {
    add_event({0, 0, 1});
    add_event({0, 0, -1});
    for (std::size_t i = 0; i < sides_.size(); ++i) {
        add_touching(sides_[i]);
        for (std::size_t j = 0; j < i && i >= corner_sides_; ++j) {
            add_crossings(sides_[i], sides_[j]);
        }
    }
    if (disk_) {
        add_disk_events();
    }
    if (events_.empty()) {
        return;
    }
    std::sort(events_.begin(), events_.end());
    add_between(kinks);
}

void ProfileRings::add_between(std::span<const double> angles) {
    const double from = events_.front();
    const double to = events_.back();
    std::copy_if(angles.begin(), angles.end(), std::back_inserter(events_),
                 [&](double angle) { return from < angle && angle < to; });
    std::sort(events_.begin(), events_.end());
    const auto near = [](double a, double b) { return b - a < kLeastPiece; };
    events_.erase(std::unique(events_.begin(), events_.end(), near), events_.end());
}

void ProfileRings::add_cuts(double cosine, double sine) {
    cuts_.clear();
    for (const Side& side : sides_) {
        const double height = side.offset - side.normal.z * cosine;
        const double swing = side.across * sine;
        if (std::abs(height) < swing) {
            const double half = std::acos(height / swing);
            for (const double cut : {side.azimuth + half, side.azimuth - half}) {
                // The circle of a polygon's side continues beyond its corners.
                if (corner_sides_ == 0 || holds({sine * std::cos(cut), sine * std::sin(cut), cosine})) {
                    cuts_.push_back(cut);
                }
            }
        }
    }
    if (disk_) {
        disk_->add_cuts(disk_->height * sine / cosine, cuts_);
    }
    for (double& cut : cuts_) {
        cut -= 2 * pi * std::floor(cut / (2 * pi));
    }
    std::sort(cuts_.begin(), cuts_.end());
}

void ProfileRings::split_arcs(double sine) {
    whole_arcs_.swap(arcs_);
    arcs_.clear();
    for (const Arc& arc : whole_arcs_) {
        cuts_.clear();
        for (const double end : kFocusEnds) {
            const double away = end * focus_width_ / sine;
            const double turned = focus_azimuth_ + away - arc.begin;
            const double length = turned - 2 * pi * std::floor(turned / (2 * pi));
            if (std::abs(away) < pi && length < arc.length) {
                cuts_.push_back(length);
            }
        }
        cuts_.push_back(arc.length);
        std::sort(cuts_.begin(), cuts_.end());
        double done = 0;
        for (const double cut : cuts_) {
            arcs_.push_back({arc.begin + done, cut - done});
            done = cut;
        }
    }
}

void ProfileRings::find_arcs(double cosine, double sine) {
    arcs_.clear();
    add_cuts(cosine, sine);
    const auto is_lit = [&](double azimuth) {
        return holds({sine * std::cos(azimuth), sine * std::sin(azimuth), cosine});
    };
    if (cuts_.empty()) {
        if (is_lit(0)) {
            // In three parts, over each of which a lobe varies less.
            for (int i = 0; i < 3; ++i) {
                arcs_.push_back({2 * pi / 3 * i, 2 * pi / 3});
            }
        }
    }
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
        const double end = i + 1 < cuts_.size() ? cuts_[i + 1] : cuts_[0] + 2 * pi;
        const Arc arc{cuts_[i], end - cuts_[i]};
        if (arc.length > 0 && is_lit(arc.begin + arc.length / 2)) {
            arcs_.push_back(arc);
        }
    }
    if (focus_width_ > 0) {
        split_arcs(sine);
    }
}

}  // namespace shlight
