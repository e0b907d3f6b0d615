// SPDX-License-Identifier: MIT
#include "surface_reflection.h"

#include <algorithm>
#include <cmath>

namespace shlight::methods {
namespace {

double largest(const Rgb& color) {
    return std::max({color.r, color.g, color.b});
}

}  // namespace

void SurfaceReflection::reset(const Bsdf& bsdf, float cos_theta_o, double azimuth) {
    const double cosine = cos_theta_o;
    view_ = Vec3d(std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine);
    mirrored_ = Rgb(0);
    albedo_ = 0;
    parts_.clear();
    for (const Lobe& lobe : bsdf.lobes()) {
        const Rgb scale = lobe.scale(cos_theta_o);
        const LobeShape shape = is_anisotropic(lobe.shape) ? with_azimuth(lobe.shape, azimuth) : lobe.shape;
        const double albedo = std::max(0.0, lobe.fit ? lobe.albedo(cosine) : lobe_albedo(shape, cosine));
        if (is_mirror(lobe.shape)) {
            mirrored_ += scale * static_cast<float>(albedo);
        } else if (scale != Rgb(0)) {
            parts_.push_back({shape, scale, largest(scale) * albedo});
            albedo_ += parts_.back().albedo;
        }
    }
}

Rgb SurfaceReflection::value(const Vec3d& direction, bool diffuse, bool glossy) const {
    Rgb sum(0);
    for (const Part& part : parts_) {
        if (is_glossy(part.shape) ? glossy : diffuse) {
            sum += part.scale * static_cast<float>(lobe_value(part.shape, direction, view_));
        }
    }
    return sum;
}

RandomDirection SurfaceReflection::sample(double choice, const glm::dvec2& point) const {
    if (!(albedo_ > 0)) {
        return {view_, 0};
    }
    double left = choice * albedo_;
    std::size_t i = 0;
    while (i + 1 < parts_.size() && left >= parts_[i].albedo) {
        left -= parts_[i].albedo;
        ++i;
    }
    const Vec3d direction = sample_lobe(parts_[i].shape, view_, point);
    return {direction, density(direction)};
}

double SurfaceReflection::density(const Vec3d& direction) const {
    double sum = 0;
    for (const Part& part : parts_) {
        sum += part.albedo * lobe_density(part.shape, view_, direction);
    }
    return albedo_ > 0 ? sum / albedo_ : 0;
}

}  // namespace shlight::methods
