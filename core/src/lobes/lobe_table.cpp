// SPDX-License-Identifier: MIT
#include "shlight/lobe_table.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "base/checks.h"
#include "lobes/lobe_moments.h"
#include "lobes/view_grid.h"

namespace shlight {
namespace {

using std::numbers::pi;

/// Values of an isotropic table that should be equal differ by no more than this share of them, or of the largest one.
constexpr double kSameShare = 1e-3, kSameOfLargest = 1e-6;

/// A peak is higher than this many times the least value within kPeakEnd [rad] of half vectors, and narrower than
/// kWidestPeak; wider lobes gain nothing from a boost.
constexpr double kPeakHeight = 3, kPeakEnd = 1, kWidestPeak = 0.5;
/// tanθ_h ÷ α where the GGX distribution is half as high as at θ_h = 0.
const double kHalfHeight = std::sqrt(std::numbers::sqrt2 - 1);
/// Views at which a peak is measured, and azimuths of half vectors and of views.
constexpr std::array<double, 3> kPeakViews = {0.1, 0.6, 1.0};
constexpr int kPeakAzimuths = 12;

/// Gauss points on each panel of albedos' rules, and azimuths of views of an anisotropic table.
constexpr int kAlbedoPoints = 4;
constexpr std::size_t kAlbedoAzimuths = 48;
/// Every so many views of view_grid.h has an albedo in an anisotropic table.
constexpr std::size_t kAlbedoStep = 4;

void check_numbers(const char* name, const std::vector<float>& numbers) {
    if (!std::all_of(numbers.begin(), numbers.end(), [](float x) { return x >= 0 && std::isfinite(x); })) {
        reject(std::string(name) + " must be finite and not negative");
    }
}

/// It errs by 1e-8 at the pole, where tables are smooth.
double polar_angle(const Vec3d& w) {
    return std::acos(std::clamp(w.z, -1.0, 1.0));
}

double azimuth_of(const Vec3d& w) {
    return std::atan2(w.y, w.x);
}

Vec3d direction(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

Vec3d turned(const Vec3d& w, double azimuth) {
    const double c = std::cos(azimuth);
    const double s = std::sin(azimuth);
    return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}

std::array<double, 4> half_vector_angles(const Vec3d& wi, const Vec3d& wo) {
    const Vec3d sum = wi + wo;
    const double across = std::hypot(sum.x, sum.y);
    const double length = std::hypot(across, sum.z);
    const double cosine = across > 0 ? sum.x / across : 1.0;
    const double sine = across > 0 ? sum.y / across : 0.0;
    // ω_i along the directions in which θ_h and φ_h grow.
    const double along = (sum.z * (cosine * wi.x + sine * wi.y) - across * wi.z) / length;
    const double beside = cosine * wi.y - sine * wi.x;
    return {std::atan2(across, sum.z), std::atan2(sine, cosine), std::atan2(glm::length(wi - wo), length),
            std::atan2(beside, along)};
}

/// ∫ f·cos dω.
double integrated(const LobeTable& table, double theta_o, double azimuth, int channel, const LobeRule& rule) {
    const Vec3d wo = direction(theta_o, azimuth);
    double sum = 0;
    for (std::size_t t = 0; t < rule.theta.nodes.size(); ++t) {
        const double theta = rule.theta.nodes[t];
        const double weight = rule.theta.weights[t] * std::sin(theta) * std::cos(theta);
        for (std::size_t p = 0; p < rule.phi.nodes.size(); ++p) {
            for (const double side : {-1.0, 1.0}) {
                const Vec3d wi = direction(theta, azimuth + pi + side * rule.phi.nodes[p]);
                sum += weight * rule.phi.weights[p] * table.value(wi, wo, channel);
            }
        }
    }
    return sum;
}

}  // namespace

TableAxis::TableAxis(std::vector<double> angles, double period) : angles_(std::move(angles)), period_(period) {
    if (angles_.empty()) {
        reject("axes must have at least one angle");
    }
    for (std::size_t i = 0; i < angles_.size(); ++i) {
        if (!std::isfinite(angles_[i]) || (i > 0 && !(angles_[i] > angles_[i - 1]))) {
            reject("axes must be finite and increasing");
        }
    }
    if (period > 0 && !(angles_.back() - angles_.front() < period)) {
        reject("axes must span less than their period");
    }
}

TableAxis::Place TableAxis::place(double angle) const {
    const std::size_t last = angles_.size() - 1;
    if (last == 0) {
        return {0, 0, 0};
    }
    if (period_ > 0) {
        angle -= period_ * std::floor((angle - angles_.front()) / period_);
        if (angle >= angles_.back()) {
            const double gap = angles_.front() + period_ - angles_.back();
            return {last, 0, std::min(1.0, (angle - angles_.back()) / gap)};
        }
    }
    const auto above = std::upper_bound(angles_.begin() + 1, angles_.end() - 1, angle);
    const auto high = static_cast<std::size_t>(above - angles_.begin());
    const double low_angle = angles_[high - 1];
    return {high - 1, high, std::clamp((angle - low_angle) / (angles_[high] - low_angle), 0.0, 1.0)};
}

LobeTable::LobeTable(TableAngles angles, std::array<TableAxis, 4> axes, int channels, std::vector<float> values,
                     std::vector<float> sampling_errors)
    : angles_(angles),
      axes_(std::move(axes)),
      channels_(channels),
      values_(std::move(values)),
      sampling_errors_(std::move(sampling_errors)) {
    if (channels != 1 && channels != 3) {
        reject("values must have 1 or 3 channels");
    }
    check_size(
        "values", values_.size(),
        axes_[0].size() * axes_[1].size() * axes_[2].size() * axes_[3].size() * static_cast<std::size_t>(channels));
    check_numbers("values", values_);
    check_numbers("sampling_errors", sampling_errors_);
    isotropic_ = axes_[1].size() == 1 && find_symmetry();
    width_ = find_width();
    find_albedos();
}

LobeTable LobeTable::with_sampling_errors(std::vector<float> errors) const {
    check_numbers("sampling_errors", errors);
    LobeTable table = *this;
    table.sampling_errors_ = std::move(errors);
    return table;
}

double LobeTable::interpolated(const std::array<double, 4>& angles, int channel) const {
    std::array<TableAxis::Place, 4> at;
    for (std::size_t k = 0; k < 4; ++k) {
        at[k] = axes_[k].place(angles[k]);
    }
    // Entries and weights at the ends of the first axes, and then of all.
    std::array<std::size_t, 16> entry{};
    std::array<double, 16> weight{1};
    std::size_t count = 1;
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t known = count;
        for (std::size_t i = 0; i < known; ++i) {
            const std::size_t first = entry[i] * axes_[k].size();
            if (at[k].share > 0) {
                entry[count] = first + at[k].high;
                weight[count++] = weight[i] * at[k].share;
            }
            entry[i] = first + at[k].low;
            weight[i] *= 1 - at[k].share;
        }
    }
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        sum += weight[i] * values_[entry[i] * static_cast<std::size_t>(channels_) + static_cast<std::size_t>(channel)];
    }
    return sum;
}

double LobeTable::value(const Vec3d& wi, const Vec3d& wo, int channel) const {
    if (angles_ == TableAngles::half_vector) {
        return interpolated(half_vector_angles(wi, wo), channel) / (wi.z + wo.z);
    }
    if (axes_[1].size() == 1) {
        const double between = std::atan2(wi.x * wo.y - wi.y * wo.x, wi.x * wo.x + wi.y * wo.y);
        return interpolated({polar_angle(wi), 0, polar_angle(wo), between}, channel);
    }
    return interpolated({polar_angle(wi), azimuth_of(wi), polar_angle(wo), azimuth_of(wo)}, channel);
}

double LobeTable::reflected(const Vec3d& wi, const Vec3d& wo, double azimuth, int channel) const {
    return wi.z * (azimuth == 0 ? value(wi, wo, channel) : value(turned(wi, azimuth), turned(wo, azimuth), channel));
}

bool LobeTable::find_symmetry() const {
    const double largest = *std::max_element(values_.begin(), values_.end());
    const auto same = [&](double a, double b) {
        return std::abs(a - b) <= kSameShare * std::max(a, b) + kSameOfLargest * largest;
    };
    for (const double a : axes_[0].angles()) {
        for (const double c : axes_[2].angles()) {
            for (const double d : axes_[3].angles()) {
                for (int channel = 0; channel < channels_; ++channel) {
                    if (!same(interpolated({a, 0, c, d}, channel), interpolated({a, 0, c, -d}, channel))) {
                        return false;
                    }
                }
            }
        }
    }
    return true;
}

/// The narrowest peak over views and azimuths of half vectors, of the sum of all channels.
double LobeTable::find_width() const {
    double width = 1;
    for (const double theta_d : kPeakViews) {
        for (int j = 0; j < kPeakAzimuths; ++j) {
            // Half vectors that tilt across the plane of the view, in which peaks are narrowest.
            const double azimuth = 2 * pi * j / kPeakAzimuths;
            const auto height = [&](double theta_h) {
                const Vec3d half = direction(theta_h, azimuth);
                const Vec3d side(-std::sin(azimuth), std::cos(azimuth), 0);
                const Vec3d wo = std::cos(theta_d) * half + std::sin(theta_d) * side;
                const Vec3d wi = std::cos(theta_d) * half - std::sin(theta_d) * side;
                double sum = 0;
                for (int channel = 0; channel < channels_; ++channel) {
                    sum += value(wi, wo, channel);
                }
                return sum;
            };
            const double peak = height(0);
            double floor = peak;
            for (double theta_h = 0.1; theta_h <= kPeakEnd; theta_h += 0.1) {
                floor = std::min(floor, height(theta_h));
            }
            if (!(peak > kPeakHeight * floor)) {
                continue;
            }
            double theta_h = 1e-3;
            while (theta_h < kPeakEnd && height(theta_h) > (peak + floor) / 2) {
                theta_h *= 1.05;
            }
            width = std::min(width, std::tan(theta_h) / kHalfHeight);
        }
    }
    return width < kWidestPeak ? width : 1;
}

void LobeTable::find_albedos() {
    const std::size_t step = isotropic_ ? 1 : kAlbedoStep;
    const std::size_t views = (kViewNodes - 1) / step + 1;
    azimuths_ = isotropic_ ? 1 : kAlbedoAzimuths;
    const auto channels = static_cast<std::size_t>(channels_);
    albedos_.assign(views * azimuths_ * channels, 0);
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(std::size_t{0}, views, [&](std::size_t view) {
            const double theta_o = least_grazing(view_angle(static_cast<int>(view * step)));
            const LobeRule rule = lobe_rule(width_, theta_o, kAlbedoPoints);
            for (std::size_t i = 0; i < azimuths_ * channels; ++i) {
                const std::size_t turn = i / channels;
                const double azimuth = 2 * pi * static_cast<double>(turn) / static_cast<double>(azimuths_);
                albedos_[view * azimuths_ * channels + i] =
                    static_cast<float>(integrated(*this, theta_o, azimuth, static_cast<int>(i % channels), rule));
            }
        });
    });
}

double LobeTable::albedo(double cos_theta_o, double azimuth, int channel) const {
    const std::size_t views = albedos_.size() / (azimuths_ * static_cast<std::size_t>(channels_));
    const double place =
        view_position(cos_theta_o) * static_cast<double>(views - 1) / static_cast<double>(kViewNodes - 1);
    const std::size_t low = std::min(static_cast<std::size_t>(place), views - 2);
    const double across = azimuth / (2 * pi) * static_cast<double>(azimuths_);
    const double turned = across - std::floor(across / static_cast<double>(azimuths_)) * static_cast<double>(azimuths_);
    const std::size_t first = std::min(static_cast<std::size_t>(turned), azimuths_ - 1);
    const auto at = [&](std::size_t view, std::size_t column) {
        return double{albedos_[(view * azimuths_ + column % azimuths_) * static_cast<std::size_t>(channels_) +
                               static_cast<std::size_t>(channel)]};
    };
    const auto of_view = [&](std::size_t view) {
        return std::lerp(at(view, first), at(view, first + 1), turned - static_cast<double>(first));
    };
    return std::lerp(of_view(low), of_view(low + 1), place - static_cast<double>(low));
}

double LobeTable::sampling_error(double cos_theta_o, int channel) const {
    const auto channels = static_cast<std::size_t>(channels_);
    const std::size_t views = sampling_errors_.size() / channels;
    if (views < 2) {
        return 0;
    }
    const double place =
        view_position(cos_theta_o) * static_cast<double>(views - 1) / static_cast<double>(kViewNodes - 1);
    const std::size_t low = std::min(static_cast<std::size_t>(place), views - 2);
    const float* row = &sampling_errors_[low * channels + static_cast<std::size_t>(channel)];
    return std::lerp(double{row[0]}, double{row[channels]}, place - static_cast<double>(low));
}

}  // namespace shlight
