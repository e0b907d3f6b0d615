// SPDX-License-Identifier: MIT
//
// Polygons: zonal integrals by recurrences along the edges, which are arcs of great circles (Wang & Ramamoorthi 2018,
// as Zhou & Wei 2020 use it for quads).
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "arc_recurrence.h"
#include "method.h"

namespace shlight::methods {
namespace {

template <class T>
struct Vertex {
    Vec3<T> position;
    T distance;
    Vec3<T> direction;

    Vertex() = default;
    explicit Vertex(const Vec3<T>& p) : position(p), distance(glm::length(p)), direction(p / distance) {}
};

/// Solid angle of a triangle, signed by its winding (Van Oosterom & Strackee 1983). The triple product is that of
/// edges, so that a small triangle keeps its digits.
template <class T>
T triangle_solid_angle(const Vertex<T>& a, const Vertex<T>& b, const Vertex<T>& c) {
    const T triple = glm::dot(
        a.direction, glm::cross((b.position - a.position) / b.distance, (c.position - a.position) / c.distance));
    return 2 * std::atan2(triple, 1 + glm::dot(a.direction, b.direction) + glm::dot(b.direction, c.direction) +
                                      glm::dot(c.direction, a.direction));
}

/// Receives the vertices of the clipped polygon in order, and sums the edges' integrals and the fan's area.
template <class T>
class PolygonIntegrals {
  public:
    explicit PolygonIntegrals(int order) : order_(order) { clear_boundary(boundary, order); }

    void add(const Vec3<T>& position) {
        const Vertex<T> vertex(position);
        if (count_ == 0) {
            first_ = vertex;
            ends_[0].set(vertex.direction, order_);
        } else {
            add_edge(vertex);
        }
        if (count_ > 1) {
            solid_angle += triangle_solid_angle(first_, last_, vertex);
        }
        last_ = vertex;
        ++count_;
    }
    void close() {
        if (count_ > 2) {
            add_edge(first_);
        }
    }

    LobeTable<T> boundary;
    T solid_angle = 0;

  private:
    void add_edge(const Vertex<T>& to) {
        if (order_ < 2) {
            return;
        }
        const Vec3<T> normal = glm::cross(last_.direction, (to.position - last_.position) / to.distance);
        const T sine = glm::length(normal);
        if (!(sine > 0)) {
            return;
        }
        LobePoint<T>& begin = ends_[present_];
        LobePoint<T>& end = ends_[1 - present_];
        end.set(to.direction, order_);
        const T angle = std::atan2(sine, glm::dot(begin.point, end.point));
        add_great_arc({normal / sine, T(0), T(1), angle}, begin, end, order_, boundary);
        present_ = 1 - present_;
    }

    int order_;
    int count_ = 0;
    std::size_t present_ = 0;  // index in ends_ of the last vertex
    Vertex<T> first_, last_;
    std::array<LobePoint<T>, 2> ends_;
};

template <class T>
void polygon(std::span<const Vec3<T>> vertices, int order, bool clip, const Options& /*options*/, T* coefficients) {
    PolygonIntegrals<T> sums(order);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3<T>& a = vertices[i];
        const Vec3<T>& b = vertices[(i + 1) % vertices.size()];
        if (!clip || a.z >= 0) {
            sums.add(a);
        }
        if (clip && ((a.z < 0 && b.z > 0) || (a.z > 0 && b.z < 0))) {
            const T share = a.z / (a.z - b.z);
            sums.add({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), T(0)});
        }
    }
    sums.close();
    if (!(std::abs(sums.solid_angle) > 0)) {  // NaN: a vertex lies in the shading point, the plane is seen edge-on
        std::fill_n(coefficients, coefficient_count(order), T(0));
        return;
    }
    const T orientation = sums.solid_angle < 0 ? T(-1) : T(1);
    zonal_coefficients(sums.boundary, orientation, std::abs(sums.solid_angle), order, coefficients);
}

}  // namespace

Method wang_ramamoorthi() {
    return {"wang_ramamoorthi",
            "Wang & Ramamoorthi 2018: zonal factorization, Legendre recurrences along great arcs",
            kMaxZonalOrder,
            false,
            false,
            {nullptr, &polygon<float>},
            {nullptr, &polygon<double>}};
}

}  // namespace shlight::methods
