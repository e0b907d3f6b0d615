// SPDX-License-Identifier: MIT
//
// The library's three roads to a polygon's coefficients, each on its own; `exact` takes the fastest that is accurate.
#include "method.h"
#include "shlight/polygon.h"

namespace shlight::methods {
namespace {

template <class T, PolygonMethod Road>
void polygon(std::span<const Vec3<T>> vertices, int order, bool clip, const Options& /*options*/, T* coefficients) {
    polygon_coefficients(vertices, order, clip, coefficients, Road);
}

template <PolygonMethod Road>
Method road(std::string_view name, std::string_view source) {
    return {name, source, kMaxOrder, false, false, {nullptr, &polygon<float, Road>}, {nullptr, &polygon<double, Road>}};
}

}  // namespace

Method polygon_boundary() {
    return road<PolygonMethod::boundary>("polygon_boundary", "docs/algorithms.md, Polygons: recurrences along edges");
}

Method polygon_edge_points() {
    return road<PolygonMethod::edge_points>("polygon_edge_points",
                                            "docs/algorithms.md, Polygons: Gauss points on the edges");
}

Method polygon_cubature() {
    return road<PolygonMethod::cubature>("polygon_cubature", "docs/algorithms.md, Polygons: Gauss points in triangles");
}

}  // namespace shlight::methods
