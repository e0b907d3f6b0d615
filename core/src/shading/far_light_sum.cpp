// SPDX-License-Identifier: MIT
#include "shading/far_light_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "shlight/basis.h"

namespace shlight {
namespace {

/// A sum of fewer lights than this saves nothing.
constexpr std::size_t kFewestInSum = 128;
/// A light nearer than this many times the size of the box is no candidate.
constexpr double kLeastDistance = 4;
/// The order in which brightness is judged.
constexpr int kEstimateOrder = 4;
/// A point darker than this share of the mean may be off as one of this share.
constexpr double kLeastShare = 0.1;
/// From here on the power of a sum's bands is taken to stay as it is: lights without extent have no last band.
constexpr int kFirstOfLastBands = kFarLightOrder - 4;
/// Of a side of a box, lest points in a plane divide by 0 [m].
constexpr double kLeastSize = 1e-30;
/// Directions whose harmonics are held at a time.
constexpr std::size_t kBasisChunk = 64;

double sum_of_magnitudes(const Rgb& color) {
    const Rgb magnitude = glm::abs(color);
    return double{magnitude.x} + double{magnitude.y} + double{magnitude.z};
}

double largest(const Rgb& color) {
    return std::max({color.x, color.y, color.z});
}

}  // namespace

FarLightSum::FarLightSum(const FarLights& far, std::span<const MaterialLobes> materials, double tolerance)
    : far_(&far), materials_(materials), tolerance_(tolerance) {}

std::size_t FarLightSum::find(double random) const {
    const auto found = std::upper_bound(summed_.begin(), summed_.end(), random * summed_.back().brightness_up_to,
                                        [](double place, const SummedLight& l) { return place < l.brightness_up_to; });
    return static_cast<std::size_t>(std::min(found, summed_.end() - 1) - summed_.begin());
}

void FarLightSum::choose(const ShadingPoints& points) {
    points_ = &points;
    summed_.clear();
    if (far_->lights().empty() || !set_box()) {
        return;
    }
    find_candidates();
    if (candidates_.size() < kFewestInSum) {
        return;
    }
    const Limits limits = find_limits();
    for (std::size_t count = count_within(limits); count >= kFewestInSum; count /= 2) {
        add_up(low_, count, kFarLightOrder, corners_[0]);
        if (limits.left * last_power(corners_[0]) <= tolerance_) {
            take(count);
            return;
        }
    }
}

/// False if a lobe is too narrow for sums.
bool FarLightSum::set_box() {
    Vec3d high(-std::numeric_limits<double>::infinity());
    low_ = -high;
    for (std::size_t point = 0; point < points_->size(); ++point) {
        const std::uint32_t material = points_->material[point];
        for (std::size_t lobe = 0; lobe < materials_[material].lobes().size(); ++lobe) {
            if (far_->lobe(material, lobe).lobe == nullptr) {
                return false;
            }
        }
        low_ = glm::min(low_, points_->frame[point].origin);
        high = glm::max(high, points_->frame[point].origin);
    }
    size_ = high - low_;
    return points_->size() > 0;
}

void FarLightSum::find_candidates() {
    candidates_.clear();
    const Vec3d middle = low_ + 0.5 * size_;
    const double diagonal = glm::length(size_);
    for (std::size_t i = 0; i < far_->lights().size(); ++i) {
        const FarLight& light = far_->lights()[i];
        const double width = diagonal + 2 * light.extent;
        const double distance = glm::length(light.position - middle) - 0.5 * width;
        // A plane light's radiance has a kink where it goes over to the dark side.
        const double height = std::abs(glm::dot(light.normal, middle - light.position));
        const bool is_planar = light.normal != Vec3d(0);
        if (distance > kLeastDistance * width && (!is_planar || height > 0.5 * diagonal)) {
            const double cosine = is_planar ? std::min(1.0, (height + 0.5 * diagonal) / distance) : 1.0;
            const double closeness = width / distance;
            candidates_.push_back(
                {i, sum_of_magnitudes(light.intensity) * cosine / (distance * distance), closeness * closeness});
        }
    }
}

/// In the order 4 the sum is blurred, but not far from as bright.
void FarLightSum::estimate_brightness() {
    add_up(low_ + 0.5 * size_, candidates_.size(), kEstimateOrder, corners_[0]);
    brightness_.assign(points_->size(), 0.0);
    for (std::size_t point = 0; point < points_->size(); ++point) {
        const std::uint32_t material = points_->material[point];
        const float cosine = points_->cos_theta_o[point];
        RotatedLobe turned(frame_of(point));
        for (std::size_t lobe = 0; lobe < materials_[material].lobes().size(); ++lobe) {
            const float* coefficients = turned.coefficients(*far_->lobe(material, lobe).lobe, cosine, kEstimateOrder);
            const Rgb reflected =
                points_->weight(point, lobe) * RotatedLobe::reflected(corners_[0], coefficients, kEstimateOrder);
            brightness_[point] += std::max(double{reflected.x} + double{reflected.y} + double{reflected.z}, 0.0);
        }
    }
}

FarLightSum::Limits FarLightSum::find_limits() {
    estimate_brightness();
    const double sum = std::accumulate(brightness_.begin(), brightness_.end(), 0.0);
    if (!(sum > 0)) {
        return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    }
    const double least = kLeastShare * sum / static_cast<double>(points_->size());
    Limits limits = {0, 0};
    for (std::size_t point = 0; point < points_->size(); ++point) {
        Limits own = {0, 0};
        const std::uint32_t material = points_->material[point];
        const std::span<const Lobe> lobes = materials_[material].lobes();
        const float cosine = points_->cos_theta_o[point];
        for (std::size_t lobe = 0; lobe < lobes.size(); ++lobe) {
            const double scale = largest(glm::abs(points_->weight(point, lobe)));
            own.curved += scale * double{far_->lobe(material, lobe).curvature(cosine)};
            own.left += scale * double{far_->lobe(material, lobe).tail(cosine)};
        }
        const double reference = std::max(brightness_[point], least);
        limits.curved = std::max(limits.curved, own.curved / reference);
        limits.left = std::max(limits.left, own.left / reference);
    }
    return limits;
}

/// Puts the dimmest first. How many of them keep within the tolerance if they lie at random; for lights that lie
/// together it is fewer.
std::size_t FarLightSum::count_within(const Limits& limits) {
    std::sort(candidates_.begin(), candidates_.end(), [&](const Candidate& a, const Candidate& b) {
        return a.brightness * (limits.left + limits.curved * a.curvature) <
               b.brightness * (limits.left + limits.curved * b.curvature);
    });
    double curved = 0;
    double squares = 0;
    std::size_t count = 0;
    for (const Candidate& candidate : candidates_) {
        curved += candidate.brightness * candidate.curvature * limits.curved;
        squares += candidate.brightness * candidate.brightness;
        const double left = limits.left * std::sqrt(squares / (4 * std::numbers::pi));
        if (!(curved <= tolerance_ && left <= tolerance_)) {
            break;
        }
        ++count;
    }
    return count;
}

void FarLightSum::add_up(const Vec3d& place, std::size_t count, int order, ColorHarmonics& sum) {
    const auto size = static_cast<std::size_t>(coefficient_count(order));
    for (std::vector<float>& channel : sum) {
        channel.assign(size, 0.0F);
    }
    basis_.resize(kBasisChunk * size);
    for (std::size_t first = 0; first < count; first += kBasisChunk) {
        const std::size_t last = std::min(first + kBasisChunk, count);
        directions_.clear();
        for (std::size_t i = first; i < last; ++i) {
            directions_.emplace_back(far_->lights()[candidates_[i].light].position - place);
        }
        sh_basis(std::span<const Vec3f>(directions_), order, std::span(basis_).first((last - first) * size));
        for (std::size_t i = first; i < last; ++i) {
            const FarLight& light = far_->lights()[candidates_[i].light];
            const Rgb irradiance = light.intensity * static_cast<float>(light.irradiance(light.position - place));
            const float* row = &basis_[(i - first) * size];
            for (int c = 0; c < 3; ++c) {
                float* channel = sum[static_cast<std::size_t>(c)].data();
                for (std::size_t k = 0; k < size; ++k) {
                    channel[k] += irradiance[c] * row[k];
                }
            }
        }
    }
}

/// The root of a band's mean power per degree, among the last ones that there are; of all channels together.
double FarLightSum::last_power(const ColorHarmonics& sum) {
    double all = 0;
    for (const std::vector<float>& channel : sum) {
        double power = 0;
        for (auto k = static_cast<std::size_t>(coefficient_count(kFirstOfLastBands)); k < channel.size(); ++k) {
            power += double{channel[k]} * double{channel[k]};
        }
        all += std::sqrt(power / (coefficient_count(kFarLightOrder) - coefficient_count(kFirstOfLastBands)));
    }
    return all;
}

/// The first so many candidates; the first corner's sum is there.
void FarLightSum::take(std::size_t count) {
    for (std::size_t i = 1; i < corners_.size(); ++i) {
        const Vec3d corner(i & 1U ? size_.x : 0, i & 2U ? size_.y : 0, i & 4U ? size_.z : 0);
        add_up(low_ + corner, count, kFarLightOrder, corners_[i]);
    }
    std::size_t index_end = 0;
    double all = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const FarLight& light = far_->lights()[candidates_[i].light];
        all += sum_of_magnitudes(light.intensity) * light.irradiance(light.position - low_ - 0.5 * size_);
        summed_.push_back({candidates_[i].light, all});
        index_end = std::max(index_end, light.index + 1);
    }
    is_summed_.assign(index_end, 0);
    for (const SummedLight& lumped : summed_) {
        is_summed_[far_->lights()[lumped.light].index] = 1;
    }
    reflect();
}

void FarLightSum::reflect() {
    radiance_.assign(points_->size(), Rgb(0));
    for (std::size_t point = 0; point < points_->size(); ++point) {
        const std::uint32_t material = points_->material[point];
        const float cosine = points_->cos_theta_o[point];
        const std::array<float, 8> weights = corner_weights(point);
        RotatedLobe turned(frame_of(point));
        for (std::size_t lobe = 0; lobe < materials_[material].lobes().size(); ++lobe) {
            const float* coefficients = turned.coefficients(*far_->lobe(material, lobe).lobe, cosine, kFarLightOrder);
            Rgb sum(0);
            for (std::size_t i = 0; i < corners_.size(); ++i) {
                sum += weights[i] * RotatedLobe::reflected(corners_[i], coefficients, kFarLightOrder);
            }
            if (far_->all_positive()) {
                sum = glm::max(sum, Rgb(0));
            }
            radiance_[point] += points_->weight(point, lobe) * sum;
        }
    }
}

glm::dmat3 FarLightSum::frame_of(std::size_t point) const {
    const ShadingFrame& frame = points_->frame[point];
    return {frame.x, frame.y, frame.z};
}

std::array<float, 8> FarLightSum::corner_weights(std::size_t point) const {
    const Vec3d place = (points_->frame[point].origin - low_) / glm::max(size_, Vec3d(kLeastSize));
    std::array<float, 8> weights;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const Vec3d along(i & 1U ? place.x : 1 - place.x, i & 2U ? place.y : 1 - place.y,
                          i & 4U ? place.z : 1 - place.z);
        weights[i] = static_cast<float>(along.x * along.y * along.z);
    }
    return weights;
}

}  // namespace shlight
