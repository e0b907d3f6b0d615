// SPDX-License-Identifier: MIT
//
// Scenes: meshes, materials and lights in one world frame, in metres.
//
// A Scene collects; compile() makes of it an immutable CompiledScene that any number of threads may read.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "shlight/environment.h"
#include "shlight/light.h"
#include "shlight/mesh.h"
#include "shlight/parallel.h"
#include "shlight/scene_rays.h"
#include "shlight/surface_point.h"
#include "shlight/types.h"

namespace shlight {

/// A place on a surface where a shader program runs.
struct SurfacePlace {
    RayHit hit;
    Vec3d position;
    Vec3d towards_viewer;  ///< unit
};

/// The same, and the surface's neighbours in the picture (see shader_program.h).
struct ShadedPlace {
    std::array<SurfacePlace, 3> at;          ///< the hit, to the right, below
    Vec3d shading_normal, geometric_normal;  ///< at the hit
    double ray_length;
    std::uint32_t transparent_depth;
};

/// Who sees lamps: a camera those with LightTraits::seen_by_camera, a mirror those that light glossy lobes, of which
/// those without shadows are seen through surfaces.
enum class LampViewer : std::uint8_t { camera, mirror, unblocked_mirror };

class CompiledScene {
  public:
    CompiledScene(const CompiledScene&) = delete;
    CompiledScene& operator=(const CompiledScene&) = delete;
    ~CompiledScene();

    /// The origin of the frame in which everything here stands, in the world: rays in float have more digits near it.
    const Vec3d& origin() const;
    std::span<const Material> materials() const;
    /// Lights with extent come first, then sources without. Both lists hold lamps in the order in which they were
    /// added, then emissive faces.
    std::span<const Light> lights() const;
    /// Number of lights with extent.
    std::size_t extended_light_count() const;
    /// The prepared environment.
    const Environment& environment() const;
    /// The environment's LightTraits::group.
    std::uint32_t environment_group() const;
    /// Groups of all lights and of all surfaces that may be seen shining, ascending.
    std::span<const std::uint32_t> light_groups() const;
    /// The environment that the camera sees; null: the background is transparent.
    const Environment* background() const;
    bool shows_lamps(LampViewer viewer) const;
    /// Radiance that lamps add to a ray of a viewer, up to a surface at this distance along it, if there is one.
    /// by_group: each group's part is added to its entry; empty: no parts are wanted.
    Rgb lamps_along(LampViewer viewer, const Ray& ray, const std::optional<double>& surface,
                    std::span<Rgb> by_group = {}) const;
    const SceneRays& rays() const;
    /// Precondition: not hit.missed(); direction is the ray's.
    SurfacePoint surface(const RayHit& hit, const Vec3f& direction) const;
    /// The place where another ray meets the plane of a surface, which may lie outside its triangle. The ray is taken
    /// to be at most twice as long as the hit's. Precondition: as of surface().
    SurfacePlace neighbour(const SurfacePlace& place, const Vec3d& normal, double length, const Ray& ray) const;
    /// The value of Pass::uv, whose last component is 1; 0 on meshes without texture coordinates.
    Vec3d uv(const RayHit& hit) const;
    const Label& object_label(const RayHit& hit) const;
    /// Reads an input of a material's program. place: 0 at the hit, 1 and 2 at its neighbours.
    void read(const ShaderInput& input, const Material& material, int place, std::span<const ShadedPlace> places,
              std::span<float> out) const;

  private:
    friend class Scene;
    class Impl;
    explicit CompiledScene(std::unique_ptr<const Impl> impl);
    std::unique_ptr<const Impl> impl_;
};

class Scene {
  public:
    /// Number of a mesh, valid as long as the scene or a copy of it holds the mesh.
    using MeshNumber = std::uint64_t;

    /// Throws as check_shape and check_use do. Emissive faces become two-sided polygon lights,
    /// many of them one mesh light; as every face, the camera sees them
    /// and they block light.
    MeshNumber add_mesh(Mesh mesh);
    /// Throws std::invalid_argument unless the scene holds the mesh.
    const SceneMesh& mesh(MeshNumber number) const;
    /// The same shape, used otherwise. Throws as mesh() and check_use do; the mesh is then as it was.
    void use_mesh(MeshNumber number, MeshUse use);
    /// Throws what mesh() throws.
    void remove_mesh(MeshNumber number);
    /// Lamps throw as make_sphere_light, make_polygon_light … do. The camera sees those that are
    /// LightTraits::seen_by_camera and have an extent; they block no light.
    void add_sphere_light(const Vec3d& center, double radius, const Rgb& radiance, bool facing_disk = false,
                          const LightTraits& traits = {});
    /// spread: see make_spread_profile, which replaces traits.profile.
    void add_polygon_light(std::vector<Vec3d> vertices, const Rgb& radiance, double spread = std::numbers::pi,
                           const LightTraits& traits = {});
    /// Shines to the side of half_axis_u × half_axis_v. spread: as of a polygon.
    void add_disk_light(const Vec3d& center, const Vec3d& half_axis_u, const Vec3d& half_axis_v, const Rgb& radiance,
                        double spread = std::numbers::pi, const LightTraits& traits = {});
    void add_point_light(const Vec3d& position, const Rgb& intensity, const LightTraits& traits = {});
    void add_spot_light(const Vec3d& position, const SpotProfile& profile, const Rgb& intensity, double radius = 0,
                        bool facing_disk = false, const LightTraits& traits = {});
    void add_sun_light(const Vec3d& direction, double angle, const Rgb& irradiance, bool tangent = false,
                       const LightTraits& traits = {});

    /// All lamps; what shines of meshes, and the environment, stays.
    void remove_lamps() { lamps_.clear(); }

    /// Takes the place of the environment before, at first a black one that the camera does not see.
    /// visible: the camera sees it behind the scene; group: as LightTraits has.
    void set_environment(Environment environment, bool visible = true, std::uint32_t group = 0);

    /// Builds with at most `threads` threads, 0: all cores; calls `progress` meanwhile, with 0, about every 10 ms.
    /// Throws std::invalid_argument for threads < 0 and for surfaces in a scene of less than 1e-6 m, std::bad_alloc or
    /// std::runtime_error when Embree fails; RenderCancelled when progress returns false, and what it throws.
    /// before: what it has built of each mesh is shared as far as that has not changed; null: nothing.
    std::shared_ptr<const CompiledScene> compile(int threads = 0, const Progress& progress = {},
                                                 const CompiledScene* before = nullptr) const;

  private:
    Box checked_bounds() const;

    std::map<MeshNumber, std::shared_ptr<const SceneMesh>> meshes_;
    MeshNumber next_mesh_ = 0;
    std::vector<Light> lamps_;
    Environment environment_;
    bool environment_visible_ = false;
    std::uint32_t environment_group_ = 0;
};

}  // namespace shlight
