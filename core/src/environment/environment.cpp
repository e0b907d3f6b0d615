// SPDX-License-Identifier: MIT
#include "shlight/environment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "base/scene_range.h"
#include "environment/environment_map.h"

namespace shlight {
namespace {

constexpr std::int64_t kMostTexels = 1 << 28;
/// How far the elements of a rotation times its transpose may be from the identity's.
constexpr double kRotationError = 1e-4;

void check_radiance(const char* name, const Rgb& radiance) {
    check_strength(name, radiance);
    if (glm::any(glm::lessThan(radiance, Rgb(0)))) {
        reject(std::string(name) + " must not be negative");
    }
}

/// The rotation nearest to it, by Newton's iteration.
glm::dmat3 checked_rotation(glm::dmat3 m) {
    for (int column = 0; column < 3; ++column) {
        check_finite("to_world", m[column]);
    }
    const glm::dmat3 square = glm::transpose(m) * m;
    double error = 0;
    for (int i = 0; i < 9; ++i) {
        error = std::max(error, std::abs(square[i / 3][i % 3] - (i % 4 == 0 ? 1.0 : 0.0)));
    }
    if (!(error <= kRotationError && glm::determinant(m) > 0)) {
        reject("to_world must be a rotation");
    }
    for (int step = 0; step < 3; ++step) {
        m = 0.5 * (m + glm::transpose(glm::inverse(m)));
    }
    return m;
}

void check(const char* name, LatLong& picture) {
    const std::int64_t texels = std::int64_t{picture.width} * picture.height;
    if (picture.width < 1 || picture.height < 1 || texels > kMostTexels) {
        reject(std::string(name) + " must have 1 … 2^28 pixels");
    }
    check_size(name, picture.pixels.size(), static_cast<std::size_t>(texels));
    for (const Rgb& texel : picture.pixels) {
        check_radiance(name, texel);
    }
    picture.to_world = checked_rotation(picture.to_world);
}

bool is_constant(const LatLong& picture) {
    return std::all_of(picture.pixels.begin(), picture.pixels.end(),
                       [&](const Rgb& texel) { return texel == picture.pixels.front(); });
}

}  // namespace

Environment::Environment(const Rgb& radiance, const char* name) : constant_(radiance) {
    check_radiance(name, radiance);
}

Environment::Environment(LatLong picture, const char* name) {
    check(name, picture);
    if (is_constant(picture)) {
        constant_ = picture.pixels.front();
    } else {
        picture_ = std::make_shared<const LatLong>(std::move(picture));
    }
}

bool Environment::is_black() const {
    return !picture_ && constant_ == Rgb(0);
}

Rgb Environment::radiance(const Vec3d& direction) const {
    return picture_ ? radiance_from(*picture_, direction * picture_->to_world) : constant_;
}

Environment Environment::prepared(const Environment& before, const Stopped& stopped) const {
    Environment result = *this;
    if (picture_) {
        result.map_ = picture_ == before.picture_ && before.map_
                          ? before.map_
                          : std::make_shared<const EnvironmentMap>(picture_, stopped);
    }
    return result;
}

}  // namespace shlight
