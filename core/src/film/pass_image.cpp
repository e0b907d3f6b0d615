// SPDX-License-Identifier: MIT
#include "film/pass_image.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shlight/parallel.h"

namespace shlight {
namespace {

/// Pixels that a thread finishes at a time.
constexpr std::size_t kPixelsAtOnce = 4096;
/// Depth where nothing is [m].
constexpr float kNowhere = 1e10F;

/// Adds to the pair of an identity; unused pairs are 0.
template <class Number>
void add_pair(std::span<Number> pairs, Number identity, Number share) {
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
        if (pairs[i] == 0) {
            pairs[i] = identity;
        }
        if (pairs[i] == identity || i + 2 == pairs.size()) {
            pairs[i + 1] += share;
            return;
        }
    }
}

void merge_matte(std::span<float> pairs, double before, double all, std::span<const double> sums) {
    for (std::size_t i = 1; i < pairs.size(); i += 2) {
        pairs[i] = static_cast<float>(before * pairs[i] / all);
        if (pairs[i] == 0) {
            pairs[i - 1] = 0;  // of a ray whose place others take
        }
    }
    for (std::size_t i = 0; i < sums.size() && sums[i] != 0; i += 2) {
        add_pair(pairs, static_cast<float>(sums[i]), static_cast<float>(sums[i + 1] / all));
    }
}

void sort_matte(std::span<float> pairs) {
    std::array<std::pair<float, float>, 16> own;
    const std::size_t count = pairs.size() / 2;
    for (std::size_t i = 0; i < count; ++i) {
        own[i] = {pairs[2 * i], pairs[2 * i + 1]};
    }
    std::stable_sort(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(count),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    for (std::size_t i = 0; i < count; ++i) {
        pairs[2 * i] = own[i].first;
        pairs[2 * i + 1] = own[i].second;
    }
}

/// Divides light by colour like Cycles: a channel without colour gets the mean of the others.
void divide(std::span<float> light, std::span<const float> color) {
    float sum = 0;
    int count = 0;
    for (std::size_t channel = 0; channel < light.size(); ++channel) {
        light[channel] = color[channel] != 0 ? light[channel] / color[channel] : 0.0F;
        sum += light[channel];
        count += color[channel] != 0 ? 1 : 0;
    }
    for (std::size_t channel = 0; channel < light.size() && count > 0; ++channel) {
        if (color[channel] == 0) {
            light[channel] = sum / static_cast<float>(count);
        }
    }
}

}  // namespace

void add_to_matte(std::span<double> pairs, double identity, double share) {
    if (identity != 0 && share > 0) {
        add_pair(pairs, identity, share);
    }
}

bool is_matte(Pass kind) {
    return kind == Pass::cryptomatte_object || kind == Pass::cryptomatte_material || kind == Pass::cryptomatte_asset;
}

bool is_of_middle(Pass kind) {
    return kind == Pass::depth || kind == Pass::position || kind == Pass::object_index || kind == Pass::material_index;
}

bool is_guide(Pass kind) {
    return kind == Pass::denoising_albedo || kind == Pass::denoising_normal || kind == Pass::denoising_depth;
}

void PassImage::merge(std::size_t index, double before, double all, std::span<const double> sums) const {
    for (const PassLayout::Place& place : layout_->places()) {
        const std::span<float> own = pixel(index).subspan(place.first, place.size);
        const std::span<const double> more = sums.subspan(place.first, place.size);
        if (is_matte(place.pass.kind)) {
            merge_matte(own, before, all, more);
        } else if (!is_of_middle(place.pass.kind)) {
            for (std::size_t i = 0; i < own.size(); ++i) {
                own[i] = static_cast<float>(before > 0 ? (before * own[i] + more[i]) / all : more[i] / all);
            }
        }
    }
}

void PassImage::fill(const GridPlace& place) const {
    for (const auto& [pass, first, size] : layout_->places()) {
        if (is_matte(pass.kind)) {
            std::ranges::copy(pixel(place.nearest()).subspan(first, size), pixel(place.pixel()).subspan(first).begin());
        } else if (!is_of_middle(pass.kind) && !is_guide(pass.kind)) {
            place.fill(stride(), first, size, values_);
        }
    }
}

void PassImage::finish(std::span<float> pixel) const {
    const auto divide_by = [&](const PassLayout::Place& place, Pass divisor) {
        const PassLayout::Place& color = *layout_->find(divisor);
        divide(pixel.subspan(place.first, place.size), pixel.subspan(color.first, color.size));
    };
    for (const PassLayout::Place& place : layout_->places()) {
        float& first = pixel[place.first];
        switch (place.pass.kind) {
            case Pass::depth:
                first = first == 0 ? kNowhere : first;
                break;
            case Pass::mist:  // summed up is how clear the view is
                first = std::clamp(1 - first, 0.0F, 1.0F);
                break;
            case Pass::diffuse_direct:
            case Pass::diffuse_indirect:
                divide_by(place, Pass::diffuse_color);
                break;
            case Pass::glossy_direct:
            case Pass::glossy_indirect:
                divide_by(place, Pass::glossy_color);
                break;
            case Pass::transmission_direct:
            case Pass::transmission_indirect:
                divide_by(place, Pass::transmission_color);
                break;
            default:
                if (is_matte(place.pass.kind)) {
                    sort_matte(pixel.subspan(place.first, place.size));
                }
        }
    }
}

void PassImage::finish(int threads) const {
    if (empty()) {
        return;
    }
    const std::size_t count = values_.size() / stride();
    parallel_for((count + kPixelsAtOnce - 1) / kPixelsAtOnce, threads, [&](std::size_t block) {
        for (std::size_t i = block * kPixelsAtOnce; i < std::min(count, (block + 1) * kPixelsAtOnce); ++i) {
            finish(pixel(i));
        }
    });
}

}  // namespace shlight
