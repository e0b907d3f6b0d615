// SPDX-License-Identifier: MIT
#include "shlight/polygon.h"

#include <vector>

#include "base/checks.h"
#include "regions/polygon_kernels.h"
#include "regions/region_checks.h"

namespace shlight {

template <class T>
void polygon_coefficients(std::span<const Vec3<T>> vertices, int vertex_count, int order, bool clip,
                          std::span<T> coefficients) {
    check_order(order);
    check_vertex_count(vertex_count);
    const auto k = static_cast<std::size_t>(vertex_count);
    const std::size_t count = vertices.size() / k;
    check_size("vertices", vertices.size(), count * k);
    check_size("coefficients", coefficients.size(), count * static_cast<std::size_t>(coefficient_count(order)));
    std::vector<Vec3d> prepared(vertices.begin(), vertices.end());
    prepare_polygons<T>(prepared, vertex_count);
    polygon_rows(prepared, vertex_count, order, clip, coefficients.data());
}

template void polygon_coefficients(std::span<const Vec3f>, int, int, bool, std::span<float>);
template void polygon_coefficients(std::span<const Vec3d>, int, int, bool, std::span<double>);

}  // namespace shlight
