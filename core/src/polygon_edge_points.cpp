// SPDX-License-Identifier: MIT
#include "polygon_edge_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "gauss_legendre.h"
#include "legendre.h"
#include "point_batch.h"

namespace shlight {
namespace {

/// How an arc is cut: `pieces` of equal length with `points` each.
struct Division {
    int pieces, points;
};

/// Along a piece a harmonic is a sum of waves of at most κ radians to either side of its middle, and by Bernstein's
/// inequality no derivative is larger than that of the fastest. So k Gauss points err by at most
///   E_k = 2^{2k+1} k!⁴ κ^{2k} / ((2k+1) (2k)!³),     E_{k+1} = E_k κ² growth[k],
/// times the largest value and half the length. 0 if even the largest rule errs by more.
int points_for(double kappa, double tolerance) {
    static constexpr auto growth = [] {
        std::array<double, kMaxGaussPoints> g{};
        for (int k = 0; k < kMaxGaussPoints; ++k) {
            g[static_cast<std::size_t>(k)] = (k + 1) / (2.0 * (2 * k + 1) * (2 * k + 1) * (2 * k + 3));
        }
        return g;
    }();
    const double square = kappa * kappa;
    double error = 2 * square * growth[0];
    for (int k = 1; k < kMaxGaussPoints; ++k) {
        if (error <= tolerance) {
            return k;
        }
        error *= square * growth[static_cast<std::size_t>(k)];
    }
    return 0;
}

/// A harmonic of degree l has waves of up to l cycles a turn about the axis; on a small circle of radius s those of
/// more than ls + 7 are too weak to count.
template <class Real>
double degree_on(const Arc<Real>& arc, int order) {
    return arc.cosine == 0 ? order - 2 : std::min(order - 1.0, (order - 1) * static_cast<double>(arc.sine) + 7);
}

/// tolerance: of the integral of a harmonic of unit size.
template <class Real>
Division division_of(const Arc<Real>& arc, int order, double tolerance) {
    const double kappa = degree_on(arc, order) * static_cast<double>(arc.angle) / 2;
    const double half = static_cast<double>(arc.sine * arc.angle) / 2;
    // More than double can resolve is not asked for. The longest arc, a whole circle at the highest order, takes
    // eight pieces.
    const double relative = std::max(tolerance / half, 1e-20);
    for (int pieces = 1; pieces < 8; ++pieces) {
        const int points = points_for(kappa / pieces, relative);
        if (points > 0) {
            return {pieces, points};
        }
    }
    return {8, kMaxGaussPoints};
}

/// Of a harmonic's integral over an arc. What it adds to a coefficient is divided by about the degree, and the region's
/// L_00 is what errors are measured by.
template <class T>
double tolerance_for(const PolygonRegion<Wider<T>>& region, int order) {
    const double share = edge_points_in_float<T>(region) ? 1 : 0.25;
    return share * order * std::numeric_limits<T>::epsilon() * static_cast<double>(region.solid_angle());
}

/// The points of one piece of an arc from its middle outwards; `turned` is the middle's angle from the arc's start.
template <class R, class Real>
void add_piece(const Arc<Real>& arc, double turned, double half, int count, PointBatch<R>& batch) {
    const Vec3<R> axis(arc.axis);
    const auto cosine = static_cast<R>(arc.cosine);
    const Vec3<R> center = cosine * axis;
    const Vec3<R> start = Vec3<R>(arc.from) - center;
    const auto turn = static_cast<R>(turned);
    const Vec3<R> middle = std::cos(turn) * start + std::sin(turn) * glm::cross(axis, start);
    const Vec3<R> along = glm::cross(axis, middle);
    const GaussRule& rule = gauss_rule(count);
    for (int i = 0; i < (count + 1) / 2; ++i) {
        const auto angle = static_cast<R>(half * (1 - 2 * rule.nodes[i]));
        const auto weight = static_cast<R>(2 * half * rule.weights[i]);
        const Vec3<R> ahead = std::sin(angle) * along;
        const Vec3<R> base = center + std::cos(angle) * middle;
        batch.add(base - ahead, weight * (axis - cosine * (base - ahead)));
        if (2 * i + 1 < count) {
            batch.add(base + ahead, weight * (axis - cosine * (base + ahead)));
        }
    }
}

/// use(batch) until all points of all arcs were in one; batches are padded to multiples of `multiple` points.
template <class T, class R, class Use>
void for_each_batch(const PolygonRegion<Wider<T>>& region, int order, int multiple, Use use) {
    const double tolerance = tolerance_for<T>(region, order);
    PointBatch<R> batch;
    const auto flush = [&] {
        batch.pad(multiple);
        use(batch);
        batch.clear();
    };
    for (const auto& arc : region.arcs()) {
        const Division division = division_of(arc, order, tolerance);
        const double half = static_cast<double>(arc.angle) / (2 * division.pieces);
        for (int piece = 0; piece < division.pieces; ++piece) {
            if (batch.size() + division.points > PointBatch<R>::kPoints) {
                flush();
            }
            add_piece(arc, (2 * piece + 1) * half, half, division.points, batch);
        }
    }
    if (batch.size() > 0) {
        flush();
    }
}

/// The monic multiples of P̂_l^m, P̃_{l+1} = z P̃_l - β P̃_{l-1}, and what takes P̃_l^m (x+iy)^{m-1} to coefficients.
///
/// ν is tangent to the sphere, so ν·∇ may be taken of any extension beyond it, such as P̂_l^m(z) (x+iy)^m:
///   ν·∇ Y_l^m = ν_z √((l-m)(l+m+1)) P̂_l^{m+1} (x+iy)^m + m (ν_x + iν_y) P̂_l^m (x+iy)^{m-1}.
/// With its first term shifted by one degree all that is needed of degree m ≥ 1 is P̂_l^m (x+iy)^{m-1}.
struct DegreeStep {
    double beta;  ///< from l-1 and l to l+1
    double down;  ///< of ν_z … in coefficient m-1, with √2, Stokes' 1/(l(l+1)) and P̂/P̃
    double same;  ///< of (ν_x + iν_y) … in coefficient m
};

/// For m = 1, 2, … and l = m … kMaxOrder-1. Zero for band 1, which has a closed form.
class DegreeSteps {
  public:
    static const DegreeSteps& get() {
        static const DegreeSteps steps;
        return steps;
    }
    /// l = m, m+1, …
    const DegreeStep* of_degree(int m) const { return &steps_[start(m)]; }

  private:
    static constexpr std::size_t start(int m) { return static_cast<std::size_t>((m - 1) * (2 * kMaxOrder - m) / 2); }

    DegreeSteps() {
        const auto& constants = LegendreConstants<double>::get();
        for (int m = 1; m < kMaxOrder; ++m) {
            double scale = constants.diagonal[m];
            for (int l = m; l < kMaxOrder; ++l) {
                scale *= l > m ? constants.step[at(l, m)] : 1;
                const double stokes = l > 1 ? scale / (l * (l + 1)) : 0;
                const double pair = m > 1 ? std::numbers::sqrt2 : 1;
                steps_[start(m) + static_cast<std::size_t>(l - m)] = {
                    static_cast<double>(l * l - m * m) / (4.0 * l * l - 1),
                    stokes * pair * constants.ladder[at(l, m - 1)], stokes * std::numbers::sqrt2 * m};
            }
        }
    }

    std::array<DegreeStep, kCosineMax> steps_;
};

/// Sums over a batch's points, degree after degree.
template <class R>
class Moments {
  public:
    explicit Moments(const PointBatch<R>& batch) : packs_(batch.packs()), batch_(batch) {
        for (int i = 0; i < packs_; ++i) {
            re_[i] = all(R(1));
            im_[i] = all(R(0));
        }
    }

    /// Adds what degree m = 1, 2, 3 … in turn has for the bands below `order`.
    void add_degree(int m, int order, double* coefficients) {
        start_degree();
        const DegreeStep* step = DegreeSteps::get().of_degree(m);
        for (int l = m; l < order; l += 2, step += 2) {
            const Two sums = next_two_bands(static_cast<R>(step[0].beta), static_cast<R>(step[1].beta));
            add(sums.first, step[0], coefficients + coefficient_index(l, 0), m);
            if (l + 1 < order) {
                add(sums.second, step[1], coefficients + coefficient_index(l + 1, 0), m);
            }
        }
    }

  private:
    struct Sums {
        Pack<R> down_re, down_im, same_re, same_im;
    };
    struct Two {
        Sums first, second;
    };
    struct Point {
        Pack<R> z, p, before, down_re, down_im, same_re, same_im;
    };

    void start_degree() {
        for (int i = 0; i < packs_; ++i) {
            const Pack<R> re = re_[i];
            const Pack<R> im = im_[i];
            points_[i] = {batch_.z[i],
                          all(R(1)),
                          all(R(0)),
                          batch_.normal_z[i] * re,
                          batch_.normal_z[i] * im,
                          batch_.normal_x[i] * re - batch_.normal_y[i] * im,
                          batch_.normal_x[i] * im + batch_.normal_y[i] * re};
            re_[i] = re * batch_.x[i] - im * batch_.y[i];
            im_[i] = re * batch_.y[i] + im * batch_.x[i];
        }
    }

    static void accumulate(Sums& sums, const Pack<R>& p, const Point& point) {
        sums.down_re += p * point.down_re;
        sums.down_im += p * point.down_im;
        sums.same_re += p * point.same_re;
        sums.same_im += p * point.same_im;
    }

    Two next_two_bands(R beta, R next_beta) {
        // Field by field: GCC clears a whole structure by an instruction that takes longer than a few points.
        Two two{{all(R(0)), all(R(0)), all(R(0)), all(R(0))}, {all(R(0)), all(R(0)), all(R(0)), all(R(0))}};
        for (int i = 0; i < packs_; ++i) {
            Point& point = points_[i];
            const Pack<R> p = point.p;
            const Pack<R> next = point.z * p - beta * point.before;
            accumulate(two.first, p, point);
            accumulate(two.second, next, point);
            point.before = next;
            point.p = point.z * next - next_beta * p;
        }
        return two;
    }

    static void add(const Sums& sums, const DegreeStep& step, double* band, int m) {
        band[m - 1] += step.down * sum_of(sums.down_re);
        band[m] += step.same * sum_of(sums.same_re);
        band[-m] += step.same * sum_of(sums.same_im);
        if (m > 1) {
            band[1 - m] += step.down * sum_of(sums.down_im);
        }
    }

    int packs_;
    const PointBatch<R>& batch_;
    typename PointBatch<R>::Values re_, im_;  // (x + iy)^{m-1}
    std::array<Point, PointBatch<R>::kPacks> points_;
};

/// The potential F = Σ f_lm Y_lm / (l(l+1)), as steps: degree after degree, l = m … order-1.
template <class T>
void potential_steps(const T* lobe_terms, int order, DegreeStep* out) {
    for (int m = 1; m < order; ++m) {
        const DegreeStep* step = DegreeSteps::get().of_degree(m);
        for (int l = m; l < order; ++l, ++step, ++out) {
            const T* f = lobe_terms + cosine_index(l, m);
            *out = {step->beta, step->down * static_cast<double>(f[-1]), step->same * static_cast<double>(f[0])};
        }
    }
}

/// Packs of a batch that go through potential_integral at once, to hide the latency of the recurrence.
constexpr int kBlock = 2;

/// Σ ν·∇F ds over kBlock packs from `first` on.
template <class R>
double potential_integral(const PointBatch<R>& batch, int first, const DegreeStep* step, int order) {
    using Values = std::array<Pack<R>, kBlock>;
    Values z, re, im, sum;
    for (int i = 0; i < kBlock; ++i) {
        z[i] = batch.z[first + i];
        re[i] = all(R(1));
        im[i] = sum[i] = all(R(0));
    }
    for (int m = 1; m < order; ++m) {
        Values p, before, down, same;
        for (int i = 0; i < kBlock; ++i) {
            p[i] = all(R(1));
            before[i] = down[i] = same[i] = all(R(0));
        }
        for (int l = m; l < order; ++l, ++step) {
            const auto of_down = static_cast<R>(step->down);
            const auto of_same = static_cast<R>(step->same);
            const auto beta = static_cast<R>(step->beta);
            for (int i = 0; i < kBlock; ++i) {
                down[i] += of_down * p[i];
                same[i] += of_same * p[i];
                const Pack<R> next = z[i] * p[i] - beta * before[i];
                before[i] = p[i];
                p[i] = next;
            }
        }
        for (int i = 0; i < kBlock; ++i) {
            const int k = first + i;
            sum[i] += (batch.normal_z[k] * down[i] + batch.normal_x[k] * same[i]) * re[i] -
                      batch.normal_y[k] * same[i] * im[i];
            const Pack<R> next = re[i] * batch.x[k] - im[i] * batch.y[k];
            im[i] = re[i] * batch.y[k] + im[i] * batch.x[k];
            re[i] = next;
        }
    }
    double total = 0;
    for (const Pack<R>& pack : sum) {
        total += sum_of(pack);
    }
    return total;
}

/// Adds all bands from 2 on.
template <class T, class R>
void add_moments(const PolygonRegion<Wider<T>>& region, int order, double* coefficients) {
    for_each_batch<T, R>(region, order, kLanes<R>, [&](const PointBatch<R>& batch) {
        Moments<R> moments(batch);
        for (int m = 1; m < order; ++m) {
            moments.add_degree(m, order, coefficients);
        }
    });
}

/// ∮ ν·∇F ds.
template <class T, class R>
double potential_integral(const PolygonRegion<Wider<T>>& region, int order, const DegreeStep* steps) {
    double sum = 0;
    for_each_batch<T, R>(region, order, kBlock * kLanes<R>, [&](const PointBatch<R>& batch) {
        for (int pack = 0; pack < batch.packs(); pack += kBlock) {
            sum += potential_integral(batch, pack, steps, order);
        }
    });
    return sum;
}

/// work(R()) with the type that edge_points_in_float tells.
template <class T, class Work>
void in_wide_enough_type(const PolygonRegion<Wider<T>>& region, const Work& work) {
    if constexpr (std::is_same_v<T, float>) {
        if (edge_points_in_float<T>(region)) {
            work(float());
            return;
        }
    }
    work(double());
}

}  // namespace

template <class T>
void edge_point_coefficients(const PolygonRegion<Wider<T>>& region, int order, T* coefficients) {
    std::array<double, coefficient_count(kMaxOrder)> sum;
    std::fill_n(sum.begin(), coefficient_count(order), 0.0);
    if (order > 2) {
        in_wide_enough_type<T>(region, [&]<class R>(R /*type*/) { add_moments<T, R>(region, order, sum.data()); });
    }
    const auto to_result = [](auto c) { return static_cast<T>(c); };
    std::transform(sum.begin(), sum.begin() + coefficient_count(order), coefficients, to_result);
    const auto low = region.low_bands();
    std::transform(low.begin(), low.begin() + std::min(4, coefficient_count(order)), coefficients, to_result);
}

template <class T>
T shade_by_edge_points(const PolygonRegion<Wider<T>>& region, const T* lobe_terms, int order) {
    const auto low = region.low_bands();
    auto sum = static_cast<double>(low[0]) * static_cast<double>(lobe_terms[0]);
    if (order > 1) {
        sum += static_cast<double>(low[2]) * static_cast<double>(lobe_terms[1]) +
               static_cast<double>(low[3]) * static_cast<double>(lobe_terms[2]);
    }
    if (order > 2) {
        std::array<DegreeStep, kCosineMax> steps;
        potential_steps(lobe_terms, order, steps.data());
        in_wide_enough_type<T>(
            region, [&]<class R>(R /*type*/) { sum += potential_integral<T, R>(region, order, steps.data()); });
    }
    return static_cast<T>(sum);
}

template <class T>
bool edge_points_in_float(const PolygonRegion<Wider<T>>& region) {
    constexpr double kWideForFloat = 0.05;
    const auto& arcs = region.arcs();
    return std::is_same_v<T, float> && region.solid_angle() > kWideForFloat * region.outline() &&
           std::all_of(arcs.begin(), arcs.end(), [](const auto& arc) { return arc.cosine == 0; });
}

template <class T>
int edge_points(const PolygonRegion<Wider<T>>& region, int order) {
    const double tolerance = tolerance_for<T>(region, order);
    int total = 0;
    for (const auto& arc : region.arcs()) {
        const Division division = division_of(arc, order, tolerance);
        total += division.pieces * division.points;
    }
    return total;
}

template void edge_point_coefficients(const PolygonRegion<double>&, int, float*);
template void edge_point_coefficients(const PolygonRegion<long double>&, int, double*);
template float shade_by_edge_points(const PolygonRegion<double>&, const float*, int);
template double shade_by_edge_points(const PolygonRegion<long double>&, const double*, int);
template bool edge_points_in_float<float>(const PolygonRegion<double>&);
template bool edge_points_in_float<double>(const PolygonRegion<long double>&);
template int edge_points<float>(const PolygonRegion<double>&, int);
template int edge_points<double>(const PolygonRegion<long double>&, int);

}  // namespace shlight
