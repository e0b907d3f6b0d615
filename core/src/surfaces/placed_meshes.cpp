// SPDX-License-Identifier: MIT
#include "surfaces/placed_meshes.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/ray_rounding.h"
#include "base/scene_range.h"
#include "base/transforms.h"
#include "surfaces/round_places.h"

namespace shlight {
namespace {

bool stretches(const glm::dmat3& linear) {
    constexpr double kRounding = 1e-6;
    const glm::dmat3 squares = glm::transpose(linear) * linear;
    const double square = squares[0][0];
    return inf_norm(squares - square * glm::dmat3(1)) > kRounding * square;
}

Placement place(std::uint32_t mesh, std::uint32_t number, std::uint32_t first_material, const glm::dmat4& to_world,
                bool baked) {
    const glm::dmat3 linear(to_world);
    return {mesh,
            number,
            first_material,
            baked,
            baked && stretches(linear),
            glm::determinant(linear) < 0,
            to_world,
            glm::inverse(to_world),
            baked ? 1.0 : inf_norm(linear) * inf_norm(glm::inverse(linear)),
            baked ? 0.0 : largest_component(Vec3d(to_world[3]))};
}

/// Component of an attribute as RGBA; 1 where it is not given.
constexpr int kAlpha = 3;

glm::dmat3 normals_to_world(const Placement& placement) {
    return glm::transpose(glm::dmat3(placement.to_object));
}

std::array<double, 3> weights_of(const RayHit& hit) {
    return {1.0 - hit.u - hit.v, hit.u, hit.v};
}

/// The normal between those of a triangle's corners, of any length.
Vec3d between(std::array<Vec3d, 3> normals, const std::array<double, 3>& weights, const Placement& placement) {
    const glm::dmat3 to_world = normals_to_world(placement);
    if (!placement.stretched) {
        return to_world * weighted(normals, weights);
    }
    for (Vec3d& own : normals) {
        own = glm::length(own) * normalized_or(to_world * own, Vec3d(0));
    }
    return weighted(normals, weights);
}

/// Numbers of matrices are counted row by row; the last column holds the translation.
constexpr int kTranslation = 3;

}  // namespace

void PlacedMeshes::add(std::shared_ptr<const CompiledMesh> mesh, std::uint32_t first_material) {
    const auto index = static_cast<std::uint32_t>(meshes_.size());
    std::uint32_t number = 0;
    for (const glm::dmat4& to_world : mesh->mesh->transforms) {
        placements_.push_back(place(index, number++, first_material, to_world, mesh->is_baked()));
    }
    meshes_.push_back(std::move(mesh));
}

std::array<Vec3d, 3> PlacedMeshes::corners(const RayHit& hit) const {
    const Placement& placement = placements_[hit.instance];
    const CompiledMesh& mesh = *meshes_[placement.mesh];
    const std::span<const Vec3f> vertices = mesh.vertices();
    const Triangle& triangle = mesh.mesh->shape->triangles[hit.triangle];
    std::array<Vec3d, 3> result = {Vec3d(vertices[triangle.x]), Vec3d(vertices[triangle.y]),
                                   Vec3d(vertices[triangle.z])};
    if (!placement.baked) {
        for (Vec3d& own : result) {
            own = transform_point(placement.to_world, own);
        }
    }
    return result;
}

double PlacedMeshes::height(const RayHit& hit, std::size_t corner) const {
    if (!is_triangle(hit)) {
        return 0;
    }
    const std::array<Vec3d, 3> at = corners(hit);
    const Vec3d edge = at[(corner + 2) % 3] - at[(corner + 1) % 3];
    return glm::length(glm::cross(glm::normalize(edge), at[corner] - at[(corner + 1) % 3]));
}

std::optional<std::array<Vec3d, 3>> PlacedMeshes::corner_normals(const RayHit& hit) const {
    const MeshShape& mesh = *mesh_of(placements_[hit.instance]).shape;
    if (mesh.vertex_normals.empty() && mesh.corner_normals.empty()) {
        return std::nullopt;
    }
    const Triangle& triangle = mesh.triangles[hit.triangle];
    std::array<Vec3d, 3> normals;
    for (int i = 0; i < 3; ++i) {
        const auto corner = static_cast<std::size_t>(i);
        normals[corner] =
            Vec3d(mesh.corner_normals.empty() ? mesh.vertex_normals[triangle[i]]
                                              : mesh.corner_normals[3 * std::size_t{hit.triangle} + corner]);
    }
    return normals;
}

Terminator PlacedMeshes::terminator(const RayHit& hit, const SurfacePoint& point) const {
    const TerminatorOffsets& offsets = mesh_of(placements_[hit.instance]).terminator;
    Terminator result;
    result.frequency = 1 / (1 - offsets.shading / 2);
    std::optional<std::array<Vec3d, 3>> normals;
    if (!(offsets.geometry > 0) || !(normals = corner_normals(hit))) {
        return result;
    }
    const std::array<double, 3> weights = weights_of(hit);
    const glm::dmat3 to_world = normals_to_world(placements_[hit.instance]);
    for (Vec3d& own : *normals) {
        own = normalized_or(to_world * own, point.shading_normal);
    }
    if (glm::dot(weighted(*normals, weights), point.geometric_normal) < 0) {
        for (Vec3d& own : *normals) {
            own = -own;
        }
    }
    result.lift = lift_to_smooth_surface(corners(hit), *normals, weights);
    if (largest_component(result.lift) > point.error) {
        result.smooth = point.shading_normal;
        result.geometric = point.geometric_normal;
        result.cutoff = offsets.geometry;
    }
    return result;
}

SurfacePoint PlacedMeshes::surface(const RayHit& hit, const Vec3f& direction) const {
    assert(!hit.missed());
    const Placement& placement = placements_[hit.instance];
    if (!is_triangle(hit)) {
        return round_surface(hit, direction);
    }
    const std::array<double, 3> weights = weights_of(hit);
    const std::array<Vec3d, 3> corners = this->corners(hit);
    const Vec3d position = weighted(corners, weights);
    // The corners in double give a point in the triangle's plane to double precision, which the ray would not.
    const Vec3d towards_viewer = -Vec3d(direction);
    Vec3d geometric =
        normalized_or(glm::cross(corners[1] - corners[0], corners[2] - corners[0]), glm::normalize(towards_viewer));
    const bool clockwise = glm::dot(geometric, towards_viewer) < 0;
    if (clockwise) {
        geometric = -geometric;
    }
    Vec3d shading = geometric;
    if (const auto normals = corner_normals(hit)) {
        shading = normalized_or(between(*normals, weights, placement), geometric);
        const bool turned =
            mesh_of(placement).turns_normals ? glm::dot(shading, geometric) < 0 : clockwise != placement.mirrored;
        if (turned) {
            shading = -shading;
        }
    }
    double extent = 0;
    for (const Vec3d& own : corners) {
        extent = std::max(extent, largest_component(own - position));
    }
    const double scale = placement.condition * (largest_component(position) + placement.origin) + extent;
    return {position, geometric, shading, kRayRounding * scale,
            placement.first_material + mesh_of(placement).shape->material_index(hit.triangle)};
}

/// A ribbon is lit where it is met, but rays leave it from the tube that it stands for, which those that go to the side
/// of the normal do not meet again, however the ribbon turns to them.
SurfacePoint PlacedMeshes::round_surface(const RayHit& hit, const Vec3f& direction) const {
    const Placement& placement = placements_[hit.instance];
    const CompiledMesh& mesh = *meshes_[placement.mesh];
    const MeshShape& shape = *mesh.mesh->shape;
    const glm::dmat4 to_world = placement.baked ? glm::dmat4(1) : placement.to_world;
    const glm::dmat4 to_object = placement.baked ? glm::dmat4(1) : placement.to_object;
    const RoundPlace middle = round_place(shape, mesh.vertices(), mesh.radius_scale, hit);
    const OutwardNormal own = outward_normal(middle, hit, transform_vector(to_object, Vec3d(direction)));
    const Vec3d outwards = transform_vector(to_world, middle.radius * own.normal);
    const Vec3d lift = transform_vector(to_world, middle.radius * own.lift);
    const Vec3d position = transform_point(to_world, middle.position) + outwards - lift;
    // The normal of a sphere that is scaled unevenly points away from its centre, as in Cycles.
    const bool is_sphere = shape.form == SurfaceForm::spheres;
    const Vec3d across = is_sphere ? outwards : glm::transpose(glm::dmat3(to_object)) * own.normal;
    const Vec3d normal = normalized_or(across, -glm::normalize(Vec3d(direction)));
    const double scale = placement.condition * (largest_component(position) + placement.origin);
    const double radius = glm::length(outwards);
    const std::uint32_t material = placement.first_material + shape.material_index(shape.part(hit.triangle));
    return {position, normal, normal, kRayRounding * scale + kRoundRounding * radius, material, lift, 2 * radius};
}

SurfacePlace PlacedMeshes::neighbour(const SurfacePlace& place, const Vec3d& normal, double length,
                                     const Ray& ray) const {
    const Vec3d direction = glm::normalize(Vec3d(ray.direction));
    const Vec3d origin(ray.origin);
    const double approach = glm::dot(direction, normal);
    const double away = glm::dot(place.position - origin, normal);
    // A ray that meets the plane far away, or behind itself, is taken to meet it not so far.
    const double most = 2 * length;
    const double t = away * approach > 0 && away / approach < most ? away / approach : most;
    SurfacePlace result = beside(place, origin + t * direction - place.position);
    result.towards_viewer = -direction;
    return result;
}

SurfacePlace PlacedMeshes::beside(const SurfacePlace& place, const Vec3d& step) const {
    SurfacePlace result = {place.hit, place.position + step, place.towards_viewer};
    if (mesh_of(placements_[place.hit.instance]).shape->form != SurfaceForm::triangles) {
        return result;
    }
    const std::array<Vec3d, 3> corners = this->corners(place.hit);
    const Vec3d u = corners[1] - corners[0];
    const Vec3d v = corners[2] - corners[0];
    const double uu = glm::dot(u, u);
    const double uv = glm::dot(u, v);
    const double vv = glm::dot(v, v);
    const double determinant = uu * vv - uv * uv;
    if (determinant > 0) {
        const double su = glm::dot(step, u);
        const double sv = glm::dot(step, v);
        result.hit.u += static_cast<float>((vv * su - uv * sv) / determinant);
        result.hit.v += static_cast<float>((uu * sv - uv * su) / determinant);
    }
    return result;
}

float PlacedMeshes::attribute(const MeshAttribute& attribute, std::uint32_t component, const RayHit& hit) const {
    if (component == kAttributeMean) {
        const auto at = [&](std::uint32_t i) { return this->attribute(attribute, i, hit); };
        return attribute.components == 1 ? at(0) : (at(0) + at(1) + at(2)) * (1 / 3.0F);
    }
    const MeshShape& mesh = *mesh_of(placements_[hit.instance]).shape;
    const std::size_t size = attribute.values.size();
    const std::uint32_t own = attribute.components == 1 && component < 3 ? 0 : component;
    const auto value = [&](std::size_t index) { return attribute.values[index * attribute.components + own]; };
    if (own >= attribute.components || size == 0) {
        return component == kAlpha ? 1.0F : 0.0F;
    }
    const std::size_t triangle = hit.triangle;
    if (mesh.form != SurfaceForm::triangles) {
        const bool is_of_points = size == mesh.vertices.size() * attribute.components;
        return !is_of_points      ? value(mesh.part(hit.triangle))
               : mesh.is_curved() ? (1 - hit.u) * value(triangle) + hit.u * value(triangle + 1)
                                  : value(triangle);
    }
    const Triangle& vertices = mesh.triangles[triangle];
    const std::array<double, 3> weights = weights_of(hit);
    double sum = 0;
    if (size == 3 * mesh.triangles.size() * attribute.components) {
        for (std::size_t i = 0; i < 3; ++i) {
            sum += weights[i] * value(3 * triangle + i);
        }
    } else if (size == mesh.vertices.size() * attribute.components) {
        for (int i = 0; i < 3; ++i) {
            sum += weights[static_cast<std::size_t>(i)] * value(vertices[i]);
        }
    } else {
        sum = value(triangle);
    }
    return static_cast<float>(sum);
}

Vec3d PlacedMeshes::uv(const RayHit& hit) const {
    const MeshShape& mesh = *mesh_of(placements_[hit.instance]).shape;
    if (mesh.uv == MeshShader::kNoAttribute) {
        return Vec3d(0);
    }
    const MeshAttribute& own = mesh.attributes[mesh.uv];
    return {attribute(own, 0, hit), attribute(own, 1, hit), 1};
}

Vec3d PlacedMeshes::growth_of_u(const RayHit& hit) const {
    const Placement& placement = placements_[hit.instance];
    const CompiledMesh& mesh = *meshes_[placement.mesh];
    if (mesh.mesh->shape->form != SurfaceForm::triangles) {
        const Vec3d along = round_place(*mesh.mesh->shape, mesh.vertices(), mesh.radius_scale, hit).along;
        return placement.baked ? along : transform_vector(placement.to_world, along);
    }
    if (mesh_of(placements_[hit.instance]).shape->uv == MeshShader::kNoAttribute) {
        return Vec3d(0);
    }
    const auto uv_at = [&](float u, float v) {
        RayHit corner = hit;
        corner.u = u;
        corner.v = v;
        return uv(corner);
    };
    const std::array<Vec3d, 3> corners = this->corners(hit);
    const Vec3d first = uv_at(0, 0);
    const Vec3d along = uv_at(1, 0) - first;
    const Vec3d beside = uv_at(0, 1) - first;
    const double area = along.x * beside.y - beside.x * along.y;
    const Vec3d growth = beside.y * (corners[1] - corners[0]) - along.y * (corners[2] - corners[0]);
    return area < 0 ? -growth : area > 0 ? growth : Vec3d(0);
}

Vec3d PlacedMeshes::around_axis(const RayHit& hit, const Vec3d& position) const {
    const Placement& placement = placements_[hit.instance];
    const Vec3d own = transform_point(placement.to_object, position);
    return transform_vector(placement.to_world, {-own.y, own.x, 0});
}

double PlacedMeshes::azimuth(const RayHit& hit, const ShadingFrame& frame) const {
    // If neither of them says it, x is the tangent.
    for (const Vec3d& tangent : {growth_of_u(hit), around_axis(hit, frame.origin)}) {
        const double x = glm::dot(tangent, frame.x);
        const double y = glm::dot(tangent, frame.y);
        if (std::isfinite(x) && std::isfinite(y) && (x != 0 || y != 0)) {
            const double turn = std::atan2(y, x);
            return turn > 0 ? 2 * std::numbers::pi - turn : -turn;
        }
    }
    return 0;
}

const Label& PlacedMeshes::label(const RayHit& hit) const {
    static constexpr Label kNoLabel;
    const Placement& placement = placements_[hit.instance];
    const std::vector<Label>& labels = mesh_of(placement).object_labels;
    return labels.empty() ? kNoLabel : labels[placement.number];
}

const Rgb& PlacedMeshes::emission(const Material& material, const RayHit& hit, const Vec3d& towards_viewer) const {
    const Emission& both = material.emission;
    return both.front != both.back && is_back(hit, towards_viewer) ? both.back : both.front;
}

Vec3d PlacedMeshes::normal_at(const ShadedPlace& shaded, const SurfacePlace& at, bool smooth) const {
    if (&at == &shaded.at) {
        return smooth ? shaded.shading_normal : shaded.geometric_normal;
    }
    const SurfacePoint point = surface(at.hit, Vec3f(-shaded.at.towards_viewer));
    return smooth ? point.shading_normal : point.geometric_normal;
}

Vec3d PlacedMeshes::mesh_normal(const RayHit& hit, const Vec3d& normal) const {
    const glm::dmat3 to_world = normals_to_world(placements_[hit.instance]);
    const auto normals = corner_normals(hit);
    const Vec3d own = normals ? weighted(*normals, weights_of(hit)) : Vec3d(0);
    if (own == Vec3d(0)) {
        return normalized_or(glm::inverse(to_world) * normal, normal);
    }
    return glm::dot(to_world * own, normal) < 0 ? -own : own;
}

float PlacedMeshes::object_value(const Placement& placement, std::uint32_t index) const {
    const std::vector<std::vector<float>>& values = mesh_of(placement).object_values;
    const bool known = placement.number < values.size() && index < values[placement.number].size();
    return known ? values[placement.number][index] : 0.0F;
}

double PlacedMeshes::to_world_number(const Placement& placement, std::uint32_t component) const {
    const auto column = static_cast<int>(component % 4);
    const auto row = static_cast<int>(component / 4);
    return placement.to_world[column][row] + (column == kTranslation && row < 3 ? origin_[row] : 0.0);
}

double PlacedMeshes::to_object_number(const Placement& placement, std::uint32_t component) const {
    const auto column = static_cast<int>(component % 4);
    const auto row = static_cast<int>(component / 4);
    double number = placement.to_object[column][row];
    for (int axis = 0; axis < 3 && column == kTranslation; ++axis) {
        number -= placement.to_object[axis][row] * origin_[axis];
    }
    return number;
}

bool PlacedMeshes::is_back(const RayHit& hit, const Vec3d& towards_viewer) const {
    if (!is_triangle(hit)) {
        return false;
    }
    const std::array<Vec3d, 3> corners = this->corners(hit);
    const Vec3d normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    return (glm::dot(normal, towards_viewer) < 0) != placements_[hit.instance].mirrored;
}

/// Reads the inputs of one material's program.
class PlacedMeshes::PlaceReader : public ShaderReader {
  public:
    PlaceReader(const PlacedMeshes& placed, const Material& material, std::span<const ShadedPlace> places,
                std::span<const PlacesBeside> beside)
        : placed_(&placed), material_(&material), places_(places), beside_(beside) {}

    void read(const ShaderInput& input, int place, std::size_t first, std::span<float> out) const override {
        const auto beside = beside_.subspan(place == 0 ? 0 : first);
        placed_->read(input, *material_, static_cast<std::size_t>(place), places_.subspan(first), beside, out);
    }

  private:
    const PlacedMeshes* placed_;
    const Material* material_;
    std::span<const ShadedPlace> places_;
    std::span<const PlacesBeside> beside_;
};

void PlacedMeshes::run(const ShaderProgram& program, const Material& material, std::span<const ShadedPlace> places,
                       std::span<const PlacesBeside> beside, ShaderProgram::Registers& registers,
                       std::span<float> results) const {
    const PlaceReader reader(*this, material, places, beside);
    program.evaluate(reader, places.size(), !beside.empty(), registers, results);
}

void PlacedMeshes::read(const ShaderInput& input, const Material& material, std::size_t place,
                        std::span<const ShadedPlace> hits, std::span<const PlacesBeside> beside,
                        std::span<float> out) const {
    const auto fill = [&](const auto& number) {
        for (std::size_t i = 0; i < out.size(); ++i) {
            out[i] = static_cast<float>(number(hits[i], place == 0 ? hits[i].at : beside[i][place - 1]));
        }
    };
    const auto component = static_cast<int>(input.component);
    const auto placement = [&](const SurfacePlace& at) -> const Placement& { return placements_[at.hit.instance]; };
    switch (input.source) {
        case ShaderSource::position:
            return fill(
                [&](const auto&, const SurfacePlace& at) { return at.position[component] + origin_[component]; });
        case ShaderSource::normal:
        case ShaderSource::geometric_normal:
            return fill([&](const ShadedPlace& shaded, const SurfacePlace& at) {
                return normal_at(shaded, at, input.source == ShaderSource::normal)[component];
            });
        case ShaderSource::towards_viewer:
            return fill([&](const auto&, const SurfacePlace& at) { return at.towards_viewer[component]; });
        case ShaderSource::attribute: {
            const std::uint32_t index =
                input.index < material.attributes.size() ? material.attributes[input.index] : MeshShader::kNoAttribute;
            if (index == MeshShader::kNoAttribute) {
                std::fill(out.begin(), out.end(), component == kAlpha ? 1.0F : 0.0F);
                return;
            }
            return fill([&](const auto&, const SurfacePlace& at) {
                return attribute(mesh_of(placement(at)).shape->attributes[index], input.component, at.hit);
            });
        }
        case ShaderSource::object_to_world:
            return fill(
                [&](const auto&, const SurfacePlace& at) { return to_world_number(placement(at), input.component); });
        case ShaderSource::world_to_object:
            return fill(
                [&](const auto&, const SurfacePlace& at) { return to_object_number(placement(at), input.component); });
        case ShaderSource::object_value:
            return fill([&](const auto&, const SurfacePlace& at) { return object_value(placement(at), input.index); });
        case ShaderSource::barycentric:
            return fill([&](const auto&, const SurfacePlace& at) { return component == 0 ? at.hit.u : at.hit.v; });
        case ShaderSource::backfacing:
            return fill([&](const ShadedPlace& shaded, const SurfacePlace& at) {
                return is_back(at.hit, shaded.at.towards_viewer) ? 1 : 0;
            });
        case ShaderSource::ray_length:
            return fill([](const ShadedPlace& shaded, const auto&) { return shaded.ray_length; });
        case ShaderSource::transparent_depth:
            return fill([](const ShadedPlace& shaded, const auto&) { return shaded.transparent_depth; });
        case ShaderSource::mesh_normal:
            return fill([&](const ShadedPlace& shaded, const SurfacePlace& at) {
                return mesh_normal(at.hit, normal_at(shaded, at, true))[component];
            });
        case ShaderSource::height:
            return fill([&](const auto&, const SurfacePlace& at) { return height(at.hit, input.component); });
    }
}

}  // namespace shlight
