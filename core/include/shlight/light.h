// SPDX-License-Identifier: MIT
//
// Lights, in the world frame.
#pragma once

#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "shlight/emission_profile.h"
#include "shlight/mesh.h"
#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// Properties of all lights other than shape and strength.
struct LightTraits {
    EmissionProfile profile = EvenProfile{};
    bool casts_shadows = true;    ///< false: nothing blocks it
    bool lights_diffuse = true;   ///< false: diffuse lobes do not reflect it
    bool lights_glossy = true;    ///< false: glossy lobes do not reflect it
    bool seen_by_camera = false;  ///< camera rays that meet it gain its radiance; it hides nothing
    bool is_surface = false;      ///< rays meet it as a surface of a mesh
    std::uint32_t group = 0;      ///< light group, whose light a render can output separately; 0: none
    LightLinks links;

    bool operator==(const LightTraits&) const = default;
};

/// A sphere, or a disk that always faces the shading point: caps of half angle asin(R/d) and atan(R/d).
struct SphereLight {
    Vec3d center;
    double radius;
    Rgb radiance;
    bool facing_disk;
    LightTraits traits = {};

    bool operator==(const SphereLight&) const = default;
};

/// A planar polygon. One-sided ones shine to the side from which the vertices run counter-clockwise.
struct PolygonLight {
    std::vector<Vec3d> vertices;
    std::vector<Triangle> triangles;  ///< triangulation, wound as the vertices are
    Vec3d normal;                     ///< unit, towards that side
    Rgb radiance;
    bool two_sided;
    Vec3d center;    ///< mean of the vertices
    double radius;   ///< largest distance of a vertex from the centre
    double error;    ///< bound of the distance between this plane and the mesh face that rays in float meet
    bool rectangle;  ///< four vertices and right angles
    LightTraits traits = {};

    bool operator==(const PolygonLight&) const = default;
};

/// A disk or an ellipse: center + a half_axis_u + b half_axis_v, a² + b² ≤ 1, with any two conjugate half axes.
/// One-sided ones shine to the side of half_axis_u × half_axis_v.
struct DiskLight {
    Vec3d center, half_axis_u, half_axis_v;
    Vec3d normal;  ///< unit, towards half_axis_u × half_axis_v
    Rgb radiance;
    bool two_sided;
    double radius;  ///< long half axis
    double error;   ///< see PolygonLight
    LightTraits traits = {};

    bool operator==(const DiskLight&) const = default;
};

/// A cap of directions: a disk infinitely far away.
struct SunLight {
    Vec3d direction;    ///< unit, towards its centre
    double half_angle;  ///< [rad], 0 < half_angle ≤ π/2
    Rgb radiance;
    LightTraits traits = {};

    bool operator==(const SunLight&) const = default;
};

/// A sphere light in the limit of radius 0.
struct PointSource {
    Vec3d position;
    Rgb intensity;  ///< [W sr⁻¹]
    LightTraits traits = {};

    bool operator==(const PointSource&) const = default;
};

/// A sun in the limit of angle 0.
struct ParallelSource {
    Vec3d direction;  ///< unit, towards it
    Rgb irradiance;   ///< [W m⁻²] on a perpendicular surface
    LightTraits traits = {};

    bool operator==(const ParallelSource&) const = default;
};

struct EmitterLevels;
class FaceTree;

/// Finds faces that shine among those that rays meet.
struct EmissiveMesh {
    std::uint32_t instance = 0;  ///< RayHit::instance
    std::shared_ptr<const SceneMesh> mesh;
    FaceSide side = FaceSide::both;      ///< that shines
    glm::dmat3 to_mesh = glm::dmat3(1);  ///< from the world to the mesh's frame

    bool operator==(const EmissiveMesh&) const = default;

    /// Whether a ray in this direction meets a side that shines of this instance.
    bool shines_at(const RayHit& hit, const Vec3f& direction) const;
};

/// The emissive faces of a mesh with many of them, or of many meshes.
struct MeshLight {
    std::shared_ptr<const EmitterLevels> shape;  ///< whose outer side shines, if one does
    Rgb radiance;                                ///< mean over the area
    std::shared_ptr<const FaceTree> faces;       ///< null: its outline stands for it
    std::vector<EmissiveMesh> meshes;            ///< in the order of their instances
    LightTraits traits = {};

    bool operator==(const MeshLight&) const = default;

    /// Whether it is what a ray in this direction meets, on a side that shines.
    bool shines_at(const RayHit& hit, const Vec3f& direction) const;
};

using Light = std::variant<SphereLight, PolygonLight, DiskLight, MeshLight, SunLight, PointSource, ParallelSource>;

const LightTraits& traits_of(const Light& light);
/// Radiance, or for sources without extent intensity or irradiance.
const Rgb& strength_of(const Light& light);
/// Whether the light has no extent.
bool is_delta(const Light& light);
/// The light, moved. Precondition: no MeshLight.
Light moved(const Light& light, const Vec3d& way);

/// Throws std::invalid_argument naming the argument: a number outside docs/conventions.md's range, a radius ≤ 0.
/// Radiance may be negative: such a light removes light.
SphereLight make_sphere_light(const Vec3d& center, double radius, const Rgb& radiance, bool facing_disk,
                              const LightTraits& traits = {});

/// vertices: k ≥ 3 of a simple polygon, convex or not; repeated vertices are merged, and vertices off the polygon's
/// plane by less than 1e-4 of its extent are moved onto it.
/// Throws std::invalid_argument naming the argument: fewer than three vertices, a number outside docs/conventions.md's
/// range, vertices that are not planar, enclose no area or cross themselves.
PolygonLight make_polygon_light(std::vector<Vec3d> vertices, const Rgb& radiance, bool two_sided,
                                const LightTraits& traits = {});

/// Throws std::invalid_argument naming the argument: a number outside docs/conventions.md's range, half axes that are
/// parallel or zero.
DiskLight make_disk_light(const Vec3d& center, const Vec3d& half_axis_u, const Vec3d& half_axis_v, const Rgb& radiance,
                          bool two_sided, const LightTraits& traits = {});

/// One-sided, with the profile of a spread (see make_spread_profile) in the place of traits.profile. Throw as the
/// functions above and make_spread_profile do.
PolygonLight make_polygon_lamp(std::vector<Vec3d> vertices, const Rgb& radiance, double spread,
                               const LightTraits& traits = {});
DiskLight make_disk_lamp(const Vec3d& center, const Vec3d& half_axis_u, const Vec3d& half_axis_v, const Rgb& radiance,
                         double spread, const LightTraits& traits = {});

/// Throws std::invalid_argument naming the argument: a number outside docs/conventions.md's range.
PointSource make_point_source(const Vec3d& position, const Rgb& intensity, const LightTraits& traits = {});

/// A SphereLight, or for radius 0 a PointSource, that shines into a cone. intensity [W sr⁻¹]: on the cone's axis, from
/// afar; for a sphere it is radiance · π radius². traits.profile is replaced. Throws std::invalid_argument naming the
/// argument: a number outside docs/conventions.md's range, a radius < 0.
Light make_spot_light(const Vec3d& position, const SpotProfile& profile, const Rgb& intensity, double radius,
                      bool facing_disk, LightTraits traits = {});

/// A SunLight, or for an angle below 1e-6, which is invisible, a ParallelSource.
/// direction: in which the light travels, of any length > 0. angle: the sun's diameter [rad], 0 … π. irradiance [W
/// m⁻²]: on a perpendicular surface. tangent: radiance irradiance / (π tan²(angle/2) cos³α), see TangentProfile, in
/// place of irradiance / (π sin²(angle/2)); traits.profile is then replaced.
/// Throws std::invalid_argument naming the argument: a number outside docs/conventions.md's range, a direction of
/// length 0, an angle outside 0 … π, or above 3 if tangent.
Light make_sun_light(const Vec3d& direction, double angle, const Rgb& irradiance, bool tangent,
                     const LightTraits& traits = {});

}  // namespace shlight
