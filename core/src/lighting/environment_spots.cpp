// SPDX-License-Identifier: MIT
#include "lighting/environment_spots.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lights/delta_kernel.h"
#include "lobes/lobe_rays.h"

namespace shlight {
namespace {

/// Directions of a spot along each side, at most; and how many of them are as far apart as a lobe is wide, or as it is
/// far from the lobe's peak, where lobes change as slowly.
constexpr int kMostAcross = 64;
constexpr double kAcrossWidth = 4;

/// Fills the lanes of a vector; any direction serves for what has no irradiance.
template <class Arrays>
void pad(Arrays& spots) {
    const std::size_t size = (spots[0].size() + kLobeRayLanes - 1) / kLobeRayLanes * kLobeRayLanes;
    for (std::size_t k = 0; k < spots.size(); ++k) {
        spots[k].resize(size, k < 3 ? 1.0F : 0.0F);
    }
}

template <class Arrays>
Rgb sum(const std::vector<float>& values, const Arrays& spots) {
    return weighted_sum(values.data(), {spots[3].data(), spots[4].data(), spots[5].data()}, values.size());
}

}  // namespace

EnvironmentSpots::EnvironmentSpots(const EnvironmentMap& map) : map_(&map) {
    for (const BrightSpot& spot : map.bright.spots) {
        add(spot, 1, spots_);
    }
    pad(spots_);
}

void EnvironmentSpots::add(const BrightSpot& spot, int across, Arrays& spots) const {
    const auto push = [&](const Vec3d& direction, double share) {
        for (int k = 0; k < 3; ++k) {
            spots[static_cast<std::size_t>(k)].push_back(static_cast<float>(direction[k]));
            spots[static_cast<std::size_t>(k) + 3].push_back(spot.irradiance[k] * static_cast<float>(share));
        }
    };
    if (across == 1) {
        push(spot.direction, 1);
        return;
    }
    const LatLong& picture = *map_->picture;
    const glm::dvec2 texel = texel_of(spot.direction, picture.width, picture.height);
    const double step = 2.0 / across;
    const double sine = std::hypot(spot.direction.x, spot.direction.y);
    // A column of directions has one azimuth, and a row one height.
    std::array<glm::dvec2, kMostAcross> azimuths{};
    for (int column = 0; column < across; ++column) {
        const glm::dvec2 off((column + 0.5) * step - 1.0, 0.0);
        azimuths[static_cast<std::size_t>(column)] =
            glm::normalize(glm::dvec2(direction_of(texel + off, picture.width, picture.height)));
    }
    for (int row = 0; row < across; ++row) {
        const double down = (row + 0.5) * step - 1.0;
        const Vec3d outmost = direction_of(texel + glm::dvec2(0.0, down), picture.width, picture.height);
        // Negative beyond a pole.
        const double radius = (outmost.x * spot.direction.x + outmost.y * spot.direction.y) / sine;
        const double share = (1 - std::abs(down)) * step * step * std::abs(radius) / sine;
        for (int column = 0; column < across; ++column) {
            const glm::dvec2 at = radius * azimuths[static_cast<std::size_t>(column)];
            push({at.x, at.y, outmost.z}, share * (1 - std::abs((column + 0.5) * step - 1.0)));
        }
    }
}

std::vector<float> EnvironmentSpots::weigh(const Arrays& spots, const LobeShape& shape, const glm::dmat3& to_map,
                                           const Vec3d& view) {
    const ShadingFrame frame = {Vec3d(0), to_map[0], to_map[1], to_map[2]};
    std::vector<float> values(spots[0].size());
    weigh_lobe_rays(shape, frame, view, {spots[0].data(), spots[1].data(), spots[2].data()}, values.size(),
                    values.data(), nullptr);
    return values;
}

Rgb EnvironmentSpots::reflected(const LobeShape& shape, const glm::dmat3& to_map, const Vec3d& view) const {
    std::vector<float> values = weigh(spots_, shape, to_map, view);
    const double spot_width = 2 * map_->texel() * kAcrossWidth;
    if (!is_glossy(shape) || !(lobe_width(shape) < spot_width)) {
        return sum(values, spots_);
    }
    const double width = lobe_width(shape);
    const Vec3d peak = to_map * mirrored(view);
    const double least_cosine = std::cos(std::min(2 * spot_width, std::numbers::pi));
    Arrays near;
    for (std::size_t i = 0; i < map_->bright.spots.size(); ++i) {
        const BrightSpot& spot = map_->bright.spots[i];
        const double cosine = glm::dot(peak, spot.direction);
        if (cosine > least_cosine) {
            // The half vector turns by half the angle.
            const double away = std::acos(std::min(cosine, 1.0)) / 2;
            const double pairs = std::ceil(spot_width / std::max(width, away) / 2);
            add(spot, 2 * std::min(static_cast<int>(pairs), kMostAcross / 2), near);
            values[i] = 0;
        }
    }
    pad(near);
    const Rgb far = sum(values, spots_);
    return near[0].empty() ? far : far + sum(weigh(near, shape, to_map, view), near);
}

}  // namespace shlight
