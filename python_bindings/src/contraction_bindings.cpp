// SPDX-License-Identifier: MIT
//
// Eq. 5 as the kernels do it, under one lobe without a warp whose terms are given: for tests and measurements of every
// band. Materials take the terms they need.
#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "arrays.h"
#include "base/aligned_floats.h"
#include "base/checks.h"
#include "bindings.h"
#include "caps/cap_checks.h"
#include "caps/cap_kernel.h"
#include "chunks.h"
#include "polygons/polygon_batch.h"
#include "polygons/polygon_checks.h"
#include "polygons/polygon_shading_kernel.h"

namespace shlight::python {
namespace {

/// A copy that may be read in whole cache lines.
AlignedFloats lobe_of(const Array<float>& cosine_terms, int order) {
    check_order(order);
    const auto terms = values(cosine_terms);
    check_size("cosine_terms", terms.size(), static_cast<std::size_t>(cosine_count(order)));
    AlignedFloats lobe;
    lobe.grow(terms.size());
    std::copy(terms.begin(), terms.end(), lobe.data());
    return lobe;
}

Array<float> contract_spheres(const Array<float>& centers, const Array<float>& radii, const Array<float>& cosine_terms,
                              int order, int threads) {
    const auto c = vectors("centers", centers);
    const auto r = values(radii);
    check_size("radii", r.size(), c.size());
    const AlignedFloats lobe = lobe_of(cosine_terms, order);
    Array<float> out(static_cast<py::ssize_t>(c.size()));
    float* sums = out.mutable_data();
    in_chunks(c.size(), threads, [&](std::size_t first, std::size_t count) {
        check_spheres(c.subspan(first, count), r.subspan(first, count), std::numeric_limits<float>::epsilon());
        shade_spheres_on_plane(&c[first], &r[first], count, lobe.data(), order, sums + first);
    });
    return out;
}

Array<float> contract_polygons(const Array<float>& vertices, const Array<float>& cosine_terms, int order, int threads) {
    const auto v = vectors("vertices", vertices);
    const auto k = static_cast<std::size_t>(vertices.shape(1));
    check_vertex_count(static_cast<int>(k));
    const AlignedFloats lobe = lobe_of(cosine_terms, order);
    Array<float> out(static_cast<py::ssize_t>(v.size() / k));
    float* sums = out.mutable_data();
    in_chunks(v.size() / k, threads, [&](std::size_t first, std::size_t count) {
        PolygonBatch polygons;
        polygons.clear(k);
        polygons.append(&v[first * k], count);
        polygons.check();
        std::vector<std::uint32_t> all(count);
        std::iota(all.begin(), all.end(), 0U);
        const std::vector<std::uint32_t> first_view(count, 0);
        shade_polygons(polygons.vertices(), polygons.vertex_count(), all, {false, {}, lobe.data(), 0, order},
                       first_view, {sums + first, count});
    });
    return out;
}

}  // namespace

void bind_contraction(py::module_& m) {
    m.def("contract_spheres", &contract_spheres, py::arg("centers").noconvert(), py::arg("radii").noconvert(),
          py::arg("cosine_terms").noconvert(), py::arg("order"), py::arg("threads"));
    m.def("contract_polygons", &contract_polygons, py::arg("vertices").noconvert(), py::arg("cosine_terms").noconvert(),
          py::arg("order"), py::arg("threads"));
}

}  // namespace shlight::python
