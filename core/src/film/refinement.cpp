// SPDX-License-Identifier: MIT
#include "film/refinement.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "lighting/ray_sums.h"
#include "shlight/parallel.h"

namespace shlight {
namespace {

/// Share of a neighbour's variance that a pixel may have without its rays showing it: that of a tenth of its area, in
/// which an edge or a wire of the neighbour goes on between the rays.
constexpr double kNeighbourShare = 0.1;
/// So many rays say nothing of it yet.
constexpr double kMissingRays = 16;

/// Variance of a unit step within the pixel after subtraction of the linear part; for steps between pixels, and of
/// alpha.
constexpr double kEdgeVariance = 1.0 / 16;
/// Times the noise of shadow rays that are drawn independently, at most.
constexpr double kMostNoise = 4;
/// Pixels around one whose noise counts as its own: a pixel's few rays may agree by chance, and one that ended by its
/// own rays alone would be too bright more often than too dark.
constexpr int kNoiseReach = 2;
/// The number of camera rays from which on a pixel's own rays tell more of its noise than those around it do.
constexpr double kOwnRays = 64;
/// The squared error by shadow rays falls with this power of their number: 1 behind many thin things, 1.5 at one edge.
constexpr double kNoiseDecay = 1.25;
/// The squared error of a mean, expected by that, ÷ the squared difference between the means of its two halves.
const double kErrorByHalves = std::exp2(-1 - kNoiseDecay);
/// The same ratio of camera rays that are drawn by themselves.
constexpr double kFineErrorByHalves = 0.25;
/// Times the error that edges explain, above which a pixel shows that it holds what is finer.
constexpr double kMostByEdges = 3;
/// Share of the squared error that is allowed from which on it counts as such.
constexpr double kCountedShare = 0.1;
/// Share of the pixels around one that show so: at an edge few do.
constexpr float kLeastFinePixels = 0.3F;

Vec3d color(std::span<const float> image, std::size_t pixel) {
    return {image[4 * pixel], image[4 * pixel + 1], image[4 * pixel + 2]};
}

/// The one of these; made if it is missing.
RefinementGroup& group_of(int from, int to, std::vector<RefinementGroup>& groups) {
    const auto known = std::find_if(groups.begin(), groups.end(),
                                    [&](const RefinementGroup& g) { return g.from == from && g.to == to; });
    return known != groups.end() ? *known : groups.emplace_back(RefinementGroup{from, to, 0, {}, {}});
}

}  // namespace

Refinement::Refinement(int width, int height, const PixelSampling& sampling, bool depth_of_field)
    : width_(width),
      height_(height),
      first_samples_(static_cast<std::uint32_t>(sampling.first_samples)),
      good_enough_(sampling.noise_threshold * sampling.noise_threshold),
      depth_of_field_(depth_of_field),
      states_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      noises_(states_.size()) {
    const auto most = static_cast<std::uint32_t>(sampling.max_samples);
    if (first_samples_ < most) {
        first_samples_ = std::bit_ceil(first_samples_);
        while (samples(most_level_ + 1) <= most) {
            ++most_level_;
        }
        while (least_level_ < most_level_ && samples(least_level_) < static_cast<std::uint32_t>(sampling.min_samples)) {
            ++least_level_;
        }
    }
    rays_left_ = static_cast<double>(states_.size()) * samples(least_level_);
    for (int level = 0; level <= most_level_; ++level) {
        noise_shares_.push_back(std::pow(1.0 * samples(0) / samples(level), kNoiseDecay));
    }
}

/// Calls f with the index of the pixel and of each in the picture that is at most so many columns and rows away.
template <class Function>
void Refinement::for_each_around(int column, int row, int reach, const Function& f) const {
    for (int y = std::max(row - reach, 0); y <= std::min(row + reach, height_ - 1); ++y) {
        for (int x = std::max(column - reach, 0); x <= std::min(column + reach, width_ - 1); ++x) {
            f(index(x, y));
        }
    }
}

void Refinement::merge(const Pixel& pixel, int level, const PixelSums& sums, std::span<float> image) {
    const std::size_t i = index(pixel.column, pixel.row);
    State& state = states_[i];
    const double before = kept_samples(state.level);
    const double all = samples(level);
    const Vec3d old = before > 0 ? color(image, i) : Vec3d(0);
    const Vec3d difference = before > 0 ? old - sums.radiance / static_cast<double>(sums.rays) : Vec3d(0);
    const Vec3d radiance = (before * old + sums.radiance) / all;
    const double alpha = before > 0 ? (before * image[4 * i + 3] + sums.opacity) / all : sums.opacity / all;
    for (int channel = 0; channel < 3; ++channel) {
        image[4 * i + static_cast<std::size_t>(channel)] = static_cast<float>(radiance[channel]);
    }
    image[4 * i + 3] = static_cast<float>(alpha);
    // Variance of all rays: the mean of the variances, plus that of the means' squared distances from the common mean.
    const double old_share = before / all;
    const Vec3d variance = old_share * Vec3d(state.variance) + (1 - old_share) * sums.variance() +
                           old_share * (1 - old_share) * difference * difference;
    if (kept_samples(level) > 0) {
        noises_[i] = merged_noise(i, level, sums, old, radiance, variance);
    }
    LightBits visibility = state.visibility;
    visibility |= sums.visibility;
    state = {Rgb(variance), 0, static_cast<std::int16_t>(level), round_, visibility, false};
}

Refinement::Noise Refinement::merged_noise(std::size_t pixel, int level, const PixelSums& sums, const Vec3d& old,
                                           const Vec3d& radiance, const Vec3d& variance) const {
    const double before = kept_samples(states_[pixel].level);
    const double all = samples(level);
    const Vec3d scale = radiance * radiance + least_square_;
    const double share = noise_share(level);
    const auto at_first = [&](const Vec3d& squared_error) {
        return static_cast<float>(mean(quotient(squared_error, scale)) / share);
    };
    Noise noise;
    noise.shared = at_first(sums.shared_noise / (all * all));
    noise.pixels = 1;
    if (before > 0) {
        const double factor = before * before / (all * all) * noise_share(states_[pixel].level) / share;
        noise.shared += static_cast<float>(factor * noises_[pixel].shared);
    }
    if (all > 1) {
        const double half = std::floor(all / 2);
        const Vec3d early = (before * old + sums.early) / half;
        const Vec3d late = (all * radiance - half * early) / (all - half);
        const Vec3d independent = sums.noise / (all * static_cast<double>(sums.rays));
        const Vec3d squared_difference = (early - late) * (early - late);
        const Vec3d by_shadows = glm::min(kErrorByHalves * squared_difference, kMostNoise * independent);
        noise.seen = at_first(by_shadows);
        noise.independent = at_first(independent);
        const double of_ray = mean(quotient(variance, scale));
        const double by_camera = mean(quotient(kFineErrorByHalves * squared_difference - by_shadows, scale));
        noise.variance = static_cast<float>(of_ray);
        noise.fine = static_cast<float>(all * by_camera - kMostByEdges * of_ray / evenness(level));
        noise.fine_pixels = noise.fine > kCountedShare * all * good_enough_ ? 1 : 0;
    }
    return noise;
}

void Refinement::begin_again() {
    for (State& state : states_) {
        state.level = -1;
    }
}

void Refinement::set_mean(std::span<const float> image) {
    double sum = 0;
    for (std::size_t i = 0; i < states_.size(); ++i) {
        sum += mean(color(image, i));
    }
    const double average = sum / static_cast<double>(states_.size());
    least_square_ = 0.01 * average * average;
}

std::vector<RefinementGroup> Refinement::next_round(std::span<const float> image, int threads, const Stopped& stopped) {
    set_mean(image);
    std::vector<Row> rows(static_cast<std::size_t>(height_));
    parallel_for(rows.size(), threads, [&](std::size_t row) {
        end_if(stopped);
        rows[row] = next_of(static_cast<int>(row), image);
    });
    std::vector<RefinementGroup> groups;
    double errors = 0;
    rays_left_ = 0;
    for (const Row& row : rows) {
        errors += row.errors;
        rays_left_ += row.rays_left;
        for (const RefinementGroup& part : row.groups) {
            RefinementGroup& group = group_of(part.from, part.to, groups);
            group.rays = samples(part.to) - kept_samples(part.from);
            group.pixels.insert(group.pixels.end(), part.pixels.begin(), part.pixels.end());
            group.gains.insert(group.gains.end(), part.gains.begin(), part.gains.end());
        }
    }
    std::sort(groups.begin(), groups.end(), [](const RefinementGroup& a, const RefinementGroup& b) {
        return std::tuple(a.from, a.to) < std::tuple(b.from, b.to);
    });
    noise_ = std::sqrt(errors / static_cast<double>(states_.size()));
    ++round_;
    return groups;
}

/// Most pixels have enough after few rounds, and are looked at again only where something near them has changed; the
/// picture's mean moves little by then.
Refinement::Row Refinement::next_of(int row, std::span<const float> image) {
    Row found;
    for (int column = 0; column < width_; ++column) {
        State& own = states_[index(column, row)];
        if (own.has_enough && !is_touched(column, row)) {
            found.errors += double{own.error};
            continue;
        }
        const int state = own.level;
        const int from = kept_samples(state) == 0 ? -1 : state;
        const Wanted level = wanted(column, row, image);
        own.has_enough = level.next <= state;
        own.error = static_cast<float>(level.error);
        found.errors += level.error;
        found.rays_left += level.next > state ? samples(std::max(level.enough, level.next)) - kept_samples(from) : 0;
        if (level.next > state) {
            RefinementGroup& group = group_of(from, level.next, found.groups);
            group.pixels.push_back({column, row, penumbrae(column, row), most_by_path(column, row, level.next, image)});
            group.gains.push_back(level.error + level.supposed_error);
        }
    }
    return found;
}

/// Camera rays that are spread evenly err less at an edge than rays drawn by themselves: their squared error is divided
/// by this.
double Refinement::evenness(int level) const {
    const double across = std::sqrt(samples(level));
    return depth_of_field_ ? std::sqrt(across) : across;
}

double Refinement::squared_error(const Causes& causes, int level) const {
    return (causes.edges / evenness(level) + causes.fine) / samples(level) + causes.shadows * noise_share(level);
}

/// The own rays tell how the light varies; by how much less they err because they are spread, only many pixels tell.
Refinement::Causes Refinement::causes(int column, int row, double variance) const {
    Noise around;
    for_each_around(column, row, kNoiseReach, [&](std::size_t i) { around += noises_[i]; });
    if (around.pixels == 0) {
        return {variance, 0, 0};
    }
    const std::size_t pixel = index(column, row);
    const double rays = kept_samples(states_[pixel].level);
    const double own_share = rays / (rays + kOwnRays);
    const bool is_fine = around.fine > 0 && around.fine_pixels > kLeastFinePixels * around.pixels;
    const double fine_share = is_fine ? std::min(around.fine / around.variance, 1.0F) : 0.0F;
    const double fine = fine_share * (own_share * variance + (1 - own_share) * around.variance / around.pixels);
    const double own = around.independent > 0 ? noises_[pixel].independent * around.seen / around.independent : 0.0F;
    const double shadows = own_share * own + ((1 - own_share) * around.seen + around.shared) / around.pixels;
    return {variance, fine, shadows};
}

int Refinement::sufficient_level(const Causes& causes) const {
    int level = least_level_;
    while (level < most_level_ && (good_enough_ == 0 || squared_error(causes, level) > good_enough_)) {
        ++level;
    }
    return level;
}

/// One level at a time: each shows better where more are needed.
Refinement::Wanted Refinement::wanted(int column, int row, std::span<const float> image) const {
    const std::size_t i = index(column, row);
    const State& state = states_[i];
    const int level = std::max<int>(state.level, 0);
    const Vec3d value = color(image, i);
    const Vec3d scale = value * value + least_square_;
    const double alpha = image[4 * i + 3];
    double variance = 4 * kEdgeVariance * alpha * (1 - alpha);
    double supposed = 0;
    if (least_square_ > 0) {  // or else the picture is black
        variance = std::max(variance, mean(Vec3d(state.variance) / scale));
    }
    const Causes all = causes(column, row, variance);
    const int enough = std::max(sufficient_level(all), level);
    // One ray knows nothing of its pixel, and what is known to need more need not be supposed to.
    if ((enough == level || level == 0) && good_enough_ > 0 && least_square_ > 0) {
        // The less likely the more rays have missed it, unless what is out of focus is as thin everywhere.
        const double missed = depth_of_field_ ? 1 : std::max(samples(level) / kMissingRays, 1.0);
        supposed = squared_error({neighbours_variance(column, row, scale, image)}, level) * kNeighbourShare /
                   (missed * missed);
    }
    bool is_one_enough = false;
    if (state.level < 0) {
        const double between = error_between(column, row, image);
        supposed = std::max(between, kEdgeVariance * kNeighbourShare);
        // One ray, which has no noise without a shadow nearby, suffices on a textured surface.
        is_one_enough = between >= supposed && penumbrae(column, row) == 0;
    }
    const int next = enough > level || supposed > good_enough_ ? std::min(level + 1, most_level_) : enough;
    return {enough, is_one_enough ? 0 : next, squared_error(all, level), supposed};
}

float Refinement::most_by_path(int column, int row, int level, std::span<const float> image) const {
    if (!limits_paths_) {
        return std::numeric_limits<float>::infinity();
    }
    std::array<double, (2 * kNoiseReach + 1) * (2 * kNoiseReach + 1)> around = {};
    std::size_t count = 0;
    for_each_around(column, row, kNoiseReach,
                    [&](std::size_t i) { around[count++] = mean(glm::abs(color(image, i))); });
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(around.begin(), middle, around.begin() + static_cast<std::ptrdiff_t>(count));
    // One ray that others replace may be a bright dot itself.
    const std::size_t pixel = index(column, row);
    const double own = kept_samples(states_[pixel].level) > 0 ? mean(glm::abs(color(image, pixel))) : 0.0;
    return static_cast<float>(samples(level) * std::max({*middle, own, std::sqrt(least_square_)}));
}

bool Refinement::is_touched(int column, int row) const {
    bool touched = false;
    for_each_around(column, row, kNoiseReach, [&](std::size_t i) { touched = touched || states_[i].merged == round_; });
    return touched;
}

std::uint32_t Refinement::penumbrae(int column, int row) const {
    const int reach = kept_samples(states_[index(column, row)].level) == 0 ? 2 * first_step() - 1 : 1;
    LightBits visibility;
    for_each_around(column, row, reach, [&](std::size_t i) { visibility |= states_[i].visibility; });
    return visibility.partly_hidden();
}

RefinementGroup Refinement::unrendered() const {
    RefinementGroup group = {-1, 0, 1.0 * samples(0), {}, {}};
    for (int row = 0; row < height_; ++row) {
        for (int column = 0; column < width_; ++column) {
            if (states_[index(column, row)].level < 0) {
                group.pixels.push_back({column, row});
            }
        }
    }
    return group;
}

double Refinement::error_between(int column, int row, std::span<const float> image) const {
    const Vec3d value = color(image, index(column, row));
    double largest = 0;
    for_each_around(column, row, 1, [&](std::size_t i) {
        const Vec3d other = color(image, i);
        const Vec3d scale = other * other + std::max(least_square_, std::numeric_limits<double>::min());
        largest = std::max(largest, mean((other - value) * (other - value) / scale));
    });
    return largest;
}

double Refinement::neighbours_variance(int column, int row, const Vec3d& scale, std::span<const float> image) const {
    const Vec3d value = color(image, index(column, row));
    const Vec3d over_scale = 1.0 / scale;
    double largest = 0;
    for_each_around(column, row, 1, [&](std::size_t i) {
        const Vec3d difference = color(image, i) - value;
        const Vec3d variance = glm::max(Vec3d(states_[i].variance), kEdgeVariance * difference * difference);
        largest = std::max(largest, mean(variance * over_scale));
    });
    return largest;
}

}  // namespace shlight
