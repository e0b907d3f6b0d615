// SPDX-License-Identifier: MIT
#include "lobes/anisotropic_fit.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/recent_values.h"
#include "lobes/fit_table.h"
#include "lobes/lobe_moments.h"
#include "lobes/normal_equations.h"
#include "math/cubic_stencil.h"
#include "math/gauss_legendre.h"
#include "math/legendre.h"
#include "shlight/plain_fit.h"

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

/// One view's f·cos over the upper hemisphere: moments with cosine and with sine terms, in cosine_index layout.
struct FullMoments {
    std::vector<double> cosines, sines;
    double norm_squared = 0;
    double albedo = 0;
};

/// Heights that integrate harmonics of all orders exactly.
const GaussRule& heights() {
    return gauss_rule(kMaxGaussPoints);
}

/// The harmonics of all orders at these heights, and their fits.
struct Hemisphere {
    HeightBasis basis{heights().nodes, kMaxOrder};
    NormalEquations equations{basis, heights().weights};

    static const Hemisphere& get() {
        static const Hemisphere instance;
        return instance;
    }
};

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

/// order > 1. In the frame of the tangent, or of the view.
FullMoments full_moments(const TableShape& shape, double theta_o, bool of_tangent, int order) {
    const HeightBasis& basis = Hemisphere::get().basis;
    const auto wanted = static_cast<int>(kAzimuthsPerPeak / shape.width());
    const Circle circle(std::clamp(std::max(wanted, 4 * order), kLeastAzimuths, kMostAzimuths), order);
    const double c = of_tangent ? std::cos(shape.azimuth) : 1.0;
    const double s = of_tangent ? std::sin(shape.azimuth) : 0.0;
    const double sine_o = std::sin(theta_o);
    const Vec3d wo(sine_o * c, sine_o * s, std::cos(theta_o));
    const double turn = of_tangent ? 0.0 : shape.azimuth;
    FullMoments sums{std::vector<double>(kCosineMax, 0.0), std::vector<double>(kCosineMax, 0.0)};
    std::vector<double> cosine_waves(circle.waves), sine_waves(circle.waves);
    const double step = 2 * pi / static_cast<double>(circle.size());
    for (std::size_t i = 0; i < heights().nodes.size(); ++i) {
        const double z = heights().nodes[i];
        const double sine = std::sqrt((1 - z) * (1 + z));
        const double weight = heights().weights[i] * step;
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
        for (std::size_t i = 0; i < heights().nodes.size(); ++i) {
            for (int l = 0; l < order; ++l) {
                const double term = coefficients[static_cast<std::size_t>(coefficient_index(l, 0))];
                sum -= 2 * pi * heights().weights[i] * term * Hemisphere::get().basis.values(l, 0)[i];
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
    static const NormalEquations& equations() { return Hemisphere::get().equations; }

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

struct AnisotropicFit::Taps {
    std::array<std::size_t, 16> rows{};
    std::array<float, 16> weights{};
    std::size_t count = 0;
};

AnisotropicFit::AnisotropicFit(const TableShape& shape, int order)
    : orders_(order == 0 ? std::vector<int>(kBoostedOrders.begin(), kBoostedOrders.end()) : std::vector<int>{order}),
      row_size_(FitTable::kHeadWidth) {
    for (const int own : orders_) {
        first_.push_back(row_size_);
        row_size_ += static_cast<std::size_t>(coefficient_count(own));
    }
    place_views(*shape.table);
    const std::size_t views = axes_[0].size() * axes_[1].size();
    rows_.resize(views * row_size_);
    // Isolated, because a thread that waits here must not start unrelated work that asks for this same fit.
    tbb::this_task_arena::isolate(
        [&] { tbb::parallel_for(std::size_t{0}, views, [&](std::size_t view) { fit_view(shape, view); }); });
}

void AnisotropicFit::place_views(const LobeTable& table) {
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

void AnisotropicFit::fit_view(const TableShape& shape, std::size_t view) {
    TableShape own = shape;
    own.azimuth = axes_[1].angles()[view % axes_[1].size()];
    const double theta_o = least_grazing(axes_[0].angles()[view / axes_[1].size()]);
    const int highest = *std::max_element(orders_.begin(), orders_.end());
    const FullFit fit(full_moments(own, theta_o, own_axes_, std::max(highest, 2)));
    const auto row = std::span(rows_).subspan(view * row_size_, row_size_);
    row[FitTable::kAlbedo] = static_cast<float>(fit.albedo());
    for (std::size_t i = 0; i < orders_.size(); ++i) {
        const auto terms = row.subspan(first_[i], static_cast<std::size_t>(coefficient_count(orders_[i])));
        fit.solve(orders_[i], terms);
        row[FitTable::kShadingErrors + i] = static_cast<float>(shading_error(
            fit.squared_error(orders_[i]), fit.missing_light(terms, orders_[i]), orders_[i], fit.albedo()));
    }
}

AnisotropicFit::Taps AnisotropicFit::taps(double cos_theta_o, double azimuth) const {
    const double theta_o = std::acos(std::clamp(cos_theta_o, 0.0, 1.0));
    const AxisTaps along = own_axes_ ? AxisTaps(axes_[0].place(theta_o)) : AxisTaps(axes_[0], theta_o);
    const AxisTaps around = own_axes_ ? AxisTaps(axes_[1].place(azimuth)) : AxisTaps(axes_[1], azimuth);
    Taps all;
    for (std::size_t i = 0; i < along.count; ++i) {
        for (std::size_t k = 0; k < around.count; ++k) {
            all.rows[all.count] = along.entries[i] * axes_[1].size() + around.entries[k];
            all.weights[all.count++] = static_cast<float>(along.weights[i] * around.weights[k]);
        }
    }
    return all;
}

void AnisotropicFit::interpolate(const Taps& taps, std::size_t column, std::size_t count, float* out) const {
    std::fill_n(out, count, 0.0F);
    for (std::size_t k = 0; k < taps.count; ++k) {
        const float* row = &rows_[taps.rows[k] * row_size_ + column];
        for (std::size_t i = 0; i < count; ++i) {
            out[i] += taps.weights[k] * row[i];
        }
    }
}

void AnisotropicFit::head(double cos_theta_o, double azimuth, float* out) const {
    interpolate(taps(cos_theta_o, azimuth), 0, FitTable::kHeadWidth, out);
}

void AnisotropicFit::coefficients(double cos_theta_o, double azimuth, int order, float* out) const {
    const auto which = static_cast<std::size_t>(std::find(orders_.begin(), orders_.end(), order) - orders_.begin());
    interpolate(taps(cos_theta_o, azimuth), first_[which], static_cast<std::size_t>(coefficient_count(order)), out);
    if (own_axes_) {
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
