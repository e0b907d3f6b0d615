// SPDX-License-Identifier: MIT
#include "shlight/light_shading.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "checks.h"
#include "light_checks.h"
#include "material_lobes.h"
#include "spherical_polygon.h"

namespace shlight {
namespace {

/// A material, kept at the last view that was asked for: lights at one hit share it.
class MaterialAtView {
  public:
    explicit MaterialAtView(const MaterialLobes& material) : material_(&material) {}

    void look(double cos_theta_o) {
        if (cos_theta_o == cos_theta_o_) {
            return;
        }
        cos_theta_o_ = cos_theta_o;
        views_.clear();
        for (std::size_t lobe = 0; lobe < material_->lobes().size(); ++lobe) {
            views_.push_back(material_->at(lobe, cos_theta_o));
        }
    }

    template <class Region>
    Rgb radiance(const Region& region, std::int32_t& effort) const {
        Rgb sum(0);
        effort = 0;
        for (std::size_t lobe = 0; lobe < views_.size(); ++lobe) {
            if (views_[lobe]) {
                const LobeRadiance r = views_[lobe]->radiance(region);
                // What rings below zero is no light.
                sum += material_->lobes()[lobe].scale(static_cast<float>(cos_theta_o_)) * std::max(0.0F, r.value);
                effort = std::max({effort, static_cast<std::int32_t>(r.order), static_cast<std::int32_t>(r.points)});
            }
        }
        return sum;
    }

  private:
    const MaterialLobes* material_;
    double cos_theta_o_ = -1;
    std::vector<std::optional<LobeAtView>> views_;
};

void check_settings(const ShadeSettings& settings) {
    if (settings.order < 0 || settings.order > kMaxOrder) {
        reject("order must be 0 … " + std::to_string(kMaxOrder));
    }
    if (!(std::isfinite(settings.tolerance) && settings.tolerance > 0)) {
        reject("tolerance must be positive and finite");
    }
}

void check_views(std::span<const double> cos_theta_o, std::size_t count) {
    check_size("cos_theta_o", cos_theta_o.size(), count);
    if (!std::all_of(cos_theta_o.begin(), cos_theta_o.end(), [](double c) { return c >= 0 && c <= 1; })) {
        reject("cos_theta_o must lie in [0, 1]");
    }
}

/// region(i): the light number i.
template <class Region>
void shade_each(std::span<const double> cos_theta_o, const Bsdf& bsdf, const ShadeSettings& settings,
                std::span<Rgb> radiance, std::span<std::int32_t> effort, const Region& region) {
    const MaterialLobes material(bsdf, settings.order, settings.tolerance);
    MaterialAtView at_view(material);
    for (std::size_t i = 0; i < radiance.size(); ++i) {
        at_view.look(cos_theta_o[i]);
        std::int32_t taken = 0;
        radiance[i] = at_view.radiance(region(i), taken);
        if (!effort.empty()) {
            effort[i] = taken;
        }
    }
}

}  // namespace

void shade_spheres(std::span<const Vec3d> centers, std::span<const double> radii, const Bsdf& bsdf,
                   std::span<const double> cos_theta_o, const ShadeSettings& settings, std::span<Rgb> radiance,
                   std::span<std::int32_t> effort) {
    check_settings(settings);
    check_size("radii", radii.size(), centers.size());
    check_views(cos_theta_o, centers.size());
    check_size("radiance", radiance.size(), centers.size());
    check_size("effort", effort.size(), effort.empty() ? 0 : centers.size());
    shade_each(cos_theta_o, bsdf, settings, radiance, effort, [&](std::size_t i) {
        check_sphere(centers[i], radii[i], std::numeric_limits<float>::epsilon());
        return circle_of_sphere(centers[i], radii[i]);
    });
}

void shade_polygons(std::span<const Vec3d> vertices, int vertex_count, const Bsdf& bsdf,
                    std::span<const double> cos_theta_o, const ShadeSettings& settings, std::span<Rgb> radiance,
                    std::span<std::int32_t> effort) {
    check_settings(settings);
    check_vertex_count(vertex_count);
    const auto k = static_cast<std::size_t>(vertex_count);
    const std::size_t count = vertices.size() / k;
    check_size("vertices", vertices.size(), count * k);
    check_views(cos_theta_o, count);
    check_size("radiance", radiance.size(), count);
    check_size("effort", effort.size(), effort.empty() ? 0 : count);
    shade_each(cos_theta_o, bsdf, settings, radiance, effort, [&](std::size_t i) {
        const auto polygon = vertices.subspan(i * k, k);
        check_polygon<float>(polygon);
        return SphericalPolygon<double>(polygon, true);
    });
}

}  // namespace shlight
