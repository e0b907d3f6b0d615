// SPDX-License-Identifier: MIT
#include "regions/polygon_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/exact_sums.h"
#include "base/safe_length.h"
#include "math/triangle_cubature.h"
#include "regions/arcs.h"
#include "shlight/basis.h"

namespace shlight {
namespace {

/// Triangles longer than this are halved first: beyond it the density of the projection costs more points than it
/// saves.
constexpr double kLongestSide = 0.7;

/// triple: a·(b×c), which is signed by the winding, tiny for narrow triangles, and known better than the corners tell.
struct Triangle {
    Vec3d a, b, c;
    double triple;
};

/// Points a side that integrate order-n harmonics over a triangle of this longest side: a wave of κ = n·side/2 radians
/// needs about κ/2 points before convergence sets in, then a few for the digits; where all is small, as many as an arc
/// of twice those waves, and one more for the triangle's density.
int points_per_side(int order, double side) {
    const double points = std::min(5 + 0.55 * order * side + 16 * side, static_cast<double>(kMaxGaussPoints));
    const Division small = divided((order + 8) * side, 1e-16);
    return std::min(static_cast<int>(std::ceil(points)), small.pieces * small.points + 1);
}

/// Adds the integrals over triangles, of which `order` and `coefficients` are the same for all.
class TriangleSum {
  public:
    TriangleSum(int order, double* coefficients) : order_(order), coefficients_(coefficients) {}

    void add_above_horizon(Triangle t) {
        const int above = (t.a.z >= 0 ? 1 : 0) + (t.b.z >= 0 ? 1 : 0) + (t.c.z >= 0 ? 1 : 0);
        if (above == 0 || above == 3) {
            return above == 0 ? void() : add(t);
        }
        while ((t.b.z >= 0) != (t.c.z >= 0)) {
            t = {t.b, t.c, t.a, t.triple};
        }
        // a is alone on its side. Shares of the sides are shares of the triple product.
        const double to_b = t.a.z / (t.a.z - t.b.z);
        const double to_c = t.a.z / (t.a.z - t.c.z);
        const Vec3d on_ab = cut(t.a, t.b);
        const Vec3d on_ac = cut(t.a, t.c);
        if (above == 1) {
            add({t.a, on_ab, on_ac, to_b * to_c * t.triple});
        } else {
            add({on_ab, t.b, t.c, t.b.z / (t.b.z - t.a.z) * t.triple});
            add({on_ab, t.c, on_ac, to_b * (t.c.z / (t.c.z - t.a.z)) * t.triple});
        }
    }

    void add(const Triangle& t) {
        const double a = glm::length(t.a);
        const double b = glm::length(t.b);
        const double c = glm::length(t.c);
        if (a > 0 && b > 0 && c > 0) {
            add_directions({t.a / a, t.b / b, t.c / c, t.triple / (a * b * c)});
        }
    }

  private:
    /// The point in which the edge from a to b meets the horizon. Heights are brought near 1, since products of
    /// subnormal ones have no digits and their reciprocal is infinite.
    static Vec3d cut(const Vec3d& a, const Vec3d& b) {
        const double scale = power_of_two_scale(std::max(std::abs(a.z), std::abs(b.z)));
        const double a_z = scale * a.z;
        const double b_z = scale * b.z;
        const double over = 1 / (a_z - b_z);
        return {over * difference_of_products(a_z, b.x, b_z, a.x), over * difference_of_products(a_z, b.y, b_z, a.y),
                0};
    }

    void add_directions(const Triangle& t) {
        const double longest = std::max({glm::length(t.b - t.a), glm::length(t.c - t.b), glm::length(t.a - t.c)});
        if (longest <= kLongestSide) {
            add_small(t, longest);
            return;
        }
        const Triangle turned = longest == glm::length(t.b - t.a)   ? t
                                : longest == glm::length(t.c - t.b) ? Triangle{t.b, t.c, t.a, t.triple}
                                                                    : Triangle{t.c, t.a, t.b, t.triple};
        const Vec3d sum = turned.a + turned.b;
        const double over = 1 / glm::length(sum);
        add_directions({turned.a, sum * over, turned.c, t.triple * over});
        add_directions({sum * over, turned.b, turned.c, t.triple * over});
    }

    void add_small(const Triangle& t, double side) {
        std::array<double, static_cast<std::size_t>(coefficient_count(kMaxOrder))> basis;
        const auto rule = product_rule(points_per_side(order_, side));
        visit_triangle(t.a, t.b, t.c, t.triple, rule, [&](const Vec3d& direction, double weight) {
            sh_basis(direction, order_, basis.data());
            for (int k = 0; k < coefficient_count(order_); ++k) {
                coefficients_[k] += weight * basis[static_cast<std::size_t>(k)];
            }
        });
    }

    int order_;
    double* coefficients_;
};

/// The vertices times a power of two, which changes no digit: triple products of tiny and huge coordinates stay in the
/// range of double.
std::vector<Vec3d> scaled_to_one(std::span<const Vec3d> vertices) {
    double largest = 0;
    for (const Vec3d& v : vertices) {
        largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    }
    const double scale = power_of_two_scale(largest);
    std::vector<Vec3d> scaled(vertices.begin(), vertices.end());
    for (Vec3d& v : scaled) {
        v *= scale;
    }
    return scaled;
}

}  // namespace

template <class T>
void polygon_by_cubature(std::span<const Vec3d> vertices, int order, bool clip, T* coefficients) {
    std::array<double, static_cast<std::size_t>(coefficient_count(kMaxOrder))> total;
    const int count = coefficient_count(order);
    std::fill_n(total.begin(), count, 0.0);
    TriangleSum sum(order, total.data());
    const std::vector<Vec3d> v = scaled_to_one(vertices);
    double volume = 0;  // signed by the winding
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        const Triangle triangle = {v[0], v[i], v[i + 1], triple_product(v[0], v[i], v[i + 1])};
        volume += triangle.triple;
        clip ? sum.add_above_horizon(triangle) : sum.add(triangle);
    }
    // Vertices that are rounded off their plane may leave less than nothing of a thin polygon.
    if ((volume < 0) != (total[0] < 0)) {
        std::fill_n(total.begin(), count, 0.0);
    }
    std::transform(total.begin(), total.begin() + count, coefficients,
                   [volume](double c) { return static_cast<T>(volume < 0 ? -c : c); });
}

template void polygon_by_cubature(std::span<const Vec3d>, int, bool, float*);
template void polygon_by_cubature(std::span<const Vec3d>, int, bool, double*);

}  // namespace shlight
