// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "mesh_arrays.h"
#include "scene_bindings.h"
#include "whole_objects.h"

using namespace pybind11::literals;

namespace shlight::python {
namespace {

/// The end of every light's docstring.
constexpr const char* kTraitsDoc =
    R"(shadows: False: it lights what it cannot see too. diffuse, glossy: False: diffuse or glossy reflection leaves it out.
camera: True: the camera sees its radiance, added to that of what is behind it; not of a light of no size.
profile: (height, width), not negative: factors of its light by the direction in which it leaves, bilinear in equal
    steps of latitude and longitude like the picture of Scene.set_environment, in the frame that to_world turns; None: 1.
group: name of its light group, or None.
receivers: numbers of the light sets that it lights, see Scene.add_mesh; None: all.
blockers: numbers of the shadow sets that block it; None: all.

Returns the Light, which can be changed and removed.
Raises ValueError naming the argument; the scene is then as it was.)";

constexpr const char* kLightDoc = R"(A light of a Scene, as Scene.add_sphere_light and its like return it.

It belongs to that scene alone; copies of the scene have lights of their own. A change shows in the next render or
query, which builds nothing of the meshes anew. A refused change leaves the light as it was. All but repr() raise
ValueError once the light has been removed.)";

std::string with_traits(const char* doc) {
    return std::string(doc) + kTraitsDoc;
}

constexpr const char* kSphereDoc = R"(Add a sphere light. It blocks no light.

center: (3,). radius: > 0. radiance: a number or RGB [W m^-2 sr^-1]; negative takes light away.
facing_disk: a disk that always faces the shading point, of half angle atan(radius / distance), instead of the sphere of
    half angle asin(radius / distance).
A point inside the sphere is lit from its whole hemisphere.
)";

constexpr const char* kPolygonDoc =
    R"(Add a one-sided polygon light. It blocks no light.

vertices: (k, 3), k >= 3, planar and simple, convex or not. It shines to the side that sees them counter-clockwise.
radiance: a number or RGB [W m^-2 sr^-1]; negative takes light away.
spread: angle [rad] within which it shines, as through a honeycomb grid, 0 < spread <= pi. In a direction at an angle
    alpha to its normal, radiance is multiplied by max(tan h - tan alpha, 0) / (tan h - h), h = spread / 2; pi is even.
)";

constexpr const char* kDiskDoc =
    R"(Add a one-sided light that is a disk or an ellipse. It does not block light.

center, half_axis_u, half_axis_v: (3,), as of disk_coefficients: the points center + a half_axis_u + b half_axis_v with
    a^2 + b^2 <= 1, half axes at right angles or not. It shines to the side of half_axis_u x half_axis_v.
radiance: a number or RGB [W m^-2 sr^-1]; negative takes light away. spread: see add_polygon_light.
)";

constexpr const char* kPointDoc = R"(Add a light of no size, with sharp shadows. Mirrors do not show it.

position: (3,). intensity: a number or RGB [W sr^-1]; a sphere of radius r and radiance L has pi r^2 L from afar.
)";

constexpr const char* kSpotDoc = R"(Add a sphere light, or a light of no size, that shines into a cone with a soft rim.

position: (3,), its centre. direction: (3,), of the cone's axis; or (3, 3), the axes x, y, z of its frame as columns:
    it shines along -z, and angles are those of that frame, so that scaled axes make an elliptical cone.
spot_angle: of the whole cone [rad], 0 < spot_angle <= pi. blend: 0 ... 1, the share of it that fades: with z the cosine
    of the angle to the axis and c that of the cone's rim, radiance is multiplied by smoothstep((z - c) / ((1 - c) blend)).
intensity: a number or RGB [W sr^-1] along the axis; with a radius r, the radiance there is intensity / (pi r^2).
radius: >= 0; 0 is a light of no size. facing_disk: see add_sphere_light.
times_cosine: multiply once more by z, as Blender did before version 4.
)";

constexpr const char* kSunDoc = R"(Add a sun: a disk infinitely far away.

direction: (3,), the way its light travels, of any length. angle: its diameter [rad], 0 ... pi; 0 has sharp shadows and
    mirrors do not show it. irradiance: a number or RGB [W m^-2] on a surface at right angles to the direction.
tangent: False: its radiance is irradiance / (pi sin^2(angle / 2)) everywhere; True: irradiance / (pi tan^2(angle / 2)
    cos^3 alpha) at an angle alpha to its middle, as Blender had it before version 4; angle is then at most 3.
)";

std::shared_ptr<const DirectionTable> table_from(const char* name, const py::object& value) {
    const AnyArray<float> array = array_from<float>(name, value);
    if (array.ndim() != 2 || array.size() == 0) {
        throw std::invalid_argument(std::string(name) + " must have shape (height, width)");
    }
    return std::make_shared<const DirectionTable>(std::vector<float>(array.data(), array.data() + array.size()),
                                                  static_cast<std::size_t>(array.shape(1)));
}

LightTraits traits_from(const py::object& scene, const py::object& shadows, const py::object& diffuse,
                        const py::object& glossy, const py::object& camera, const py::object& group,
                        const py::object& receivers, const py::object& blockers, const py::object& profile) {
    LightTraits traits;
    traits.casts_shadows = flag_from("shadows", shadows);
    traits.lights_diffuse = flag_from("diffuse", diffuse);
    traits.lights_glossy = flag_from("glossy", glossy);
    traits.seen_by_camera = flag_from("camera", camera);
    traits.group = group_from(scene.cast<SceneObject&>(), group);
    traits.links = links_from(receivers, blockers);
    if (!profile.is_none()) {
        traits.profile = with_table({}, table_from("profile", profile), glm::dmat3(1));
    }
    return traits;
}

/// The lamp of a record, whose profile has the table of the record's, if there is one.
Light made(const LampRecord& record) {
    Light light = record.make(record);
    if (const auto* table = std::get_if<TableProfile>(&record.traits.profile)) {
        std::visit(
            [&](auto& own) {
                own.traits.profile =
                    with_table(own.traits.profile, table->table, glm::inverse(glm::dmat3(record.to_world)));
            },
            light);
    }
    return light;
}

/// A lamp of a scene; it keeps the scene alive.
struct LampHandle {
    py::object owner;
    Scene::LampNumber number;

    SceneObject& scene() const { return owner.cast<SceneObject&>(); }
    /// Throws std::invalid_argument if the lamp has been removed.
    const LampRecord& record() const {
        const auto found = scene().lamps.find(number);
        if (found == scene().lamps.end()) {
            throw std::invalid_argument("light has been removed from its scene");
        }
        return found->second;
    }
    /// Makes the lamp anew. Throws std::invalid_argument naming the argument; the lamp is then as it was.
    void change(LampRecord record) const {
        SceneObject& own = scene();
        own.scene.set_lamp(number, made(record));
        own.lamps[number] = std::move(record);
        own.changed();
    }
};

LampHandle add_lamp(const py::object& self, LampRecord record) {
    auto& scene = self.cast<SceneObject&>();
    const Scene::LampNumber number = scene.scene.add_lamp(made(record));
    scene.lamps.emplace(number, std::move(record));
    scene.changed();
    return {self, number};
}

/// The scale of a transform that turns, moves and scales alike in all directions. Throws std::invalid_argument naming
/// `to_world` for others.
double even_scale(const glm::dmat4& to_world, const char* kind) {
    constexpr double kRounding = 1e-6;
    const glm::dmat3 linear(to_world);
    const double scale = std::cbrt(std::abs(glm::determinant(linear)));
    const glm::dmat3 squares = glm::transpose(linear) * linear / (scale * scale);
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
            if (!(std::abs(squares[column][row] - (row == column ? 1 : 0)) <= kRounding)) {
                throw std::invalid_argument(std::string("to_world must turn, move and scale a ") + kind +
                                            " light alike in all directions");
            }
        }
    }
    return scale;
}

Vec3d moved(const LampRecord& own, const Vec3d& point) {
    return Vec3d(own.to_world * glm::dvec4(point, 1));
}

Vec3d turned(const LampRecord& own, const Vec3d& vector) {
    return glm::dmat3(own.to_world) * vector;
}

bool is_mirrored(const LampRecord& own) {
    return glm::determinant(glm::dmat3(own.to_world)) < 0;
}

LampHandle add_sphere_light(const py::object& self, const py::object& center, const py::object& radius,
                            const py::object& radiance, const py::object& facing_disk, const py::object& shadows,
                            const py::object& diffuse, const py::object& glossy, const py::object& camera,
                            const py::object& group, const py::object& receivers, const py::object& blockers,
                            const py::object& profile) {
    const Vec3d place = vector_from("center", center);
    const double size = real_from("radius", radius);
    const Rgb strength = color_from("radiance", radiance);
    const bool faces = flag_from("facing_disk", facing_disk);
    return add_lamp(self, {"sphere", "radiance", strength,
                           traits_from(self, shadows, diffuse, glossy, camera, group, receivers, blockers, profile),
                           [=](const LampRecord& own) -> Light {
                               return make_sphere_light(moved(own, place), even_scale(own.to_world, own.kind) * size,
                                                        own.strength, faces, own.traits);
                           }});
}

LampHandle add_polygon_light(const py::object& self, const py::object& vertices, const py::object& radiance,
                             const py::object& spread, const py::object& shadows, const py::object& diffuse,
                             const py::object& glossy, const py::object& camera, const py::object& group,
                             const py::object& receivers, const py::object& blockers, const py::object& profile) {
    const std::vector<Vec3d> corners = points_from("vertices", vertices);
    const Rgb strength = color_from("radiance", radiance);
    const double angle = real_from("spread", spread);
    return add_lamp(self, {"polygon", "radiance", strength,
                           traits_from(self, shadows, diffuse, glossy, camera, group, receivers, blockers, profile),
                           [=](const LampRecord& own) -> Light {
                               std::vector<Vec3d> placed(corners.size());
                               std::transform(corners.begin(), corners.end(), placed.begin(),
                                              [&](const Vec3d& corner) { return moved(own, corner); });
                               if (is_mirrored(own)) {
                                   std::reverse(placed.begin(), placed.end());
                               }
                               return make_polygon_lamp(std::move(placed), own.strength, angle, own.traits);
                           }});
}

LampHandle add_disk_light(const py::object& self, const py::object& center, const py::object& half_axis_u,
                          const py::object& half_axis_v, const py::object& radiance, const py::object& spread,
                          const py::object& shadows, const py::object& diffuse, const py::object& glossy,
                          const py::object& camera, const py::object& group, const py::object& receivers,
                          const py::object& blockers, const py::object& profile) {
    const Vec3d place = vector_from("center", center);
    const Vec3d u = vector_from("half_axis_u", half_axis_u);
    const Vec3d v = vector_from("half_axis_v", half_axis_v);
    const Rgb strength = color_from("radiance", radiance);
    const double angle = real_from("spread", spread);
    return add_lamp(self, {"disk", "radiance", strength,
                           traits_from(self, shadows, diffuse, glossy, camera, group, receivers, blockers, profile),
                           [=](const LampRecord& own) -> Light {
                               return make_disk_lamp(moved(own, place), turned(own, u),
                                                     turned(own, is_mirrored(own) ? -v : v), own.strength, angle,
                                                     own.traits);
                           }});
}

LampHandle add_point_light(const py::object& self, const py::object& position, const py::object& intensity,
                           const py::object& shadows, const py::object& diffuse, const py::object& glossy,
                           const py::object& camera, const py::object& group, const py::object& receivers,
                           const py::object& blockers, const py::object& profile) {
    const Vec3d place = vector_from("position", position);
    const Rgb strength = color_from("intensity", intensity);
    return add_lamp(self, {"point", "intensity", strength,
                           traits_from(self, shadows, diffuse, glossy, camera, group, receivers, blockers, profile),
                           [=](const LampRecord& own) -> Light {
                               return make_point_source(moved(own, place), own.strength, own.traits);
                           }});
}

LampHandle add_spot_light(const py::object& self, const py::object& position, const py::object& direction,
                          const py::object& spot_angle, const py::object& blend, const py::object& intensity,
                          const py::object& radius, const py::object& facing_disk, const py::object& times_cosine,
                          const py::object& shadows, const py::object& diffuse, const py::object& glossy,
                          const py::object& camera, const py::object& group, const py::object& receivers,
                          const py::object& blockers, const py::object& profile) {
    const Vec3d place = vector_from("position", position);
    const glm::dmat3 axes = axes_from("direction", direction);
    const double angle = real_from("spot_angle", spot_angle);
    const double fading = real_from("blend", blend);
    const bool cosine = flag_from("times_cosine", times_cosine);
    const Rgb strength = color_from("intensity", intensity);
    const double size = real_from("radius", radius);
    const bool faces = flag_from("facing_disk", facing_disk);
    return add_lamp(self, {"spot", "intensity", strength,
                           traits_from(self, shadows, diffuse, glossy, camera, group, receivers, blockers, profile),
                           [=](const LampRecord& own) -> Light {
                               const double scale = even_scale(own.to_world, own.kind);
                               const SpotProfile cone =
                                   make_spot_profile(glm::dmat3(own.to_world) * axes / scale, angle, fading, cosine);
                               return make_spot_light(moved(own, place), cone, own.strength, scale * size, faces,
                                                      own.traits);
                           }});
}

LampHandle add_sun_light(const py::object& self, const py::object& direction, const py::object& angle,
                         const py::object& irradiance, const py::object& tangent, const py::object& shadows,
                         const py::object& diffuse, const py::object& glossy, const py::object& camera,
                         const py::object& group, const py::object& receivers, const py::object& blockers,
                         const py::object& profile) {
    const Vec3d way = vector_from("direction", direction);
    const double size = real_from("angle", angle);
    const Rgb strength = color_from("irradiance", irradiance);
    const bool is_tangent = flag_from("tangent", tangent);
    return add_lamp(self, {"sun", "irradiance", strength,
                           traits_from(self, shadows, diffuse, glossy, camera, group, receivers, blockers, profile),
                           [=](const LampRecord& own) -> Light {
                               const double scale = even_scale(own.to_world, own.kind);
                               return make_sun_light(turned(own, way) / scale, size, own.strength, is_tangent,
                                                     own.traits);
                           }});
}

/// A light's strength under the name that its add_..._light has for it.
py::array strength(const LampHandle& self, const char* name) {
    const LampRecord& record = self.record();
    if (std::strcmp(record.strength_name, name) != 0) {
        throw py::attribute_error(std::string("a ") + record.kind + " light has no " + name + " but " +
                                  record.strength_name);
    }
    py::array_t<double> rgb(3);
    for (int channel = 0; channel < 3; ++channel) {
        rgb.mutable_at(channel) = double{record.strength[channel]};
    }
    return rgb;
}

void set_strength(const LampHandle& self, const char* name, const py::object& value) {
    strength(self, name);
    LampRecord record = self.record();
    record.strength = color_from(name, value);
    self.change(std::move(record));
}

void set_group(const LampHandle& self, const py::object& group) {
    LampRecord record = self.record();
    record.traits.group = group_from(self.scene(), group);
    self.change(std::move(record));
}

void set_place(const LampHandle& self, const py::object& to_world) {
    LampRecord record = self.record();
    record.to_world = place_from("to_world", to_world);
    self.change(std::move(record));
}

void remove_light(const LampHandle& self) {
    self.record();
    SceneObject& scene = self.scene();
    scene.scene.remove_lamp(self.number);
    scene.lamps.erase(self.number);
    scene.changed();
}

std::string repr_of(const LampHandle& self) {
    const auto found = self.scene().lamps.find(self.number);
    if (found == self.scene().lamps.end()) {
        return "Light(removed)";
    }
    const LampRecord& own = found->second;
    const auto group = py::repr(group_name(self.scene(), own.traits.group)).cast<std::string>();
    return std::string("Light(") + own.kind + ", " + own.strength_name + "=" +
           py::repr(strength(self, own.strength_name).attr("tolist")()).cast<std::string>() + ", group=" + group + ")";
}

void bind_light(py::module_& m) {
    py::class_<LampHandle> light(m, "Light", kLightDoc, without_constructor());
    for (const char* name : {"radiance", "intensity", "irradiance"}) {
        light.def_property(
            name, [name](const LampHandle& self) { return strength(self, name); },
            [name](const LampHandle& self, const py::object& value) { set_strength(self, name, value); },
            "(3,), RGB, as of the add_..._light that has made the light; AttributeError if that calls it otherwise.");
    }
    light
        .def_property(
            "group", [](const LampHandle& self) { return group_name(self.scene(), self.record().traits.group); },
            &set_group, "The name of its light group, or None.")
        .def_property(
            "to_world", [](const LampHandle& self) { return array_of(self.record().to_world); }, &set_place,
            "(4, 4), for column vectors: from the frame in which the light was added, at first the world's. A polygon "
            "or\n"
            "disk takes any affine one; a sphere, spot or sun one that scales alike in all directions.")
        .def("remove", &remove_light, "Take the light out of its scene.")
        .def("__repr__", &repr_of);
}

}  // namespace

void bind_lights(py::module_& m, py::class_<SceneObject>& scene) {
    bind_light(m);
    scene
        .def("add_sphere_light", &add_sphere_light, with_traits(kSphereDoc).c_str(), "center"_a, "radius"_a,
             "radiance"_a, py::kw_only(), "facing_disk"_a = false, "shadows"_a = true, "diffuse"_a = true,
             "glossy"_a = true, "camera"_a = false, "group"_a = py::none(), "receivers"_a = py::none(),
             "blockers"_a = py::none(), "profile"_a = py::none())
        .def("add_polygon_light", &add_polygon_light, with_traits(kPolygonDoc).c_str(), "vertices"_a, "radiance"_a,
             py::kw_only(), "spread"_a = std::numbers::pi, "shadows"_a = true, "diffuse"_a = true, "glossy"_a = true,
             "camera"_a = false, "group"_a = py::none(), "receivers"_a = py::none(), "blockers"_a = py::none(),
             "profile"_a = py::none())
        .def("add_disk_light", &add_disk_light, with_traits(kDiskDoc).c_str(), "center"_a, "half_axis_u"_a,
             "half_axis_v"_a, "radiance"_a, py::kw_only(), "spread"_a = std::numbers::pi, "shadows"_a = true,
             "diffuse"_a = true, "glossy"_a = true, "camera"_a = false, "group"_a = py::none(),
             "receivers"_a = py::none(), "blockers"_a = py::none(), "profile"_a = py::none())
        .def("add_point_light", &add_point_light, with_traits(kPointDoc).c_str(), "position"_a, "intensity"_a,
             py::kw_only(), "shadows"_a = true, "diffuse"_a = true, "glossy"_a = true, "camera"_a = false,
             "group"_a = py::none(), "receivers"_a = py::none(), "blockers"_a = py::none(), "profile"_a = py::none())
        .def("add_spot_light", &add_spot_light, with_traits(kSpotDoc).c_str(), "position"_a, "direction"_a,
             "spot_angle"_a, "blend"_a, "intensity"_a, py::kw_only(), "radius"_a = 0.0, "facing_disk"_a = false,
             "times_cosine"_a = false, "shadows"_a = true, "diffuse"_a = true, "glossy"_a = true, "camera"_a = false,
             "group"_a = py::none(), "receivers"_a = py::none(), "blockers"_a = py::none(), "profile"_a = py::none())
        .def("add_sun_light", &add_sun_light, with_traits(kSunDoc).c_str(), "direction"_a, "angle"_a, "irradiance"_a,
             py::kw_only(), "tangent"_a = false, "shadows"_a = true, "diffuse"_a = true, "glossy"_a = true,
             "camera"_a = false, "group"_a = py::none(), "receivers"_a = py::none(), "blockers"_a = py::none(),
             "profile"_a = py::none());
}

}  // namespace shlight::python
