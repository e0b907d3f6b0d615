// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "regions/polygon_kernels.h"
#include "regions/region_checks.h"
#include "shlight/types.h"

namespace shlight {

/// Polygons of the same number of vertices in the shading frame, as the kernels read them. Keeps its memory.
class PolygonBatch {
  public:
    void clear(std::size_t vertex_count) {
        vertex_count_ = vertex_count;
        vertices_.clear();
        viewed_ = 0;
    }
    /// One more vertex.
    void push_back(const Vec3d& vertex) { vertices_.push_back(vertex); }
    template <class T>
    void append(const Vec3<T>* vertices, std::size_t polygons) {
        const std::size_t first = vertices_.size();
        const std::size_t count = polygons * vertex_count_;
        if (count > 0) {
            vertices_.resize(first + count);
            std::copy_n(&vertices->x, 3 * count, &vertices_[first].x);
        }
    }
    /// Calls prepare_polygons for all.
    template <class T>
    void prepare() {
        prepare_polygons<T>(vertices_, vertex_count());
    }

    int vertex_count() const { return static_cast<int>(vertex_count_); }
    std::size_t size() const { return vertices_.size() / vertex_count_; }
    std::span<const Vec3d> vertices() const { return vertices_; }
    std::span<const Vec3d> polygon(std::size_t i) const { return vertices().subspan(i * vertex_count_, vertex_count_); }
    bool lies_below(std::size_t i) const {
        const auto v = polygon(i);
        return std::none_of(v.begin(), v.end(), [](const Vec3d& p) { return p.z > 0; });
    }

    /// Each as a direction and half an angle; worked out for those that are new.
    PolygonArrays views() {
        if (viewed_ != size()) {
            viewed_ = size();
            for (std::vector<double>* array : {&x_, &y_, &z_, &half_angle_}) {
                array->resize(viewed_);
            }
            polygon_extents(vertices_, vertex_count(), {x_, y_, z_, half_angle_});
        }
        return {x_.data(), y_.data(), z_.data(), half_angle_.data()};
    }

  private:
    std::size_t vertex_count_ = 3;
    std::vector<Vec3d> vertices_;
    std::size_t viewed_ = 0;
    std::vector<double> x_, y_, z_, half_angle_;
};

}  // namespace shlight
