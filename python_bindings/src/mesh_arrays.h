// SPDX-License-Identifier: MIT
//
// Conversion of numpy arrays to the core's scene types. Errors as in arguments.h.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "scene_bindings.h"
#include "shlight/environment.h"
#include "shlight/mesh.h"
#include "shlight/types.h"

namespace shlight::python {

/// Shape (3,).
Vec3d vector_from(const char* name, const pybind11::handle& value);
/// Shape (n, 3).
std::vector<Vec3d> points_from(const char* name, const pybind11::handle& value);
/// A lamp's frame, see make_spot_profile(): its axes as columns, shape (3, 3), or the direction in which it shines,
/// (3,).
glm::dmat3 axes_from(const char* name, const pybind11::handle& value);
/// Shape (4, 4), to be multiplied with column vectors.
glm::dmat4 matrix_from(const char* name, const pybind11::handle& value);

/// The same of a transform that is affine and invertible.
glm::dmat4 place_from(const char* name, const pybind11::handle& value);
/// Shape (4, 4).
pybind11::array array_of(const glm::dmat4& matrix);

/// Shape (3, 3), to be multiplied with column vectors.
glm::dmat3 rotation_from(const char* name, const pybind11::handle& value);
/// A radiance, a number or shape (3,), or a lat-long picture, shape (height, width, 3), rotated by `to_world`.
Environment environment_from(const char* name, const pybind11::handle& value, const glm::dmat3& to_world);

/// Arguments of Scene.add_mesh about materials; None if they are omitted.
struct MaterialArguments {
    pybind11::object bsdf, emission, group, names, pass_indices;
};

/// Arguments about instances.
struct PlaceArguments {
    pybind11::object transforms, object_values, object_names, asset_names, object_indices;
};

/// Arguments about light linking.
struct LinkArguments {
    pybind11::object light_set, shadow_set, receivers = pybind11::none(), blockers = pybind11::none();
};

/// Arguments that meshes, curves and point clouds share.
struct SurfaceArguments {
    pybind11::object uvs, colors, attributes, material_indices;
    MaterialArguments materials;
    PlaceArguments places;
    pybind11::object turn_normals, terminator_geometry_offset, terminator_shading_offset, visible_to, holdout;
    LinkArguments links;
};

/// The arguments of Scene.add_mesh about its triangles.
struct TriangleArguments {
    pybind11::object vertices, triangles, normals;
};

/// The arguments of Scene.add_curves and Scene.add_point_cloud about their curves and spheres.
struct RoundArguments {
    SurfaceForm form;
    pybind11::object points, radii, first, subdivisions;  // of spheres: no `first`
};

/// The names of a mesh's attributes, in their order.
using AttributeNames = std::vector<std::string>;

/// None: all.
LightLinks links_from(const pybind11::object& receivers, const pybind11::object& blockers);

/// Checks shapes and types; Scene::add_mesh checks the rest. names: output, the mesh's attributes. Groups and AOVs are
/// added to the scene's lists, also by the functions below.
Mesh mesh_from(const TriangleArguments& shape, const SurfaceArguments& arguments, AttributeNames& names,
               SceneObject& scene);
Mesh mesh_from(const RoundArguments& shape, const SurfaceArguments& arguments, AttributeNames& names,
               SceneObject& scene);
void set_materials(MeshUse& use, const AttributeNames& names, const MaterialArguments& arguments, SceneObject& scene);
void set_places(MeshUse& use, const PlaceArguments& arguments);

}  // namespace shlight::python
