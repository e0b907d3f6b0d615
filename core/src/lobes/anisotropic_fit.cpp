// SPDX-License-Identifier: MIT
#include "lobes/anisotropic_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/recent_values.h"
#include "lobes/fit_table.h"
#include "lobes/lobe_moments.h"
#include "lobes/normal_equations.h"
#include "math/legendre.h"
#include "shlight/plain_fit.h"

namespace shlight {
namespace {

using std::numbers::pi;

/// Fits of all orders up to that of the moments, which are reduced.
class FullFit {
  public:
    explicit FullFit(FullMoments moments) : moments_(std::move(moments)) {
        equations().reduce(moments_.cosines);
        equations().reduce(moments_.sines);
    }
    double norm() const { return std::sqrt(moments_.norm_squared); }
    double squared_error(int order) const {
        const double rest = equations().squared_error(moments_.cosines, order, moments_.norm_squared);
        return equations().squared_error(moments_.sines, order, rest);
    }
    /// ∫ (f·cos - fit) dω.
    double missing_light(std::span<const float> coefficients, int order) const {
        double sum = moments_.albedo;
        for (std::size_t i = 0; i < upper_heights().nodes.size(); ++i) {
            for (int l = 0; l < order; ++l) {
                const double term = coefficients[static_cast<std::size_t>(coefficient_index(l, 0))];
                sum -= 2 * pi * upper_heights().weights[i] * term * upper_basis().values(l, 0)[i];
            }
        }
        return sum;
    }
    double albedo() const { return moments_.albedo; }
    void solve(int order, std::span<float> coefficients) const {
        std::array<double, kCosineMax> cosines, sines;
        equations().solve(moments_.cosines, order, cosines);
        equations().solve(moments_.sines, order, sines);
        for (int l = 0; l < order; ++l) {
            for (int m = 0; m <= l; ++m) {
                coefficients[static_cast<std::size_t>(coefficient_index(l, m))] = static_cast<float>(cosines[at(l, m)]);
                if (m > 0) {
                    coefficients[static_cast<std::size_t>(coefficient_index(l, -m))] =
                        static_cast<float>(sines[at(l, m)]);
                }
            }
        }
    }

  private:
    static const NormalEquations& equations() {
        static const NormalEquations instance(upper_basis(), upper_heights().weights);
        return instance;
    }

    FullMoments moments_;
};

/// Turns coefficients from the frame of the tangent to that of a view at an azimuth.
void turn_to_view(double azimuth, int order, float* coefficients) {
    std::array<double, kMaxOrder> cosines, sines;
    complex_powers(std::cos(azimuth), std::sin(azimuth), order, cosines.data(), sines.data());
    for (int l = 1; l < order; ++l) {
        for (int m = 1; m <= l; ++m) {
            float& even = coefficients[coefficient_index(l, m)];
            float& odd = coefficients[coefficient_index(l, -m)];
            const auto c = static_cast<float>(cosines[static_cast<std::size_t>(m)]);
            const auto s = static_cast<float>(sines[static_cast<std::size_t>(m)]);
            const float turned = c * even + s * odd;
            odd = c * odd - s * even;
            even = turned;
        }
    }
}

}  // namespace

AnisotropicFit::AnisotropicFit(const TableShape& shape, int order)
    : orders_(order == 0 ? std::vector<int>(kBoostedOrders.begin(), kBoostedOrders.end()) : std::vector<int>{order}),
      row_size_(FitTable::kHeadWidth),
      views_(*shape.table) {
    for (const int own : orders_) {
        first_.push_back(row_size_);
        row_size_ += static_cast<std::size_t>(coefficient_count(own));
    }
    rows_.resize(views_.size() * row_size_);
    views_.for_each([&](std::size_t view) { fit_view(shape, view); });
}

void AnisotropicFit::fit_view(const TableShape& shape, std::size_t view) {
    const int highest = *std::max_element(orders_.begin(), orders_.end());
    const FullFit fit(views_.moments(shape, view, std::max(highest, 2)));
    const auto row = std::span(rows_).subspan(view * row_size_, row_size_);
    row[FitTable::kAlbedo] = static_cast<float>(fit.albedo());
    for (std::size_t i = 0; i < orders_.size(); ++i) {
        const auto terms = row.subspan(first_[i], static_cast<std::size_t>(coefficient_count(orders_[i])));
        fit.solve(orders_[i], terms);
        row[FitTable::kShadingErrors + i] = static_cast<float>(shading_error(
            fit.squared_error(orders_[i]), fit.missing_light(terms, orders_[i]), orders_[i], fit.albedo()));
    }
}

void AnisotropicFit::head(double cos_theta_o, double azimuth, float* out) const {
    views_.taps(cos_theta_o, azimuth).interpolate(rows_, row_size_, 0, FitTable::kHeadWidth, out);
}

void AnisotropicFit::coefficients(double cos_theta_o, double azimuth, int order, float* out) const {
    const auto which = static_cast<std::size_t>(std::find(orders_.begin(), orders_.end(), order) - orders_.begin());
    views_.taps(cos_theta_o, azimuth)
        .interpolate(rows_, row_size_, first_[which], static_cast<std::size_t>(coefficient_count(order)), out);
    if (views_.are_of_tangent()) {
        turn_to_view(azimuth, order, out);
    }
}

std::shared_ptr<const AnisotropicFit> anisotropic_fit(const TableShape& shape, int order) {
    constexpr std::size_t kRecentFits = 24;
    static RecentValues<std::pair<TableShape, int>, AnisotropicFit> recent(kRecentFits);
    const TableShape key{shape.table, shape.channel};
    return recent.get({key, order}, [&] { return std::make_shared<const AnisotropicFit>(key, order); });
}

PlainView plain_view(const TableShape& shape, double cos_theta_o, int order) {
    check_order(order);
    const double theta_o = least_grazing(std::acos(std::clamp(cos_theta_o, 0.0, 1.0)));
    const FullFit fit(full_moments(shape, theta_o, true, std::max(order, 2)));
    PlainView view{std::vector<float>(static_cast<std::size_t>(coefficient_count(order))), fit.norm(), 0};
    fit.solve(order, view.coefficients);
    const double lacking = shape.table->sampling_error(cos_theta_o, shape.channel);
    view.residual = view.norm > 0 ? std::sqrt(fit.squared_error(order)) / view.norm + lacking : 0.0;
    return view;
}

}  // namespace shlight
