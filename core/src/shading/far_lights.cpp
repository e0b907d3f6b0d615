// SPDX-License-Identifier: MIT
#include "shading/far_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "lobes/view_grid.h"

namespace shlight {
namespace {

/// With fewer a sum saves less than it costs.
constexpr std::size_t kLeastLights = 256;

/// GGX lobes narrower than this have too much in higher bands.
constexpr double kLeastWidth = 0.15;

double area(const PolygonLight& light) {
    Vec3d sum(0);
    for (const Triangle& t : light.triangles) {
        const Vec3d& a = light.vertices[t[0]];
        sum += 0.5 * glm::cross(light.vertices[t[1]] - a, light.vertices[t[2]] - a);
    }
    return glm::length(sum);
}

/// Nothing for lights whose light does not fall with the square of their distance, or changes with the direction in
/// another way than a surface's, or not for all lobes, or has no one place.
std::optional<FarLight> far_light(const Light& light, std::size_t index) {
    const LightTraits& traits = traits_of(light);
    if (!std::holds_alternative<EvenProfile>(traits.profile) || !traits.lights_diffuse || !traits.lights_glossy) {
        return std::nullopt;
    }
    FarLight result = {Vec3d(0), Vec3d(0), false, traits.casts_shadows, traits.group, 0, strength_of(light), index};
    if (const auto* point = std::get_if<PointSource>(&light)) {
        result.position = point->position;
        return result;
    }
    double facing_area = 0;
    if (const auto* sphere = std::get_if<SphereLight>(&light)) {
        result.position = sphere->center;
        result.extent = sphere->radius;
        facing_area = std::numbers::pi * sphere->radius * sphere->radius;
    } else if (const auto* polygon = std::get_if<PolygonLight>(&light)) {
        result.position = polygon->center;
        result.normal = polygon->normal;
        result.two_sided = polygon->two_sided;
        result.extent = polygon->radius;
        facing_area = area(*polygon);
    } else if (const auto* disk = std::get_if<DiskLight>(&light)) {
        result.position = disk->center;
        result.normal = disk->normal;
        result.two_sided = disk->two_sided;
        result.extent = disk->radius;
        facing_area = std::numbers::pi * glm::length(glm::cross(disk->half_axis_u, disk->half_axis_v));
    } else {
        return std::nullopt;
    }
    result.intensity *= static_cast<float>(facing_area);
    return result;
}

}  // namespace

double FarLight::irradiance(const Vec3d& way) const {
    const double square = glm::dot(way, way);
    if (normal == Vec3d(0)) {
        return 1 / square;
    }
    const double cosine = -glm::dot(normal, way) / std::sqrt(square);
    return (two_sided ? std::abs(cosine) : std::max(cosine, 0.0)) / square;
}

FarLobe::FarLobe(const LobeShape& shape) {
    if (lobe_width(shape) < kLeastWidth) {
        return;
    }
    lobe = sh_projection(shape);
    for (std::size_t node = 0; node < lobe->node_count(); ++node) {
        const float* powers = lobe->powers(node);
        double left = lobe->tail(node);
        for (int l = kMaxOrder - 1; l >= kFarLightOrder; --l) {
            left += powers[l];
        }
        // The Laplacian of Y_l / d² is (2 - l (l + 1)) Y_l / d⁴; of the second differences along the edges a, a third
        // of the diagonal's square each, it is a² / 8 times that.
        double squares = 0;
        for (int l = 0; l < kFarLightOrder; ++l) {
            const double laplacian = std::max(2.0, l * (l + 1.0) - 2);
            squares += powers[l] * laplacian * laplacian;
        }
        tails.push_back(static_cast<float>(std::sqrt(left)));
        curvatures.push_back(static_cast<float>(std::sqrt(squares / (4 * std::numbers::pi)) / 8));
    }
}

float FarLobe::largest_near(const std::vector<float>& by_view, double cos_theta_o) {
    const std::size_t low = by_view.size() == 1 ? 0 : ViewInterval(cos_theta_o).low;
    return std::max(by_view[low], by_view[std::min(low + 1, by_view.size() - 1)]);
}

FarLights::FarLights(std::span<const Light> lights, std::span<const MaterialLobes> materials, int order) {
    if (order != 0 || lights.size() < kLeastLights) {
        return;
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (const std::optional<FarLight> light = far_light(lights[i], i)) {
            lights_.push_back(*light);
            all_positive_ = all_positive_ && glm::all(glm::greaterThanEqual(light->intensity, Rgb(0)));
        }
    }
    if (lights_.size() < kLeastLights) {
        lights_.clear();
        return;
    }
    for (const MaterialLobes& material : materials) {
        auto& lobes = lobes_.emplace_back();
        for (const Lobe& lobe : material.lobes()) {
            // Where the width varies no one sum is reflected.
            lobes.push_back(lobe.varying_width != 0 ? FarLobe() : FarLobe(lobe.shape));
        }
    }
}

}  // namespace shlight
