// SPDX-License-Identifier: MIT
//
// numpy arrays → what the core's scene holds. Errors as of arguments.h.
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
/// A radiance: shape (3,).
Rgb rgb_from(const char* name, const pybind11::handle& value);
/// Shape (n, 3).
std::vector<Vec3d> points_from(const char* name, const pybind11::handle& value);
/// A lamp's frame, see make_spot_profile: its axes as columns, shape (3, 3), or the way it shines, (3,).
glm::dmat3 axes_from(const char* name, const pybind11::handle& value);
/// Shape (4, 4), to be multiplied with column vectors.
glm::dmat4 matrix_from(const char* name, const pybind11::handle& value);

/// Shape (3, 3), to be multiplied with column vectors.
glm::dmat3 rotation_from(const char* name, const pybind11::handle& value);
/// A radiance, shape (3,), or a lat-long picture, shape (height, width, 3), which `to_world` turns.
Environment environment_from(const char* name, const pybind11::handle& value, const glm::dmat3& to_world);

/// Arguments of Scene.add_mesh about materials; None where Python leaves one out.
struct MaterialArguments {
    pybind11::object bsdf, emission, group, names, pass_indices;
};

/// Those about instances.
struct PlaceArguments {
    pybind11::object transforms, object_values, object_names, asset_names, object_indices;
};

/// All of them.
struct MeshArguments {
    pybind11::object vertices, triangles, normals, uvs, colors, attributes, material_indices;
    MaterialArguments materials;
    PlaceArguments places;
};

/// The names of a mesh's attributes, in their order.
using AttributeNames = std::vector<std::string>;

/// Shapes and types are checked here, the rest by Scene::add_mesh. names: is given those of the mesh. Groups and AOVs
/// become known to the scene, here and below.
Mesh mesh_from(const MeshArguments& arguments, AttributeNames& names, SceneObject& scene);
void set_materials(MeshUse& use, const AttributeNames& names, const MaterialArguments& arguments, SceneObject& scene);
void set_places(MeshUse& use, const PlaceArguments& arguments);

}  // namespace shlight::python
