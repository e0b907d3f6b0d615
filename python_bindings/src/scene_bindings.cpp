// SPDX-License-Identifier: MIT
#include "scene_bindings.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "bindings.h"
#include "mesh_arrays.h"
#include "whole_objects.h"

using namespace pybind11::literals;

namespace shlight::python {
namespace {

constexpr const char* kSceneDoc = R"(Meshes, curves, point clouds, lights and a camera in one world frame, in metres.

Scene() is empty. Add meshes and lights, set a camera, then call shlight.render().
What render() builds of a mesh is kept as long as the mesh stays as it is.
A copy, deep or not, and the Scene that it was made of do not change each other.

>>> scene = shlight.Scene()
>>> floor = scene.add_mesh([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], [[0, 1, 2], [0, 2, 3]])
>>> lamp = scene.add_sphere_light((0, 0, 1), 0.2, radiance=10)
>>> scene.irradiance([[0, 0, 0], [1, 0, 0]], (0, 0, 1))[:, 0].round(3)  # π L sin²σ cosθ
array([1.257, 0.444])
>>> lamp.radiance = (5, 5, 5))";

constexpr const char* kAddMeshDoc = R"(Add a triangle mesh. Surfaces are two-sided.

vertices: (n, 3).
triangles: (k, 3) integers, vertex indices.
normals: (n, 3) per vertex or (k, 3, 3) per triangle corner, of any length; None: flat triangles.
uvs: (n, 2) per vertex or (k, 3, 2) per triangle corner, or a dict of such arrays by name; shlight.nodes.uv() reads
    them.
colors, attributes: likewise, of one to four numbers per vertex, triangle or triangle corner; shlight.nodes.attribute()
    reads them.
bsdf: a Bsdf or a Shader of shlight.nodes, or a sequence with one per material; None: Bsdf.lambert(0.8).
emission: emitted radiance [W m^-2 sr^-1] of both sides: a number, RGB, or (m, 3) with one per material, or
    (m, 2, 3) with that of the front, from where a triangle's corners run counter-clockwise in the mesh's frame, and that of the back; None:
    none. Emissive faces light the scene, are seen by the camera and block light.
material_indices: (k,) integers, the material of each triangle; None: 0 for all.
transforms: (i, 4, 4), one object-to-world matrix per instance, for column vectors; None: one at the identity.
object_values: (i, v), numbers of each instance, which shlight.nodes.object_value() reads.
group: name of the light group of what it emits, or None.
object_names, asset_names: what Cryptomatte knows its instances by: one string for all, or one for each instance.
object_indices: integers >= 0 for the pass object_index: one for all, or one for each instance.
material_names, material_pass_indices: likewise, of its materials.
turn_normals: whether normals that lie on the back of their triangle are turned to its front. Otherwise their light comes
    from that side, as in Cycles: closed meshes are black there.
terminator_geometry_offset, terminator_shading_offset: 0 ... 1, against flat triangles that show at the edge of a smooth
    mesh's own shadow, as in Cycles. The first is the cosine of the light to a triangle below which shadow rays start
    on the smooth surface that its normals describe; the second lets the light end earlier.
visible_to: names of the kinds of rays that meet it: "camera", "diffuse" and "glossy" from surfaces that reflect so,
    "transmission" through glass, "shadow" towards lights; None: all. What it emits lights diffuse and glossy surfaces alike.
holdout: the camera sees nothing there, and the picture is transparent; what is behind shows as far as the mesh is.
light_set: 0 ... 63, shadow_set: 0 ... 27: numbers by which lights tell what they light, and what blocks them.
receivers, blockers: numbers of the light sets that its emission lights, and of the shadow sets that block it; None: all.
    What has the shadow set of a mesh that shines blocks its light too.

Returns the SceneMesh, which can be changed and removed.
Raises ValueError naming the argument; the scene is then as it was.)";

constexpr const char* kAddCurvesDoc = R"(Add hair: curves that are Catmull-Rom splines through their points.

points: (n, 3), of one curve after the other.
radii: [m], not negative: a number, or (n,) with one per point.
first: (c,) integers, the number of each curve's first point; the first is 0, and a curve has two points or more.
ribbons: whether the curves are flat, turned to each ray, and shaded as tubes, which is fast; otherwise they are tubes.
subdivisions: 1 ... 16, the straight pieces of a ribbon between two points.
uvs: (n, 2) per point or (c, 2) per curve, or a dict of such arrays by name; shlight.nodes.uv() reads them.
attributes: likewise, of one to four numbers; shlight.nodes.attribute() reads them. They are linear between points.
material_indices: (c,) integers, the material of each curve; None: 0 for all.
emission: as of Scene.add_mesh. Curves are seen to shine; they light nothing but by bounces.
bsdf, transforms, object_values, group, object_names, asset_names, object_indices, material_names,
    material_pass_indices, terminator_shading_offset, visible_to, holdout, light_set, shadow_set: as of Scene.add_mesh.

A transform scales curves as it scales a mesh: where it is uneven, tubes are no longer round.
Tubes are met from outside alone. Returns the SceneMesh, which can be changed and removed.
Raises ValueError naming the argument; the scene is then as it was.)";

constexpr const char* kAddPointCloudDoc = R"(Add a cloud of spheres.

points: (n, 3), the centres.
radii: [m], not negative: a number, or (n,).
uvs, attributes, material_indices: as of Scene.add_curves, one for each sphere.
emission: as of Scene.add_mesh. Spheres are seen to shine; they light nothing but by bounces.
bsdf, transforms, object_values, group, object_names, asset_names, object_indices, material_names,
    material_pass_indices, terminator_shading_offset, visible_to, holdout, light_set, shadow_set: as of Scene.add_mesh.

A transform scales spheres as it scales a mesh; the normals of uneven ones point away from their centres, as in Cycles.
Spheres are met from outside alone. Returns the SceneMesh, which can be changed and removed.
Raises ValueError naming the argument; the scene is then as it was.)";

constexpr const char* kSceneMeshDoc = R"(A mesh, curves or a cloud of a Scene, as Scene.add_mesh and its like return it.

It belongs to that scene alone; copies of the scene have meshes of their own. A render that runs shows what was there
when it began. All methods raise ValueError once the mesh has been removed.)";

constexpr const char* kSetBsdfDoc = R"(Give the mesh other materials; arguments as of Scene.add_mesh.

Raises ValueError naming the argument; the mesh is then as it was.)";

constexpr const char* kSetTransformsDoc =
    R"(Place the mesh elsewhere; arguments as of Scene.add_mesh.

Raises ValueError naming the argument; the mesh is then as it was.)";

constexpr const char* kEnvironmentDoc =
    R"(Set the light that comes from infinitely far all around; it takes the place of the one before.

radiance: [W m^-2 sr^-1], not negative: a number or RGB, the same from everywhere, or (height, width, 3), a
    picture of all directions in equal steps of latitude and longitude, bilinear between the centres of its texels. Row 0 lies around +z; columns
    go from -x over +y, +x (the middle) and -y back to -x, as in Blender.
to_world: (3, 3), a rotation of the picture, for column vectors; None: none.
visible: the camera sees it behind the scene, where the picture is then opaque.
background: what the camera sees there in its place, as radiance, in the same frame; None: radiance.
group: name of its light group, or None.

Raises ValueError naming the argument.)";

/// A mesh of a scene; it keeps the scene alive.
struct MeshHandle {
    py::object owner;
    Scene::MeshNumber number;
    AttributeNames names;

    SceneObject& scene() const { return owner.cast<SceneObject&>(); }
};

template <class Shape>
MeshHandle add_shape(const py::object& self, const Shape& shape, const SurfaceArguments& arguments) {
    MeshHandle handle = {self, 0, {}};
    SceneObject& scene = handle.scene();
    handle.number = scene.scene.add_mesh(mesh_from(shape, arguments, handle.names, scene));
    scene.changed();
    return handle;
}

MeshHandle add_mesh(const py::object& self, const py::object& vertices, const py::object& triangles,
                    const py::object& normals, const py::object& uvs, const py::object& colors,
                    const py::object& attributes, const py::object& bsdf, const py::object& emission,
                    const py::object& material_indices, const py::object& transforms, const py::object& object_values,
                    const py::object& group, const py::object& object_names, const py::object& asset_names,
                    const py::object& object_indices, const py::object& material_names,
                    const py::object& material_pass_indices, const py::object& turn_normals,
                    const py::object& terminator_geometry_offset, const py::object& terminator_shading_offset,
                    const py::object& visible_to, const py::object& holdout, const py::object& light_set,
                    const py::object& shadow_set, const py::object& receivers, const py::object& blockers) {
    return add_shape(self, TriangleArguments{vertices, triangles, normals},
                     {uvs,
                      colors,
                      attributes,
                      material_indices,
                      {bsdf, emission, group, material_names, material_pass_indices},
                      {transforms, object_values, object_names, asset_names, object_indices},
                      turn_normals,
                      terminator_geometry_offset,
                      terminator_shading_offset,
                      visible_to,
                      holdout,
                      {light_set, shadow_set, receivers, blockers}});
}

MeshHandle add_curves(const py::object& self, const py::object& points, const py::object& radii,
                      const py::object& first, const py::object& ribbons, const py::object& subdivisions,
                      const py::object& uvs, const py::object& attributes, const py::object& bsdf,
                      const py::object& emission, const py::object& material_indices, const py::object& transforms,
                      const py::object& object_values, const py::object& group, const py::object& object_names,
                      const py::object& asset_names, const py::object& object_indices, const py::object& material_names,
                      const py::object& material_pass_indices, const py::object& terminator_shading_offset,
                      const py::object& visible_to, const py::object& holdout, const py::object& light_set,
                      const py::object& shadow_set) {
    const SurfaceForm form = flag_from("ribbons", ribbons) ? SurfaceForm::ribbons : SurfaceForm::tubes;
    return add_shape(self, RoundArguments{form, points, radii, first, subdivisions},
                     {uvs,
                      py::none(),
                      attributes,
                      material_indices,
                      {bsdf, emission, group, material_names, material_pass_indices},
                      {transforms, object_values, object_names, asset_names, object_indices},
                      py::bool_(true),
                      py::float_(0.0),
                      terminator_shading_offset,
                      visible_to,
                      holdout,
                      {light_set, shadow_set}});
}

MeshHandle add_point_cloud(const py::object& self, const py::object& points, const py::object& radii,
                           const py::object& uvs, const py::object& attributes, const py::object& bsdf,
                           const py::object& emission, const py::object& material_indices, const py::object& transforms,
                           const py::object& object_values, const py::object& group, const py::object& object_names,
                           const py::object& asset_names, const py::object& object_indices,
                           const py::object& material_names, const py::object& material_pass_indices,
                           const py::object& terminator_shading_offset, const py::object& visible_to,
                           const py::object& holdout, const py::object& light_set, const py::object& shadow_set) {
    return add_shape(self, RoundArguments{SurfaceForm::spheres, points, radii, py::none(), py::none()},
                     {uvs,
                      py::none(),
                      attributes,
                      material_indices,
                      {bsdf, emission, group, material_names, material_pass_indices},
                      {transforms, object_values, object_names, asset_names, object_indices},
                      py::bool_(true),
                      py::float_(0.0),
                      terminator_shading_offset,
                      visible_to,
                      holdout,
                      {light_set, shadow_set}});
}

void set_bsdf(const MeshHandle& self, const py::object& bsdf, const py::object& emission, const py::object& group,
              const py::object& material_names, const py::object& material_pass_indices) {
    SceneObject& scene = self.scene();
    auto use = MeshUse(static_cast<const MeshUse&>(scene.scene.mesh(self.number)));
    set_materials(use, self.names, {bsdf, emission, group, material_names, material_pass_indices}, scene);
    scene.scene.use_mesh(self.number, std::move(use));
    scene.changed();
}

void set_transforms(const MeshHandle& self, const py::object& transforms, const py::object& object_values,
                    const py::object& object_names, const py::object& asset_names, const py::object& object_indices) {
    SceneObject& scene = self.scene();
    auto use = MeshUse(static_cast<const MeshUse&>(scene.scene.mesh(self.number)));
    set_places(use, {transforms, object_values, object_names, asset_names, object_indices});
    scene.scene.use_mesh(self.number, std::move(use));
    scene.changed();
}

/// The use of a mesh that has one instance.
MeshUse single_use(const MeshHandle& self) {
    const auto& use = static_cast<const MeshUse&>(self.scene().scene.mesh(self.number));
    if (use.transforms.size() != 1) {
        throw std::invalid_argument("to_world is of a mesh with one instance; this one has " +
                                    std::to_string(use.transforms.size()) + ": call set_transforms");
    }
    return use;
}

void set_place(const MeshHandle& self, const py::object& to_world) {
    MeshUse use = single_use(self);
    use.transforms.front() = place_from("to_world", to_world);
    self.scene().scene.use_mesh(self.number, std::move(use));
    self.scene().changed();
}

void set_group(const MeshHandle& self, const py::object& group) {
    auto use = MeshUse(static_cast<const MeshUse&>(self.scene().scene.mesh(self.number)));
    use.group = group_from(self.scene(), group);
    self.scene().scene.use_mesh(self.number, std::move(use));
    self.scene().changed();
}

std::string counted(std::size_t count, const char* name, const char* plural) {
    return std::to_string(count) + " " + (count == 1 ? name : plural);
}

std::string repr_of_mesh(const MeshHandle& self) {
    try {
        const SceneMesh& mesh = self.scene().scene.mesh(self.number);
        const MeshShape& shape = *mesh.shape;
        const std::string part = shape.form == SurfaceForm::triangles ? "triangle"
                                 : shape.is_curved()                  ? "curve"
                                                                      : "sphere";
        return "SceneMesh(index=" + std::to_string(self.number) + ", " +
               counted(shape.part_count(), part.c_str(), (part + "s").c_str()) + ", " +
               counted(mesh.transforms.size(), "instance", "instances") + ")";
    } catch (const std::invalid_argument&) {
        return "SceneMesh(removed)";
    }
}

std::string repr_of(const SceneObject& self) {
    return "Scene(" + counted(self.scene.mesh_count(), "mesh", "meshes") + ", " +
           counted(self.scene.lamp_count(), "light", "lights") +
           (self.scene.environment().is_black() ? "" : ", an environment") + (self.camera ? ", a camera" : "") + ")";
}

void remove_mesh(const MeshHandle& self) {
    self.scene().scene.remove_mesh(self.number);
    self.scene().changed();
}

void remove_lights(SceneObject& self) {
    self.scene.remove_lamps();
    self.lamps.clear();
    self.changed();
}

void set_environment(SceneObject& self, const py::object& radiance, const py::object& to_world,
                     const py::object& visible, const py::object& group, const py::object& background) {
    const glm::dmat3 rotation = to_world.is_none() ? glm::dmat3(1) : rotation_from("to_world", to_world);
    const bool seen = flag_from("visible", visible);
    std::optional<Environment> shown;
    if (!background.is_none()) {
        shown = environment_from("background", background, rotation);
    }
    Environment light = environment_from("radiance", radiance, rotation);
    self.scene.set_environment(std::move(light), seen, group_from(self, group), shown);
    self.changed();
}

}  // namespace

std::uint32_t group_from(SceneObject& scene, const py::object& name) {
    if (name.is_none()) {
        return 0;
    }
    const std::string wanted = py::isinstance<py::str>(name) ? name.cast<std::string>() : std::string();
    if (wanted.empty()) {
        throw std::invalid_argument("group must be a string that is not empty, or None");
    }
    const auto known = std::find(scene.groups.begin(), scene.groups.end(), wanted);
    const auto number = static_cast<std::uint32_t>(known - scene.groups.begin()) + 1;
    if (known == scene.groups.end()) {
        scene.groups.push_back(wanted);
    }
    return number;
}

py::object group_name(const SceneObject& scene, std::uint32_t group) {
    return group == 0 ? py::object(py::none()) : py::object(py::str(scene.groups[group - 1]));
}

std::uint32_t aov_number(SceneObject& scene, const std::string& name, bool is_color) {
    const std::pair wanted(name, is_color);
    const auto known = std::find(scene.aovs.begin(), scene.aovs.end(), wanted);
    const auto number = static_cast<std::uint32_t>(known - scene.aovs.begin());
    if (known == scene.aovs.end()) {
        scene.aovs.push_back(wanted);
    }
    return number;
}

void bind_scene(py::module_& m) {
    py::class_<MeshHandle>(m, "SceneMesh", kSceneMeshDoc, without_constructor())
        .def("set_bsdf", &set_bsdf, kSetBsdfDoc, "bsdf"_a, py::kw_only(), "emission"_a = py::none(),
             "group"_a = py::none(), "material_names"_a = py::none(), "material_pass_indices"_a = py::none())
        .def("set_transforms", &set_transforms, kSetTransformsDoc, "transforms"_a, py::kw_only(),
             "object_values"_a = py::none(), "object_names"_a = py::none(), "asset_names"_a = py::none(),
             "object_indices"_a = py::none())
        .def("remove", &remove_mesh, "Take the mesh out of its scene.")
        .def_property(
            "to_world", [](const MeshHandle& self) { return array_of(single_use(self).transforms.front()); },
            &set_place, "(4, 4), for column vectors: the place of a mesh with one instance.")
        .def_property(
            "group",
            [](const MeshHandle& self) { return group_name(self.scene(), self.scene().scene.mesh(self.number).group); },
            &set_group, "The name of the light group of what it emits, or None.")
        .def("__repr__", &repr_of_mesh)
        .def_property_readonly(
            "index", [](const MeshHandle& self) { return self.number; },
            "Hits.mesh of rays that meet it: the number of meshes that were added to the scene before, removed ones\n"
            "among them.");
    py::class_<SceneObject> scene(m, "Scene", kSceneDoc, constructed_when_new());
    scene.def(py::init<>())
        .def("__repr__", &repr_of)
        .def("__copy__", [](const SceneObject& self) { return self; })
        .def(
            "__deepcopy__", [](const SceneObject& self, const py::object&) { return self; }, "memo"_a)
        .def("__reduce__",
             [](const SceneObject&) -> py::object {
                 throw py::type_error(
                     "a Scene cannot be pickled: build it in the process that renders it, from arrays "
                     "and materials, which can");
             })
        .def("add_mesh", &add_mesh, kAddMeshDoc, "vertices"_a, "triangles"_a, py::kw_only(), "normals"_a = py::none(),
             "uvs"_a = py::none(), "colors"_a = py::none(), "attributes"_a = py::none(), "bsdf"_a = py::none(),
             "emission"_a = py::none(), "material_indices"_a = py::none(), "transforms"_a = py::none(),
             "object_values"_a = py::none(), "group"_a = py::none(), "object_names"_a = py::none(),
             "asset_names"_a = py::none(), "object_indices"_a = py::none(), "material_names"_a = py::none(),
             "material_pass_indices"_a = py::none(), "turn_normals"_a = true, "terminator_geometry_offset"_a = 0.0,
             "terminator_shading_offset"_a = 0.0, "visible_to"_a = py::none(), "holdout"_a = false, "light_set"_a = 0,
             "shadow_set"_a = 0, "receivers"_a = py::none(), "blockers"_a = py::none())
        .def("add_curves", &add_curves, kAddCurvesDoc, "points"_a, "radii"_a, "first"_a, py::kw_only(),
             "ribbons"_a = true, "subdivisions"_a = 5, "uvs"_a = py::none(), "attributes"_a = py::none(),
             "bsdf"_a = py::none(), "emission"_a = py::none(), "material_indices"_a = py::none(),
             "transforms"_a = py::none(), "object_values"_a = py::none(), "group"_a = py::none(),
             "object_names"_a = py::none(), "asset_names"_a = py::none(), "object_indices"_a = py::none(),
             "material_names"_a = py::none(), "material_pass_indices"_a = py::none(),
             "terminator_shading_offset"_a = 0.0, "visible_to"_a = py::none(), "holdout"_a = false, "light_set"_a = 0,
             "shadow_set"_a = 0)
        .def("add_point_cloud", &add_point_cloud, kAddPointCloudDoc, "points"_a, "radii"_a, py::kw_only(),
             "uvs"_a = py::none(), "attributes"_a = py::none(), "bsdf"_a = py::none(), "emission"_a = py::none(),
             "material_indices"_a = py::none(), "transforms"_a = py::none(), "object_values"_a = py::none(),
             "group"_a = py::none(), "object_names"_a = py::none(), "asset_names"_a = py::none(),
             "object_indices"_a = py::none(), "material_names"_a = py::none(), "material_pass_indices"_a = py::none(),
             "terminator_shading_offset"_a = 0.0, "visible_to"_a = py::none(), "holdout"_a = false, "light_set"_a = 0,
             "shadow_set"_a = 0)
        .def("remove_lights", &remove_lights,
             "Take out all lights that the add_..._light methods have added; emissive meshes and the environment stay.")
        .def("set_environment", &set_environment, kEnvironmentDoc, "radiance"_a, py::kw_only(),
             "to_world"_a = py::none(), "visible"_a = true, "group"_a = py::none(), "background"_a = py::none());
    bind_cameras(scene);
    bind_lights(m, scene);
    bind_queries(scene);
    bind_views(m, scene);
}

}  // namespace shlight::python
