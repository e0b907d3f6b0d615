// SPDX-License-Identifier: MIT
#include "lights/delta_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/ray_rounding.h"
#include "lights/local_light.h"

namespace shlight {

namespace {

/// Least distance of a point source that shines on a point [m]; the irradiance from nearer ones overflows in float.
constexpr double kNearest = 1e-12;

}  // namespace

void DeltaViews::resize(std::size_t count) {
    for (std::vector<double>* array : {&x, &y, &z, &irradiance}) {
        array->resize(count);
    }
}

DeltaLights::DeltaLights(std::span<const Light> lights) : lights_(lights) {
    const std::size_t size = (lights.size() + kDeltaLanes - 1) / kDeltaLanes * kDeltaLanes;
    for (std::vector<double>* array : {&x_, &y_, &z_, &w_}) {
        array->resize(size);
    }
    for (std::vector<float>* array : {&r_, &g_, &b_, &abs_r_, &abs_g_, &abs_b_, &lights_diffuse_, &lights_glossy_}) {
        array->resize(size);
    }
    casts_shadows_.resize(size);
    group_.resize(size);
    links_.resize(size);
    is_even_.resize(size);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const auto* point = std::get_if<PointSource>(&lights[i]);
        const Vec3d& place = point != nullptr ? point->position : std::get<ParallelSource>(lights[i]).direction;
        x_[i] = place.x;
        y_[i] = place.y;
        z_[i] = place.z;
        w_[i] = point != nullptr ? 1 : 0;
        const Rgb& strength = strength_of(lights[i]);
        r_[i] = strength.x;
        g_[i] = strength.y;
        b_[i] = strength.z;
        abs_r_[i] = std::abs(strength.x);
        abs_g_[i] = std::abs(strength.y);
        abs_b_[i] = std::abs(strength.z);
        const LightTraits& traits = traits_of(lights[i]);
        lights_diffuse_[i] = traits.lights_diffuse ? 1 : 0;
        lights_glossy_[i] = traits.lights_glossy ? 1 : 0;
        casts_shadows_[i] = traits.casts_shadows ? 1 : 0;
        group_[i] = traits.group;
        links_[i] = traits.links;
        are_linked_ = are_linked_ || traits.links.receivers != LightLinks().receivers;
        is_even_[i] = std::holds_alternative<EvenProfile>(traits.profile) ? 1 : 0;
        if (is_even_[i] == 0) {
            uneven_.push_back(i);
        }
    }
}

DeltaArrays DeltaLights::arrays(const DeltaRange& range) const {
    const std::size_t first = range.begin;
    return {x_.data() + first, y_.data() + first, z_.data() + first, w_.data() + first, range.count};
}

double DeltaLights::factor(std::size_t i, const Vec3d& way) const {
    return profile_factor(traits_of(lights_[i]).profile, -glm::normalize(way));
}

void DeltaLights::see(const DeltaRange& range, const ShadingFrame& frame, double error, DeltaViews& views) const {
    views.resize(range.count);
    see_deltas(arrays(range), frame, std::max(2 * error, kNearest), views.arrays());
    for (auto i = std::lower_bound(uneven_.begin(), uneven_.end(), range.begin);
         i != uneven_.end() && *i < range.begin + range.count; ++i) {
        double& irradiance = views.irradiance[*i - range.begin];
        irradiance *= irradiance > 0 ? factor(*i, way(*i, frame.origin)) : 0;
    }
}

bool DeltaLights::shines(std::size_t i, const ShadingFrame& frame, double error) const {
    const Vec3d to_source = way(i, frame.origin);
    const double least = 2 * error * w_[i];
    if (!(glm::dot(frame.z, to_source) > 0 && glm::dot(to_source, to_source) > least * least)) {
        return false;
    }
    return is_even_[i] != 0 || factor(i, to_source) > 0;
}

void DeltaLights::reflect(const DeltaRange& range, const DeltaViews& views, const LobeShape& shape, float cos_theta_o,
                          float* values) const {
    const double cosine = cos_theta_o;
    const Vec3d view(std::sqrt(1 - cosine * cosine), 0, cosine);
    // lobe_values() gives 0 for a mirror: it shows a source without extent with probability 0.
    lobe_values(shape, views.x.data(), views.y.data(), views.z.data(), range.count, view, values);
    const float* lights = (is_glossy(shape) ? lights_glossy_ : lights_diffuse_).data() + range.begin;
    for (std::size_t i = 0; i < range.count; ++i) {
        values[i] = static_cast<float>(views.irradiance[i] * double{values[i]}) * lights[i];
    }
}

Ray DeltaLights::ray(std::size_t i, const Vec3d& origin) const {
    // The vector starts at the rounded origin, so that the ray ends at the source.
    const Vec3f start(origin);
    const float end = w_[i] > 0 ? kRayEnd : std::numeric_limits<float>::infinity();
    return {start, 0.0F, Vec3f(way(i, Vec3d(start))), end, links_[i].shadow_rays};
}

double DeltaLights::changing_distance(const Vec3d& position) const {
    double distance = std::sqrt(nearest_delta_square(arrays({0, padded_size()}), position));
    for (const std::size_t i : uneven_) {
        distance = std::min(distance, shlight::changing_distance(lights_[i], position));
    }
    return distance;
}

}  // namespace shlight
