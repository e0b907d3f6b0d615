// SPDX-License-Identifier: MIT
#include "lighting/environment_shading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <numbers>

#include "environment/map_lookup.h"
#include "lobes/lobe_rays.h"
#include "lobes/turned_lobes.h"
#include "shlight/basis.h"
#include "simd/dot_products.h"

namespace shlight {
namespace {

/// Directions that a lobe is summed over, along each side of the unit square, and the widths up to which few and some
/// of them do: the narrower a lobe is the less the picture changes over it. One of two widths takes the most.
constexpr std::size_t kFewAcross = 8, kSomeAcross = 16, kManyAcross = 24, kStretchedAcross = 32;
constexpr double kFewWidth = 0.001, kSomeWidth = 0.011;

/// Points of the unit square that these are made of.
template <std::size_t kAcross>
struct DirectionPoints {
    static constexpr std::size_t kCount = kAcross * kAcross;
    static_assert(kCount % kLobeRayLanes == 0 && kCount % kLookupLanes == 0);

    DirectionPoints() {
        for (std::size_t i = 0; i < kCount; ++i) {
            const std::size_t row = i / kAcross;
            u[i] = (static_cast<float>(i % kAcross) + 0.5F) / kAcross;
            v[i] = (static_cast<float>(row) + 0.5F) / kAcross;
        }
    }
    std::array<float, kCount> u, v;
};

/// What is known of them; elements are written before they are read.
template <std::size_t kAcross>
struct DirectionArrays {
    std::array<std::array<float, kAcross * kAcross>, 8> values;
};

/// Relative to the lobe's albedo and the picture's mean: if harmonics err by more, the lobe is summed over directions.
constexpr double kDirectionError = 5e-3;

/// A lobe less than this many times as wide as a texel sees spots as areas: its directions miss none that count.
constexpr double kLeastWidth = 1.0 / 32;
/// First band from which the power per degree of a picture is extrapolated as constant, as for bright points.
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

/// Widths between which the light that a lobe of varying width reflects is interpolated linearly. Their logarithm has
/// even steps down to a width that band 63 hardly sees, from where on the width itself has steps of the last length.
class TabulatedWidths {
  public:
    static constexpr std::size_t kCount = 37;

    static double width(std::size_t number) {
        const auto place = static_cast<double>(number);
        const double narrow = kNarrow * (1 - kStep * (place - kLogarithmic));
        return place <= kLogarithmic ? std::exp(-kStep * place) : std::max(narrow, kLeast);
    }
    /// The position of a width among them, less than kCount - 1.
    static float place(float width) {
        const auto last = static_cast<float>(kCount - 1) * (1 - std::numeric_limits<float>::epsilon());
        const auto own = static_cast<float>(width > kNarrow ? -std::log(width) / kStep
                                                            : kLogarithmic + (1 - width / kNarrow) / kStep);
        return std::clamp(own, 0.0F, last);
    }

  private:
    static constexpr double kStep = 0.125, kLogarithmic = 28, kNarrow = 0.030197383422318501, kLeast = kNarrow / 64;
};

}  // namespace

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
    spots_.emplace(*environment.map());
    for (const MaterialLobes& material : materials) {
        auto& plans = plans_.emplace_back();
        auto& width_plans = width_plans_.emplace_back();
        for (const Lobe& lobe : material.lobes()) {
            const bool varies = lobe.varying_width != 0 && !has_two_widths(lobe.shape);
            plans.push_back(varies ? Plan() : plan(lobe.shape));
            width_plans.push_back(varies ? std::make_unique<const ValuesByNumber<Plan>>(TabulatedWidths::kCount)
                                         : nullptr);
        }
    }
}

EnvironmentShading::PlanMix EnvironmentShading::plans(std::size_t material, std::size_t lobe, float width) const {
    if (width_plans_[material][lobe] == nullptr) {
        return {{&plans_[material][lobe], &plans_[material][lobe]}, 0};
    }
    const auto at = [&](std::size_t step) {
        return &width_plans_[material][lobe]->get(step, [&] {
            return plan(with_width(materials_[material].lobes()[lobe].shape, TabulatedWidths::width(step)));
        });
    };
    const float place = TabulatedWidths::place(width);
    const auto step = static_cast<std::size_t>(place);
    return {{at(step), at(step + 1)}, place - static_cast<float>(step)};
}

bool EnvironmentShading::sees_texels(const LobeShape& shape) const {
    return order_ == 0 && is_glossy(shape) && lobe_width(shape) < kLeastWidth * environment_->map()->texel();
}

bool EnvironmentShading::splits(std::size_t material, std::size_t lobe, const LobeForm& form) const {
    const LobeShape shape = materials_[material].shape(lobe, form);
    return environment_->map() != nullptr && !is_mirror(shape) && !sees_texels(shape);
}

EnvironmentShading::Plan EnvironmentShading::plan(const LobeShape& shape) const {
    if (is_mirror(shape) || has_two_widths(shape)) {
        return {};
    }
    const EnvironmentMap& map = *environment_->map();
    const int order = order_;
    const double tolerance = tolerance_;
    const bool may_be_narrow = order == 0 && is_glossy(shape);
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
        const bool narrow = may_be_narrow && error > std::max(kDirectionError, tolerance);
        plan.choices.push_back({chosen, narrow, error <= tolerance});
    }
    return plan;
}

EnvironmentShading::Choice EnvironmentShading::either(const Choice& a, const Choice& b) {
    return {std::max(a.order, b.order), a.directions || b.directions, a.met && b.met};
}

EnvironmentShading::Choice EnvironmentShading::choose(const PlanMix& mix, const LobeShape& shape, double cos_theta_o,
                                                      double azimuth) const {
    const Choice choice =
        either(choose(*mix.plans[0], cos_theta_o, azimuth), choose(*mix.plans[1], cos_theta_o, azimuth));
    return sees_texels(shape) ? Choice{choice.order, true, choice.met} : choice;
}

EnvironmentShading::Choice EnvironmentShading::choose(const Plan& plan, double cos_theta_o, double azimuth) {
    const RowTaps nodes = plan.lobe->nodes(cos_theta_o, azimuth);
    Choice choice = plan.choices[nodes.rows[0]];
    for (std::size_t i = 1; i < nodes.count; ++i) {
        choice = either(choice, plan.choices[nodes.rows[i]]);
    }
    return choice;
}

/// One point under a picture.
class EnvironmentShading::Point {
  public:
    Point(const EnvironmentMap& map, const ShadingFrame& frame, double cos_theta_o)
        : map_(&map),
          to_map_(map.to_map(frame.x), map.to_map(frame.y), map.to_map(frame.z)),
          view_(std::sqrt(1 - cos_theta_o * cos_theta_o), 0, cos_theta_o) {}

    const glm::dmat3& to_map() const { return to_map_; }
    const Vec3d& view() const { return view_; }

    /// The mean of what directions show of the picture, weighed with f·cos over their density.
    Rgb by_directions(const LobeShape& shape, bool with_spots) const {
        if (has_two_widths(shape)) {
            return by_directions<kStretchedAcross>(shape, with_spots);
        }
        const double width = lobe_width(shape);
        return width <= kFewWidth    ? by_directions<kFewAcross>(shape, with_spots)
               : width <= kSomeWidth ? by_directions<kSomeAcross>(shape, with_spots)
                                     : by_directions<kManyAcross>(shape, with_spots);
    }

  private:
    template <std::size_t kAcross>
    Rgb by_directions(const LobeShape& shape, bool with_spots) const {
        static const DirectionPoints<kAcross> points;
        constexpr std::size_t kDirections = DirectionPoints<kAcross>::kCount;
        DirectionArrays<kAcross> lanes;
        auto& [x, y, z, value, density, red, green, blue] = lanes.values;
        sample_lobe_rays(shape, view_, points.u.data(), points.v.data(), kDirections, {x.data(), y.data(), z.data()});
        const ShadingFrame own = {Vec3d(0), {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        weigh_lobe_rays(shape, own, view_, {x.data(), y.data(), z.data()}, kDirections, value.data(), density.data());
        const glm::mat3 to_map(to_map_);
        for (std::size_t i = 0; i < kDirections; ++i) {
            const Vec3f turned = to_map * Vec3f(x[i], y[i], z[i]);
            x[i] = turned.x;
            y[i] = turned.y;
            z[i] = turned.z;
            const bool above = density[i] > 0;
            value[i] = above ? value[i] / density[i] : 0.0F;
            density[i] = 1 / ((above ? density[i] : 1.0F) * kDirections);  // the solid angle
        }
        look_up_blurred(*map_, with_spots, {x.data(), y.data(), z.data()}, density.data(), kDirections,
                        {red.data(), green.data(), blue.data()});
        Rgb sum(0);
        float weights = 0;
        for (std::size_t i = 0; i < kDirections; ++i) {
            sum += value[i] * Rgb(red[i], green[i], blue[i]);
            weights += value[i];
        }
        return weights > 0 ? sum / weights : Rgb(0);
    }

    const EnvironmentMap* map_;
    glm::dmat3 to_map_;  // from the shading frame
    Vec3d view_;
};

/// Zonal lobes whose harmonics are held at a time: as many as fit the cache.
constexpr std::size_t kZonalAtOnce = 64;

/// Sums of harmonics that are wanted for a list of values.
class EnvironmentShading::Harmonics {
  public:
    explicit Harmonics(const ColorHarmonics& light) : light_(&light) {}

    /// Adds what a lobe reflects to value. azimuth: see TableShape. All stay where they are until `finish`. to_light:
    /// from the frame of the view.
    void add(const PlanMix& mix, float cos_theta_o, float own_azimuth, const glm::dmat3& to_light, int order,
             Rgb& value) {
        const ShProjection& lobe = *mix.plans[0]->lobe;
        const double azimuth = lobe.azimuth_of_view(own_azimuth);
        const glm::dmat3 turn = glm::dmat3({std::cos(azimuth), -std::sin(azimuth), 0},
                                           {std::sin(azimuth), std::cos(azimuth), 0}, {0, 0, 1});
        const Wanted wanted = {mix, cos_theta_o, own_azimuth, false, to_light * turn, order, &value};
        (lobe.is_zonal() ? zonal_ : turned_).push_back(wanted);
        if (lobe.has_sines()) {
            turned_.push_back(wanted);
            turned_.back().sines = true;
        }
    }

    void finish() {
        for (std::span<Wanted> rest = zonal_; !rest.empty();) {
            const auto alike = [&, first = rest[0]](const Wanted& own) {
                return own.mix.plans[0]->lobe == first.mix.plans[0]->lobe && own.order == first.order;
            };
            const auto others = std::stable_partition(rest.begin(), rest.end(), alike);
            const auto count = static_cast<std::size_t>(others - rest.begin());
            add_zonal(rest.first(count));
            rest = rest.subspan(count);
        }
        add_turned();
    }

  private:
    struct Wanted {
        PlanMix mix;
        float cos_theta_o, azimuth;
        bool sines;
        glm::dmat3 to_light;
        int order;
        Rgb* value;

        void terms(float* out) const {
            mix.plans[0]->lobe->coefficients(cos_theta_o, azimuth, sines, order, out);
            if (mix.share > 0) {
                std::array<float, kCosineMax> second;
                mix.plans[1]->lobe->coefficients(cos_theta_o, azimuth, sines, order, second.data());
                std::transform(out, out + cosine_count(order), second.begin(), out,
                               [&](float a, float b) { return a + mix.share * (b - a); });
            }
        }
    };

    /// Adds zonal lobes of one shape and order, as sums of P_l(ω·axis) = 4π/(2l+1) Σ_m Y_lm(axis) Y_lm(ω).
    void add_zonal(std::span<const Wanted> some) {
        const int order = some[0].order;
        std::array<float, kCosineMax> terms;
        some[0].terms(terms.data());
        ColorHarmonics reflected = *light_;
        for (int l = 0; l < order; ++l) {
            const float factor =
                terms[at(l, 0)] * std::sqrt(4 * std::numbers::pi_v<float> / static_cast<float>(2 * l + 1));
            for (std::vector<float>& channel : reflected) {
                std::for_each_n(&channel[static_cast<std::size_t>(l * l)], 2 * l + 1, [&](float& c) { c *= factor; });
            }
        }
        const auto size = static_cast<std::size_t>(coefficient_count(order));
        for (std::size_t first = 0; first < some.size(); first += kZonalAtOnce) {
            const auto own = some.subspan(first, std::min(kZonalAtOnce, some.size() - first));
            normals_.clear();
            std::transform(own.begin(), own.end(), std::back_inserter(normals_),
                           [](const Wanted& wanted) { return Vec3f(wanted.to_light[2]); });
            basis_.resize(size * own.size());
            sh_basis(std::span<const Vec3f>(normals_), order, std::span(basis_));
            for (std::size_t i = 0; i < own.size(); ++i) {
                Rgb sum;
                for (int c = 0; c < 3; ++c) {
                    dot_products(reflected[static_cast<std::size_t>(c)].data(), &basis_[i * size], size, 1, &sum[c]);
                }
                *own[i].value += sum;
            }
        }
    }

    /// Adds other lobes, sorted by order: a lobe shares the bands of the largest order in its group, with terms 0.
    void add_turned() {
        std::stable_sort(turned_.begin(), turned_.end(),
                         [](const Wanted& a, const Wanted& b) { return a.order < b.order; });
        for (std::size_t first = 0; first < turned_.size(); first += kTurnedLanes) {
            const auto some = std::span(turned_).subspan(first, std::min(kTurnedLanes, turned_.size() - first));
            lobes_.clear();
            for (std::size_t i = 0; i < kTurnedLanes; ++i) {
                const Wanted& own = some[std::min(i, some.size() - 1)];
                TurnedLobe& lobe =
                    lobes_.emplace_back(TurnedLobe{{}, BandRotation(own.to_light), own.sines ? 1.0F : 0.0F});
                own.terms(lobe.terms.data());
            }
            std::array<Rgb, kTurnedLanes> reflected;
            reflect_turned(lobes_, some.back().order, *light_, reflected);
            for (std::size_t i = 0; i < some.size(); ++i) {
                *some[i].value += reflected[i];
            }
        }
    }

    const ColorHarmonics* light_;
    std::vector<Wanted> zonal_, turned_;
    std::vector<TurnedLobe> lobes_;
    std::vector<Vec3f> normals_;
    std::vector<float> basis_;
};

void EnvironmentShading::shade(const ShadingPoints& points, UnshadowedParts& parts, RenderReport& report) const {
    for (std::vector<Rgb>* part : {&parts.smooth, &parts.spots}) {
        part->assign(lobe_stride_ * points.size(), Rgb(0));
    }
    if (environment_->map() == nullptr) {
        shade_constant(points, parts.smooth, report);
    } else {
        shade_map(points, parts, report);
    }
}

void EnvironmentShading::shade_constant(const ShadingPoints& points, std::span<Rgb> smooth,
                                        RenderReport& report) const {
    for (std::size_t point = 0; point < points.size(); ++point) {
        const MaterialLobes& material = materials_[points.material[point]];
        for (std::size_t lobe = 0; lobe < material.lobes().size(); ++lobe) {
            const LobeForm& form = points.forms(point)[lobe];
            if (is_mirror(material.shape(lobe, form))) {
                continue;
            }
            // A constant is one harmonic, and a lobe's own first coefficient its albedo.
            const double albedo = material.albedo(lobe, form, points.cos_theta_o[point]);
            smooth[lobe * points.size() + point] =
                static_cast<float>(albedo) * environment_->radiance(points.frame[point].z);
            report.order_counts[1] += points.hit_count(point);
        }
    }
}

template <class Function>
void EnvironmentShading::for_each_lobe(const ShadingPoints& points, const Function& function) const {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Point point(*environment_->map(), points.frame[i], points.cos_theta_o[i]);
        const MaterialLobes& material = materials_[points.material[i]];
        for (std::size_t lobe = 0; lobe < material.lobes().size(); ++lobe) {
            const LobeShape shape = material.shape(lobe, points.forms(i)[lobe]);
            if (!is_mirror(shape)) {
                function(i, lobe, shape, point, lobe * points.size() + i);
            }
        }
    }
}

void EnvironmentShading::shade_map(const ShadingPoints& points, UnshadowedParts& parts, RenderReport& report) const {
    Harmonics harmonics(environment_->map()->coefficients.channels);
    for_each_lobe(points,
                  [&](std::size_t i, std::size_t lobe, const LobeShape& shape, const Point& point, std::size_t at) {
                      if (has_two_widths(shape)) {
                          return;
                      }
                      const float cosine = points.cos_theta_o[i];
                      const LobeForm& form = points.forms(i)[lobe];
                      const PlanMix mix = plans(points.material[i], lobe, form.width);
                      const Choice choice = choose(mix, shape, cosine, form.azimuth);
                      if (!choice.directions) {
                          harmonics.add(mix, cosine, form.azimuth, point.to_map(), choice.order, parts.smooth[at]);
                      }
                  });
    harmonics.finish();
    for_each_lobe(
        points, [&](std::size_t i, std::size_t lobe, const LobeShape& shape, const Point& point, std::size_t at) {
            const std::uint32_t material = points.material[i];
            const LobeForm& form = points.forms(i)[lobe];
            const double cosine = points.cos_theta_o[i];
            const bool two_widths = has_two_widths(shape);
            if (two_widths && points.weight(i, lobe) == Rgb(0)) {
                return;
            }
            const Choice choice = two_widths ? Choice{0, true, true}
                                             : choose(plans(material, lobe, form.width), shape, cosine, form.azimuth);
            if (!sees_texels(shape)) {
                parts.spots[at] = spots_->reflected(shape, point.to_map(), point.view());
            }
            Rgb& smooth = parts.smooth[at];
            if (choice.directions) {
                smooth = static_cast<float>(materials_[material].albedo(lobe, form, cosine)) *
                         point.by_directions(shape, sees_texels(shape));
            }
            smooth = glm::max(smooth, Rgb(0));
            (choice.directions ? report.cubature_count : report.order_counts[static_cast<std::size_t>(choice.order)]) +=
                points.hit_count(i);
            report.over_tolerance += choice.met ? 0 : points.hit_count(i);
        });
}

}  // namespace shlight
