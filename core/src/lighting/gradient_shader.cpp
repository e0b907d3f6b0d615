// SPDX-License-Identifier: MIT
#include "shlight/gradient_shader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "base/checks.h"
#include "lighting/light_views.h"
#include "lobes/arc_sums.h"
#include "lobes/boundary_integral.h"
#include "regions/boundary.h"
#include "regions/region_checks.h"
#include "regions/spherical_polygon.h"
#include "shlight/cap.h"

namespace shlight {
namespace {

template <class T>
using In = std::span<const T>;
/// A derivative of each colour channel by a vector.
using ColorByVector = std::array<Vec3d, 3>;

/// The lobes of a material at one view.
class View {
  public:
    View(const Bsdf& bsdf, const LightViews& views, std::size_t light)
        : cosine_(views.cosine_of(light)), azimuth_(views.azimuth_of(light)) {
        for (const Lobe& lobe : bsdf.lobes()) {
            const Rgb weight = lobe.scale(static_cast<float>(cosine_));
            if (weight != Rgb(0) && !is_mirror(lobe.shape)) {
                lobes_.push_back({is_anisotropic(lobe.shape) ? with_azimuth(lobe.shape, azimuth_) : lobe.shape,
                                  {weight.x, weight.y, weight.z}});
            }
        }
    }

    bool is_of(const LightViews& views, std::size_t light) const {
        return views.cosine_of(light) == cosine_ && views.azimuth_of(light) == azimuth_;
    }

    /// Sums along an arc, at once of neighbours of one width, such as the two that make a metal's Fresnel factor.
    ArcSums sums(const Arc<double>& arc, const std::array<double, 3>& weights) const {
        return by_width<9>([&](In<WeightedLobe> lobes) { return arc_sums(lobes, cosine_, arc, weights); });
    }

    /// α = roughness², so that dα is 2√α of roughness.
    Vec3d by_roughness(In<Arc<double>> boundary) const {
        const auto sum = by_width<3>([&](In<WeightedLobe> lobes) {
            auto own = boundary_integral_by_alpha(lobes, cosine_, boundary);
            for (double& number : own) {
                number *= 2 * std::sqrt(lobe_width(lobes[0].shape));
            }
            return own;
        });
        return {sum[0], sum[1], sum[2]};
    }

  private:
    /// The sum of what function(lobes) returns for neighbours of one width.
    template <std::size_t kNumbers, class Function>
    std::array<double, kNumbers> by_width(const Function& function) const {
        std::array<double, kNumbers> sums{};
        for (auto first = lobes_.begin(); first != lobes_.end();) {
            const auto last = std::find_if(first, lobes_.end(), [&](const WeightedLobe& lobe) {
                return lobe_width(lobe.shape) != lobe_width(first->shape);
            });
            const auto own = function(In<WeightedLobe>(first, last));
            std::transform(sums.begin(), sums.end(), own.begin(), sums.begin(), std::plus<>());
            first = last;
        }
        return sums;
    }

    double cosine_, azimuth_;
    std::vector<WeightedLobe> lobes_;
};

/// The view of a light, `last` if it is the same.
const View& view_of(const Bsdf& bsdf, const LightViews& views, std::size_t light, std::optional<View>& last) {
    if (!last || !last->is_of(views, light)) {
        last.emplace(bsdf, views, light);
    }
    return *last;
}

template <class T>
T within_range(double number) {
    constexpr double kLargest = std::numeric_limits<T>::max();
    return static_cast<T>(std::clamp(number, -kLargest, kLargest));
}

template <class T>
void write(const Vec3d& from, T* to) {
    for (int k = 0; k < 3; ++k) {
        to[k] = within_range<T>(from[k]);
    }
}

/// The derivatives of a sphere's light by its centre, and by its radius. arc: of the sphere's circle, above the
/// horizon.
template <class T>
void move_sphere(const View& view, const Arc<double>& arc, double radius, T* by_center, T* by_radius) {
    const double over_distance = 1 / std::max(radius / arc.sine, std::numeric_limits<double>::min());
    const double stretch = arc.cosine > 0 ? arc.sine / arc.cosine : 0;  // of σ by r, times sinσ and the distance
    const ArcSums sums = view.sums(arc, {arc.sine, 1, 1});
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const auto [one, cosine, sine] = std::array{sums[3 * channel], sums[3 * channel + 1], sums[3 * channel + 2]};
        const Vec3d across = cosine * arc.middle + sine * glm::cross(arc.axis, arc.middle);
        write(over_distance * (arc.sine * (across - stretch * one * arc.axis)), by_center + 3 * channel);
        by_radius[channel] = within_range<T>(over_distance * (stretch * one));
    }
}

/// An edge of a polygon, the interior on its left: the great circle about `pole`, and the part above the horizon.
struct Edge {
    double sine = 0;          ///< of its length; 0: there is nothing to integrate
    Arc<double> kept{};       ///< above the horizon
    double from = 0, to = 0;  ///< angles from the edge's ends to the middle of `kept`
};

Edge edge_between(const Vec3d& a, const Vec3d& b) {
    const Vec3d cross = glm::cross(a, b - a);
    const double size = glm::length(cross);
    if (!(size > 0) || (a.z <= 0 && b.z <= 0)) {
        return {};
    }
    const Vec3d pole = cross / size;
    const Vec3d start = a / glm::length(a);
    const auto angle_to = [&](const Vec3d& v) {
        return std::atan2(glm::dot(pole, glm::cross(start, v)), glm::dot(start, v));
    };
    const double length = std::atan2(size, glm::dot(a, b));
    const Vec3d cut = a + a.z / (a.z - b.z) * (b - a);
    const double first = a.z < 0 ? angle_to(cut) : 0;
    const double last = b.z < 0 ? angle_to(cut) : length;
    const double middle = (first + last) / 2;
    const Vec3d direction = std::cos(middle) * start + std::sin(middle) * glm::cross(pole, start);
    return {size / (glm::length(a) * glm::length(b)),
            {pole, (last - first) / 2, direction, 0, 0, 1, {}},
            middle,
            length - middle};
}

/// Adds to the derivatives by an edge's ends. A point of the edge moves by δa and δb as sines of its distances from the
/// other ends tell, and outwards is away from the pole.
void add_edge(const View& view, const Vec3d& a, const Vec3d& b, ColorByVector& by_a, ColorByVector& by_b) {
    const Edge edge = edge_between(a, b);
    if (!(edge.sine > 0 && edge.kept.half > 0)) {
        return;
    }
    const ArcSums sums = view.sums(edge.kept, {0, 1, 1 / edge.kept.half});
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const auto [one, cosine, sine] = std::array{sums[3 * channel], sums[3 * channel + 1], sums[3 * channel + 2]};
        const double with_a = std::sin(edge.to) * cosine - std::cos(edge.to) * sine;
        const double with_b = std::sin(edge.from) * cosine + std::cos(edge.from) * sine;
        by_a[channel] -= with_a / (edge.sine * glm::length(a)) * edge.kept.axis;
        by_b[channel] -= with_b / (edge.sine * glm::length(b)) * edge.kept.axis;
    }
}

/// The factor by which prepare_polygons() has multiplied a polygon.
template <class T>
double scale_of(In<Vec3<T>> given, In<Vec3d> prepared) {
    for (int axis = 0; axis < 3; ++axis) {
        if (given[0][axis] != 0) {
            return prepared[0][axis] / double{given[0][axis]};
        }
    }
    return 1;
}

}  // namespace

template <class T>
void GradientShader::spheres(In<Vec3<T>> centers, In<T> radii, In<double> cos_theta_o, std::span<T> by_center,
                             std::span<T> by_radius, std::span<T> by_roughness, In<double> azimuth) const {
    const LightViews views = {cos_theta_o, azimuth};
    check_size("radii", radii.size(), centers.size());
    check_views(views, centers.size());
    check_spheres(centers, radii, std::numeric_limits<float>::epsilon());
    check_size("by_center", by_center.size(), 9 * centers.size());
    check_size("by_radius", by_radius.size(), 3 * centers.size());
    check_size("by_roughness", by_roughness.size(), by_roughness.empty() ? 0 : 3 * centers.size());
    for (auto all : {by_center, by_radius, by_roughness}) {
        std::fill(all.begin(), all.end(), T(0));
    }
    std::optional<View> last;
    for (std::size_t i = 0; i < centers.size(); ++i) {
        const CapBoundary boundary(cap_of_sphere(Vec3d(centers[i]), radii[i]));
        if (boundary.arcs().empty()) {
            continue;
        }
        const View& view = view_of(bsdf_, views, i, last);
        move_sphere(view, boundary.arcs()[0], radii[i], &by_center[9 * i], &by_radius[3 * i]);
        if (!by_roughness.empty()) {
            write(view.by_roughness(boundary.arcs()), &by_roughness[3 * i]);
        }
    }
}

template <class T>
void GradientShader::polygons(In<Vec3<T>> vertices, int vertex_count, In<double> cos_theta_o, std::span<T> by_vertices,
                              std::span<T> by_roughness, In<double> azimuth) const {
    check_vertex_count(vertex_count);
    const auto k = static_cast<std::size_t>(vertex_count);
    const std::size_t count = vertices.size() / k;
    const LightViews views = {cos_theta_o, azimuth};
    check_size("vertices", vertices.size(), count * k);
    check_views(views, count);
    check_size("by_vertices", by_vertices.size(), 9 * vertices.size());
    check_size("by_roughness", by_roughness.size(), by_roughness.empty() ? 0 : 3 * count);
    std::vector<Vec3d> prepared(vertices.begin(), vertices.end());
    prepare_polygons<T>(prepared, vertex_count);
    std::vector<ColorByVector> by_vertex(k);
    std::optional<View> last;
    for (std::size_t i = 0; i < count; ++i) {
        const In<Vec3d> v = std::span(prepared).subspan(i * k, k);
        const double side = plane_side(v);
        const View& view = view_of(bsdf_, views, i, last);
        std::fill(by_vertex.begin(), by_vertex.end(), ColorByVector{});
        for (std::size_t a = 0; a < k && side != 0; ++a) {
            const std::size_t b = a + 1 < k ? a + 1 : 0;
            side > 0 ? add_edge(view, v[a], v[b], by_vertex[a], by_vertex[b])
                     : add_edge(view, v[b], v[a], by_vertex[b], by_vertex[a]);
        }
        const double scale = scale_of(vertices.subspan(i * k, k), v);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            for (std::size_t a = 0; a < k; ++a) {
                write(scale * by_vertex[a][channel], &by_vertices[((3 * i + channel) * k + a) * 3]);
            }
        }
        if (!by_roughness.empty()) {
            write(view.by_roughness(polygon_boundary(SphericalPolygon(v, true))), &by_roughness[3 * i]);
        }
    }
}

template void GradientShader::spheres(In<Vec3f>, In<float>, In<double>, std::span<float>, std::span<float>,
                                      std::span<float>, In<double>) const;
template void GradientShader::spheres(In<Vec3d>, In<double>, In<double>, std::span<double>, std::span<double>,
                                      std::span<double>, In<double>) const;
template void GradientShader::polygons(In<Vec3f>, int, In<double>, std::span<float>, std::span<float>,
                                       In<double>) const;
template void GradientShader::polygons(In<Vec3d>, int, In<double>, std::span<double>, std::span<double>,
                                       In<double>) const;

}  // namespace shlight
