// SPDX-License-Identifier: MIT
#include "queries/unshadowed_coefficients.h"

#include <numbers>
#include <variant>

#include "regions/polygon_kernels.h"
#include "shlight/disk.h"

namespace shlight {

bool UnshadowedCoefficients::knows(const Light& light) {
    const auto* mesh = std::get_if<MeshLight>(&light);
    return !is_delta(light) && std::holds_alternative<EvenProfile>(traits_of(light).profile) &&
           (mesh == nullptr || mesh->faces == nullptr);
}

void UnshadowedCoefficients::look(const Light& light, const ShadingFrame& frame, double error, std::uint32_t row) {
    if (const auto* mesh = std::get_if<MeshLight>(&light)) {
        look_at(*mesh, frame, row);
    } else if (!seen_.look(light, frame, error)) {
        return;
    } else if (seen_.cap()) {
        caps_.push_back(circle_of(*seen_.cap()));
        cap_rows_.push_back(row);
    } else if (seen_.corners().empty()) {
        centers_.push_back(seen_.ellipse().center);
        half_axes_u_.push_back(seen_.ellipse().half_axis_u);
        half_axes_v_.push_back(seen_.ellipse().half_axis_v);
        disk_rows_.push_back(row);
    } else {
        add_polygon(seen_.corners(), row);
    }
}

void UnshadowedCoefficients::look_at(const MeshLight& light, const ShadingFrame& frame, std::uint32_t row) {
    switch (mesh_view_.look(*light.shape, frame, 0)) {
        case MeshView::Kind::hidden:
            break;
        case MeshView::Kind::outline:
            corners_.clear();
            for (const FlatOutline::Vertex& v : mesh_view_.outline().line(0)) {
                corners_.push_back(mesh_view_.outline().direction(v.at));
            }
            add_polygon(corners_, row);
            break;
        case MeshView::Kind::faces:
            for (std::size_t i = 0; i + 2 < mesh_view_.faces().size(); i += 3) {
                add_polygon(mesh_view_.faces().subspan(i, 3), row);
            }
            break;
        case MeshView::Kind::inside:
            add_hemisphere(row);
            break;
    }
}

void UnshadowedCoefficients::add_hemisphere(std::uint32_t row) {
    caps_.push_back(cap_about_axis({0, 0, 1}, std::numbers::pi / 2));
    cap_rows_.push_back(row);
}

void UnshadowedCoefficients::add_polygon(std::span<const Vec3d> corners, std::uint32_t row) {
    Polygons& alike = polygons_[corners.size()];
    alike.corners.insert(alike.corners.end(), corners.begin(), corners.end());
    alike.rows.push_back(row);
}

void UnshadowedCoefficients::move_to(int order, std::span<double> rows) {
    const auto width = static_cast<std::size_t>(coefficient_count(order));
    values_.resize(caps_.size() * width);
    cap_coefficients<double>(caps_, order, true, values_);
    add_values(cap_rows_, width, rows);
    for (auto& [count, own] : polygons_) {
        values_.resize(own.rows.size() * width);
        polygon_rows(own.corners, static_cast<int>(count), order, true, values_.data());
        add_values(own.rows, width, rows);
        own.corners.clear();
        own.rows.clear();
    }
    values_.resize(disk_rows_.size() * width);
    disk_coefficients<double>(centers_, half_axes_u_, half_axes_v_, order, true, values_);
    add_values(disk_rows_, width, rows);
    for (std::vector<Vec3d>* vectors : {&centers_, &half_axes_u_, &half_axes_v_}) {
        vectors->clear();
    }
    caps_.clear();
    cap_rows_.clear();
    disk_rows_.clear();
}

void UnshadowedCoefficients::add_values(std::span<const std::uint32_t> numbers, std::size_t width,
                                        std::span<double> rows) const {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        for (std::size_t k = 0; k < width; ++k) {
            rows[numbers[i] * width + k] += values_[i * width + k];
        }
    }
}

}  // namespace shlight
