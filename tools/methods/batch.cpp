// SPDX-License-Identifier: MIT
#include "batch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/checks.h"
#include "regions/region_checks.h"
#include "shlight/sampling.h"

namespace shlight::methods {
namespace {

void check_method_order(const Method& method, int order) {
    if (order < 1 || order > method.largest_order) {
        reject("order must be 1 … " + std::to_string(method.largest_order) + " for method '" +
               std::string(method.name) + "', got " + std::to_string(order));
    }
}

[[noreturn]] void reject_light(const Method& method, const char* lights) {
    reject("method '" + std::string(method.name) + "' does not know " + lights);
}

std::uint32_t seed_of(const Options& options, std::size_t index) {
    return hash(options.seed, static_cast<std::uint32_t>(index));
}

/// light(i): light number i, after checks.
template <class T, class Light>
void each_cap(const Method& method, std::size_t count, int order, bool clip, Options options, std::size_t first,
              std::span<T> coefficients, const Light& light) {
    check_method_order(method, order);
    const CapFunction<T> function = functions_of<T>(method).cap;
    if (function == nullptr) {
        reject_light(method, "spheres and caps");
    }
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("coefficients", coefficients.size(), count * row);
    const Options given = options;
    for (std::size_t i = 0; i < count; ++i) {
        options.seed = seed_of(given, first + i);
        function(light(i), order, clip, options, coefficients.data() + i * row);
    }
}

void radiances_of(const LobeIntegrator& lobe, std::span<const SphericalCap> caps, std::span<const std::uint32_t> seeds,
                  std::span<Reflected> results) {
    lobe.radiances(caps, seeds, results);
}
void radiances_of(const LobeIntegrator& lobe, std::span<const SeenPolygon> polygons,
                  std::span<const std::uint32_t> seeds, std::span<Reflected> results) {
    for (std::size_t i = 0; i < polygons.size(); ++i) {
        results[i] = lobe.radiance(polygons[i], seeds[i]);
    }
}

/// A material's lobes at the view requested last.
class MaterialAtView {
  public:
    MaterialAtView(const ShadingMethod& method, const Bsdf& bsdf, const Options& options)
        : method_(method), lobes_(bsdf.lobes()), options_(options) {
        if (std::any_of(lobes_.begin(), lobes_.end(), [](const Lobe& lobe) { return is_mirror(lobe.shape); })) {
            reject("bsdf: method '" + std::string(method.name) + "' does not know perfect mirrors");
        }
    }

    void look(double cos_theta_o) {
        if (!(cos_theta_o >= 0 && cos_theta_o <= 1)) {
            reject("cos_theta_o must lie in [0, 1]");
        }
        if (cos_theta_o == cos_theta_o_) {
            return;
        }
        cos_theta_o_ = cos_theta_o;
        views_.clear();
        for (const Lobe& lobe : lobes_) {
            views_.push_back(method_.make(lobe.shape, cos_theta_o, options_));
        }
    }

    /// A run of lights with the same view; index: of the first one.
    template <class Region>
    void shade(std::span<const Region> regions, std::size_t index, std::span<Rgb> radiance,
               std::span<std::int32_t> effort) {
        std::fill(radiance.begin(), radiance.end(), Rgb(0));
        std::fill(effort.begin(), effort.end(), 0);
        seeds_.resize(regions.size());
        results_.resize(regions.size());
        for (std::size_t lobe = 0; lobe < lobes_.size(); ++lobe) {
            for (std::size_t i = 0; i < regions.size(); ++i) {
                seeds_[i] = hash(seed_of(options_, index + i), static_cast<std::uint32_t>(lobe));
            }
            radiances_of(*views_[lobe], regions, seeds_, results_);
            const Rgb scale = lobes_[lobe].scale(static_cast<float>(cos_theta_o_));
            for (std::size_t i = 0; i < regions.size(); ++i) {
                const Reflected& r = results_[i];
                radiance[i] += scale * static_cast<float>(r.value);
                effort[i] = std::max(effort[i], static_cast<std::int32_t>(r.points > 0 ? r.points : options_.order));
            }
        }
    }

  private:
    const ShadingMethod& method_;
    const std::vector<Lobe>& lobes_;
    Options options_;
    double cos_theta_o_ = -1;
    std::vector<std::unique_ptr<LobeIntegrator>> views_;
    std::vector<std::uint32_t> seeds_;
    std::vector<Reflected> results_;
};

template <class Region>
void shade_each(const ShadingMethod& method, const Bsdf& bsdf, std::span<const double> cos_theta_o,
                const Options& options, std::size_t first, std::span<Rgb> radiance, std::span<std::int32_t> effort,
                const Region& region) {
    check_size("cos_theta_o", cos_theta_o.size(), radiance.size());
    check_size("effort", effort.size(), radiance.size());
    if (method.harmonic && (options.order < 1 || options.order > kMaxOrder)) {
        reject("order must be 1 … " + std::to_string(kMaxOrder) + " for method '" + std::string(method.name) + "'");
    }
    if (method.sampled && options.samples < 1) {
        reject("samples must be at least 1");
    }
    MaterialAtView at_view(method, bsdf, options);
    std::vector<decltype(region(0))> regions;
    for (std::size_t begin = 0; begin < radiance.size(); begin += regions.size()) {
        at_view.look(cos_theta_o[begin]);
        regions.clear();
        for (std::size_t i = begin; i < radiance.size() && cos_theta_o[i] == cos_theta_o[begin]; ++i) {
            regions.push_back(region(i));
        }
        at_view.shade<decltype(region(0))>(regions, first + begin, radiance.subspan(begin, regions.size()),
                                           effort.subspan(begin, regions.size()));
    }
}

}  // namespace

template <class T>
void sphere_coefficients(const Method& method, std::span<const Vec3<T>> centers, std::span<const T> radii, int order,
                         bool clip, const Options& options, std::size_t first, std::span<T> coefficients) {
    check_size("radii", radii.size(), centers.size());
    each_cap(method, centers.size(), order, clip, options, first, coefficients, [&](std::size_t i) {
        const Vec3d center(centers[i]);
        check_sphere(center, radii[i], std::numeric_limits<T>::epsilon());
        return CapLight{CapLight::Kind::sphere, center, radii[i]};
    });
}

template <class T>
void cap_coefficients(const Method& method, std::span<const Vec3<T>> axes, std::span<const T> half_angles, int order,
                      bool clip, const Options& options, std::size_t first, std::span<T> coefficients) {
    check_size("half_angles", half_angles.size(), axes.size());
    each_cap(method, axes.size(), order, clip, options, first, coefficients, [&](std::size_t i) {
        const Vec3d axis(axes[i]);
        check_cap(axis, half_angles[i]);
        return CapLight{CapLight::Kind::angle, axis, half_angles[i]};
    });
}

template <class T>
void polygon_coefficients(const Method& method, std::span<const Vec3<T>> vertices, int vertex_count, int order,
                          bool clip, const Options& options, std::size_t first, std::span<T> coefficients) {
    check_method_order(method, order);
    const PolygonFunction<T> function = functions_of<T>(method).polygon;
    if (function == nullptr) {
        reject_light(method, "polygons");
    }
    check_vertex_count(vertex_count);
    const auto k = static_cast<std::size_t>(vertex_count);
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    const std::size_t count = vertices.size() / k;
    check_size("vertices", vertices.size(), count * k);
    check_size("coefficients", coefficients.size(), count * row);
    Options own = options;
    for (std::size_t i = 0; i < count; ++i) {
        const auto given = vertices.subspan(i * k, k);
        std::vector<Vec3d> prepared(given.begin(), given.end());
        prepare_polygons<T>(prepared, vertex_count);
        const std::vector<Vec3<T>> polygon(prepared.begin(), prepared.end());
        own.seed = seed_of(options, first + i);
        function(polygon, order, clip, own, coefficients.data() + i * row);
    }
}

void shade_spheres(const ShadingMethod& method, std::span<const Vec3d> centers, std::span<const double> radii,
                   const Bsdf& bsdf, std::span<const double> cos_theta_o, const Options& options, std::size_t first,
                   std::span<Rgb> radiance, std::span<std::int32_t> effort) {
    check_size("radii", radii.size(), centers.size());
    check_size("radiance", radiance.size(), centers.size());
    shade_each(method, bsdf, cos_theta_o, options, first, radiance, effort, [&](std::size_t i) {
        check_sphere(centers[i], radii[i], std::numeric_limits<float>::epsilon());
        return cap_of_sphere(centers[i], radii[i]);
    });
}

void shade_polygons(const ShadingMethod& method, std::span<const Vec3d> vertices, int vertex_count, const Bsdf& bsdf,
                    std::span<const double> cos_theta_o, const Options& options, std::size_t first,
                    std::span<Rgb> radiance, std::span<std::int32_t> effort) {
    check_vertex_count(vertex_count);
    const auto k = static_cast<std::size_t>(vertex_count);
    check_size("vertices", vertices.size(), radiance.size() * k);
    std::vector<Vec3d> prepared(vertices.begin(), vertices.end());
    prepare_polygons<float>(prepared, vertex_count);
    shade_each(method, bsdf, cos_theta_o, options, first, radiance, effort,
               [&](std::size_t i) { return SeenPolygon(std::span(prepared).subspan(i * k, k)); });
}

template void sphere_coefficients(const Method&, std::span<const Vec3<float>>, std::span<const float>, int, bool,
                                  const Options&, std::size_t, std::span<float>);
template void cap_coefficients(const Method&, std::span<const Vec3<float>>, std::span<const float>, int, bool,
                               const Options&, std::size_t, std::span<float>);
template void polygon_coefficients(const Method&, std::span<const Vec3<float>>, int, int, bool, const Options&,
                                   std::size_t, std::span<float>);
template void sphere_coefficients(const Method&, std::span<const Vec3<double>>, std::span<const double>, int, bool,
                                  const Options&, std::size_t, std::span<double>);
template void cap_coefficients(const Method&, std::span<const Vec3<double>>, std::span<const double>, int, bool,
                               const Options&, std::size_t, std::span<double>);
template void polygon_coefficients(const Method&, std::span<const Vec3<double>>, int, int, bool, const Options&,
                                   std::size_t, std::span<double>);

}  // namespace shlight::methods
