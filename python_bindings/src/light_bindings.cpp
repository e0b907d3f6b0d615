// SPDX-License-Identifier: MIT
#include <numbers>
#include <string>

#include "arguments.h"
#include "mesh_arrays.h"
#include "scene_bindings.h"

using namespace pybind11::literals;

namespace shlight::python {
namespace {

/// The end of every light's docstring.
constexpr const char* kTraitsDoc =
    R"(shadows: False: it lights what it cannot see too. diffuse, glossy: False: diffuse or glossy reflection leaves it out.
camera: True: the camera sees its radiance, added to that of what is behind it; not of a light of no size.
group: name of its light group, or None.

Raises ValueError naming the argument.)";

std::string with_traits(const char* doc) {
    return std::string(doc) + kTraitsDoc;
}

constexpr const char* kSphereDoc = R"(Add a sphere light. It blocks no light.

center: (3,). radius: > 0. radiance: RGB [W m^-2 sr^-1]; negative takes light away.
facing_disk: a disk that always faces the shading point, of half angle atan(radius / distance), instead of the sphere of
    half angle asin(radius / distance).
A point inside the sphere is lit from its whole hemisphere.
)";

constexpr const char* kPolygonDoc =
    R"(Add a one-sided polygon light. It blocks no light.

vertices: (k, 3), k >= 3, planar and simple, convex or not. It shines to the side that sees them counter-clockwise.
radiance: RGB [W m^-2 sr^-1]; negative takes light away.
spread: angle [rad] within which it shines, as through a honeycomb grid, 0 < spread <= pi. In a direction at an angle
    alpha to its normal, radiance is multiplied by max(tan h - tan alpha, 0) / (tan h - h), h = spread / 2; pi is even.
)";

constexpr const char* kDiskDoc =
    R"(Add a one-sided light that is a disk or an ellipse. It does not block light.

center, half_axis_u, half_axis_v: (3,), as of disk_coefficients: the points center + a half_axis_u + b half_axis_v with
    a^2 + b^2 <= 1, half axes at right angles or not. It shines to the side of half_axis_u x half_axis_v.
radiance: RGB [W m^-2 sr^-1]; negative takes light away. spread: see add_polygon_light.
)";

constexpr const char* kPointDoc = R"(Add a light of no size, with sharp shadows. Mirrors do not show it.

position: (3,). intensity: RGB [W sr^-1]; a sphere of radius r and radiance L has pi r^2 L from afar.
)";

constexpr const char* kSpotDoc = R"(Add a sphere light, or a light of no size, that shines into a cone with a soft rim.

position: (3,), its centre. direction: (3,), of the cone's axis; or (3, 3), the axes x, y, z of its frame as columns:
    it shines along -z, and angles are those of that frame, so that scaled axes make an elliptical cone.
spot_angle: of the whole cone [rad], 0 < spot_angle <= pi. blend: 0 ... 1, the share of it that fades: with z the cosine
    of the angle to the axis and c that of the cone's rim, radiance is multiplied by smoothstep((z - c) / ((1 - c) blend)).
intensity: RGB [W sr^-1] along the axis; with a radius r, the radiance there is intensity / (pi r^2).
radius: >= 0; 0 is a light of no size. facing_disk: see add_sphere_light.
times_cosine: multiply once more by z, as Blender did before version 4.
)";

constexpr const char* kSunDoc = R"(Add a sun: a disk infinitely far away.

direction: (3,), the way its light travels, of any length. angle: its diameter [rad], 0 ... pi; 0 has sharp shadows and
    mirrors do not show it. irradiance: RGB [W m^-2] on a surface at right angles to the direction.
tangent: False: its radiance is irradiance / (pi sin^2(angle / 2)) everywhere; True: irradiance / (pi tan^2(angle / 2)
    cos^3 alpha) at an angle alpha to its middle, as Blender had it before version 4; angle is then at most 3.
)";

LightTraits traits_from(SceneObject& scene, const py::object& shadows, const py::object& diffuse,
                        const py::object& glossy, const py::object& camera, const py::object& group) {
    LightTraits traits;
    traits.casts_shadows = flag_from("shadows", shadows);
    traits.lights_diffuse = flag_from("diffuse", diffuse);
    traits.lights_glossy = flag_from("glossy", glossy);
    traits.seen_by_camera = flag_from("camera", camera);
    traits.group = group_from(scene, group);
    return traits;
}

void add_sphere_light(SceneObject& self, const py::object& center, const py::object& radius, const py::object& radiance,
                      const py::object& facing_disk, const py::object& shadows, const py::object& diffuse,
                      const py::object& glossy, const py::object& camera, const py::object& group) {
    self.scene.add_sphere_light(vector_from("center", center), real_from("radius", radius),
                                rgb_from("radiance", radiance), flag_from("facing_disk", facing_disk),
                                traits_from(self, shadows, diffuse, glossy, camera, group));
    self.changed();
}

void add_polygon_light(SceneObject& self, const py::object& vertices, const py::object& radiance,
                       const py::object& spread, const py::object& shadows, const py::object& diffuse,
                       const py::object& glossy, const py::object& camera, const py::object& group) {
    self.scene.add_polygon_light(points_from("vertices", vertices), rgb_from("radiance", radiance),
                                 real_from("spread", spread),
                                 traits_from(self, shadows, diffuse, glossy, camera, group));
    self.changed();
}

void add_disk_light(SceneObject& self, const py::object& center, const py::object& half_axis_u,
                    const py::object& half_axis_v, const py::object& radiance, const py::object& spread,
                    const py::object& shadows, const py::object& diffuse, const py::object& glossy,
                    const py::object& camera, const py::object& group) {
    self.scene.add_disk_light(vector_from("center", center), vector_from("half_axis_u", half_axis_u),
                              vector_from("half_axis_v", half_axis_v), rgb_from("radiance", radiance),
                              real_from("spread", spread), traits_from(self, shadows, diffuse, glossy, camera, group));
    self.changed();
}

void add_point_light(SceneObject& self, const py::object& position, const py::object& intensity,
                     const py::object& shadows, const py::object& diffuse, const py::object& glossy,
                     const py::object& camera, const py::object& group) {
    self.scene.add_point_light(vector_from("position", position), rgb_from("intensity", intensity),
                               traits_from(self, shadows, diffuse, glossy, camera, group));
    self.changed();
}

void add_spot_light(SceneObject& self, const py::object& position, const py::object& direction,
                    const py::object& spot_angle, const py::object& blend, const py::object& intensity,
                    const py::object& radius, const py::object& facing_disk, const py::object& times_cosine,
                    const py::object& shadows, const py::object& diffuse, const py::object& glossy,
                    const py::object& camera, const py::object& group) {
    self.scene.add_spot_light(vector_from("position", position),
                              make_spot_profile(axes_from("direction", direction), real_from("spot_angle", spot_angle),
                                                real_from("blend", blend), flag_from("times_cosine", times_cosine)),
                              rgb_from("intensity", intensity), real_from("radius", radius),
                              flag_from("facing_disk", facing_disk),
                              traits_from(self, shadows, diffuse, glossy, camera, group));
    self.changed();
}

void add_sun_light(SceneObject& self, const py::object& direction, const py::object& angle,
                   const py::object& irradiance, const py::object& tangent, const py::object& shadows,
                   const py::object& diffuse, const py::object& glossy, const py::object& camera,
                   const py::object& group) {
    self.scene.add_sun_light(vector_from("direction", direction), real_from("angle", angle),
                             rgb_from("irradiance", irradiance), flag_from("tangent", tangent),
                             traits_from(self, shadows, diffuse, glossy, camera, group));
    self.changed();
}

}  // namespace

void bind_lights(py::class_<SceneObject>& scene) {
    scene
        .def("add_sphere_light", &add_sphere_light, with_traits(kSphereDoc).c_str(), "center"_a, "radius"_a,
             "radiance"_a, py::kw_only(), "facing_disk"_a = false, "shadows"_a = true, "diffuse"_a = true,
             "glossy"_a = true, "camera"_a = false, "group"_a = py::none())
        .def("add_polygon_light", &add_polygon_light, with_traits(kPolygonDoc).c_str(), "vertices"_a, "radiance"_a,
             py::kw_only(), "spread"_a = std::numbers::pi, "shadows"_a = true, "diffuse"_a = true, "glossy"_a = true,
             "camera"_a = false, "group"_a = py::none())
        .def("add_disk_light", &add_disk_light, with_traits(kDiskDoc).c_str(), "center"_a, "half_axis_u"_a,
             "half_axis_v"_a, "radiance"_a, py::kw_only(), "spread"_a = std::numbers::pi, "shadows"_a = true,
             "diffuse"_a = true, "glossy"_a = true, "camera"_a = false, "group"_a = py::none())
        .def("add_point_light", &add_point_light, with_traits(kPointDoc).c_str(), "position"_a, "intensity"_a,
             py::kw_only(), "shadows"_a = true, "diffuse"_a = true, "glossy"_a = true, "camera"_a = false,
             "group"_a = py::none())
        .def("add_spot_light", &add_spot_light, with_traits(kSpotDoc).c_str(), "position"_a, "direction"_a,
             "spot_angle"_a, "blend"_a, "intensity"_a, py::kw_only(), "radius"_a = 0.0, "facing_disk"_a = false,
             "times_cosine"_a = false, "shadows"_a = true, "diffuse"_a = true, "glossy"_a = true, "camera"_a = false,
             "group"_a = py::none())
        .def("add_sun_light", &add_sun_light, with_traits(kSunDoc).c_str(), "direction"_a, "angle"_a, "irradiance"_a,
             py::kw_only(), "tangent"_a = false, "shadows"_a = true, "diffuse"_a = true, "glossy"_a = true,
             "camera"_a = false, "group"_a = py::none());
}

}  // namespace shlight::python
