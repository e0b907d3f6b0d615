// SPDX-License-Identifier: MIT
//
// BRDFs as tables: measured ones, and functions that were sampled. Values between the entries are linear in each angle.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "shlight/types.h"

namespace shlight {

/// Increasing angles [rad] of a table's entries.
class TableAxis {
  public:
    /// period: after it the values repeat; 0: beyond the first and the last angle they are constant.
    /// Throws std::invalid_argument for no angles, angles that are not finite and increasing, or, with a period, that
    /// span a whole one.
    TableAxis(std::vector<double> angles, double period);

    std::size_t size() const { return angles_.size(); }
    const std::vector<double>& angles() const { return angles_; }
    double period() const { return period_; }

    /// The entries on both sides of an angle, and the weight of the second.
    struct Place {
        std::size_t low, high;
        double share;
    };
    Place place(double angle) const;

  private:
    std::vector<double> angles_;
    double period_;
};

/// The meaning of a table's four axes.
enum class TableAngles {
    /// θ_i, φ_i, θ_o, φ_o. A table with one φ_i depends on φ_o - φ_i only.
    directions,
    /// θ_h, φ_h, θ_d, φ_d of the half vector and of ω_i beside it (Rusinkiewicz 1998, "A New Change of Variables for
    /// Efficient BRDF Representation"). A peak at the mirror direction lies at θ_h = 0 for all views. Entries are
    /// f · (cosθ_i + cosθ_o), which stays finite at grazing angles. A table with one φ_h is isotropic.
    half_vector
};

/// Immutable; any number of threads may read it.
class LobeTable {
  public:
    /// values: an entry for each of `axes`, the last one fastest, with `channels` numbers each, 1 or 3.
    /// sampling_errors: see sampling_error(); a row of `channels` numbers for each of some views, θ_o = 0 … π/2 in
    /// equal steps; none: 0.
    /// Throws std::invalid_argument for sizes that do not fit, and values that are negative or not finite.
    LobeTable(TableAngles angles, std::array<TableAxis, 4> axes, int channels, std::vector<float> values,
              std::vector<float> sampling_errors);

    /// The same with other errors.
    LobeTable with_sampling_errors(std::vector<float> errors) const;

    TableAngles angles() const { return angles_; }
    const std::array<TableAxis, 4>& axes() const { return axes_; }
    int channels() const { return channels_; }
    const std::vector<float>& entries() const { return values_; }
    const std::vector<float>& sampling_errors() const { return sampling_errors_; }

    /// The BRDF f [sr⁻¹]. Vectors: unit, above the horizon, in the frame of the surface's tangent x and normal z.
    double value(const Vec3d& wi, const Vec3d& wo, int channel) const;
    /// f·cos of directions in a frame that is turned about the normal by an azimuth [rad].
    double reflected(const Vec3d& wi, const Vec3d& wo, double azimuth, int channel) const;
    /// Whether f is the same for directions that are turned about the normal together, and for mirrored ones.
    bool is_isotropic() const { return isotropic_; }
    /// Whether f has a peak at the mirror direction, as a microfacet lobe has.
    bool is_glossy() const { return width_ < 1; }
    /// α of the GGX distribution whose half width is that of the peak; 1 without a peak.
    double width() const { return width_; }
    /// ∫ f·cos dω for views at the azimuth [rad].
    double albedo(double cos_theta_o, double azimuth, int channel) const;
    /// L2 norm over the hemisphere of what the table's f·cos lacks of the function that was sampled, ÷ that of f·cos.
    double sampling_error(double cos_theta_o, int channel) const;

  private:
    double interpolated(const std::array<double, 4>& angles, int channel) const;
    bool find_symmetry() const;
    double find_width() const;
    void find_albedos();

    TableAngles angles_;
    std::array<TableAxis, 4> axes_;
    int channels_;
    std::vector<float> values_;
    std::vector<float> sampling_errors_;
    bool isotropic_ = false;
    double width_ = 1;
    std::size_t azimuths_ = 1;    // of albedos_
    std::vector<float> albedos_;  // by θ_o, azimuth and channel
};

}  // namespace shlight
