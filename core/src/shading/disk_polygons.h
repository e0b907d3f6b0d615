// SPDX-License-Identifier: MIT
//
// Disks as points see them, and as the polygons that stand for them under a lobe, those of one size together.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "disks/disk_polygon.h"
#include "lobes/material_views.h"
#include "polygons/polygon_batch.h"

namespace shlight {

/// Keeps its memory.
class DiskPolygons {
  public:
    void clear() {
        seen_.clear();
        given_.clear();
    }
    /// A disk in the shading frame, under the view number `view`; what lies wholly below the horizon or is seen edge-on
    /// is left out. number: what it is known by.
    void add(const Ellipse<double>& disk, std::uint32_t view, std::uint32_t number) {
        const SphericalEllipse<double> ellipse(disk, true);
        if (!ellipse.empty()) {
            seen_.push_back({ellipse, 0, 0, view, number});
        }
    }
    /// A part of a disk, as a convex polygon.
    void add(std::span<const Vec3d> corners, std::uint32_t view, std::uint32_t number) {
        seen_.push_back({std::nullopt, given_.size(), corners.size(), view, number});
        given_.insert(given_.end(), corners.begin(), corners.end());
    }

    /// shade() for each batch of polygons of one size, after they, their views and their numbers were set.
    template <class Shade>
    void for_each_size(const LobeViews& lobe, double tolerance, const Shade& shade) {
        sort(lobe, tolerance);
        for (std::size_t first = 0; first < order_.size();) {
            const int size = sizes_[order_[first]];
            polygons_.clear(static_cast<std::size_t>(size));
            views_.clear();
            numbers_.clear();
            for (; first < order_.size() && sizes_[order_[first]] == size; ++first) {
                const Seen& seen = seen_[order_[first]];
                corners_.clear();
                append_corners(seen, size);
                polygons_.append(corners_.data(), 1);
                views_.push_back(seen.view);
                numbers_.push_back(seen.number);
            }
            shade();
        }
    }
    PolygonBatch& polygons() { return polygons_; }
    const std::vector<std::uint32_t>& views() const { return views_; }
    const std::vector<std::uint32_t>& numbers() const { return numbers_; }

  private:
    struct Seen {
        std::optional<SphericalEllipse<double>> ellipse;
        std::size_t first, count;  // of given_, if there is no ellipse
        std::uint32_t view, number;
    };

    int size_of(const Seen& seen, const LobeViews& lobe, double tolerance) const {
        if (!seen.ellipse) {
            return (static_cast<int>(seen.count) + kDiskPolygonStep - 1) / kDiskPolygonStep * kDiskPolygonStep;
        }
        const double width = narrowest(lobe.shape(), lobe.positions().cosine()[seen.view]);
        return disk_polygon_size(*seen.ellipse, width, tolerance);
    }

    void append_corners(const Seen& seen, int size) {
        if (seen.ellipse) {
            append_disk_polygon(*seen.ellipse, size, corners_);
            return;
        }
        const auto from = given_.begin() + static_cast<std::ptrdiff_t>(seen.first);
        corners_.insert(corners_.end(), from, from + static_cast<std::ptrdiff_t>(seen.count));
        corners_.resize(static_cast<std::size_t>(size), corners_.back());
    }

    void sort(const LobeViews& lobe, double tolerance) {
        sizes_.clear();
        for (const Seen& seen : seen_) {
            sizes_.push_back(size_of(seen, lobe, tolerance));
        }
        order_.resize(seen_.size());
        std::iota(order_.begin(), order_.end(), 0U);
        std::stable_sort(order_.begin(), order_.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return sizes_[a] < sizes_[b]; });
    }

    std::vector<Seen> seen_;
    std::vector<int> sizes_;
    std::vector<std::uint32_t> order_;
    std::vector<Vec3d> given_, corners_;
    // Of the size at hand:
    PolygonBatch polygons_;
    std::vector<std::uint32_t> views_, numbers_;
};

}  // namespace shlight
