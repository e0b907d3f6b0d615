// SPDX-License-Identifier: MIT
#include "shlight/warped_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/recent_values.h"
#include "lobes/ggx_fit_table.h"
#include "lobes/lambert.h"
#include "lobes/view_table.h"
#include "math/cubic_stencil.h"
#include "math/legendre.h"

namespace shlight {
namespace {

/// Roughness rows of the shared table, equally spaced in log(α + kAlphaOffset): below the offset a lobe's image in its
/// own warp no longer depends on α.
constexpr int kAlphaRows = 32;
constexpr double kAlphaOffset = 0.02;
constexpr double kLeastAlpha = 2e-4;

double alpha_position(double alpha) {
    const double least = std::log(kLeastAlpha + kAlphaOffset);
    const double most = std::log(1 + kAlphaOffset);
    return (std::log(std::max(alpha, kLeastAlpha) + kAlphaOffset) - least) / (most - least) * (kAlphaRows - 1);
}

double row_alpha(int row) {
    const double least = std::log(kLeastAlpha + kAlphaOffset);
    const double most = std::log(1 + kAlphaOffset);
    return std::exp(least + (most - least) * row / (kAlphaRows - 1)) - kAlphaOffset;
}

/// All GGX lobes with Fresnel factors that have no parameter.
class GgxTable {
  public:
    GgxTable() {
        for (int row = 0; row < kAlphaRows; ++row) {
            one_.push_back(fit_ggx_table({row_alpha(row), Fresnel::one}, kWarpedOrders));
            schlick_.push_back(fit_ggx_table({row_alpha(row), Fresnel::schlick}, kWarpedOrders));
        }
    }

    static const GgxTable& get() {
        static const GgxTable table;
        return table;
    }

    GgxFitTable row(const GgxShape& shape) const {
        const std::vector<GgxFitTable>& rows = shape.fresnel == Fresnel::one ? one_ : schlick_;
        const CubicStencil s(alpha_position(shape.alpha), 0, kAlphaRows);
        std::vector<float> nodes(rows[0].nodes().size(), 0.0F);
        for (int k = 0; k < 4; ++k) {
            const auto from = rows[s.first + k].nodes();
            std::transform(from.begin(), from.end(), nodes.begin(), nodes.begin(),
                           [w = s.weights[k]](float value, float sum) { return sum + w * value; });
        }
        return {rows[0].layout(), std::move(nodes)};
    }

    std::size_t size() const { return 2 * one_.size() * one_[0].nodes().size_bytes(); }

  private:
    std::vector<GgxFitTable> one_, schlick_;
};

GgxFitTable make_row(const GgxShape& shape, int order) {
    if (order != 0) {
        return fit_ggx_table(shape, std::array{order});
    }
    return shape.fresnel == Fresnel::dielectric ? fit_ggx_table(shape, kWarpedOrders) : GgxTable::get().row(shape);
}

}  // namespace

Warp lobe_warp(const LobeShape& shape, double cos_theta_o) {
    const auto* ggx = std::get_if<GgxShape>(&shape);
    if (ggx == nullptr) {
        return {};
    }
    // Found by minimising the residual of order 12: the lobe's width over the warped sphere, 5 α cos^0.4 θ_o for narrow
    // ones, saturating where there is nothing to gain.
    const double cosine = std::clamp(cos_theta_o, kLeastFittedCosine, 1.0);
    const double width = 5 * ggx->alpha * std::pow(cosine, 0.4);
    return {std::acos(cosine), width / std::pow(1 + width * std::sqrt(width), 2.0 / 3)};
}

WarpedFit::WarpedFit(const LobeShape& shape, int order)
    : shape_(shape), order_(order == 0 ? kLambertOrder : std::min(order, kLambertOrder)) {
    if (order != 0) {
        check_order(order);
    }
    if (const auto* ggx = std::get_if<GgxShape>(&shape)) {
        table_ = std::make_shared<const ViewTable>(make_row(*ggx, order));
    }
}

std::vector<int> WarpedFit::orders() const {
    if (table_) {
        return {table_->orders().begin(), table_->orders().end()};
    }
    return {order_};
}

double WarpedFit::albedo(double cos_theta_o) const {
    return table_ ? table_->head(cos_theta_o)[ViewTable::kAlbedo] : 1.0;
}

double WarpedFit::shading_error(double cos_theta_o, int order) const {
    if (!table_) {
        return lambert_error(order);
    }
    return std::max(0.0F, table_->head(cos_theta_o)[ViewTable::kShadingErrors + table_->which(order)]);
}

double WarpedFit::residual(double cos_theta_o, int order) const {
    if (!table_) {
        return lambert_error(order);
    }
    return std::max(0.0F, table_->head(cos_theta_o)[ViewTable::kResiduals + table_->which(order)]);
}

int WarpedFit::order_for(double cos_theta_o, double tolerance) const {
    if (table_ && cos_theta_o < kLeastFittedCosine) {
        return 0;
    }
    for (const int order : orders()) {
        if (shading_error(cos_theta_o, order) <= tolerance) {
            return order;
        }
    }
    return 0;
}

Warp WarpedFit::warp(double cos_theta_o) const {
    return lobe_warp(shape_, cos_theta_o);
}

void WarpedFit::coefficients(double cos_theta_o, int order, float* cosine_terms) const {
    if (table_) {
        table_->terms(cos_theta_o, table_->which(order), cosine_terms);
        return;
    }
    fit_lambert(order, cosine_terms);
}

std::shared_ptr<const WarpedFit> warped_fit(const LobeShape& shape, int order) {
    constexpr std::size_t kRecentFits = 64;
    static RecentValues<std::pair<LobeShape, int>, WarpedFit> recent(kRecentFits);
    return recent.get({shape, order}, [&] { return std::make_shared<const WarpedFit>(shape, order); });
}

std::size_t prepare_ggx_table() {
    return GgxTable::get().size();
}

}  // namespace shlight
