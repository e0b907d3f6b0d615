// SPDX-License-Identifier: MIT
//
// Triangle meshes, hair and clouds of spheres with materials, placed once or many times.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "shlight/bsdf.h"
#include "shlight/ray_tracer.h"
#include "shlight/surface_shader.h"
#include "shlight/types.h"

namespace shlight {

/// Numbers on a mesh that shader programs read, linear over each triangle and between points of a curve.
struct MeshAttribute {
    std::uint32_t components;   ///< 1 … 4
    std::vector<float> values;  ///< `components` for each vertex, or for each part, or for each triangle's corner
};

/// Numbers that AOVs output for an object or a material.
struct Label {
    float index = 0;
    float name = 0, asset = 0;  ///< identities, see cryptomatte_id(); 0: none
};

/// Which side of a face: the front is that from which its corners, in the mesh's frame, run counter-clockwise.
enum class FaceSide : std::uint8_t { both, front, back };

/// Emitted radiance.
struct Emission {
    Rgb front{0}, back{0};

    Emission(const Rgb& both = Rgb(0)) : front(both), back(both) {}
    Emission(const Rgb& of_front, const Rgb& of_back) : front(of_front), back(of_back) {}

    friend bool operator==(const Emission&, const Emission&) = default;
    /// Sides that emit alike are one part; otherwise each is one. The others are 0.
    Rgb part(FaceSide side) const {
        if ((front == back) != (side == FaceSide::both)) {
            return Rgb(0);
        }
        return side == FaceSide::back ? back : front;
    }
};

/// Light linking: what a light lights, and what blocks it.
struct LightLinks {
    std::uint64_t receivers = ~std::uint64_t{0};  ///< bits of the light sets that it lights
    std::uint32_t shadow_rays = kShadowRay;       ///< see shadow_rays_of()

    bool operator==(const LightLinks&) const = default;
    bool lights(std::uint32_t light_set) const { return (receivers >> light_set & 1) != 0; }
};

/// Light sets have numbers below this.
inline constexpr std::uint32_t kLightSets = 64;

/// A material as the renderer meets it.
struct Material {
    Bsdf bsdf;
    Emission emission;
    std::shared_ptr<const SurfaceShader> shader;  ///< replaces both; null: they are constant
    std::vector<std::uint32_t> attributes;        ///< see MeshShader
    std::uint32_t group = 0;                      ///< light group of its emission, see LightTraits::group
    std::vector<std::uint32_t> aovs;              ///< see MeshShader
    Label label;
    std::uint32_t light_set = 0;  ///< see MeshUse
    LightLinks links;             ///< of its emission
};

/// A shader program bound to the attributes of a mesh.
struct MeshShader {
    std::shared_ptr<const SurfaceShader> shader;  ///< null: the material's Bsdf and emission
    /// For each attribute of the program its index among the mesh's attributes, or kNoAttribute.
    std::vector<std::uint32_t> attributes;
    /// RenderPass::number for each AOV of the program.
    std::vector<std::uint32_t> aovs;

    static constexpr std::uint32_t kNoAttribute = 0xFFFFFFFFU;
};

/// Triangles with normals, or curves or spheres, with attributes. Its parts are triangles, curves or spheres.
struct MeshShape {
    std::vector<Vec3f> vertices;      ///< of triangles, or points of curves, or middles of spheres
    std::vector<Triangle> triangles;  ///< vertex indices
    SurfaceForm form = SurfaceForm::triangles;
    std::vector<float> radii;          ///< of curves and spheres: one per vertex
    std::vector<std::uint32_t> first;  ///< of curves: the first vertex of each, which has two or more
    std::uint32_t subdivisions = 5;    ///< see RoundParts
    /// Shading normals of any length in the mesh's frame: one per vertex, three per triangle, or none (flat).
    std::vector<Vec3f> vertex_normals, corner_normals;
    std::vector<MeshAttribute> attributes;
    std::uint32_t uv = MeshShader::kNoAttribute;  ///< the attribute that is Pass::uv
    std::vector<std::uint32_t> material_indices;  ///< one per part, or none (all 0)

    bool is_curved() const { return form == SurfaceForm::ribbons || form == SurfaceForm::tubes; }
    std::size_t part_count() const {
        return form == SurfaceForm::triangles ? triangles.size() : is_curved() ? first.size() : vertices.size();
    }
    /// The part of RayHit::triangle.
    std::size_t part(std::uint32_t number) const {
        return is_curved() ? static_cast<std::size_t>(std::ranges::upper_bound(first, number) - first.begin()) - 1
                           : number;
    }
    /// The vertex behind the last one of a curve.
    std::size_t curve_end(std::size_t curve) const {
        return curve + 1 < first.size() ? first[curve + 1] : vertices.size();
    }
    std::uint32_t material_index(std::size_t part) const {
        return material_indices.empty() ? 0 : material_indices[part];
    }
};

/// Two numbers, 0 … 1, keep flat triangles from showing at the edge of a smooth surface's own shadow, as in Cycles; at
/// 0 they do nothing. See Terminator.
struct TerminatorOffsets {
    double geometry = 0;  ///< cosine of the light below which shadow rays start on the smooth surface
    double shading = 0;   ///< how much earlier the light ends
};

/// The materials and the instances of a shape. Surfaces are two-sided: triangles are turned to the viewer, and with
/// them their normals. Curves and spheres are seen to shine where they emit, and light nothing but by bounces.
struct MeshUse {
    std::vector<Bsdf> bsdfs = {Bsdf()};         ///< one per material, or one for all
    std::vector<Emission> emission = {Rgb(0)};  ///< one per material, or one for all
    /// One per material, or none. The camera sees the emission of shaders; lights are made from `emission`.
    std::vector<MeshShader> shaders;
    std::vector<glm::dmat4> transforms = {glm::dmat4(1)};  ///< object to world, one per instance
    std::vector<std::vector<float>> object_values;         ///< one list per instance, or none: see ShaderSource
    TerminatorOffsets terminator;
    /// Normals on the other side of their triangle than the viewer are turned once more. Otherwise they stay there, and
    /// what lights them is on that side, as in Cycles.
    bool turns_normals = true;
    std::uint32_t seen_by = kAllRays;    ///< the RayKind of rays that meet it, a shadow set by its shadow rays; its
                                         ///< emission lights lobes alike
    bool is_holdout = false;             ///< the camera sees nothing there, and through it as far as it is transparent
    std::uint32_t group = 0;             ///< light group of its emission, see LightTraits::group
    std::uint32_t light_set = 0;         ///< lights with it among LightLinks::receivers light this
    LightLinks links;                    ///< of its emission
    std::vector<Label> object_labels;    ///< one per instance, or none
    std::vector<Label> material_labels;  ///< one per material, or none

    std::size_t material_count() const { return std::max({bsdfs.size(), emission.size(), shaders.size()}); }
    const Bsdf& bsdf(std::size_t material) const { return bsdfs[bsdfs.size() == 1 ? 0 : material]; }
    const Emission& emitted(std::size_t material) const { return emission[emission.size() == 1 ? 0 : material]; }
    Material material(std::size_t index) const {
        const MeshShader shader = shaders.empty() ? MeshShader() : shaders[index];
        return {bsdf(index),
                emitted(index),
                shader.shader,
                shader.attributes,
                group,
                shader.aovs,
                index < material_labels.size() ? material_labels[index] : Label(),
                light_set,
                links};
    }
};

struct Mesh : MeshShape, MeshUse {};

/// A mesh of a scene. Its shape may be shared with other meshes, also of earlier scenes.
struct SceneMesh : MeshUse {
    std::shared_ptr<const MeshShape> shape;
};

/// Throws std::invalid_argument naming the member that is wrong: sizes that do not fit, an index out of range,
/// a number outside docs/conventions.md's range.
void check_shape(const MeshShape& shape);
/// check_shape() for the use of a shape; a transform must be affine and invertible.
void check_use(const MeshShape& shape, const MeshUse& use);

/// Throws std::invalid_argument naming the argument unless the matrix is affine and invertible.
void check_place(const char* name, const glm::dmat4& to_world);

struct Box {
    Vec3d least{std::numeric_limits<double>::infinity()}, largest{-std::numeric_limits<double>::infinity()};

    void add(const Vec3d& point) {
        least = glm::min(least, point);
        largest = glm::max(largest, point);
    }
    bool empty() const { return !(least.x <= largest.x); }
    /// The largest coordinate in it; 0 if it is empty.
    double reach() const {
        const Vec3d far = glm::max(-least, largest);
        return std::max({0.0, far.x, far.y, far.z});
    }
};

/// A box around all instances, in the world.
Box bounds(const MeshShape& shape, const MeshUse& use);

}  // namespace shlight
