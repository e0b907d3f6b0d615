// SPDX-License-Identifier: MIT
//
// What many points see of one mesh, as polygons that are shaded together.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "emitters/mesh_view.h"
#include "polygons/polygon_batch.h"

namespace shlight {

/// Keeps its memory from mesh to mesh.
class MeshOutlines {
  public:
    void clear();
    /// What the point number `point` sees. tolerance: of the radiance of a white surface.
    void look(const EmitterLevels& emitter, const ShadingFrame& frame, double tolerance, std::uint32_t point);

    /// shade() for each batch of polygons with as many vertices, after they and the points that see them were put into
    /// `polygons` and `seen_by`. Vertices are repeated up to the next multiple of a few.
    template <class Shade>
    void for_each_size(PolygonBatch& polygons, std::vector<std::uint32_t>& seen_by, const Shade& shade) {
        std::stable_sort(seen_.begin(), seen_.end(), [](const Seen& a, const Seen& b) { return a.padded < b.padded; });
        for (std::size_t first = 0; first < seen_.size();) {
            const std::uint32_t size = seen_[first].padded;
            polygons.clear(size);
            seen_by.clear();
            std::size_t last = first;
            for (; last < seen_.size() && seen_[last].padded == size; ++last) {
                seen_by.push_back(seen_[last].point);
                for (std::uint32_t i = 0; i < size; ++i) {
                    polygons.push_back(vertices_[seen_[last].first + std::min(i, seen_[last].count - 1)]);
                }
            }
            shade();
            first = last;
        }
    }
    /// Points within the mesh, which see it in all directions.
    std::span<const std::uint32_t> inside() const { return inside_; }

  private:
    struct Seen {
        std::uint32_t point, first, count, padded;
    };
    /// The vertices from `first` on, as what a point sees.
    void add(std::size_t first, std::uint32_t point);

    MeshView view_;
    std::vector<Vec3d> vertices_;
    std::vector<Seen> seen_;
    std::vector<std::uint32_t> inside_;
};

}  // namespace shlight
