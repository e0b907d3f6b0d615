// SPDX-License-Identifier: MIT
#include "environment/environment_shading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>

#include "environment/environment_map.h"
#include "lobes/rotated_lobe.h"
#include "lobes/view_grid.h"

namespace shlight {
namespace {

/// Directions along each side of the unit square that a narrow lobe is summed over.
constexpr int kDirections = 16;
/// Relative to the lobe's albedo and the picture's mean: harmonics that err by more are not left alone.
constexpr double kDirectionError = 5e-3;

/// A lobe this many times as wide as a texel sees a spot as one direction.
constexpr double kTexelsPerWidth = 2;
/// From here on the spectrum of a picture is taken to go on as it is: what is brightest has the same power per degree
/// in all bands.
constexpr int kFirstOfLastBands = 48;

/// The root mean square error, over all turns of the picture, that orders 1 … 64 leave, ÷ the lobe's albedo and the
/// picture's mean radiance: bands are turned independently.
std::array<double, kMaxOrder> relative_errors(const float* lobe, double lobe_tail, const RadianceCoefficients& light) {
    std::array<double, kMaxOrder> errors;
    double last = 0;
    for (int l = kFirstOfLastBands; l < kMaxOrder; ++l) {
        last += light.powers[static_cast<std::size_t>(l)] / (2 * l + 1) / (kMaxOrder - kFirstOfLastBands);
    }
    double left = lobe_tail * last;
    for (int l = kMaxOrder - 1; l >= 0; --l) {
        const auto i = static_cast<std::size_t>(l);
        errors[i] = std::sqrt(left / (double{lobe[0]} * light.powers[0]));
        left += double{lobe[i]} * light.powers[i] / (2 * l + 1);
    }
    return errors;
}

double albedo_of(const MaterialLobes& material, std::size_t lobe, float width, double cos_theta_o) {
    const Lobe& own = material.lobes()[lobe];
    return own.varying_width != 0 ? lobe_albedo(material.shape(lobe, width), cos_theta_o) : own.albedo(cos_theta_o);
}

/// Of the logarithm of a width that varies; between steps what is reflected is linear.
constexpr float kWidthStep = 0.125F;
constexpr std::size_t kWidthSteps = 96;  // down to the least width

}  // namespace

class EnvironmentShading::WidthPlans {
  public:
    WidthPlans(const EnvironmentShading& shading, const LobeShape& shape) : shading_(&shading), shape_(shape) {}

    PlanMix at(float width) const {
        const float place = std::clamp(-std::log(width) / kWidthStep, 0.0F, static_cast<float>(kWidthSteps - 2));
        const auto step = static_cast<std::size_t>(place);
        return {{&plan(step), &plan(step + 1)}, place - static_cast<float>(step)};
    }

  private:
    const Plan& plan(std::size_t step) const {
        Entry& entry = entries_[step];
        std::call_once(entry.once, [&] {
            const double width = std::exp(-double{kWidthStep} * static_cast<double>(step));
            entry.plan = shading_->plan(with_width(shape_, width));
        });
        return entry.plan;
    }

    struct Entry {
        std::once_flag once;
        Plan plan;
    };
    const EnvironmentShading* shading_;
    LobeShape shape_;
    mutable std::array<Entry, kWidthSteps> entries_;
};

EnvironmentShading::~EnvironmentShading() = default;

EnvironmentShading::EnvironmentShading(const Environment& environment, std::span<const MaterialLobes> materials,
                                       std::size_t lobe_stride, int order, double tolerance)
    : environment_(&environment),
      materials_(materials),
      lobe_stride_(lobe_stride),
      order_(order),
      tolerance_(tolerance) {
    if (environment.map() == nullptr) {
        return;
    }
    for (const MaterialLobes& material : materials) {
        auto& plans = plans_.emplace_back();
        auto& width_plans = width_plans_.emplace_back();
        for (const Lobe& lobe : material.lobes()) {
            const bool varies = lobe.varying_width != 0;
            plans.push_back(varies ? Plan() : plan(lobe.shape));
            width_plans.push_back(varies ? std::make_unique<const WidthPlans>(*this, lobe.shape) : nullptr);
        }
    }
}

EnvironmentShading::PlanMix EnvironmentShading::plans(std::size_t material, std::size_t lobe, float width) const {
    const auto& varying = width_plans_[material][lobe];
    return varying != nullptr ? varying->at(width) : PlanMix{{&plans_[material][lobe], &plans_[material][lobe]}, 0};
}

bool EnvironmentShading::sees_texels(const LobeShape& shape) const {
    return order_ == 0 && is_glossy(shape) && lobe_width(shape) < kTexelsPerWidth * environment_->map()->texel;
}

bool EnvironmentShading::splits(std::size_t material, std::size_t lobe, float width) const {
    const LobeShape shape = materials_[material].shape(lobe, width);
    return environment_->map() != nullptr && !is_mirror(shape) && !sees_texels(shape);
}

EnvironmentShading::Plan EnvironmentShading::plan(const LobeShape& shape) const {
    if (is_mirror(shape)) {
        return {};
    }
    const EnvironmentMap& map = *environment_->map();
    const int order = order_;
    const double tolerance = tolerance_;
    const bool may_be_narrow = order == 0 && is_glossy(shape);
    const bool sees = sees_texels(shape);
    Plan plan = {sh_projection(shape), {}};
    for (std::size_t node = 0; node < plan.lobe->node_count(); ++node) {
        const auto errors = relative_errors(plan.lobe->powers(node), plan.lobe->tail(node), map.coefficients);
        int chosen = order;
        if (order == 0) {
            const auto sufficient =
                std::find_if(errors.begin(), errors.end() - 1, [&](double error) { return error <= tolerance; });
            chosen = static_cast<int>(sufficient - errors.begin()) + 1;
        }
        const double error = errors[static_cast<std::size_t>(chosen - 1)];
        const bool narrow = sees || (may_be_narrow && error > std::max(kDirectionError, tolerance));
        plan.choices.push_back({narrow ? kMaxOrder : chosen, narrow, error <= tolerance});
    }
    return plan;
}

EnvironmentShading::Choice EnvironmentShading::choose(const PlanMix& mix, double cos_theta_o) {
    const Choice a = choose(*mix.plans[0], cos_theta_o);
    const Choice b = choose(*mix.plans[1], cos_theta_o);
    return {std::max(a.order, b.order), a.directions || b.directions, a.met && b.met};
}

EnvironmentShading::Choice EnvironmentShading::choose(const Plan& plan, double cos_theta_o) {
    if (plan.choices.size() == 1) {
        return plan.choices[0];
    }
    const std::size_t low = ViewInterval(cos_theta_o).low;
    const Choice& a = plan.choices[low];
    const Choice& b = plan.choices[low + 1];
    return {std::max(a.order, b.order), a.directions || b.directions, a.met && b.met};
}

/// One point under a picture.
class EnvironmentShading::Point {
  public:
    Point(const EnvironmentMap& map, const ShadingFrame& frame, double cos_theta_o)
        : map_(&map),
          to_map_(map.to_map(frame.x), map.to_map(frame.y), map.to_map(frame.z)),
          view_(std::sqrt(1 - cos_theta_o * cos_theta_o), 0, cos_theta_o),
          turned_(to_map_) {}

    /// Without the spots.
    Rgb by_harmonics(const ShProjection& lobe, int order) {
        const float* turned = turned_.coefficients(lobe, static_cast<float>(view_.z), order);
        return RotatedLobe::reflected(map_->coefficients.channels, turned, order);
    }

    Rgb spots(const LobeShape& shape) const {
        Rgb sum(0);
        for (const BrightSpot& spot : map_->spots) {
            const Vec3d direction = spot.direction * to_map_;
            if (direction.z > 0) {
                sum += static_cast<float>(lobe_value(shape, direction, view_)) * spot.irradiance;
            }
        }
        return sum;
    }

    /// The mean of what the directions show of the remainder, weighed with f·cos over their density.
    Rgb by_directions(const LobeShape& shape, bool with_spots) const {
        const RadiancePyramid& remainder = with_spots ? map_->whole_remainder : map_->remainder;
        Vec3d sum(0);
        double weights = 0;
        for (int i = 0; i < kDirections * kDirections; ++i) {
            const int row = i / kDirections;
            const glm::dvec2 point = glm::dvec2(i % kDirections + 0.5, row + 0.5) / double{kDirections};
            const Vec3d direction = sample_lobe(shape, view_, point);
            if (direction.z > 0) {
                const double density = lobe_density(shape, view_, direction);
                const double weight = lobe_value(shape, direction, view_) / density;
                const double solid_angle = 1 / (density * kDirections * kDirections);
                sum += weight * Vec3d(remainder.radiance(to_map_ * direction, solid_angle));
                weights += weight;
            }
        }
        return weights > 0 ? Rgb(sum / weights) : Rgb(0);
    }

    Rgb mirrored() const { return map_->picture.radiance(to_map_ * shlight::mirrored(view_)); }

  private:
    const EnvironmentMap* map_;
    glm::dmat3 to_map_;  // from the shading frame
    Vec3d view_;
    RotatedLobe turned_;
};

void EnvironmentShading::shade(const ShadingPoints& points, std::vector<DirectLightParts>& values,
                               RenderReport& report) const {
    values.assign(lobe_stride_ * points.size(), {});
    if (environment_->map() == nullptr) {
        shade_constant(points, values, report);
    } else {
        shade_map(points, values, report);
    }
}

void EnvironmentShading::shade_constant(const ShadingPoints& points, std::span<DirectLightParts> values,
                                        RenderReport& report) const {
    for (std::size_t point = 0; point < points.size(); ++point) {
        const auto lobes = materials_[points.material[point]].lobes();
        for (std::size_t i = 0; i < lobes.size(); ++i) {
            // A constant is one harmonic, and a lobe's own first coefficient its albedo.
            const double albedo =
                albedo_of(materials_[points.material[point]], i, points.widths(point)[i], points.cos_theta_o[point]);
            values[i * points.size() + point].smooth =
                static_cast<float>(albedo) * environment_->radiance(points.frame[point].z);
            (is_mirror(lobes[i].shape) ? report.mirror_count : report.order_counts[1]) += points.hit_count(point);
        }
    }
}

void EnvironmentShading::shade_map(const ShadingPoints& points, std::span<DirectLightParts> values,
                                   RenderReport& report) const {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::uint32_t material = points.material[i];
        const double cosine = points.cos_theta_o[i];
        Point point(*environment_->map(), points.frame[i], cosine);
        for (std::size_t lobe = 0; lobe < materials_[material].lobes().size(); ++lobe) {
            const float width = points.widths(i)[lobe];
            const LobeShape shape = materials_[material].shape(lobe, width);
            const auto albedo = static_cast<float>(albedo_of(materials_[material], lobe, width, cosine));
            DirectLightParts& value = values[lobe * points.size() + i];
            if (is_mirror(shape)) {
                value.smooth = albedo * point.mirrored();
                report.mirror_count += points.hit_count(i);
                continue;
            }
            const PlanMix mix = plans(material, lobe, width);
            const Choice choice = choose(mix, cosine);
            value.smooth = (1 - mix.share) * point.by_harmonics(*mix.plans[0]->lobe, choice.order);
            if (mix.share > 0) {
                value.smooth += mix.share * point.by_harmonics(*mix.plans[1]->lobe, choice.order);
            }
            if (!sees_texels(shape)) {
                value.spots = point.spots(shape);
            }
            if (choice.directions) {
                value.smooth += albedo * point.by_directions(shape, sees_texels(shape));
            }
            value.smooth = glm::max(value.smooth, Rgb(0));
            (choice.directions ? report.cubature_count : report.order_counts[static_cast<std::size_t>(choice.order)]) +=
                points.hit_count(i);
            report.over_tolerance += choice.met ? 0 : points.hit_count(i);
        }
    }
}

}  // namespace shlight
