// SPDX-License-Identifier: MIT
#include "lobes/material_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "lobes/fit_table.h"
#include "lobes/view_kernel.h"

namespace shlight {
namespace {

/// Limits of a lobe's tolerance, an error ÷ albedo under a light of unit strength: below the least one rounding
/// dominates, and beyond the most the methods' error estimates do not hold.
constexpr double kLeastTolerance = 1e-6;
constexpr double kMostTolerance = 0.1;

}  // namespace

void ViewPositions::assign(std::span<const double> cos_theta_o, bool tabulated) {
    size_ = cos_theta_o.size();
    if (const std::size_t room = padded_views(size_); cosine_.size() < room) {
        for (std::vector<double>* array : {&cosine_, &sine_, &fitted_sine_, &fitted_cosine_}) {
            array->resize(room);
        }
        log_cosine_.resize(room);
        row_.resize(room);
        weights_.resize(4 * room);
        all_.resize(room);
        std::iota(all_.begin(), all_.end(), 0U);
    }
    std::copy(cos_theta_o.begin(), cos_theta_o.end(), cosine_.begin());
    if (tabulated) {
        find_views(cosine_.data(), size_, arrays());
    }
}

ViewOutput ViewPositions::arrays() {
    return {sine_.data(), fitted_sine_.data(), fitted_cosine_.data(), log_cosine_.data(), row_.data(), weights_.data()};
}

void LobeViews::look_up(const MaterialLobes& material, std::size_t lobe, ViewPositions& positions,
                        const LobeWeights& weights, const LobeForms& forms, bool judged) {
    lobe_ = &material.lobes()[lobe];
    weights_ = weights;
    forms_ = forms;
    index_ = lobe;
    fit_ = material.fit(lobe);
    positions_ = &positions;
    weighed_.clear();
    std::copy_if(positions.all().begin(), positions.all().end(), std::back_inserter(weighed_),
                 [&](std::uint32_t view) { return weight(view) != Rgb(0); });
    anisotropic_ = material.anisotropic(lobe);
    find_parameters(material.grid(lobe));
    layout_ = fit_ != nullptr ? fit_->table() : nullptr;
    if (!neighbours_.empty() && !is_black()) {
        layout_ = neighbours_[FitGrid::kNeighbours * weighed_.front()];
    }
    chooses_ = has_two_widths() || (material.auto_order() && !orders().empty());
    judged_ = judged;
    relative_tolerance_ = 0;
    has_boosts_ = false;
    stride_ = 0;
    if (judged_) {
        find_albedos();
    }
}

std::span<const int> LobeViews::orders() const {
    return layout_ != nullptr        ? layout_->orders()
           : anisotropic_ != nullptr ? anisotropic_->orders()
                                     : std::span<const int>();
}

void LobeViews::find_parameters(const FitGrid* grid) {
    const std::size_t count = positions_->size();
    widths_.assign(padded_views(count), static_cast<float>(lobe_width(shape())));
    neighbours_.clear();
    neighbour_weights_.clear();
    if (anisotropic_ != nullptr) {
        azimuths_.assign(padded_views(count), 0);
        for (const std::uint32_t view : weighed_) {
            azimuths_[view] = form(view).azimuth;
        }
    }
    if (has_two_widths()) {
        for (const std::uint32_t view : weighed_) {
            widths_[view] = form(view).width;
        }
    }
    if (grid == nullptr) {
        return;
    }
    neighbours_.resize(FitGrid::kNeighbours * count);
    neighbour_weights_.resize(FitGrid::kNeighbours * count);
    for (const std::uint32_t view : weighed_) {
        widths_[view] = form(view).width;
        const FitGrid::Neighbours found = grid->neighbours(double{widths_[view]});
        const auto first = static_cast<std::ptrdiff_t>(FitGrid::kNeighbours * view);
        std::copy(found.tables.begin(), found.tables.end(), neighbours_.begin() + first);
        std::copy(found.weights.begin(), found.weights.end(), neighbour_weights_.begin() + first);
    }
}

void LobeViews::interpolate(std::size_t column, std::size_t width, std::span<const std::uint32_t> views, float* out,
                            std::size_t stride) {
    columns_.assign(std::max<std::size_t>(1, neighbours_.size()), layout_->values().data() + column);
    for (const std::uint32_t view : neighbours_.empty() ? views.first(0) : views) {
        const auto first = static_cast<std::ptrdiff_t>(FitGrid::kNeighbours * view);
        std::transform(neighbours_.begin() + first, neighbours_.begin() + first + FitGrid::kNeighbours,
                       columns_.begin() + first,
                       [column](const FitTable* table) { return table->values().data() + column; });
    }
    const std::size_t count = neighbours_.empty() ? 1 : FitGrid::kNeighbours;
    positions_->interpolate({count, columns_.data(), neighbour_weights_.data()}, layout_->row_size(), width, views, out,
                            stride);
}

void LobeViews::find_albedos() {
    const std::size_t count = positions_->size();
    albedo_.assign(count, 0);
    if (orders().empty()) {
        for (const std::uint32_t view : weighed_) {
            const double cosine = positions_->cosine()[view];
            albedo_[view] =
                static_cast<float>(has_two_widths() ? lobe_albedo(shape(view), cosine) : lobe_->albedo(cosine));
        }
        return;
    }
    heads_.grow(count * FitTable::kHeadWidth);
    if (layout_ != nullptr) {
        interpolate(0, FitTable::kHeadWidth, weighed_, heads_.data(), FitTable::kHeadWidth);
    }
    for (const std::uint32_t view : anisotropic_ != nullptr ? std::span(weighed_) : std::span<std::uint32_t>()) {
        anisotropic_->head(positions_->cosine()[view], double{azimuths_[view]},
                           heads_.data() + view * FitTable::kHeadWidth);
    }
    for (const std::uint32_t view : weighed_) {
        albedo_[view] = heads_.data()[view * FitTable::kHeadWidth + FitTable::kAlbedo];
    }
}

/// tolerance_scales: albedo of the material ÷ albedo of this lobe at each view; infinite where the lobe is black.
void LobeViews::choose_orders(double tolerance, std::span<const float> tolerance_scales) {
    const std::size_t count = positions_->size();
    const std::span<const int> orders = this->orders();
    const int only = !orders.empty() ? (chooses_ ? -1 : orders.front()) : fit_ != nullptr ? fit_->orders().front() : 0;
    black_.assign(count, 0);
    within_tolerance_.assign(count, 1);
    order_.assign(count, static_cast<std::uint8_t>(std::max(only, 0)));
    any_black_ = false;
    if (!judged_) {
        for (std::size_t view = 0; view < count && !has_one_weight(); ++view) {
            black_[view] = weight(view) == Rgb(0) ? 1 : 0;
            any_black_ = any_black_ || black_[view] != 0;
        }
        return;
    }
    tolerance_.resize(count);
    for (std::size_t view = 0; view < count; ++view) {
        black_[view] = std::isinf(tolerance_scales[view]) ? 1 : 0;
        any_black_ = any_black_ || black_[view] != 0;
        tolerance_[view] = static_cast<float>(tolerance * tolerance_scales[view]);
        if (black_[view] != 0) {
            continue;
        }
        if (orders.empty()) {
            within_tolerance_[view] = only != 1 || 0.5F <= tolerance_[view] ? 1 : 0;
            continue;
        }
        const float* errors = heads_.data() + view * FitTable::kHeadWidth + FitTable::kShadingErrors;
        if (only >= 0) {
            within_tolerance_[view] = errors[0] <= tolerance_[view] ? 1 : 0;
        } else if (positions_->cosine()[view] >= kLeastFittedCosine) {
            std::size_t i = 0;
            while (i < orders.size() && !(errors[i] <= tolerance_[view])) {
                ++i;
            }
            order_[view] = static_cast<std::uint8_t>(i < orders.size() ? orders[i] : 0);
        }
    }
}

double LobeViews::error_of_largest_order(std::size_t view) const {
    if (positions_->cosine()[view] < kLeastFittedCosine) {
        return std::numeric_limits<double>::infinity();
    }
    const float* head = heads_.data() + view * FitTable::kHeadWidth;
    return double{head[FitTable::kShadingErrors + orders().size() - 1]} * albedo_[view];
}

BoostArrays LobeViews::boost_arrays() {
    const std::size_t room = padded_views(positions_->size());
    const ViewOutput views = positions_->arrays();
    if (!has_boosts_) {
        boosts_.resize(std::max(boosts_.size(), 7 * room));
    }
    double* w = boosts_.data();
    if (!has_boosts_) {
        boost_views(widths_.data(), views, positions_->size(),
                    {w, w + room, w + 2 * room, w + 3 * room, w + 4 * room, w + 5 * room, w + 6 * room});
        has_boosts_ = true;
    }
    return {views.fitted_sine, views.fitted_cosine, w,           w + room, w + 2 * room, w + 3 * room,
            w + 4 * room,      w + 5 * room,        w + 6 * room};
}

void LobeViews::make_room_for_terms(std::size_t stride) {
    if (stride_ == 0) {
        stride_ = stride;
        terms_.grow(positions_->size() * stride_);
        has_terms_.assign(positions_->size(), 0);
    }
}

bool LobeViews::lacks_terms(std::uint32_t view, std::size_t which) {
    const bool lacks = has_terms_[view] != which + 1;
    has_terms_[view] = static_cast<std::uint8_t>(which + 1);
    return lacks;
}

void LobeViews::interpolate_terms(std::size_t which, std::span<const std::uint32_t> used) {
    const FitTable& table = *layout_;
    std::size_t widest = 0;
    for (std::size_t i = 0; i < table.orders().size(); ++i) {
        widest = std::max(widest, table.width(i));
    }
    make_room_for_terms(widest);
    missing_.clear();
    std::copy_if(used.begin(), used.end(), std::back_inserter(missing_),
                 [&](std::uint32_t view) { return lacks_terms(view, which); });
    interpolate(table.terms(which), table.width(which), missing_, terms_.data(), stride_);
}

const float* LobeViews::coefficients(int order, std::uint32_t view) {
    make_room_for_terms(AlignedFloats::padded(static_cast<std::size_t>(coefficient_count(largest_order()))));
    float* own = terms_.data() + view * stride_;
    const auto which = static_cast<std::size_t>(std::ranges::find(orders(), order) - orders().begin());
    if (lacks_terms(view, which)) {
        anisotropic_->coefficients(positions_->cosine()[view], double{azimuths_[view]}, order, own);
    }
    return own;
}

LobeArrays LobeViews::arrays(int order, std::span<const std::uint32_t> used) {
    if (layout_ != nullptr) {
        interpolate_terms(layout_->which(order), used);
        const bool boosted = is_glossy(shape());
        return {boosted, boosted ? boost_arrays() : BoostArrays{}, terms_.data(), positions_->size() == 1 ? 0 : stride_,
                order};
    }
    if (stride_ == 0) {
        stride_ = AlignedFloats::padded(static_cast<std::size_t>(cosine_count(order)));
        terms_.grow(stride_);
        fit_->coefficients(1, order, terms_.data());
    }
    return {false, {}, terms_.data(), 0, order};
}

void MaterialViews::assign(const MaterialLobes& material, std::span<const double> cos_theta_o,
                           const LobeWeights& weights, const LobeForms& forms, bool judged) {
    const bool weighed = judged || material.auto_order() || material.is_anisotropic();
    lobe_count_ = material.lobes().size();
    tolerance_ = material.tolerance();
    bool tabulated = false;
    for (std::size_t i = 0; i < lobe_count_; ++i) {
        const BoostedFit* fit = material.fit(i);
        tabulated = tabulated || fit == nullptr || fit->table() != nullptr;
    }
    positions_.assign(cos_theta_o, tabulated);
    if (lobes_.size() < lobe_count_) {
        lobes_.resize(lobe_count_);
    }
    for (std::size_t i = 0; i < lobe_count_; ++i) {
        lobes_[i].look_up(material, i, positions_, weights, forms, weighed);
    }
    if (weighed && lobe_count_ > 1) {
        whole_.assign(positions_.size(), Rgb(0));
        for (std::size_t i = 0; i < lobe_count_; ++i) {
            for (std::size_t view = 0; view < positions_.size(); ++view) {
                whole_[view] += lobes_[i].weight(view) * lobes_[i].albedo_[view];
            }
        }
    }
    for (std::size_t i = 0; i < lobe_count_; ++i) {
        if (weighed) {
            find_tolerance_scales(i);
        }
        lobes_[i].choose_orders(material.tolerance(), tolerance_scales_);
    }
}

void MaterialViews::find_tolerance_scales(std::size_t lobe) {
    const LobeViews& lobe_views = lobes_[lobe];
    tolerance_scales_.resize(positions_.size());
    for (std::size_t view = 0; view < positions_.size(); ++view) {
        const Rgb light = lobe_views.weight(view) * lobe_views.albedo_[view];
        float scale = std::numeric_limits<float>::infinity();
        for (int channel = 0; channel < 3; ++channel) {
            if (light[channel] > 0) {
                scale = std::min(scale, lobe_count_ == 1 ? 1.0F : whole_[view][channel] / light[channel]);
            }
        }
        tolerance_scales_[view] = scale;
    }
}

void MaterialViews::allow_error(double error, const Rgb& strength) {
    for (std::size_t i = 0; i < lobe_count_; ++i) {
        find_tolerance_scales(i, error, strength);
        lobes_[i].choose_orders(1, tolerance_scales_);
        lobes_[i].relative_tolerance_ = tolerance_;
    }
}

void MaterialViews::find_tolerance_scales(std::size_t lobe, double error, const Rgb& strength) {
    const LobeViews& lobe_views = lobes_[lobe];
    const Rgb magnitude = glm::abs(strength);
    for (std::size_t view = 0; view < positions_.size(); ++view) {
        const Rgb light = magnitude * lobe_views.weight(view) * lobe_views.albedo_[view];
        const double most = std::max({light.x, light.y, light.z});
        tolerance_scales_[view] = lobe_views.weight(view) == Rgb(0)
                                      ? std::numeric_limits<float>::infinity()
                                      : static_cast<float>(std::clamp(error / most, kLeastTolerance, kMostTolerance));
    }
}

}  // namespace shlight
