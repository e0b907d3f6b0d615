// SPDX-License-Identifier: MIT
#include "shlight/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <variant>

#include <tbb/parallel_for.h>

#include "base/scene_range.h"
#include "render/placed_meshes.h"
#include "render/visible_lamps.h"
#include "shlight/parallel.h"

namespace shlight {
namespace {

/// A box around what has a place of a lamp.
struct LampBounds {
    Box operator()(const SunLight&) const { return {}; }
    Box operator()(const ParallelSource&) const { return {}; }
    Box operator()(const MeshLight&) const { return {}; }
    Box operator()(const PointSource& light) const { return {light.position, light.position}; }
    template <class AreaLight>
    Box operator()(const AreaLight& light) const {
        return {light.center - light.radius, light.center + light.radius};
    }
};

/// A scene keeps the world's frame, or the one before, if it is no more of its own sizes away from its origin.
constexpr double kSizesAway = 8;

bool is_near(const Box& box, const Vec3d& origin) {
    const double size = largest_component(box.largest - box.least) / 2;
    return largest_component((box.least + box.largest) / 2.0 - origin) <= kSizesAway * size;
}

/// The same triangles in the same places, opaque or not.
bool meets_rays_alike(const std::shared_ptr<const CompiledMesh>& a, const std::shared_ptr<const CompiledMesh>& b) {
    return a->opaque == b->opaque && a->transparent == b->transparent && a->mesh->transforms == b->mesh->transforms;
}

/// Reads the inputs of one material.
class PlaceReader : public ShaderReader {
  public:
    PlaceReader(const PlacedMeshes& placed, const Material& material, std::span<const ShadedPlace> places)
        : placed_(&placed), material_(&material), places_(places) {}

    void read(const ShaderInput& input, int place, std::size_t first, std::span<float> out) const override {
        placed_->read(input, material_->attributes, place, places_.subspan(first, out.size()), out);
    }

  private:
    const PlacedMeshes* placed_;
    const Material* material_;
    std::span<const ShadedPlace> places_;
};

}  // namespace

class CompiledScene::Impl {
  public:
    /// Runs the programs of surfaces that shadow rays meet.
    class Transparency : public SurfaceTransparency {
      public:
        explicit Transparency(const Impl& scene) : scene_(&scene) {}
        void find(std::span<const Ray> rays, std::span<const RayHit> hits, std::uint32_t depth,
                  std::span<Rgb> passed) const override;

      private:
        const Impl* scene_;
    };

    Impl(const Vec3d& frame_origin, std::span<const Light> lamps, Environment all_around, bool environment_visible,
         std::uint32_t group)
        : origin(frame_origin),
          environment(std::move(all_around)),
          has_background(environment_visible),
          environment_group(group) {
        for (const Light& lamp : lamps) {
            lights.push_back(origin == Vec3d(0) ? lamp : moved(lamp, -origin));
        }
        placed.set_origin(origin);
    }

    /// before: whose meshes and rays are shared as far as they are the same; null: nothing.
    void build(std::span<const std::shared_ptr<const SceneMesh>> meshes, const Impl* before, const Stopped& stopped) {
        environment = environment.prepared(before == nullptr ? Environment() : before->environment, stopped);
        std::vector<std::shared_ptr<const CompiledMesh>> compiled(meshes.size());
        tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t i) {
            compiled[i] =
                compile_mesh(meshes[i], origin, before == nullptr ? nullptr : before->of_shape(*meshes[i]), stopped);
        });
        for (std::shared_ptr<const CompiledMesh>& mesh : compiled) {
            add(std::move(mesh));
        }
        const auto first_delta =
            std::stable_partition(lights.begin(), lights.end(), [](const Light& light) { return !is_delta(light); });
        extended_light_count = static_cast<std::size_t>(first_delta - lights.begin());
        const bool alike =
            before != nullptr && std::ranges::equal(placed.meshes(), before->placed.meshes(), meets_rays_alike);
        rays = alike ? std::make_unique<const SceneRays>(*before->rays, transparency) : built_rays(stopped);
        for (const LampViewer viewer : {LampViewer::camera, LampViewer::mirror, LampViewer::unblocked_mirror}) {
            seen_lamps[static_cast<std::size_t>(viewer)] = VisibleLamps(lights, viewer);
        }
        find_light_groups();
    }

    Vec3d origin;
    PlacedMeshes placed;
    std::vector<Material> materials;
    std::vector<Light> lights;
    std::size_t extended_light_count = 0;
    Environment environment;
    bool has_background;
    std::uint32_t environment_group;
    Transparency transparency{*this};
    std::unique_ptr<const SceneRays> rays;
    std::array<VisibleLamps, 3> seen_lamps;  // by LampViewer
    std::vector<std::uint32_t> light_groups;

  private:
    /// Null: there is none.
    std::shared_ptr<const CompiledMesh> of_shape(const SceneMesh& mesh) const {
        const auto found = by_shape_.find(mesh.shape.get());
        return found == by_shape_.end() ? nullptr : placed.meshes()[found->second];
    }
    void add(std::shared_ptr<const CompiledMesh> compiled);
    std::unique_ptr<const SceneRays> built_rays(const Stopped& stopped) const;
    void find_light_groups();

    std::unordered_map<const MeshShape*, std::size_t> by_shape_;  // index in placed.meshes()
};

void CompiledScene::Impl::add(std::shared_ptr<const CompiledMesh> compiled) {
    const SceneMesh& mesh = *compiled->mesh;
    const auto first_instance = static_cast<std::uint32_t>(placed.placements().size());
    for (const Light& light : compiled->lights) {
        lights.push_back(light);
        if (auto* mesh_light = std::get_if<MeshLight>(&lights.back())) {
            mesh_light->instance += first_instance;
        }
    }
    const auto first_material = static_cast<std::uint32_t>(materials.size());
    for (std::size_t i = 0; i < mesh.material_count(); ++i) {
        materials.push_back(mesh.material(i));
    }
    by_shape_[mesh.shape.get()] = placed.meshes().size();
    placed.add(std::move(compiled), first_material);
}

std::unique_ptr<const SceneRays> CompiledScene::Impl::built_rays(const Stopped& stopped) const {
    std::vector<TracedInstance> opaque, transparent;
    for (const Placement& placement : placed.placements()) {
        const CompiledMesh& mesh = *placed.meshes()[placement.mesh];
        const glm::dmat4 to_world = placement.baked ? glm::dmat4(1) : placement.to_world;
        opaque.push_back({mesh.opaque, to_world});
        transparent.push_back({mesh.transparent, to_world});
    }
    return std::make_unique<const SceneRays>(std::move(opaque), std::move(transparent), transparency, stopped);
}

void CompiledScene::Impl::Transparency::find(std::span<const Ray> rays, std::span<const RayHit> hits,
                                             std::uint32_t depth, std::span<Rgb> passed) const {
    std::vector<ShadedPlace> places;
    std::vector<std::uint32_t> material, order(hits.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const SurfacePoint point = scene_->placed.surface(hits[i], rays[i].direction);
        const Vec3d towards_viewer = -glm::normalize(Vec3d(rays[i].direction));
        ShadedPlace& place = places.emplace_back();
        place.at.fill({hits[i], point.position, towards_viewer});
        place.shading_normal = point.shading_normal;
        place.geometric_normal = point.geometric_normal;
        place.ray_length = glm::distance(point.position, Vec3d(rays[i].origin));
        place.transparent_depth = depth;
        material.push_back(point.material);
    }
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return material[a] < material[b]; });
    std::vector<ShadedPlace> alike;
    std::vector<float> results;
    ShaderProgram::Registers registers;
    for (std::size_t first = 0; first < order.size();) {
        const Material& own = scene_->materials[material[order[first]]];
        alike.clear();
        std::size_t last = first;
        for (; last < order.size() && material[order[last]] == material[order[first]]; ++last) {
            alike.push_back(places[order[last]]);
        }
        const ShaderProgram& program = own.shader->shadow_program;
        results.resize(program.result_count() * alike.size());
        program.evaluate(PlaceReader(scene_->placed, own, alike), alike.size(), false, registers, results);
        for (std::size_t k = 0; k < alike.size(); ++k) {
            for (int channel = 0; channel < 3; ++channel) {
                const float share = results[static_cast<std::size_t>(channel) * alike.size() + k];
                passed[order[first + k]][channel] = share > 0 ? share : 0.0F;
            }
        }
        first = last;
    }
}

void CompiledScene::Impl::find_light_groups() {
    if (!environment.is_black()) {
        light_groups.push_back(environment_group);
    }
    for (const Light& light : lights) {
        light_groups.push_back(traits_of(light).group);
    }
    for (const Material& material : materials) {
        if (material.emission != Rgb(0) || (material.shader != nullptr && material.shader->emission)) {
            light_groups.push_back(material.group);
        }
    }
    std::sort(light_groups.begin(), light_groups.end());
    light_groups.erase(std::unique(light_groups.begin(), light_groups.end()), light_groups.end());
}

CompiledScene::CompiledScene(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
CompiledScene::~CompiledScene() = default;

const Vec3d& CompiledScene::origin() const {
    return impl_->origin;
}

std::span<const Material> CompiledScene::materials() const {
    return impl_->materials;
}
std::span<const Light> CompiledScene::lights() const {
    return impl_->lights;
}
std::size_t CompiledScene::extended_light_count() const {
    return impl_->extended_light_count;
}
const Environment& CompiledScene::environment() const {
    return impl_->environment;
}
const Environment* CompiledScene::background() const {
    return impl_->has_background ? &impl_->environment : nullptr;
}
std::span<const std::uint32_t> CompiledScene::light_groups() const {
    return impl_->light_groups;
}
std::uint32_t CompiledScene::environment_group() const {
    return impl_->environment_group;
}
bool CompiledScene::shows_lamps(LampViewer viewer) const {
    return !impl_->seen_lamps[static_cast<std::size_t>(viewer)].empty();
}
Rgb CompiledScene::lamps_along(LampViewer viewer, const Ray& ray, const std::optional<double>& surface,
                               std::span<Rgb> by_group) const {
    return shows_lamps(viewer) ? impl_->seen_lamps[static_cast<std::size_t>(viewer)].radiance(ray, surface, by_group)
                               : Rgb(0);
}
const SceneRays& CompiledScene::rays() const {
    return *impl_->rays;
}

SurfacePoint CompiledScene::surface(const RayHit& hit, const Vec3f& direction) const {
    return impl_->placed.surface(hit, direction);
}
SurfacePlace CompiledScene::neighbour(const SurfacePlace& place, const Vec3d& normal, double length,
                                      const Ray& ray) const {
    return impl_->placed.neighbour(place, normal, length, ray);
}
Vec3d CompiledScene::uv(const RayHit& hit) const {
    return impl_->placed.uv(hit);
}
const Label& CompiledScene::object_label(const RayHit& hit) const {
    return impl_->placed.label(hit);
}
void CompiledScene::read(const ShaderInput& input, const Material& material, int place,
                         std::span<const ShadedPlace> places, std::span<float> out) const {
    impl_->placed.read(input, material.attributes, place, places, out);
}

Scene::MeshNumber Scene::add_mesh(Mesh mesh) {
    check_shape(mesh);
    check_use(mesh, mesh);
    auto shape = std::make_shared<const MeshShape>(std::move(static_cast<MeshShape&>(mesh)));
    meshes_[next_mesh_] =
        std::make_shared<const SceneMesh>(SceneMesh{std::move(static_cast<MeshUse&>(mesh)), std::move(shape)});
    return next_mesh_++;
}

const SceneMesh& Scene::mesh(MeshNumber number) const {
    const auto found = meshes_.find(number);
    if (found == meshes_.end()) {
        reject("mesh has been removed from its scene");
    }
    return *found->second;
}

void Scene::use_mesh(MeshNumber number, MeshUse use) {
    const SceneMesh& own = mesh(number);
    check_use(*own.shape, use);
    meshes_[number] = std::make_shared<const SceneMesh>(SceneMesh{std::move(use), own.shape});
}

void Scene::remove_mesh(MeshNumber number) {
    mesh(number);
    meshes_.erase(number);
}

void Scene::add_sphere_light(const Vec3d& center, double radius, const Rgb& radiance, bool facing_disk,
                             const LightTraits& traits) {
    lamps_.emplace_back(make_sphere_light(center, radius, radiance, facing_disk, traits));
}

void Scene::add_polygon_light(std::vector<Vec3d> vertices, const Rgb& radiance, double spread,
                              const LightTraits& traits) {
    PolygonLight light = make_polygon_light(std::move(vertices), radiance, false, traits);
    light.traits.profile = make_spread_profile(light.normal, spread);
    lamps_.emplace_back(std::move(light));
}

void Scene::add_disk_light(const Vec3d& center, const Vec3d& half_axis_u, const Vec3d& half_axis_v, const Rgb& radiance,
                           double spread, const LightTraits& traits) {
    DiskLight light = make_disk_light(center, half_axis_u, half_axis_v, radiance, false, traits);
    light.traits.profile = make_spread_profile(light.normal, spread);
    lamps_.emplace_back(light);
}

void Scene::add_point_light(const Vec3d& position, const Rgb& intensity, const LightTraits& traits) {
    lamps_.emplace_back(make_point_source(position, intensity, traits));
}

void Scene::add_spot_light(const Vec3d& position, const SpotProfile& profile, const Rgb& intensity, double radius,
                           bool facing_disk, const LightTraits& traits) {
    lamps_.push_back(make_spot_light(position, profile, intensity, radius, facing_disk, traits));
}

void Scene::add_sun_light(const Vec3d& direction, double angle, const Rgb& irradiance, bool tangent,
                          const LightTraits& traits) {
    lamps_.push_back(make_sun_light(direction, angle, irradiance, tangent, traits));
}

void Scene::set_environment(Environment environment, bool visible, std::uint32_t group) {
    environment_ = std::move(environment);
    environment_visible_ = visible;
    environment_group_ = group;
}

Box Scene::checked_bounds() const {
    Box box;
    const auto add = [&](const Box& own) {
        if (!own.empty()) {
            box.add(own.least);
            box.add(own.largest);
        }
    };
    for (const auto& [number, mesh] : meshes_) {
        add(bounds(*mesh->shape, *mesh));
    }
    const bool is_tiny = box.reach() > 0 && box.reach() < kLeastReach;
    for (const Light& lamp : lamps_) {
        add(std::visit(LampBounds{}, lamp));
    }
    if (is_tiny && box.reach() < kLeastReach) {
        reject("scene reaches less than 1e-6 m from the origin, which rays in float do not resolve");
    }
    return box;
}

std::shared_ptr<const CompiledScene> Scene::compile(int threads, const Progress& progress,
                                                    const CompiledScene* before) const {
    const Box box = checked_bounds();
    const Vec3d last = before == nullptr ? Vec3d(0) : before->origin();
    const Vec3d origin = box.empty() || is_near(box, Vec3d(0)) ? Vec3d(0)
                         : is_near(box, last)                  ? last
                                                               : (box.least + box.largest) / 2.0;
    auto impl =
        std::make_unique<CompiledScene::Impl>(origin, lamps_, environment_, environment_visible_, environment_group_);
    std::vector<std::shared_ptr<const SceneMesh>> meshes;
    for (const auto& [number, mesh] : meshes_) {
        if (!mesh->shape->triangles.empty() && !mesh->transforms.empty()) {
            meshes.push_back(mesh);
        }
    }
    const auto build = [&](const Watch& caller) {
        impl->build(meshes, before == nullptr ? nullptr : before->impl_.get(), caller.stopped);
    };
    run_watched(threads, build, progress ? std::function<bool()>([&] { return progress(0); }) : nullptr);
    return std::shared_ptr<const CompiledScene>(new CompiledScene(std::move(impl)));
}

}  // namespace shlight
