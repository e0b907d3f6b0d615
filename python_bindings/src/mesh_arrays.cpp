// SPDX-License-Identifier: MIT
#include "mesh_arrays.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include "arguments.h"
#include "gil.h"
#include "shader_bindings.h"
#include "shlight/emission_profile.h"
#include "shlight/render_passes.h"

namespace shlight::python {
namespace {

constexpr py::ssize_t kAny = -1;

std::string describe(std::initializer_list<py::ssize_t> shape) {
    std::string text = "(";
    for (const py::ssize_t size : shape) {
        text += (text.size() > 1 ? ", " : "") + (size == kAny ? "n" : std::to_string(size));
    }
    return text + ")";
}

bool fits(const py::array& array, std::initializer_list<py::ssize_t> shape) {
    if (array.ndim() != static_cast<py::ssize_t>(shape.size())) {
        return false;
    }
    py::ssize_t axis = 0;
    for (const py::ssize_t size : shape) {
        if (size != kAny && array.shape(axis) != size) {
            return false;
        }
        ++axis;
    }
    return true;
}

template <class T>
AnyArray<T> numbers(const char* name, const py::handle& value, std::initializer_list<py::ssize_t> shape) {
    AnyArray<T> array = array_from<T>(name, value);
    if (!fits(array, shape)) {
        throw std::invalid_argument(std::string(name) + " must have shape " + describe(shape));
    }
    return array;
}

/// Integers in 0 … 2³² - 1.
std::vector<std::uint32_t> indices(const char* name, const py::handle& value,
                                   std::initializer_list<py::ssize_t> shape) {
    // An empty list has numpy's default type, float.
    const py::array raw = py::array::ensure(value);
    const bool empty = raw && raw.size() == 0;
    const auto array = array_from<std::int64_t>(name, value, empty ? "fiu" : "iu");
    if (!fits(array, shape)) {
        throw std::invalid_argument(std::string(name) + " must have shape " + describe(shape));
    }
    std::vector<std::uint32_t> result(static_cast<std::size_t>(array.size()));
    for (std::size_t i = 0; i < result.size(); ++i) {
        const std::int64_t index = array.data()[i];
        if (index < 0 || index > 0xFFFFFFFFLL) {
            throw std::invalid_argument(std::string(name) + ": " + std::to_string(index) + " is out of range");
        }
        result[i] = static_cast<std::uint32_t>(index);
    }
    return result;
}

template <class T>
std::vector<Vec3<T>> copy_vectors(const char* name, const AnyArray<T>& array) {
    const std::span<const Vec3<T>> all = vectors(name, array);
    return {all.begin(), all.end()};
}

glm::dmat4 matrix_at(const double* rows) {
    glm::dmat4 matrix(1);
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) {
            matrix[column][row] = rows[4 * row + column];
        }
    }
    return matrix;
}

/// The items of a sequence; empty for objects that are not iterable, such as arrays without axes.
py::list items_of(const py::object& value) {
    try {
        return py::list(value);
    } catch (const py::error_already_set& error) {
        if (!error.matches(PyExc_TypeError)) {
            throw;
        }
        return py::list();
    }
}

std::uint32_t attribute_index(const AttributeNames& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? MeshShader::kNoAttribute : static_cast<std::uint32_t>(found - names.begin());
}

/// item: a Bsdf, or an object with a method `compiled` that returns a shader.
void add_material(MeshUse& use, const AttributeNames& names, const py::handle& item, SceneObject& scene) {
    use.bsdfs.emplace_back();
    use.shaders.emplace_back();
    if (py::isinstance<Bsdf>(item)) {
        use.bsdfs.back() = item.cast<Bsdf>();
        return;
    }
    if (!py::hasattr(item, "compiled")) {
        throw std::invalid_argument("bsdf must be a Bsdf, a shader of shlight.nodes, or a sequence of them");
    }
    const auto shader = item.attr("compiled")().cast<ShaderObject>();
    use.shaders.back().shader = shader.shader;
    for (const std::string& name : shader.attribute_names) {
        use.shaders.back().attributes.push_back(attribute_index(names, name));
    }
    for (std::size_t i = 0; i < shader.aov_names.size(); ++i) {
        use.shaders.back().aovs.push_back(aov_number(scene, shader.aov_names[i], shader.shader->aovs[i].is_color));
    }
}

void set_bsdfs(MeshUse& use, const AttributeNames& names, const py::object& value, SceneObject& scene) {
    use.shaders.clear();
    use.bsdfs.clear();
    if (value.is_none()) {
        use.bsdfs = {Bsdf::lambert(Rgb(0.8F))};
        return;
    }
    if (py::isinstance<Bsdf>(value) || py::hasattr(value, "compiled")) {
        add_material(use, names, value, scene);
    } else {
        for (const py::handle item : items_of(value)) {
            add_material(use, names, item, scene);
        }
    }
    if (use.bsdfs.empty()) {
        throw std::invalid_argument("bsdf must be a Bsdf or a sequence of at least one");
    }
    const bool constant = std::all_of(use.shaders.begin(), use.shaders.end(),
                                      [](const MeshShader& shader) { return shader.shader == nullptr; });
    if (constant) {
        use.shaders.clear();
    }
}

/// The names of a shape's vertices and parts.
std::pair<const char*, const char*> names_of_parts(const MeshShape& shape) {
    return shape.form == SurfaceForm::triangles ? std::pair("vertices", "triangles")
           : shape.is_curved()                  ? std::pair("points", "curves")
                                                : std::pair("points", "spheres");
}

/// (n,) or (n, c) for n vertices or parts; (k, 3) or (k, 3, c) for corners.
MeshAttribute attribute_from(const std::string& name, const MeshShape& mesh, const py::handle& value) {
    const AnyArray<float> array = array_from<float>(name.c_str(), value);
    const auto vertex_count = static_cast<py::ssize_t>(mesh.vertices.size());
    const auto triangle_count = static_cast<py::ssize_t>(mesh.triangles.size());
    const bool has_rows = array.ndim() >= 1;
    const bool of_corners = array.ndim() == 3 && fits(array, {triangle_count, 3, kAny});
    const auto part_count = static_cast<py::ssize_t>(mesh.part_count());
    const bool of_rows =
        has_rows && array.ndim() <= 2 && (array.shape(0) == vertex_count || array.shape(0) == part_count);
    const py::ssize_t components = array.ndim() == 1 ? 1 : has_rows ? array.shape(array.ndim() - 1) : 0;
    if (!(of_corners || of_rows) || components < 1 || components > 4) {
        const auto [vertices, parts] = names_of_parts(mesh);
        throw std::invalid_argument(
            name + " must have one to four numbers for each of " + std::to_string(vertex_count) + " " + vertices +
            " or " + std::to_string(part_count) + " " + parts +
            (mesh.form == SurfaceForm::triangles ? ", or shape (triangles, 3, components)" : ""));
    }
    if (name == "uvs" && components != 2) {
        throw std::invalid_argument("uvs must have two numbers for each vertex, part or corner");
    }
    const auto all = values(array);
    check_all_finite(name.c_str(), all);
    return {static_cast<std::uint32_t>(components), {all.begin(), all.end()}};
}

/// value: one array, named by the argument, or a dict of arrays.
void add_attributes(MeshShape& mesh, AttributeNames& names, const std::string& argument, const py::object& value) {
    if (value.is_none()) {
        return;
    }
    if (!py::isinstance<py::dict>(value)) {
        mesh.attributes.push_back(attribute_from(argument, mesh, value));
        names.push_back(argument);
        return;
    }
    for (const auto& [key, array] : value.cast<py::dict>()) {
        const auto name = py::str(key).cast<std::string>();
        std::string place = argument;
        place.append("['").append(name).append("']");
        mesh.attributes.push_back(attribute_from(place, mesh, array));
        names.push_back(name);
    }
}

/// Identities of names: one string for all, or one for each of `count`; 0 for None.
std::vector<float> identities(const char* name, const py::object& value, std::size_t count) {
    if (value.is_none()) {
        return std::vector<float>(count);
    }
    if (py::isinstance<py::str>(value)) {
        return std::vector<float>(count, cryptomatte_id(value.cast<std::string>()));
    }
    std::vector<float> result;
    for (const py::handle item : items_of(value)) {
        if (!py::isinstance<py::str>(item)) {
            throw std::invalid_argument(std::string(name) + " must be strings");
        }
        result.push_back(cryptomatte_id(item.cast<std::string>()));
    }
    if (result.size() != count) {
        throw std::invalid_argument(std::string(name) + " must be one string, or " + std::to_string(count));
    }
    return result;
}

/// Pass indices: one integer for all, or one for each of `count`; 0 for None.
std::vector<float> pass_indices(const char* name, const py::object& value, std::size_t count) {
    if (value.is_none()) {
        return std::vector<float>(count);
    }
    const bool is_one = py::isinstance<py::int_>(value);
    const py::object all = is_one ? py::object(py::make_tuple(value)) : value;
    const std::vector<std::uint32_t> own = indices(name, all, {is_one ? 1 : static_cast<py::ssize_t>(count)});
    std::vector<float> result(count);
    for (std::size_t i = 0; i < count; ++i) {
        result[i] = static_cast<float>(own[is_one ? 0 : i]);
    }
    return result;
}

std::vector<Emission> emission_from(const py::object& value) {
    if (value.is_none()) {
        return {Rgb(0)};
    }
    const AnyArray<float> array = array_from<float>("emission", value);
    const bool has_sides = fits(array, {kAny, 2, 3});
    if (array.ndim() == 0) {
        return {Rgb(*array.data())};
    }
    if (!fits(array, {3}) && !((fits(array, {kAny, 3}) || has_sides) && array.size() > 0)) {
        throw std::invalid_argument("emission must be a number or have shape (3,), (m, 3) or (m, 2, 3)");
    }
    const std::span<const Rgb> all = vectors("emission", array);
    std::vector<Emission> result;
    for (std::size_t i = 0; i < all.size(); i += has_sides ? 2 : 1) {
        result.emplace_back(all[i], all[has_sides ? i + 1 : i]);
    }
    return result;
}

constexpr std::array<std::pair<std::string_view, RayKind>, 5> kRayKinds = {
    std::pair(std::string_view("camera"), kCameraRay),
    {"diffuse", kDiffuseRay},
    {"glossy", kGlossyRay},
    {"transmission", kTransmissionRay},
    {"shadow", kShadowRay}};

bool is_collection(const py::object& given) {
    return py::isinstance<py::list>(given) || py::isinstance<py::tuple>(given) || py::isinstance<py::anyset>(given);
}

/// The bits of kinds by their names.
std::uint32_t ray_kinds_from(const char* name, const py::object& names) {
    const auto refuse = [&](const py::handle& given) {
        throw std::invalid_argument(std::string(name) +
                                    " must be some of camera, diffuse, glossy, transmission and shadow, got " +
                                    (py::isinstance<py::str>(given) ? py::str(given).cast<std::string>()
                                                                    : std::string(Py_TYPE(given.ptr())->tp_name)));
    };
    const bool is_one = py::isinstance<py::str>(names);
    if (!is_one && !is_collection(names)) {
        refuse(names);
    }
    std::uint32_t kinds = 0;
    for (const py::handle& item : is_one ? py::make_tuple(names) : py::tuple(names)) {
        const auto known = std::ranges::find_if(kRayKinds, [&](const auto& own) {
            return py::isinstance<py::str>(item) && item.cast<std::string>() == own.first;
        });
        if (known == kRayKinds.end()) {
            refuse(item);
        }
        kinds |= known->second;
    }
    return kinds;
}

/// Bits of the sets with these numbers, which are below `count`.
std::uint64_t set_bits(const char* name, const py::object& numbers, std::uint32_t count) {
    if (!is_collection(numbers)) {
        throw std::invalid_argument(std::string(name) + " must be a list, tuple or set of integers, or None");
    }
    std::uint64_t bits = 0;
    for (const py::handle number : py::tuple(numbers)) {
        bits |= std::uint64_t{1} << integer_from(name, number, 0, count - 1);
    }
    return bits;
}

/// All but the triangles, curves or spheres, which the mesh has.
Mesh completed(Mesh mesh, const SurfaceArguments& arguments, AttributeNames& names, SceneObject& scene) {
    add_attributes(mesh, names, "uvs", arguments.uvs);
    mesh.uv = names.empty() ? MeshShader::kNoAttribute : 0;
    add_attributes(mesh, names, "colors", arguments.colors);
    add_attributes(mesh, names, "attributes", arguments.attributes);
    set_materials(mesh, names, arguments.materials, scene);
    if (!arguments.material_indices.is_none()) {
        mesh.material_indices =
            indices("material_indices", arguments.material_indices, {static_cast<py::ssize_t>(mesh.part_count())});
    }
    set_places(mesh, arguments.places);
    mesh.turns_normals = flag_from("turn_normals", arguments.turn_normals);
    mesh.terminator = {real_from("terminator_geometry_offset", arguments.terminator_geometry_offset),
                       real_from("terminator_shading_offset", arguments.terminator_shading_offset)};
    mesh.seen_by = arguments.visible_to.is_none() ? kAllRays : ray_kinds_from("visible_to", arguments.visible_to);
    mesh.is_holdout = flag_from("holdout", arguments.holdout);
    mesh.light_set =
        static_cast<std::uint32_t>(integer_from("light_set", arguments.links.light_set, 0, kLightSets - 1));
    const std::int64_t shadow_set = integer_from("shadow_set", arguments.links.shadow_set, 0, kShadowSets - 1);
    mesh.seen_by &= ~std::uint32_t{kShadowRay} | shadow_rays_of(static_cast<std::uint32_t>(shadow_set));
    mesh.links = links_from(arguments.links.receivers, arguments.links.blockers);
    return mesh;
}

/// Normals per vertex or per corner; the other list stays empty.
void set_normals(MeshShape& mesh, const py::object& value) {
    const AnyArray<float> array = array_from<float>("normals", value);
    const auto vertex_count = static_cast<py::ssize_t>(mesh.vertices.size());
    const auto triangle_count = static_cast<py::ssize_t>(mesh.triangles.size());
    if (fits(array, {vertex_count, 3})) {
        mesh.vertex_normals = copy_vectors("normals", array);
    } else if (fits(array, {triangle_count, 3, 3})) {
        mesh.corner_normals = copy_vectors("normals", array);
    } else {
        throw std::invalid_argument("normals must have shape " + describe({vertex_count, 3}) + " or " +
                                    describe({triangle_count, 3, 3}));
    }
}

}  // namespace

LightLinks links_from(const py::object& receivers, const py::object& blockers) {
    LightLinks links;
    if (!receivers.is_none()) {
        links.receivers = set_bits("receivers", receivers, kLightSets);
    }
    if (!blockers.is_none()) {
        links.shadow_rays = static_cast<std::uint32_t>(set_bits("blockers", blockers, kShadowSets) * shadow_rays_of(0));
    }
    return links;
}

Vec3d vector_from(const char* name, const py::handle& value) {
    return vectors(name, numbers<double>(name, value, {3}))[0];
}

std::vector<Vec3d> points_from(const char* name, const py::handle& value) {
    return copy_vectors(name, numbers<double>(name, value, {kAny, 3}));
}

glm::dmat3 axes_from(const char* name, const py::handle& value) {
    const AnyArray<double> array = array_from<double>(name, value);
    if (fits(array, {3})) {
        return lamp_axes({array.data()[0], array.data()[1], array.data()[2]});
    }
    if (!fits(array, {3, 3})) {
        throw std::invalid_argument(std::string(name) + " must have shape (3,) or (3, 3)");
    }
    return glm::transpose(glm::make_mat3(array.data()));
}

glm::dmat4 matrix_from(const char* name, const py::handle& value) {
    return matrix_at(numbers<double>(name, value, {4, 4}).data());
}

glm::dmat4 place_from(const char* name, const py::handle& value) {
    const glm::dmat4 matrix = matrix_from(name, value);
    check_place(name, matrix);
    return matrix;
}

py::array array_of(const glm::dmat4& matrix) {
    py::array_t<double> array({4, 4});
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) {
            array.mutable_at(row, column) = matrix[column][row];
        }
    }
    return array;
}

glm::dmat3 rotation_from(const char* name, const py::handle& value) {
    const AnyArray<double> rows = numbers<double>(name, value, {3, 3});
    return glm::transpose(glm::make_mat3(rows.data()));
}

Environment environment_from(const char* name, const py::handle& value, const glm::dmat3& to_world) {
    const AnyArray<float> array = array_from<float>(name, value);
    if (array.ndim() < 2) {
        return Environment(color_from(name, array), name);
    }
    if (!fits(array, {kAny, kAny, 3})) {
        throw std::invalid_argument(std::string(name) + " must be a number or have shape (3,) or (height, width, 3)");
    }
    if (array.shape(0) > std::numeric_limits<int>::max() || array.shape(1) > std::numeric_limits<int>::max()) {
        throw std::invalid_argument(std::string(name) + " is too large");
    }
    const auto pixels = vectors(name, array);
    LatLong picture = {
        {pixels.begin(), pixels.end()}, static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)), to_world};
    const GilReleased release;
    return Environment(std::move(picture), name);
}

void set_materials(MeshUse& use, const AttributeNames& names, const MaterialArguments& arguments, SceneObject& scene) {
    set_bsdfs(use, names, arguments.bsdf, scene);
    use.emission = emission_from(arguments.emission);
    use.group = group_from(scene, arguments.group);
    const std::size_t count = use.material_count();
    const std::vector<float> index = pass_indices("material_pass_indices", arguments.pass_indices, count);
    const std::vector<float> name = identities("material_names", arguments.names, count);
    use.material_labels.clear();
    for (std::size_t i = 0; i < count; ++i) {
        use.material_labels.push_back({index[i], name[i], 0});
    }
}

void set_places(MeshUse& use, const PlaceArguments& arguments) {
    use.transforms = {glm::dmat4(1)};
    if (!arguments.transforms.is_none()) {
        const AnyArray<double> array = numbers<double>("transforms", arguments.transforms, {kAny, 4, 4});
        use.transforms.clear();
        for (py::ssize_t i = 0; i < array.shape(0); ++i) {
            use.transforms.push_back(matrix_at(array.data() + 16 * i));
        }
    }
    const std::size_t count = use.transforms.size();
    use.object_values.clear();
    if (!arguments.object_values.is_none()) {
        const AnyArray<float> array =
            numbers<float>("object_values", arguments.object_values, {static_cast<py::ssize_t>(count), kAny});
        for (std::size_t i = 0; i < count; ++i) {
            const float* row = array.data() + static_cast<py::ssize_t>(i) * array.shape(1);
            use.object_values.emplace_back(row, row + array.shape(1));
        }
    }
    const std::vector<float> index = pass_indices("object_indices", arguments.object_indices, count);
    const std::vector<float> name = identities("object_names", arguments.object_names, count);
    const std::vector<float> asset = identities("asset_names", arguments.asset_names, count);
    use.object_labels.clear();
    for (std::size_t i = 0; i < count; ++i) {
        use.object_labels.push_back({index[i], name[i], asset[i]});
    }
}

Mesh mesh_from(const TriangleArguments& shape, const SurfaceArguments& arguments, AttributeNames& names,
               SceneObject& scene) {
    Mesh mesh;
    mesh.vertices = copy_vectors("vertices", numbers<float>("vertices", shape.vertices, {kAny, 3}));
    const std::vector<std::uint32_t> corners = indices("triangles", shape.triangles, {kAny, 3});
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        mesh.triangles.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
    }
    if (!shape.normals.is_none()) {
        set_normals(mesh, shape.normals);
    }
    return completed(std::move(mesh), arguments, names, scene);
}

Mesh mesh_from(const RoundArguments& shape, const SurfaceArguments& arguments, AttributeNames& names,
               SceneObject& scene) {
    Mesh mesh;
    mesh.form = shape.form;
    mesh.vertices = copy_vectors("points", numbers<float>("points", shape.points, {kAny, 3}));
    const AnyArray<float> radii = array_from<float>("radii", shape.radii);
    if (radii.ndim() == 0) {
        mesh.radii.assign(mesh.vertices.size(), *radii.data());
    } else {
        const auto all = values(numbers<float>("radii", radii, {static_cast<py::ssize_t>(mesh.vertices.size())}));
        mesh.radii.assign(all.begin(), all.end());
    }
    if (mesh.is_curved()) {
        mesh.first = indices("first", shape.first, {kAny});
        mesh.subdivisions = static_cast<std::uint32_t>(integer_from("subdivisions", shape.subdivisions, 1, 16));
    }
    return completed(std::move(mesh), arguments, names, scene);
}

}  // namespace shlight::python
