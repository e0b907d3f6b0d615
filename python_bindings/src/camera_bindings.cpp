// SPDX-License-Identifier: MIT
#include <array>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "arguments.h"
#include "mesh_arrays.h"
#include "scene_bindings.h"
#include "shlight/camera.h"

using namespace pybind11::literals;

namespace shlight::python {
namespace {

constexpr double kPi = std::numbers::pi;

constexpr const char* kCameraDoc = R"(Set a perspective camera with square pixels.

to_world: (4, 4), camera to world, for column vectors; the camera looks along -z, y is up.
fov_x: horizontal field of view in radians, between 0 and pi.)";

constexpr const char* kWindowDoc = R"(Set a camera by the rectangle that the image shows.

to_world: (4, 4), camera to world, for column vectors; the camera looks along -z, y is up.
left, right, bottom, top: on the plane z = -1 of the camera frame, or in metres if orthographic.
clip_start, clip_end: surfaces are seen between these depths along the view axis.)";

constexpr const char* kPanoramaDoc =
    R"(Set a camera whose picture is no plane, as Blender's render engine Cycles has it.

to_world: (4, 4), camera to world, for column vectors; the camera looks along -z, y is up.
panorama_type: "equirectangular", "central_cylindrical", "fisheye_equidistant", "fisheye_equisolid",
    "fisheye_lens_polynomial", "mirrorball" or "equiangular_cubemap_face". What follows counts for the types it names.
left, right, bottom, top: what the image shows of the whole panorama, which is 0 ... 1 along both axes.
equirectangular_range: (longitude_min, longitude_max, latitude_min, latitude_max) in radians; (0, 0) is ahead.
central_cylindrical_range: (u_min, u_max, v_min, v_max), longitudes in radians and heights on a cylinder of radius 1.
fisheye_fov: in radians; the picture is black beyond it.
fisheye_lens: focal length of "fisheye_equisolid" [m].
fisheye_polynomial: (5,), k0 ... k4 of "fisheye_lens_polynomial": the angle to the axis is -(k0 + k1 r + ... + k4 r**4)
    at r metres from the sensor's middle.
sensor_width, sensor_height: of these two [m].
clip_start, clip_end: surfaces are seen between these distances.)";

std::string with_aperture(const char* doc) {
    return std::string(doc) + R"(
aperture_size: radius of the lens's opening [m], half the focal length / f-stop; 0: everything is in focus.
focus_distance: [m] along the view axis, of a panorama along the ray; may be infinite.
aperture_blades: corners of the opening, a regular polygon in that circle; below 3: a disk.
aperture_rotation: of the polygon, anticlockwise, in radians.
aperture_ratio: height / width of the opening, whose width is divided by it.

Raises ValueError naming the argument.)";
}

Aperture aperture_from(const py::object& size, const py::object& focus_distance, const py::object& blades,
                       const py::object& rotation, const py::object& ratio) {
    return {real_from("aperture_size", size), real_from("focus_distance", focus_distance),
            int_from("aperture_blades", blades), real_from("aperture_rotation", rotation),
            real_from("aperture_ratio", ratio)};
}

Window window_from(const py::object& left, const py::object& right, const py::object& bottom, const py::object& top) {
    return {real_from("left", left), real_from("right", right), real_from("bottom", bottom), real_from("top", top)};
}

ClipRange clips_from(const py::object& start, const py::object& end) {
    return {real_from("clip_start", start), real_from("clip_end", end)};
}

void set_camera(SceneObject& self, const py::object& to_world, const py::object& fov_x, const py::object& size,
                const py::object& focus_distance, const py::object& blades, const py::object& rotation,
                const py::object& ratio) {
    self.camera.emplace(matrix_from("to_world", to_world), real_from("fov_x", fov_x),
                        aperture_from(size, focus_distance, blades, rotation, ratio));
}

void set_camera_window(SceneObject& self, const py::object& to_world, const py::object& left, const py::object& right,
                       const py::object& bottom, const py::object& top, const py::object& orthographic,
                       const py::object& clip_start, const py::object& clip_end, const py::object& size,
                       const py::object& focus_distance, const py::object& blades, const py::object& rotation,
                       const py::object& ratio) {
    self.camera.emplace(matrix_from("to_world", to_world), window_from(left, right, bottom, top),
                        flag_from("orthographic", orthographic) ? Projection::orthographic : Projection::perspective,
                        clips_from(clip_start, clip_end), aperture_from(size, focus_distance, blades, rotation, ratio));
}

template <std::size_t N>
std::array<double, N> numbers_from(const char* name, const py::handle& value) {
    const AnyArray<double> array = array_from<double>(name, value);
    if (array.ndim() != 1 || array.shape(0) != N) {
        throw std::invalid_argument(std::string(name) + " must have shape (" + std::to_string(N) + ",)");
    }
    std::array<double, N> numbers{};
    std::copy_n(array.data(), N, numbers.begin());
    return numbers;
}

Panorama panorama_from(const py::object& type, const py::object& equirectangular_range,
                       const py::object& central_cylindrical_range, const py::object& fov, const py::object& lens,
                       const py::object& polynomial, const py::object& sensor_width, const py::object& sensor_height) {
    const auto angles = numbers_from<4>("equirectangular_range", equirectangular_range);
    const auto cylinder = numbers_from<4>("central_cylindrical_range", central_cylindrical_range);
    const double angle = real_from("fisheye_fov", fov);
    const double length = real_from("fisheye_lens", lens);
    const auto coefficients = numbers_from<5>("fisheye_polynomial", polynomial);
    const Sensor sensor = {real_from("sensor_width", sensor_width), real_from("sensor_height", sensor_height)};
    const auto name = py::isinstance<py::str>(type) ? type.cast<std::string>() : std::string();
    if (name == "equirectangular") {
        return Equirectangular{angles[0], angles[1], angles[2], angles[3]};
    }
    if (name == "central_cylindrical") {
        return CentralCylindrical{cylinder[0], cylinder[1], cylinder[2], cylinder[3]};
    }
    if (name == "fisheye_equidistant") {
        return FisheyeEquidistant{angle};
    }
    if (name == "fisheye_equisolid") {
        return FisheyeEquisolid{length, angle, sensor};
    }
    if (name == "fisheye_lens_polynomial") {
        return FisheyeLensPolynomial{coefficients, angle, sensor};
    }
    if (name == "mirrorball") {
        return MirrorBall{};
    }
    if (name == "equiangular_cubemap_face") {
        return EquiangularCubemapFace{};
    }
    throw std::invalid_argument(
        R"(panorama_type must be "equirectangular", "central_cylindrical", "fisheye_equidistant", "fisheye_equisolid", )"
        R"("fisheye_lens_polynomial", "mirrorball" or "equiangular_cubemap_face")");
}

void set_panorama_camera(SceneObject& self, const py::object& to_world, const py::object& panorama_type,
                         const py::object& left, const py::object& right, const py::object& bottom,
                         const py::object& top, const py::object& equirectangular_range,
                         const py::object& central_cylindrical_range, const py::object& fisheye_fov,
                         const py::object& fisheye_lens, const py::object& fisheye_polynomial,
                         const py::object& sensor_width, const py::object& sensor_height, const py::object& clip_start,
                         const py::object& clip_end, const py::object& size, const py::object& focus_distance,
                         const py::object& blades, const py::object& rotation, const py::object& ratio) {
    self.camera.emplace(matrix_from("to_world", to_world),
                        panorama_from(panorama_type, equirectangular_range, central_cylindrical_range, fisheye_fov,
                                      fisheye_lens, fisheye_polynomial, sensor_width, sensor_height),
                        window_from(left, right, bottom, top), clips_from(clip_start, clip_end),
                        aperture_from(size, focus_distance, blades, rotation, ratio));
}

}  // namespace

void bind_cameras(py::class_<SceneObject>& scene) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    scene
        .def("set_camera", &set_camera, with_aperture(kCameraDoc).c_str(), "to_world"_a, "fov_x"_a, py::kw_only(),
             "aperture_size"_a = 0.0, "focus_distance"_a = Aperture().focus_distance, "aperture_blades"_a = 0,
             "aperture_rotation"_a = 0.0, "aperture_ratio"_a = 1.0)
        .def("set_camera_window", &set_camera_window, with_aperture(kWindowDoc).c_str(), "to_world"_a, "left"_a,
             "right"_a, "bottom"_a, "top"_a, py::kw_only(), "orthographic"_a = false, "clip_start"_a = 0.0,
             "clip_end"_a = kInfinite, "aperture_size"_a = 0.0, "focus_distance"_a = Aperture().focus_distance,
             "aperture_blades"_a = 0, "aperture_rotation"_a = 0.0, "aperture_ratio"_a = 1.0)
        .def("set_panorama_camera", &set_panorama_camera, with_aperture(kPanoramaDoc).c_str(), "to_world"_a,
             "panorama_type"_a, py::kw_only(), "left"_a = 0.0, "right"_a = 1.0, "bottom"_a = 0.0, "top"_a = 1.0,
             "equirectangular_range"_a = py::make_tuple(-kPi, kPi, -kPi / 2, kPi / 2),
             "central_cylindrical_range"_a = py::make_tuple(-kPi, kPi, -1.0, 1.0),
             "fisheye_fov"_a = FisheyeEquidistant().fov, "fisheye_lens"_a = FisheyeEquisolid().lens,
             "fisheye_polynomial"_a = py::make_tuple(0.0, 0.0, 0.0, 0.0, 0.0), "sensor_width"_a = Sensor().width,
             "sensor_height"_a = Sensor().height, "clip_start"_a = 0.0, "clip_end"_a = kInfinite,
             "aperture_size"_a = 0.0, "focus_distance"_a = Aperture().focus_distance, "aperture_blades"_a = 0,
             "aperture_rotation"_a = 0.0, "aperture_ratio"_a = 1.0);
}

}  // namespace shlight::python
