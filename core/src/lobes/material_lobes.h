// SPDX-License-Identifier: MIT
//
// The lobes of a material, and how exactly each must be shaded at each view.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lobes/anisotropic_fit.h"
#include "lobes/fit_table.h"
#include "shlight/bsdf.h"
#include "shlight/types.h"

namespace shlight {

/// Width of the lobe [rad]: the least angle over which its f·cos changes at this view; 0 for a mirror.
double narrowest(const LobeShape& lobe, double cos_theta_o);
/// The angle [rad] over which f·cos changes around a direction wi; all vectors are unit vectors. On the sphere of
/// (h_x/α, h_y/α, h_z), where the GGX lobe is round, a step of wi is at most 1/α long, divided by the length of that
/// vector.
double distance_of_change(const LobeShape& lobe, const Vec3d& wi, const Vec3d& wo);

/// Whether rays drawn from both lobes have the same distribution, at all hits.
bool spread_alike(const Lobe& a, const Lobe& b);

/// Weights of a material's lobes; values[v · stride + i] is that of lobe i at view v.
struct LobeWeights {
    std::span<const Rgb> values;
    std::size_t stride;  ///< 0: the views share their weights
};

/// Forms of lobes that vary over a surface, laid out as LobeWeights.
struct LobeForms {
    std::span<const LobeForm> values;  ///< empty: none varies
    std::size_t stride;
};

class MaterialLobes {
  public:
    /// order: the only one, 1 … 64, or 0 to choose orders that meet the tolerance, which is an error of the radiance ÷
    /// the albedo of the whole material, in each colour channel.
    /// light_set: see MeshUse.
    MaterialLobes(std::span<const Lobe> lobes, int order, double tolerance, std::uint32_t light_set = 0);

    /// The material's lobes, without black ones.
    std::span<const Lobe> lobes() const { return lobes_; }
    /// The fit that shades a lobe; null for a mirror, and for a lobe that varies.
    const BoostedFit* fit(std::size_t lobe) const { return auto_order_ ? lobes_[lobe].fit.get() : fits_[lobe].get(); }
    /// The fits that shade a lobe whose width varies; null for others.
    const FitGrid* grid(std::size_t lobe) const { return grids_[lobe].get(); }
    /// The fits that shade the lobe of an anisotropic table; null for others.
    const AnisotropicFit* anisotropic(std::size_t lobe) const { return anisotropic_[lobe].get(); }
    /// Whether any lobe varies over a surface, or depends on the azimuth of the view.
    bool varies() const {
        return std::any_of(lobes_.begin(), lobes_.end(), [](const Lobe& lobe) { return lobe.varies(); });
    }
    bool is_anisotropic() const {
        return std::any_of(lobes_.begin(), lobes_.end(),
                           [](const Lobe& lobe) { return shlight::is_anisotropic(lobe.shape); });
    }
    /// Whether orders are chosen per view and light; otherwise a fit has only one order.
    bool auto_order() const { return auto_order_; }
    double tolerance() const { return tolerance_; }
    std::uint32_t light_set() const { return light_set_; }
    /// The lobes' weights at these views, stored in `values`, which must outlive the result.
    LobeWeights weights(std::span<const double> cos_theta_o, std::vector<Rgb>& values) const;
    /// Width of the narrowest lobe [rad], see narrowest() above. forms: of each lobe, read where it varies.
    double narrowest(double cos_theta_o, std::span<const LobeForm> forms) const;
    /// A lobe's shape; `form` replaces its own if that varies.
    LobeShape shape(std::size_t lobe, const LobeForm& form) const {
        const Lobe& own = lobes_[lobe];
        return own.varies() ? with_form(own.shape, form) : own.shape;
    }
    /// Albedo of a lobe's shape, from the lobe's fits where it has some; `form` as above.
    double albedo(std::size_t lobe, const LobeForm& form, double cos_theta_o) const;

  private:
    std::vector<Lobe> lobes_;
    std::vector<std::shared_ptr<const BoostedFit>> fits_;  // of the only order; otherwise empty
    std::vector<std::shared_ptr<const FitGrid>> grids_;
    std::vector<std::shared_ptr<const AnisotropicFit>> anisotropic_;
    bool auto_order_;
    double tolerance_;
    std::uint32_t light_set_;
};

}  // namespace shlight
