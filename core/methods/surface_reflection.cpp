// SPDX-License-Identifier: MIT
#include "surface_reflection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shlight::methods {
namespace {

double largest(const Rgb& color) {
    return std::max({color.r, color.g, color.b});
}

}  // namespace

void SurfaceReflection::reset(const Bsdf& bsdf, float cos_theta_o) {
    const double cosine = cos_theta_o;
    view_ = Vec3d(std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine);
    diffuse_ = mirrored_ = Rgb(0);
    diffuse_albedo_ = albedo_ = 0;
    glossy_.clear();
    factors_.clear();
    for (const Lobe& lobe : bsdf.lobes()) {
        const Rgb scale = lobe.scale(cos_theta_o);
        if (scale == Rgb(0)) {
            continue;
        }
        const double albedo = std::max(0.0, lobe.albedo(cosine));
        if (is_mirror(lobe.shape)) {
            mirrored_ += scale * static_cast<float>(albedo);
        } else if (const auto* ggx = std::get_if<GgxShape>(&lobe.shape)) {
            add(*ggx, scale, albedo);
        } else {
            diffuse_ += scale;
            diffuse_albedo_ += largest(scale) * albedo;
        }
    }
    albedo_ = diffuse_albedo_;
    for (const Glossy& glossy : glossy_) {
        albedo_ += glossy.albedo;
    }
}

void SurfaceReflection::add(const GgxShape& shape, const Rgb& scale, double albedo) {
    std::size_t i = 0;
    while (i < glossy_.size() && glossy_[i].alpha != shape.alpha) {
        ++i;
    }
    if (i == glossy_.size()) {
        glossy_.push_back({shape.alpha, 0, LobeSampler(shape.alpha, view_)});
    }
    glossy_[i].albedo += largest(scale) * albedo;
    factors_.push_back({i, shape, scale});
}

Rgb SurfaceReflection::value(const Vec3d& direction, bool diffuse, bool glossy) const {
    if (!(direction.z > 0)) {
        return Rgb(0);
    }
    Rgb sum = diffuse ? diffuse_ * static_cast<float>(direction.z / std::numbers::pi) : Rgb(0);
    const double between = std::sqrt(std::max(0.0, (1 + glm::dot(direction, view_)) / 2));  // ω_i·h
    for (std::size_t i = 0; glossy && i < glossy_.size(); ++i) {
        Rgb color(0);
        for (const Factor& factor : factors_) {
            if (factor.glossy == i) {
                color += factor.scale * static_cast<float>(fresnel_factor(factor.shape, between));
            }
        }
        sum += color * static_cast<float>(lobe_value(GgxShape{glossy_[i].alpha}, direction, view_));
    }
    return sum;
}

RandomDirection SurfaceReflection::sample(double choice, const glm::dvec2& point) const {
    if (!(albedo_ > 0)) {
        return {view_, 0};
    }
    double left = choice * albedo_ - diffuse_albedo_;
    Vec3d direction;
    if (left < 0 || glossy_.empty()) {
        direction = ReflectionSampler(LambertShape{}, view_).sample(point);
    } else {
        std::size_t i = 0;
        while (i + 1 < glossy_.size() && left >= glossy_[i].albedo) {
            left -= glossy_[i].albedo;
            ++i;
        }
        direction = glossy_[i].sampler.sample(point);
    }
    return {direction, density(direction)};
}

double SurfaceReflection::density(const Vec3d& direction) const {
    if (!(direction.z > 0 && albedo_ > 0)) {
        return 0;
    }
    double sum = diffuse_albedo_ * direction.z / std::numbers::pi;
    for (const Glossy& glossy : glossy_) {
        sum += glossy.albedo * glossy.sampler.density(direction);
    }
    return sum / albedo_;
}

}  // namespace shlight::methods
