// SPDX-License-Identifier: MIT
#include "lobes/anisotropic_views.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "lobes/lobe_moments.h"
#include "math/cubic_stencil.h"
#include "math/legendre.h"

namespace shlight {
namespace {

using std::numbers::pi;

/// Views of a table without views of its own: θ_o = 0 … π/2 in equal steps, and azimuths.
constexpr std::size_t kThetas = 33, kAzimuths = 48;
/// A table of directions with more views than this is fitted at those.
constexpr std::size_t kMostOwnViews = 4096;

/// The azimuths of a rule, at least; a peak takes more, up to the most.
constexpr int kLeastAzimuths = 96, kMostAzimuths = 384;
constexpr double kAzimuthsPerPeak = 16;

/// cos mφ and sin mφ at equal steps around.
struct Circle {
    std::size_t waves;
    std::vector<double> cosines, sines;

    Circle(int points, int order) : waves(static_cast<std::size_t>(order)) {
        cosines.resize(static_cast<std::size_t>(points) * waves);
        sines.resize(cosines.size());
        for (int j = 0; j < points; ++j) {
            const double phi = 2 * pi * (j + 0.5) / points;
            const std::size_t first = static_cast<std::size_t>(j) * waves;
            complex_powers(std::cos(phi), std::sin(phi), order, &cosines[first], &sines[first]);
        }
    }
    std::size_t size() const { return cosines.size() / waves; }
};

/// An axis of equal steps from 0 on.
TableAxis even_axis(std::size_t count, double step, double period) {
    std::vector<double> angles(count);
    std::iota(angles.begin(), angles.end(), 0.0);
    std::transform(angles.begin(), angles.end(), angles.begin(), [&](double i) { return step * i; });
    return {angles, period};
}

/// Entries of an axis and their weights.
struct AxisTaps {
    std::array<std::size_t, 4> entries{};
    std::array<double, 4> weights{};
    std::size_t count = 1;

    /// Linear.
    explicit AxisTaps(const TableAxis::Place& place)
        : entries{place.low, place.high}, weights{1 - place.share, place.share}, count(place.share > 0 ? 2 : 1) {}
    /// Cubic, between equal steps from 0 on.
    AxisTaps(const TableAxis& axis, double angle) {
        if (axis.size() == 1) {
            weights[0] = 1;
            return;
        }
        const double position = angle / (axis.angles()[1] - axis.angles()[0]);
        const auto size = static_cast<int>(axis.size());
        const bool around = axis.period() > 0;
        const double turned = around ? position - size * std::floor(position / size) : position;
        const CubicStencil stencil = around ? CubicStencil(turned, -1, size + 3) : CubicStencil(turned, 0, size);
        count = 4;
        for (std::size_t k = 0; k < 4; ++k) {
            entries[k] = static_cast<std::size_t>((stencil.first + static_cast<int>(k) + size) % size);
            weights[k] = stencil.weights[k];
        }
    }
};

}  // namespace

const GaussRule& upper_heights() {
    return gauss_rule(kMaxGaussPoints);
}

const HeightBasis& upper_basis() {
    static const HeightBasis basis(upper_heights().nodes, kMaxOrder);
    return basis;
}

FullMoments full_moments(const TableShape& shape, double theta_o, bool of_tangent, int order) {
    const HeightBasis& basis = upper_basis();
    const auto wanted = static_cast<int>(kAzimuthsPerPeak / shape.width());
    const Circle circle(std::clamp(std::max(wanted, 2 * order), kLeastAzimuths, kMostAzimuths), order);
    const double c = of_tangent ? std::cos(shape.azimuth) : 1.0;
    const double s = of_tangent ? std::sin(shape.azimuth) : 0.0;
    const double sine_o = std::sin(theta_o);
    const Vec3d wo(sine_o * c, sine_o * s, std::cos(theta_o));
    const double turn = of_tangent ? 0.0 : shape.azimuth;
    FullMoments sums{std::vector<double>(kCosineMax, 0.0), std::vector<double>(kCosineMax, 0.0)};
    std::vector<double> cosine_waves(circle.waves), sine_waves(circle.waves);
    const double step = 2 * pi / static_cast<double>(circle.size());
    for (std::size_t i = 0; i < upper_heights().nodes.size(); ++i) {
        const double z = upper_heights().nodes[i];
        const double sine = std::sqrt((1 - z) * (1 + z));
        const double weight = upper_heights().weights[i] * step;
        std::fill(cosine_waves.begin(), cosine_waves.end(), 0.0);
        std::fill(sine_waves.begin(), sine_waves.end(), 0.0);
        for (std::size_t j = 0; j < circle.size(); ++j) {
            const double* cosines = &circle.cosines[j * circle.waves];
            const double* sines = &circle.sines[j * circle.waves];
            const double f = shape.table->reflected({sine * cosines[1], sine * sines[1], z}, wo, turn, shape.channel);
            sums.norm_squared += weight * f * f;
            for (std::size_t m = 0; m < circle.waves; ++m) {
                cosine_waves[m] += f * cosines[m];
                sine_waves[m] += f * sines[m];
            }
        }
        sums.albedo += weight * cosine_waves[0];
        for (int l = 0; l < order; ++l) {
            for (int m = 0; m <= l; ++m) {
                const double value = weight * basis.values(l, m)[i] * (m == 0 ? 1.0 : std::numbers::sqrt2);
                sums.cosines[at(l, m)] += value * cosine_waves[static_cast<std::size_t>(m)];
                sums.sines[at(l, m)] += value * sine_waves[static_cast<std::size_t>(m)];
            }
        }
    }
    return sums;
}

void RowTaps::interpolate(std::span<const float> table, std::size_t row_size, std::size_t column, std::size_t width,
                          float* out) const {
    std::fill_n(out, width, 0.0F);
    for (std::size_t k = 0; k < count; ++k) {
        const float* row = &table[rows[k] * row_size + column];
        for (std::size_t i = 0; i < width; ++i) {
            out[i] += weights[k] * row[i];
        }
    }
}

AnisotropicViews::AnisotropicViews(const LobeTable& table) {
    const bool turns = table.axes()[1].size() > 1;
    const TableAxis& thetas = table.axes()[2];
    const TableAxis& azimuths = table.axes()[3];
    own_axes_ = table.angles() == TableAngles::directions && turns && thetas.size() * azimuths.size() <= kMostOwnViews;
    if (own_axes_) {
        axes_ = {thetas, azimuths};
        return;
    }
    axes_ = {even_axis(kThetas, pi / 2 / (kThetas - 1), 0),
             even_axis(turns ? kAzimuths : 1, 2 * pi / static_cast<double>(kAzimuths), 2 * pi)};
}

void AnisotropicViews::for_each(const std::function<void(std::size_t view)>& function) const {
    // Isolated, because a thread that waits here must not start unrelated work that asks for the same values.
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::size_t{0}, size(), function); });
}

FullMoments AnisotropicViews::moments(const TableShape& shape, std::size_t view, int order) const {
    TableShape own = shape;
    own.azimuth = axes_[1].angles()[view % axes_[1].size()];
    return full_moments(own, least_grazing(axes_[0].angles()[view / axes_[1].size()]), own_axes_, order);
}

RowTaps AnisotropicViews::taps(double cos_theta_o, double azimuth) const {
    const double theta_o = std::acos(std::clamp(cos_theta_o, 0.0, 1.0));
    const AxisTaps along = own_axes_ ? AxisTaps(axes_[0].place(theta_o)) : AxisTaps(axes_[0], theta_o);
    const AxisTaps around = own_axes_ ? AxisTaps(axes_[1].place(azimuth)) : AxisTaps(axes_[1], azimuth);
    RowTaps all;
    for (std::size_t i = 0; i < along.count; ++i) {
        for (std::size_t k = 0; k < around.count; ++k) {
            all.rows[all.count] = along.entries[i] * axes_[1].size() + around.entries[k];
            all.weights[all.count++] = static_cast<float>(along.weights[i] * around.weights[k]);
        }
    }
    return all;
}

}  // namespace shlight
