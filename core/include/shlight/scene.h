// SPDX-License-Identifier: MIT
//
// Scenes: meshes, materials and lights in one world frame, in metres.
//
// A Scene collects; compile() makes of it an immutable CompiledScene that any number of threads may read.
#pragma once

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
#include "shlight/types.h"

namespace shlight {

struct JoinedLights;
class PlacedMeshes;
class Scene;
class VisibleLamps;

/// Who sees lamps: a camera those with LightTraits::seen_by_camera, a mirror those that light glossy lobes, of which
/// those without shadows are seen through surfaces.
enum class LampViewer : std::uint8_t { camera, mirror, unblocked_mirror };

class CompiledScene : public SurfaceTransparency, public std::enable_shared_from_this<CompiledScene> {
  public:
    CompiledScene(const CompiledScene&) = delete;
    CompiledScene& operator=(const CompiledScene&) = delete;
    ~CompiledScene() override;

    /// The origin of the frame in which everything here stands, in the world: rays in float have more digits near it.
    const Vec3d& origin() const { return origin_; }
    std::span<const Material> materials() const { return materials_; }
    /// Lights with extent come first, then sources without. Both lists hold lamps in the order in which they were
    /// added, then emissive faces.
    std::span<const Light> lights() const { return lights_; }
    /// Number of lights with extent.
    std::size_t extended_light_count() const { return extended_light_count_; }
    /// The prepared environment.
    const Environment& environment() const { return environment_; }
    /// The environment's LightTraits::group.
    std::uint32_t environment_group() const { return environment_group_; }
    /// Groups of all lights and of all surfaces that may be seen shining, ascending.
    std::span<const std::uint32_t> light_groups() const { return light_groups_; }
    /// The light that the camera sees behind the scene, or would see if it were visible.
    const Environment& background() const { return background_; }
    /// If not, the picture is transparent there.
    bool background_visible() const { return background_visible_; }
    const VisibleLamps& visible_lamps(LampViewer viewer) const;
    const PlacedMeshes& placed() const { return *placed_; }
    /// Scene::MeshNumber of each mesh of placed().
    std::span<const std::uint64_t> mesh_numbers() const { return mesh_numbers_; }
    const SceneRays& rays() const { return *rays_; }

  private:
    friend class Scene;
    /// settings: whose environment and background it has; lamps: its lamps.
    CompiledScene(const Vec3d& origin, std::span<const Light> lamps, const Scene& settings);
    /// before: whose meshes and rays are shared as far as they are the same; null: nothing. Those of `meshes` are
    /// numbered in mesh_numbers_.
    void build(std::span<const std::shared_ptr<const SceneMesh>> meshes, const CompiledScene* before,
               const Stopped& stopped);
    /// Makes few lights of those of the meshes, which follow so many lamps, if there are many.
    void join_mesh_lights(std::size_t lamps, const CompiledScene* before, const Stopped& stopped);
    void build_rays(const CompiledScene* before, const Stopped& stopped);
    void find_light_groups();
    void find(std::span<const Ray> rays, std::span<const RayHit> hits, std::uint32_t depth, std::span<Rgb> passed,
              std::span<Rgb> entered) const override;

    Vec3d origin_;
    std::unique_ptr<PlacedMeshes> placed_;
    std::vector<std::uint64_t> mesh_numbers_;
    std::vector<Material> materials_;
    std::vector<Light> lights_;
    std::shared_ptr<const JoinedLights> joined_lights_;  // null: those of the meshes are few
    std::size_t extended_light_count_ = 0;
    Environment environment_, background_;
    bool background_visible_;
    std::uint32_t environment_group_;
    std::unique_ptr<const SceneRays> rays_;
    std::vector<VisibleLamps> visible_lamps_;  // by LampViewer
    std::vector<std::uint32_t> light_groups_;
};

class Scene {
  public:
    /// Number of a mesh: of those that were added before, also of ones that have been removed. It is the same in copies
    /// of the scene.
    using MeshNumber = std::uint64_t;

    /// Throws as check_shape and check_use do. Emissive faces become polygon lights, many of them one mesh light; as
    /// every face, the camera sees them and they block light.
    MeshNumber add_mesh(Mesh mesh);
    /// Throws std::invalid_argument unless the scene holds the mesh.
    const SceneMesh& mesh(MeshNumber number) const;
    /// The same shape, used otherwise. Throws as mesh() and check_use do; the mesh is then as it was.
    void use_mesh(MeshNumber number, MeshUse use);
    /// Throws what mesh() throws.
    void remove_mesh(MeshNumber number);
    std::size_t mesh_count() const { return meshes_.size(); }

    /// Number of a lamp: of those that were added before, also of ones that have been removed. It is the same in copies
    /// of the scene.
    using LampNumber = std::uint64_t;

    /// The camera sees lamps that are LightTraits::seen_by_camera and have an extent; they block no light.
    LampNumber add_lamp(Light lamp);
    /// Throw std::invalid_argument unless the scene holds the lamp.
    void set_lamp(LampNumber number, Light lamp);
    void remove_lamp(LampNumber number);
    /// All lamps; what shines of meshes, and the environment, stays.
    void remove_lamps() { lamps_.clear(); }
    std::size_t lamp_count() const { return lamps_.size(); }

    /// Add lamps, and throw, as make_sphere_light, make_polygon_lamp … do.
    LampNumber add_sphere_light(const Vec3d& center, double radius, const Rgb& radiance, bool facing_disk = false,
                                const LightTraits& traits = {});
    LampNumber add_polygon_light(std::vector<Vec3d> vertices, const Rgb& radiance, double spread = std::numbers::pi,
                                 const LightTraits& traits = {});
    LampNumber add_disk_light(const Vec3d& center, const Vec3d& half_axis_u, const Vec3d& half_axis_v,
                              const Rgb& radiance, double spread = std::numbers::pi, const LightTraits& traits = {});
    LampNumber add_point_light(const Vec3d& position, const Rgb& intensity, const LightTraits& traits = {});
    LampNumber add_spot_light(const Vec3d& position, const SpotProfile& profile, const Rgb& intensity,
                              double radius = 0, bool facing_disk = false, const LightTraits& traits = {});
    LampNumber add_sun_light(const Vec3d& direction, double angle, const Rgb& irradiance, bool tangent = false,
                             const LightTraits& traits = {});

    /// Takes the place of the environment before, at first a black one that the camera does not see.
    /// visible: the camera sees it behind the scene, or `background` in its place; group: as LightTraits has.
    void set_environment(Environment environment, bool visible = true, std::uint32_t group = 0,
                         const std::optional<Environment>& background = std::nullopt);
    const Environment& environment() const { return environment_; }

    /// Builds with at most `threads` threads, 0: all cores; calls `progress` meanwhile, with 0, about every 10 ms.
    /// Throws std::invalid_argument for threads < 0 and for surfaces in a scene of less than 1e-6 m, std::bad_alloc or
    /// std::runtime_error when Embree fails; RenderCancelled when progress returns false, and what it throws.
    /// before: what it has built of each mesh is shared as far as that has not changed; null: nothing.
    std::shared_ptr<const CompiledScene> compile(int threads = 0, const Progress& progress = {},
                                                 const CompiledScene* before = nullptr) const;

  private:
    friend class CompiledScene;
    Box checked_bounds() const;

    std::map<MeshNumber, std::shared_ptr<const SceneMesh>> meshes_;
    MeshNumber next_mesh_ = 0;
    std::map<LampNumber, Light> lamps_;
    LampNumber next_lamp_ = 0;
    Environment environment_, background_;
    bool background_visible_ = false;
    std::uint32_t environment_group_ = 0;
};

}  // namespace shlight
