// SPDX-License-Identifier: MIT
#include "surfaces/mesh_emission.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

#include "base/transforms.h"
#include "emitters/emitter_levels.h"
#include "emitters/face_tree.h"
#include "shlight/mesh_light.h"

namespace shlight {
namespace {

/// Corners of the flat parts of an emissive mesh that are lights of their own; one with more is one light.
constexpr std::size_t kMostCorners = 64;
/// Faces of the coarsest level of detail: with fewer, outlines lose their shape.
constexpr std::size_t kLeastLevelFaces = 64;

std::vector<Triangle> turned(std::span<const Triangle> triangles) {
    std::vector<Triangle> result(triangles.begin(), triangles.end());
    for (Triangle& t : result) {
        std::swap(t.y, t.z);
    }
    return result;
}

LightTraits traits_of(const SceneMesh& mesh) {
    LightTraits traits;
    traits.group = mesh.group;
    traits.lights_diffuse = (mesh.seen_by & kDiffuseRay) != 0;
    traits.lights_glossy = (mesh.seen_by & kGlossyRay) != 0;
    traits.is_surface = true;
    traits.links = mesh.links;
    traits.links.shadow_rays |= mesh.seen_by & kShadowRay;  // they find the light's own faces
    return traits;
}

bool is_one_sided(const EmissiveFaces& faces) {
    return faces.mesh.side != FaceSide::both;
}

/// The flat parts of the faces as lights; none if they have too many corners or overlap.
std::vector<Light> flat_parts(const EmissiveFaces& faces) {
    std::vector<Light> parts;
    std::size_t corners = kMostCorners;
    std::vector<Rgb> left = faces.radiance;
    while (!left.empty()) {
        const Rgb color = left.front();
        std::vector<Triangle> alike;
        for (std::size_t i = 0; i < faces.triangles.size(); ++i) {
            if (faces.radiance[i] == color) {
                alike.push_back(faces.triangles[i]);
            }
        }
        auto outlines = merge_faces(faces.vertices, alike, corners);
        if (!outlines) {
            return {};
        }
        for (FaceOutline& outline : *outlines) {
            corners -= outline.size();
            try {
                parts.emplace_back(make_polygon_light(std::move(outline), color, !is_one_sided(faces), faces.traits));
            } catch (const std::invalid_argument&) {
                return {};  // the boundary crosses itself
            }
        }
        std::erase(left, color);
    }
    return parts;
}

/// The faces of a mesh that shine to a side, with the vertices that they use, in the frame in which rays meet them.
struct SidePart {
    SidePart(const CompiledMesh& compiled, FaceSide side) {
        const SceneMesh& mesh = *compiled.mesh;
        std::vector<std::uint32_t> number;  // most meshes do not shine
        for (std::size_t i = 0; i < mesh.shape->triangles.size(); ++i) {
            const Rgb emitted = mesh.emitted(mesh.shape->material_index(i)).part(side);
            if (emitted == Rgb(0)) {
                continue;
            }
            number.resize(compiled.vertices().size(), kUnused);
            Triangle triangle = mesh.shape->triangles[i];
            for (int corner = 0; corner < 3; ++corner) {
                std::uint32_t& own = number[triangle[corner]];
                if (own == kUnused) {
                    own = static_cast<std::uint32_t>(vertices.size());
                    vertices.emplace_back(compiled.vertices()[triangle[corner]]);
                }
                triangle[corner] = own;
            }
            triangles.push_back(triangle);
            radiance.push_back(emitted);
        }
    }

    static constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
    std::vector<Vec3d> vertices;
    std::vector<Triangle> triangles;
    std::vector<Rgb> radiance;
};

/// Faces of joined lights, at most, of some 600 bytes each: those of further meshes stay apart.
constexpr std::size_t kMostJoinedFaces = 1 << 19;
/// Radius of a closed surface ÷ that of all emissive faces, above which it is a light of its own: from within it, the
/// far sides of others would count as its inner side does.
constexpr double kSurrounding = 0.5;

double radius_of(std::span<const EmissiveFaces> faces) {
    Vec3d low = faces.front().vertices.front();
    Vec3d high = low;
    for (const EmissiveFaces& own : faces) {
        for (const Vec3d& vertex : own.vertices) {
            low = glm::min(low, vertex);
            high = glm::max(high, vertex);
        }
    }
    return 0.5 * glm::length(high - low);
}

/// Faces that are summed up alike.
struct JoinedFaces {
    LightTraits traits;
    bool closed, one_sided;
    std::vector<Vec3d> vertices;
    std::vector<Triangle> triangles;
    std::vector<Rgb> radiance;
    std::vector<EmissiveMesh> meshes;
    double area = 0;

    bool takes(const EmissiveFaces& faces, const EmitterLevels& surface) const {
        return traits == faces.traits && closed == surface.closed && one_sided == surface.one_sided;
    }

    void add(const EmissiveFaces& faces, const EmitterLevels& surface) {
        const auto first = static_cast<std::uint32_t>(vertices.size());
        vertices.insert(vertices.end(), faces.vertices.begin(), faces.vertices.end());
        for (const Triangle& t : surface.turned ? turned(faces.triangles) : faces.triangles) {
            triangles.push_back(t + first);
        }
        radiance.insert(radiance.end(), faces.radiance.begin(), faces.radiance.end());
        meshes.push_back(faces.mesh);
        area += surface.area;
    }

    MeshLight light(const Stopped& stopped) {
        auto tree = std::make_shared<const FaceTree>(vertices, triangles, radiance, closed, one_sided, stopped);
        const EmitterLevels shape = {{}, one_sided, false, closed, false, tree->center(), tree->radius(), area};
        std::ranges::stable_sort(meshes, {}, &EmissiveMesh::instance);
        return {std::make_shared<const EmitterLevels>(shape), tree->mean(), tree, meshes, traits};
    }
};

}  // namespace

void visit_emissive_faces(const CompiledMesh& compiled, std::uint32_t first,
                          const std::function<void(EmissiveFaces&&)>& visit) {
    const SceneMesh& mesh = *compiled.mesh;
    for (const FaceSide side : {FaceSide::both, FaceSide::front, FaceSide::back}) {
        const SidePart part(compiled, side);
        for (std::uint32_t k = 0; k < mesh.transforms.size() && !part.triangles.empty(); ++k) {
            std::vector<Vec3d> vertices;
            for (const Vec3d& v : part.vertices) {
                vertices.push_back(compiled.is_baked() ? v : transform_point(mesh.transforms[k], v));
            }
            const glm::dmat3 linear(mesh.transforms[k]);
            const bool runs_clockwise = (side == FaceSide::back) != (glm::determinant(linear) < 0);
            visit({std::move(vertices),
                   runs_clockwise && side != FaceSide::both ? turned(part.triangles) : part.triangles,
                   part.radiance,
                   {first + k, compiled.mesh, side, glm::inverse(linear)},
                   traits_of(mesh)});
        }
    }
}

void add_lights(const EmissiveFaces& faces, const Stopped& stopped, std::vector<Light>& lights) {
    if (const std::vector<Light> parts = flat_parts(faces); !parts.empty()) {
        lights.insert(lights.end(), parts.begin(), parts.end());
        return;
    }
    EmitterLevels levels =
        make_emitter_levels(faces.vertices, faces.triangles, kLeastLevelFaces, stopped, is_one_sided(faces));
    if (!(levels.area > 0)) {
        return;
    }
    MeshLight light = {nullptr, faces.radiance.front(), nullptr, {faces.mesh}, faces.traits};
    const bool is_even = std::ranges::all_of(faces.radiance, [&](const Rgb& color) { return color == light.radiance; });
    if (!is_even || !levels.convex) {
        light.faces =
            std::make_shared<const FaceTree>(faces.vertices, levels.turned ? turned(faces.triangles) : faces.triangles,
                                             faces.radiance, levels.closed, levels.one_sided, stopped);
        light.radiance = light.faces->mean();
    }
    light.shape = std::make_shared<const EmitterLevels>(std::move(levels));
    lights.emplace_back(std::move(light));
}

JoinedLights joined_lights(std::vector<PlacedEmitter> emitters, const Stopped& stopped) {
    std::vector<EmissiveFaces> faces;
    for (const PlacedEmitter& emitter : emitters) {
        visit_emissive_faces(*emitter.mesh, emitter.first_instance,
                             [&](EmissiveFaces&& own) { faces.push_back(std::move(own)); });
    }
    std::vector<JoinedFaces> joined;
    std::vector<Light> lights;
    const double most = kSurrounding * radius_of(faces);
    std::size_t count = 0;
    for (const EmissiveFaces& own : faces) {
        const EmitterLevels surface = measure_emitter(own.vertices, own.triangles, stopped, is_one_sided(own));
        if (!(surface.area > 0)) {
            continue;
        }
        const bool surrounds = surface.closed && !surface.one_sided && surface.radius > most;
        if (surrounds || count + own.triangles.size() > kMostJoinedFaces) {
            add_lights(own, stopped, lights);
            continue;
        }
        count += own.triangles.size();
        auto alike = std::ranges::find_if(joined, [&](const JoinedFaces& part) { return part.takes(own, surface); });
        if (alike == joined.end()) {
            joined.push_back({own.traits, surface.closed, surface.one_sided, {}, {}, {}, {}});
            alike = joined.end() - 1;
        }
        alike->add(own, surface);
    }
    for (JoinedFaces& part : joined) {
        lights.emplace_back(part.light(stopped));
    }
    return {std::move(emitters), std::move(lights)};
}

}  // namespace shlight
