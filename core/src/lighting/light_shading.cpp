// SPDX-License-Identifier: MIT
#include "shlight/light_shading.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/checks.h"
#include "lighting/light_views.h"
#include "lighting/lobe_integrator.h"
#include "lighting/local_lights.h"
#include "lobes/material_views.h"
#include "regions/region_checks.h"

namespace shlight {
namespace {

/// Lights that are prepared and sorted at a time: enough for long lists of each kind, few enough for the cache.
constexpr std::size_t kLightsPerChunk = 1024;

template <class T>
using In = std::span<const T>;
using Radiance = std::span<Rgb>;
using Effort = std::span<std::int32_t>;

void check_settings(const ShadeSettings& settings) {
    if (settings.order < 0 || settings.order > kMaxOrder) {
        reject("order must be 0 … " + std::to_string(kMaxOrder));
    }
    if (!(std::isfinite(settings.tolerance) && settings.tolerance > 0)) {
        reject("tolerance must be positive and finite");
    }
}

const ShadeSettings& checked(const ShadeSettings& settings) {
    check_settings(settings);
    return settings;
}

}  // namespace

class LightShaderWork {
  public:
    LightShaderWork(const Bsdf& bsdf, const ShadeSettings& settings)
        : material_(bsdf.lobes(), settings.order, settings.tolerance) {}
    ~LightShaderWork() = default;
    // The parts refer to each other.
    LightShaderWork(const LightShaderWork&) = delete;
    LightShaderWork& operator=(const LightShaderWork&) = delete;

    /// Checks what is given of `count` lights, and calls shade_chunk(first, radiance, effort) for each chunk, after its
    /// views were found.
    template <class Shade>
    void in_chunks(std::size_t count, const LightViews& views, const LightLobes& own, Radiance radiance, Effort effort,
                   const Shade& shade_chunk) {
        check_views(views, count);
        check_lobes(own, count);
        check_size("radiance", radiance.size(), count);
        check_size("effort", effort.size(), effort.empty() ? 0 : count);
        for (std::size_t first = 0; first < count; first += kLightsPerChunk) {
            const std::size_t size = std::min(kLightsPerChunk, count - first);
            find_views(views, own, first, size);
            shade_chunk(first, radiance.subspan(first, size), effort.empty() ? effort : effort.subspan(first, size));
        }
    }

    template <class T>
    void shade_spheres(In<Vec3<T>> centers, In<T> radii, Radiance radiance, Effort effort) {
        check_spheres(centers, radii, std::numeric_limits<float>::epsilon());
        seen_.set_spheres(centers, radii.data());
        shade(radiance, effort);
    }

    template <class T>
    void shade_polygons(In<Vec3<T>> vertices, std::size_t vertex_count, Radiance radiance, Effort effort) {
        seen_.set_polygons(vertices, vertex_count);
        shade(radiance, effort);
    }

    /// disk(i): of those that find_views was called for.
    template <class Disk>
    void shade_disks(const Disk& disk, Radiance radiance, Effort effort) {
        seen_.clear();
        for (std::uint32_t i = 0; i < radiance.size(); ++i) {
            seen_.add_disk(disk(i), i);
        }
        shade(radiance, effort);
    }

  private:
    void check_lobes(const LightLobes& own, std::size_t count) const {
        const std::size_t all = count * material_.lobes().size();
        check_size("colors", own.colors.size(), own.colors.empty() ? 0 : all);
        const bool varies = std::any_of(material_.lobes().begin(), material_.lobes().end(),
                                        [](const Lobe& lobe) { return lobe.varying_width != 0; });
        check_size("alphas", own.alphas.size(), varies || !own.alphas.empty() ? all : 0);
    }

    /// Each change from light to light is a new view.
    void find_views(const LightViews& views, const LightLobes& own, std::size_t first, std::size_t count) {
        view_of_.assign(count, 0);
        cosines_.assign(1, views.cosine_of(first));
        azimuths_.assign(1, views.azimuth_of(first));
        lights_.assign(1, first);
        if (!views.shared() || !own.empty()) {
            cosines_.resize(count);
            azimuths_.resize(count);
            lights_.resize(count);
            std::uint32_t view = 0;
            for (std::size_t i = 1; i < count; ++i) {
                const double cosine = views.cosine_of(first + i);
                const double azimuth = views.azimuth_of(first + i);
                view += cosine != cosines_[view] || azimuth != azimuths_[view] || changes(own, first + i) ? 1 : 0;
                cosines_[view] = cosine;
                azimuths_[view] = azimuth;
                lights_[view] = first + i;
                view_of_[i] = view;
            }
            cosines_.resize(view + std::size_t{1});
            azimuths_.resize(cosines_.size());
            lights_.resize(cosines_.size());
        }
        views_.assign(material_, cosines_, weights(own.colors), forms(own.alphas), false);
    }

    /// Whether a light's lobes differ from those of the one before.
    bool changes(const LightLobes& own, std::size_t light) const {
        const std::size_t lobes = material_.lobes().size();
        const auto differ = [&](const auto& numbers) {
            const auto last = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.empty() ? 0 : light * lobes);
            return !numbers.empty() && !std::equal(last - static_cast<std::ptrdiff_t>(lobes), last, last);
        };
        return differ(own.colors) || differ(own.alphas);
    }

    LobeWeights weights(std::span<const Rgb> colors) {
        if (colors.empty()) {
            return material_.weights(cosines_, weights_);
        }
        weights_.clear();
        for (std::size_t view = 0; view < lights_.size(); ++view) {
            for (std::size_t i = 0; i < material_.lobes().size(); ++i) {
                weights_.push_back(material_.lobes()[i].scale(static_cast<float>(cosines_[view])) *
                                   colors[lights_[view] * material_.lobes().size() + i]);
            }
        }
        return {weights_, material_.lobes().size()};
    }

    /// Returns the form of each lobe at each view.
    LobeForms forms(std::span<const float> alphas) {
        forms_.clear();
        const std::span<const Lobe> lobes = material_.lobes();
        for (std::size_t view = 0; view < lights_.size() && material_.varies(); ++view) {
            for (std::size_t i = 0; i < lobes.size(); ++i) {
                LobeForm& form = forms_.emplace_back(lobe_form(lobes[i].shape));
                form.width = lobes[i].varying_width != 0 ? alphas[lights_[view] * lobes.size() + i] : form.width;
                form.azimuth = static_cast<float>(azimuths_[view]);
            }
        }
        return {forms_, lobes.size()};
    }

    /// Shades the lights in seen_.
    void shade(Radiance radiance, Effort effort) {
        std::fill(radiance.begin(), radiance.end(), Rgb(0));
        std::fill(effort.begin(), effort.end(), 0);
        for (std::size_t l = 0; l < views_.lobe_count(); ++l) {
            LobeViews& lobe = views_.lobe(l);
            seen_.shade(lobe, view_of_, material_.tolerance(), !effort.empty(), batch_,
                        [&](std::span<const std::uint32_t> numbers) {
                            if (numbers.empty()) {
                                add(
                                    lobe, [](std::size_t k) { return k; }, radiance, effort);
                            } else {
                                add(
                                    lobe, [&](std::size_t k) { return numbers[k]; }, radiance, effort);
                            }
                        });
        }
    }

    /// Adds what the batch found of a lobe. number(k): of the batch's light k.
    template <class Number>
    void add(const LobeViews& lobe, const Number& number, Radiance radiance, Effort effort) {
        const std::span<const float> values = batch_.values();
        if (lobe.has_one_weight()) {
            const Rgb weight = lobe.weight(0);
            for (std::size_t k = 0; k < values.size(); ++k) {
                radiance[number(k)] += weight * values[k];
            }
        } else {
            for (std::size_t k = 0; k < values.size(); ++k) {
                radiance[number(k)] += lobe.weight(view_of_[number(k)]) * values[k];
            }
        }
        for (std::size_t k = 0; k < values.size() && !effort.empty(); ++k) {
            effort[number(k)] = std::max(effort[number(k)], batch_.efforts()[k]);
        }
    }

    MaterialLobes material_;
    MaterialViews views_;
    LobeIntegrator batch_;
    std::vector<double> cosines_, azimuths_;
    std::vector<std::size_t> lights_;  // one that each view belongs to
    std::vector<LobeForm> forms_;
    std::vector<Rgb> weights_;  // of the lobes at each view, or at all
    std::vector<std::uint32_t> view_of_;
    LocalLights seen_;
};

LightShader::LightShader(const Bsdf& bsdf, const ShadeSettings& settings)
    : work_(std::make_unique<LightShaderWork>(bsdf, checked(settings))) {}
LightShader::~LightShader() = default;
LightShader::LightShader(LightShader&&) noexcept = default;
LightShader& LightShader::operator=(LightShader&&) noexcept = default;

template <class T>
void LightShader::spheres(In<Vec3<T>> centers, In<T> radii, In<double> cos_theta_o, Radiance radiance, Effort effort,
                          In<double> azimuth, const LightLobes& own) {
    check_size("radii", radii.size(), centers.size());
    work_->in_chunks(centers.size(), {cos_theta_o, azimuth}, own, radiance, effort,
                     [&](std::size_t first, Radiance sums, Effort most) {
                         work_->shade_spheres(centers.subspan(first, sums.size()), radii.subspan(first, sums.size()),
                                              sums, most);
                     });
}

template <class T>
void LightShader::polygons(In<Vec3<T>> vertices, int vertex_count, In<double> cos_theta_o, Radiance radiance,
                           Effort effort, In<double> azimuth, const LightLobes& own) {
    check_vertex_count(vertex_count);
    const auto k = static_cast<std::size_t>(vertex_count);
    const std::size_t count = vertices.size() / k;
    check_size("vertices", vertices.size(), count * k);
    work_->in_chunks(count, {cos_theta_o, azimuth}, own, radiance, effort,
                     [&](std::size_t first, Radiance sums, Effort most) {
                         work_->shade_polygons(vertices.subspan(first * k, sums.size() * k), k, sums, most);
                     });
}

template <class T>
void LightShader::disks(In<Vec3<T>> centers, In<Vec3<T>> half_axes_u, In<Vec3<T>> half_axes_v, In<double> cos_theta_o,
                        Radiance radiance, Effort effort, In<double> azimuth, const LightLobes& own) {
    const std::size_t count = centers.size();
    check_size("half_axes_u", half_axes_u.size(), count);
    check_size("half_axes_v", half_axes_v.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
        check_disk({Vec3d(centers[i]), Vec3d(half_axes_u[i]), Vec3d(half_axes_v[i])},
                   std::numeric_limits<T>::epsilon());
    }
    work_->in_chunks(
        count, {cos_theta_o, azimuth}, own, radiance, effort, [&](std::size_t first, Radiance sums, Effort most) {
            const auto disk = [&](std::size_t i) {
                return Ellipse{Vec3d(centers[first + i]), Vec3d(half_axes_u[first + i]), Vec3d(half_axes_v[first + i])};
            };
            work_->shade_disks(disk, sums, most);
        });
}

template void LightShader::spheres(In<Vec3<float>>, In<float>, In<double>, Radiance, Effort, In<double>,
                                   const LightLobes&);
template void LightShader::spheres(In<Vec3<double>>, In<double>, In<double>, Radiance, Effort, In<double>,
                                   const LightLobes&);
template void LightShader::polygons(In<Vec3<float>>, int, In<double>, Radiance, Effort, In<double>, const LightLobes&);
template void LightShader::polygons(In<Vec3<double>>, int, In<double>, Radiance, Effort, In<double>, const LightLobes&);
template void LightShader::disks(In<Vec3<float>>, In<Vec3<float>>, In<Vec3<float>>, In<double>, Radiance, Effort,
                                 In<double>, const LightLobes&);
template void LightShader::disks(In<Vec3<double>>, In<Vec3<double>>, In<Vec3<double>>, In<double>, Radiance, Effort,
                                 In<double>, const LightLobes&);

}  // namespace shlight
