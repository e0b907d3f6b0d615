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

/// What all lights have beside their shape and radiance.
struct LightTraits {
    EmissionProfile profile = EvenProfile{};
    bool casts_shadows = true;    ///< false: it lights what it cannot see too
    bool lights_diffuse = true;   ///< false: diffuse lobes do not reflect it
    bool lights_glossy = true;    ///< likewise, glossy ones
    bool seen_by_camera = false;  ///< it adds its radiance to what camera rays that meet it bring, and hides nothing
    std::uint32_t group = 0;      ///< that its light is kept apart in where a render is asked for it; 0: none
};

/// A sphere, or a disk that always faces the shading point: caps of half angle asin(R/d) and atan(R/d).
struct SphereLight {
    Vec3d center;
    double radius;
    Rgb radiance;
    bool facing_disk;
    LightTraits traits = {};
};

/// A planar polygon. One-sided ones shine to the side that sees the vertices counter-clockwise.
struct PolygonLight {
    std::vector<Vec3d> vertices;
    std::vector<Triangle> triangles;  ///< triangulation, wound as the vertices are
    Vec3d normal;                     ///< unit, towards the side that sees the vertices counter-clockwise
    Rgb radiance;
    bool two_sided;
    Vec3d center;    ///< mean of the vertices
    double radius;   ///< largest distance of a vertex from it
    double error;    ///< bound of the distance between this plane and a mesh face that float rays meet in its place
    bool rectangle;  ///< four vertices and right angles
    LightTraits traits = {};
};

/// A disk or an ellipse: center + a half_axis_u + b half_axis_v, a² + b² ≤ 1, of any two conjugate half axes. One-sided
/// ones shine to the side of half_axis_u × half_axis_v.
struct DiskLight {
    Vec3d center, half_axis_u, half_axis_v;
    Vec3d normal;  ///< unit, towards half_axis_u × half_axis_v
    Rgb radiance;
    bool two_sided;
    double radius;  ///< half of the long axis
    double error;   ///< as PolygonLight's
    LightTraits traits = {};
};

/// A cap of directions: a disk infinitely far away.
struct SunLight {
    Vec3d direction;    ///< unit, towards its middle
    double half_angle;  ///< [rad], 0 < half_angle ≤ π/2
    Rgb radiance;
    LightTraits traits = {};
};

/// A sphere light that has shrunk to a point.
struct PointSource {
    Vec3d position;
    Rgb intensity;  ///< [W sr⁻¹]
    LightTraits traits = {};
};

/// A sun that has shrunk to a point.
struct ParallelSource {
    Vec3d direction;  ///< unit, towards it
    Rgb irradiance;   ///< [W m⁻²] on a surface at right angles to it
    LightTraits traits = {};
};

struct EmitterLevels;
class FaceRadiance;

/// The emissive faces of a mesh, where they are many: to both sides.
struct MeshLight {
    std::shared_ptr<const EmitterLevels> shape;
    Rgb radiance;                               ///< the mean by area
    std::shared_ptr<const FaceRadiance> faces;  ///< null: all shine alike
    // Which of the faces that rays meet are the light's.
    std::uint32_t instance;  ///< RayHit::instance
    std::shared_ptr<const SceneMesh> mesh;
    LightTraits traits = {};

    bool holds(const RayHit& hit) const {
        return hit.instance == instance && mesh->emitted(mesh->shape->material_index(hit.triangle)) != Rgb(0);
    }
};

using Light = std::variant<SphereLight, PolygonLight, DiskLight, MeshLight, SunLight, PointSource, ParallelSource>;

const LightTraits& traits_of(const Light& light);
/// Radiance, or of sources without extent: intensity or irradiance.
const Rgb& strength_of(const Light& light);
/// Whether it is a source without extent.
bool is_delta(const Light& light);

/// Throws std::invalid_argument naming the argument: a number outside docs/conventions.md's range, a radius ≤ 0.
/// Radiance may be negative: such a light takes light away.
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

/// Throws std::invalid_argument naming the argument: a number outside docs/conventions.md's range.
PointSource make_point_source(const Vec3d& position, const Rgb& intensity, const LightTraits& traits = {});

/// A SphereLight, or for radius 0 a PointSource, that shines into a cone. intensity [W sr⁻¹]: along the cone's axis,
/// from afar; of a sphere, radiance times π radius². traits.profile is replaced. Throws std::invalid_argument naming
/// the argument: a number outside docs/conventions.md's range, a radius < 0.
Light make_spot_light(const Vec3d& position, const SpotProfile& profile, const Rgb& intensity, double radius,
                      bool facing_disk, LightTraits traits = {});

/// A SunLight, or for an angle of less than a millionth, whose width nothing can show, a ParallelSource.
/// direction: the way the light travels, of any length > 0. angle: the sun's diameter [rad], 0 … π. irradiance [W m⁻²]:
/// on a surface at right angles to the direction. tangent: of the radiance irradiance / (π tan²(angle/2) cos³α), see
/// TangentProfile, in place of irradiance / (π sin²(angle/2)); traits.profile is then replaced.
/// Throws std::invalid_argument naming the argument: a number outside docs/conventions.md's range, a direction of
/// length 0, an angle outside 0 … π, or above 3 if tangent.
Light make_sun_light(const Vec3d& direction, double angle, const Rgb& irradiance, bool tangent,
                     const LightTraits& traits = {});

}  // namespace shlight
