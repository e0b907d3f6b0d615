// SPDX-License-Identifier: MIT
#include "shlight/scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <variant>

#include <tbb/parallel_for.h>

#include "base/scene_range.h"
#include "shlight/parallel.h"
#include "surfaces/mesh_emission.h"
#include "surfaces/placed_meshes.h"
#include "surfaces/visible_lamps.h"

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
    return a->opaque == b->opaque && a->transparent == b->transparent && a->mesh->transforms == b->mesh->transforms &&
           a->mesh->seen_by == b->mesh->seen_by;
}

}  // namespace

CompiledScene::CompiledScene(const Vec3d& origin, std::span<const Light> lamps, const Scene& settings)
    : origin_(origin),
      placed_(std::make_unique<PlacedMeshes>()),
      environment_(settings.environment_),
      background_(settings.background_),
      background_visible_(settings.background_visible_),
      environment_group_(settings.environment_group_) {
    for (const Light& lamp : lamps) {
        lights_.push_back(origin == Vec3d(0) ? lamp : moved(lamp, -origin));
    }
    placed_->set_origin(origin);
}

CompiledScene::~CompiledScene() = default;

const VisibleLamps& CompiledScene::visible_lamps(LampViewer viewer) const {
    return visible_lamps_[static_cast<std::size_t>(viewer)];
}

void CompiledScene::build(std::span<const std::shared_ptr<const SceneMesh>> meshes, const CompiledScene* before,
                          const Stopped& stopped) {
    const std::size_t lamps = lights_.size();
    environment_ = environment_.prepared(before == nullptr ? Environment() : before->environment_, stopped);
    std::unordered_map<const MeshShape*, std::shared_ptr<const CompiledMesh>> of_shape;
    for (std::size_t i = 0; before != nullptr && i < before->placed_->meshes().size(); ++i) {
        const std::shared_ptr<const CompiledMesh>& mesh = before->placed_->meshes()[i];
        of_shape[mesh->mesh->shape.get()] = mesh;
    }
    std::vector<std::shared_ptr<const CompiledMesh>> compiled(meshes.size());
    tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t i) {
        const auto same = of_shape.find(meshes[i]->shape.get());
        compiled[i] = compile_mesh(meshes[i], origin_, same == of_shape.end() ? nullptr : same->second, stopped);
    });
    for (std::shared_ptr<const CompiledMesh>& mesh : compiled) {
        const auto first_instance = static_cast<std::uint32_t>(placed_->placements().size());
        for (Light light : mesh->lights) {
            if (auto* mesh_light = std::get_if<MeshLight>(&light)) {
                mesh_light->meshes.front().instance += first_instance;
            }
            lights_.push_back(std::move(light));
        }
        const auto first_material = static_cast<std::uint32_t>(materials_.size());
        for (std::size_t i = 0; i < mesh->mesh->material_count(); ++i) {
            materials_.push_back(mesh->mesh->material(i));
        }
        placed_->add(std::move(mesh), first_material);
    }
    join_mesh_lights(lamps, before, stopped);
    const auto first_delta =
        std::stable_partition(lights_.begin(), lights_.end(), [](const Light& light) { return !is_delta(light); });
    extended_light_count_ = static_cast<std::size_t>(first_delta - lights_.begin());
    build_rays(before, stopped);
    for (const LampViewer viewer : {LampViewer::camera, LampViewer::mirror, LampViewer::unblocked_mirror}) {
        visible_lamps_.emplace_back(lights_, viewer);
    }
    find_light_groups();
}

void CompiledScene::join_mesh_lights(std::size_t lamps, const CompiledScene* before, const Stopped& stopped) {
    const auto is_crowd = [](const std::shared_ptr<const CompiledMesh>& mesh) { return mesh->is_crowd; };
    if (lights_.size() - lamps <= kMostMeshLights && std::ranges::none_of(placed_->meshes(), is_crowd)) {
        return;
    }
    std::vector<PlacedEmitter> emitters;
    std::uint32_t first_instance = 0;
    for (const std::shared_ptr<const CompiledMesh>& mesh : placed_->meshes()) {
        if (mesh->is_crowd || !mesh->lights.empty()) {
            emitters.push_back({mesh, first_instance});
        }
        first_instance += static_cast<std::uint32_t>(mesh->mesh->transforms.size());
    }
    const bool knows = before != nullptr && before->joined_lights_ != nullptr;
    joined_lights_ = knows && before->joined_lights_->emitters == emitters
                         ? before->joined_lights_
                         : std::make_shared<const JoinedLights>(joined_lights(std::move(emitters), stopped));
    lights_.erase(lights_.begin() + static_cast<std::ptrdiff_t>(lamps), lights_.end());
    lights_.insert(lights_.end(), joined_lights_->lights.begin(), joined_lights_->lights.end());
}

void CompiledScene::build_rays(const CompiledScene* before, const Stopped& stopped) {
    if (before != nullptr && std::ranges::equal(placed_->meshes(), before->placed_->meshes(), meets_rays_alike)) {
        rays_ = std::make_unique<const SceneRays>(*before->rays_, *this);
        return;
    }
    std::vector<TracedInstance> opaque, transparent;
    for (const Placement& placement : placed_->placements()) {
        const CompiledMesh& mesh = *placed_->meshes()[placement.mesh];
        const glm::dmat4 to_world = placement.baked ? glm::dmat4(1) : placement.to_world;
        opaque.push_back({mesh.opaque, to_world, mesh.mesh->seen_by});
        transparent.push_back({mesh.transparent, to_world, mesh.mesh->seen_by});
    }
    rays_ = std::make_unique<const SceneRays>(std::move(opaque), std::move(transparent), *this, stopped);
}

/// Runs the programs of surfaces that shadow rays meet.
void CompiledScene::find(std::span<const Ray> rays, std::span<const RayHit> hits, std::uint32_t depth,
                         std::span<Rgb> passed, std::span<Rgb> entered) const {
    std::vector<ShadedPlace> places;
    std::vector<std::uint32_t> material, order(hits.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const SurfacePoint point = placed_->surface(hits[i], rays[i].direction);
        const Vec3d towards_viewer = -glm::normalize(Vec3d(rays[i].direction));
        const double length = glm::distance(point.position, Vec3d(rays[i].origin));
        places.emplace_back(point, hits[i], towards_viewer, length, depth);
        material.push_back(point.material);
    }
    std::iota(order.begin(), order.end(), 0U);
    std::vector<ShadedPlace> alike;
    std::vector<float> results;
    ShaderProgram::Registers registers;
    for_each_run(order, material, [&](std::span<const std::uint32_t> numbers) {
        const Material& own = materials_[material[numbers.front()]];
        alike.clear();
        for (const std::uint32_t i : numbers) {
            alike.push_back(places[i]);
        }
        const ShaderProgram& program = own.shader->shadow_program;
        results.resize(program.result_count() * alike.size());
        placed_->run(program, own, alike, {}, registers, results);
        for (std::size_t k = 0; k < alike.size(); ++k) {
            const bool leaves =
                own.shader->absorption != Rgb(0) && placed_->is_back(hits[numbers[k]], alike[k].at.towards_viewer);
            entered[numbers[k]] = leaves ? -own.shader->absorption : own.shader->absorption;
            for (int channel = 0; channel < 3; ++channel) {
                const float share = results[static_cast<std::size_t>(channel) * alike.size() + k];
                const bool stops = own.shader->blocks_shadow_rays && (rays[numbers[k]].kinds & kShadowRay) != 0;
                passed[numbers[k]][channel] = share > 0 && !stops ? share : 0.0F;
            }
        }
    });
}

void CompiledScene::find_light_groups() {
    if (!environment_.is_black() || !background_.is_black()) {
        light_groups_.push_back(environment_group_);
    }
    for (const Light& light : lights_) {
        light_groups_.push_back(traits_of(light).group);
    }
    for (const Material& material : materials_) {
        if (material.emission != Emission() || (material.shader != nullptr && material.shader->emission)) {
            light_groups_.push_back(material.group);
        }
    }
    std::sort(light_groups_.begin(), light_groups_.end());
    light_groups_.erase(std::unique(light_groups_.begin(), light_groups_.end()), light_groups_.end());
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

Scene::LampNumber Scene::add_lamp(Light lamp) {
    lamps_.emplace(next_lamp_, std::move(lamp));
    return next_lamp_++;
}

void Scene::set_lamp(LampNumber number, Light lamp) {
    const auto found = lamps_.find(number);
    if (found == lamps_.end()) {
        reject("light has been removed from its scene");
    }
    found->second = std::move(lamp);
}

void Scene::remove_lamp(LampNumber number) {
    if (lamps_.erase(number) == 0) {
        reject("light has been removed from its scene");
    }
}

Scene::LampNumber Scene::add_sphere_light(const Vec3d& center, double radius, const Rgb& radiance, bool facing_disk,
                                          const LightTraits& traits) {
    return add_lamp(make_sphere_light(center, radius, radiance, facing_disk, traits));
}

Scene::LampNumber Scene::add_polygon_light(std::vector<Vec3d> vertices, const Rgb& radiance, double spread,
                                           const LightTraits& traits) {
    return add_lamp(make_polygon_lamp(std::move(vertices), radiance, spread, traits));
}

Scene::LampNumber Scene::add_disk_light(const Vec3d& center, const Vec3d& half_axis_u, const Vec3d& half_axis_v,
                                        const Rgb& radiance, double spread, const LightTraits& traits) {
    return add_lamp(make_disk_lamp(center, half_axis_u, half_axis_v, radiance, spread, traits));
}

Scene::LampNumber Scene::add_point_light(const Vec3d& position, const Rgb& intensity, const LightTraits& traits) {
    return add_lamp(make_point_source(position, intensity, traits));
}

Scene::LampNumber Scene::add_spot_light(const Vec3d& position, const SpotProfile& profile, const Rgb& intensity,
                                        double radius, bool facing_disk, const LightTraits& traits) {
    return add_lamp(make_spot_light(position, profile, intensity, radius, facing_disk, traits));
}

Scene::LampNumber Scene::add_sun_light(const Vec3d& direction, double angle, const Rgb& irradiance, bool tangent,
                                       const LightTraits& traits) {
    return add_lamp(make_sun_light(direction, angle, irradiance, tangent, traits));
}

void Scene::set_environment(Environment environment, bool visible, std::uint32_t group,
                            const std::optional<Environment>& background) {
    environment_ = std::move(environment);
    background_ = background.value_or(environment_);
    background_visible_ = visible;
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
    for (const auto& [number, lamp] : lamps_) {
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
    std::vector<Light> lamps;
    std::ranges::transform(lamps_, std::back_inserter(lamps), [](const auto& lamp) { return lamp.second; });
    const std::shared_ptr<CompiledScene> compiled(new CompiledScene(origin, lamps, *this));
    std::vector<std::shared_ptr<const SceneMesh>> meshes;
    for (const auto& [number, mesh] : meshes_) {
        if (mesh->shape->part_count() > 0 && !mesh->transforms.empty()) {
            meshes.push_back(mesh);
            compiled->mesh_numbers_.push_back(number);
        }
    }
    const auto build = [&](const Watch& caller) { compiled->build(meshes, before, caller.stopped); };
    run_watched(threads, build, progress ? std::function<bool()>([&] { return progress(0); }) : nullptr);
    return compiled;
}

}  // namespace shlight
