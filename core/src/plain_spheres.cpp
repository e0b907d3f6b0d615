// SPDX-License-Identifier: MIT
#include "plain_spheres.h"

#include <algorithm>
#include <array>

#include "kernels/cap_kernel.h"
#include "kernels/sphere_shading.h"
#include "view_table.h"

namespace shlight {
namespace {

int order_of(const WarpedFit& fit) {
    return fit.orders().front();
}

}  // namespace

bool PlainSpheres::takes(const MaterialLobes& material) {
    return !material.auto_order() && std::none_of(material.lobes().begin(), material.lobes().end(),
                                                  [](const Lobe& lobe) { return is_mirror(lobe.shape); });
}

PlainSpheres::PlainSpheres(const MaterialLobes& material) : material_(material), terms_(material.lobes().size()) {
    for (std::size_t i = 0; i < terms_.size(); ++i) {
        const WarpedFit& fit = *material.fit(i);
        if (fit.table() == nullptr) {
            terms_[i].grow(static_cast<std::size_t>(cosine_count(order_of(fit))));
            fit.coefficients(1, order_of(fit), terms_[i].data());
        }
    }
}

void PlainSpheres::shade(std::span<const Vec3f> centers, const float* radii, std::span<const double> cos_theta_o,
                         std::span<Rgb> radiance, std::span<std::int32_t> effort) {
    const std::span<const Lobe> lobes = material_.lobes();
    if (lobes.empty()) {
        std::fill(radiance.begin(), radiance.end(), Rgb(0));
    }
    std::fill(effort.begin(), effort.end(), 0);
    values_.resize(centers.size());
    if (cos_theta_o.size() == 1) {
        view_.assign(material_, cos_theta_o, false);
    }
    for (std::size_t i = 0; i < lobes.size(); ++i) {
        find_values(i, centers, radii, cos_theta_o);
        add(i, cos_theta_o, radiance);
        const int order = order_of(*material_.fit(i));
        for (std::size_t k = 0; k < effort.size(); ++k) {
            const double cosine = cos_theta_o[cos_theta_o.size() == 1 ? 0 : k];
            const bool nothing = centers[k].z <= -radii[k] || lobes[i].scale(static_cast<float>(cosine)) == Rgb(0);
            effort[k] = std::max(effort[k], nothing ? 0 : order);
        }
    }
}

void PlainSpheres::find_values(std::size_t lobe, std::span<const Vec3f> centers, const float* radii,
                               std::span<const double> cos_theta_o) {
    constexpr std::array<std::uint32_t, 1> kFirstView = {0};
    const WarpedFit& fit = *material_.fit(lobe);
    const int order = order_of(fit);
    if (fit.table() == nullptr) {
        shade_spheres_on_plane(centers.data(), radii, centers.size(), terms_[lobe].data(), order, values_.data());
    } else if (cos_theta_o.size() == 1) {
        shade_spheres_at_view(centers.data(), radii, centers.size(), view_.lobe(lobe).arrays(order, kFirstView),
                              values_.data());
    } else {
        const ViewTable& table = *fit.table();
        const std::size_t which = table.which(order);
        const TabulatedLobe columns{std::get<GgxShape>(fit.shape()).alpha, table.terms(which), table.columns(which),
                                    table.width(which), order};
        shade_spheres_at_views(centers.data(), radii, cos_theta_o.data(), centers.size(), columns, values_.data());
    }
}

void PlainSpheres::add(std::size_t lobe, std::span<const double> cos_theta_o, std::span<Rgb> radiance) const {
    const Lobe& own = material_.lobes()[lobe];
    // What rings below zero is no light.
    const auto reflected = [&](std::size_t k, const Rgb& scale) { return scale * std::max(0.0F, values_[k]); };
    if (lobe > 0 || (own.weight && cos_theta_o.size() > 1)) {
        for (std::size_t k = 0; k < radiance.size(); ++k) {
            const double cosine = cos_theta_o[cos_theta_o.size() == 1 ? 0 : k];
            radiance[k] = reflected(k, own.scale(static_cast<float>(cosine))) + (lobe > 0 ? radiance[k] : Rgb(0));
        }
        return;
    }
    const Rgb scale = own.scale(static_cast<float>(cos_theta_o.front()));
    for (std::size_t k = 0; k < radiance.size(); ++k) {
        radiance[k] = reflected(k, scale);
    }
}

}  // namespace shlight
