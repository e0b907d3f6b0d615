// SPDX-License-Identifier: MIT
#include "zonal_factorization.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "shlight/basis.h"

namespace shlight::methods {
namespace {

/// The direction ω_d after rounding to T, which the recurrences use.
template <class T>
Vec3d rounded_direction(std::size_t lobe) {
    return Vec3d(Vec3<T>(lobe_directions()[lobe]));
}

/// A square matrix, row by row.
struct Matrix {
    explicit Matrix(std::size_t n) : size(n), values(n * n) {}
    double& operator()(std::size_t row, std::size_t column) { return values[row * size + column]; }
    double operator()(std::size_t row, std::size_t column) const { return values[row * size + column]; }

    std::size_t size;
    std::vector<double> values;
};

/// Y_lm(ω_d) with a row for each of the first 2l + 1 directions and a column for each m (Eq. 6).
template <class T>
Matrix band_matrix(int l) {
    Matrix matrix(static_cast<std::size_t>(2 * l + 1));
    std::array<double, coefficient_count(kMaxZonalOrder)> basis;
    for (std::size_t d = 0; d < matrix.size; ++d) {
        sh_basis(glm::normalize(rounded_direction<T>(d)), l + 1, basis.data());
        for (std::size_t m = 0; m < matrix.size; ++m) {
            matrix(d, m) = basis[static_cast<std::size_t>(l * l) + m];
        }
    }
    return matrix;
}

/// The inverse by Gauss–Jordan elimination with pivots.
Matrix inverse(Matrix a) {
    const std::size_t n = a.size;
    Matrix b(n);
    for (std::size_t i = 0; i < n; ++i) {
        b(i, i) = 1;
    }
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k + 1; i < n; ++i) {
            pivot = std::abs(a(i, k)) > std::abs(a(pivot, k)) ? i : pivot;
        }
        const double scale = 1 / a(pivot, k);
        for (std::size_t j = 0; j < n; ++j) {
            std::swap(a(k, j), a(pivot, j));
            std::swap(b(k, j), b(pivot, j));
            a(k, j) *= scale;
            b(k, j) *= scale;
        }
        for (std::size_t i = 0; i < n; ++i) {
            const double factor = a(i, k);
            if (i == k || factor == 0) {
                continue;
            }
            for (std::size_t j = 0; j < n; ++j) {
                a(i, j) -= factor * a(k, j);
                b(i, j) -= factor * b(k, j);
            }
        }
    }
    return b;
}

/// Squared singular values by one-sided Jacobi rotations, which turn pairs of columns until all are orthogonal.
std::vector<double> squared_singular_values(Matrix a) {
    const std::size_t n = a.size;
    const auto product = [&](std::size_t p, std::size_t q) {
        double sum = 0;
        for (std::size_t i = 0; i < n; ++i) {
            sum += a(i, p) * a(i, q);
        }
        return sum;
    };
    for (bool turned = true; turned;) {
        turned = false;
        for (std::size_t p = 0; p < n; ++p) {
            for (std::size_t q = p + 1; q < n; ++q) {
                const double pp = product(p, p);
                const double qq = product(q, q);
                const double pq = product(p, q);
                if (std::abs(pq) <= 1e-12 * std::sqrt(pp * qq)) {
                    continue;
                }
                turned = true;
                const double angle = std::atan2(2 * pq, pp - qq) / 2;
                const double c = std::cos(angle);
                const double s = std::sin(angle);
                for (std::size_t i = 0; i < n; ++i) {
                    const double x = a(i, p);
                    a(i, p) = c * x + s * a(i, q);
                    a(i, q) = c * a(i, q) - s * x;
                }
            }
        }
    }
    std::vector<double> squares(n);
    for (std::size_t p = 0; p < n; ++p) {
        squares[p] = product(p, p);
    }
    return squares;
}

/// The matrices from S_l(ω_d) to L_lm, band after band: a row of coefficients for each direction. Both dimensions are
/// padded with zeros to whole groups of lobes.
template <class T>
struct Factorization {
    std::vector<T> rows;

    Factorization() {
        for (int l = 1; l < kMaxZonalOrder; ++l) {
            const Matrix solved = inverse(band_matrix<T>(l));
            const double factor = (2 * l + 1) / (4 * std::numbers::pi);
            const std::size_t width = lobe_columns(l + 1);
            std::vector<T> band(width * width);
            for (std::size_t d = 0; d < solved.size; ++d) {
                for (std::size_t m = 0; m < solved.size; ++m) {
                    band[d * width + m] = static_cast<T>(factor * solved(m, d));
                }
            }
            rows.insert(rows.end(), band.begin(), band.end());
        }
    }
    static const Factorization& get() {
        static const Factorization factorization;
        return factorization;
    }
};

/// Eq. 10, in place.
template <class T>
void surface_integrals(LobeTable<T>& integrals, T orientation, int order) {
    const std::size_t columns = lobe_columns(order);
    for (std::size_t l = 1; l < static_cast<std::size_t>(order); ++l) {
        LobeRow<T>& row = integrals[l];
        const T outer = orientation * kZonal<T>.outer[l];
        if (l < 3) {
            for (std::size_t i = 0; i < columns; ++i) {
                row[i] *= outer;
            }
            continue;
        }
        const LobeRow<T>& before = integrals[l - 2];
        const T inner = kZonal<T>.inner[l];
        for (std::size_t i = 0; i < columns; ++i) {
            row[i] = outer * row[i] + inner * before[i];
        }
    }
}

/// Σ_d S_l(ω_d) · row d, four rows at a time, so that the sums are loaded and stored less often.
template <class T>
void combine(const LobeRow<T>& integral, const T* rows, std::size_t width, std::array<T, kLobeColumns>& sums) {
    static_assert(kLobeGroup == 4);
    std::fill_n(sums.begin(), width, T(0));
    for (std::size_t d = 0; d < width; d += kLobeGroup, rows += kLobeGroup * width) {
        const T s0 = integral[d];
        const T s1 = integral[d + 1];
        const T s2 = integral[d + 2];
        const T s3 = integral[d + 3];
        for (std::size_t m = 0; m < width; ++m) {
            sums[m] += (s0 * rows[m] + s1 * rows[width + m]) + (s2 * rows[2 * width + m] + s3 * rows[3 * width + m]);
        }
    }
}

}  // namespace

template <class T>
const LobeAxes<T>& LobeAxes<T>::get() {
    static const LobeAxes axes = [] {
        LobeAxes made;
        for (std::size_t i = 0; i < kLobeColumns; ++i) {
            const Vec3<T> direction(rounded_direction<T>(std::min(i, kMaxLobes - 1)));
            made.x[i] = direction.x;
            made.y[i] = direction.y;
            made.z[i] = direction.z;
        }
        return made;
    }();
    return axes;
}

template <class T>
void zonal_coefficients(LobeTable<T>& integrals, T orientation, T solid_angle, int order, T* coefficients) {
    coefficients[0] = solid_angle / std::sqrt(4 * std::numbers::pi_v<T>);
    surface_integrals(integrals, orientation, order);
    const T* rows = Factorization<T>::get().rows.data();
    std::array<T, kLobeColumns> sums;
    for (int l = 1; l < order; ++l) {
        const std::size_t width = lobe_columns(l + 1);
        combine(integrals[static_cast<std::size_t>(l)], rows, width, sums);
        std::copy_n(sums.begin(), 2 * l + 1, coefficients + coefficient_index(l, -l));
        rows += width * width;
    }
}

double lobe_condition(int band) {
    const std::vector<double> squares = squared_singular_values(band_matrix<double>(band));
    const auto [least, largest] = std::minmax_element(squares.begin(), squares.end());
    return std::sqrt(*largest / *least);
}

template struct LobeAxes<float>;
template struct LobeAxes<double>;
template void zonal_coefficients(LobeTable<float>&, float, float, int, float*);
template void zonal_coefficients(LobeTable<double>&, double, double, int, double*);

}  // namespace shlight::methods
