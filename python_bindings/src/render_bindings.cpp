// SPDX-License-Identifier: MIT
#include "shlight/render.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <sstream>
#include <string>
#include <tuple>

#include "arguments.h"
#include "bindings.h"
#include "gil.h"
#include "pass_arrays.h"
#include "render_calls.h"
#include "whole_objects.h"

using namespace pybind11::literals;

namespace shlight::python {
namespace {

constexpr const char* kRenderDoc = R"(Render a scene: its direct light, and light that bounces.

scene: a Scene with a camera.
width, height: pixels.
order: 1 ... 64: harmonics of this order for every light, or "auto": for each lobe, view and light the cheapest of
    harmonics in the lobe's warp and cubature that meets the tolerance.
tolerance: error of what a point reflects / that, or / a tenth of the picture's mean where that is larger; > 0.
noise_threshold: a pixel has enough camera rays where the estimated error of its mean, relative to sqrt(r^2 + 0.01 m^2),
    r its value and m the picture's mean, is not above this; 0 ... 1, 0: all pixels get max_samples.
min_samples, max_samples: camera rays of a pixel, over the filter. The first pass takes one of each pixel, the second
    four times as many where they are needed, later ones twice as many. max_samples is rounded down to 1 or 4, 8, 16 ...
pixel_samples: camera rays of each pixel in the first pass, in place of one; then also min_samples, and max_samples is
    16 times as many unless it is given. Rounded up to a power of two, unless it is max_samples: then it is one pass.
pixel_filter, filter_width: "box" of one pixel, or "gaussian" or "blackman_harris" of a width in pixels, 0.001 ... 100,
    as Blender's render engine Cycles has them.
time_limit: seconds, or None. The render ends then; pixels that have no ray yet are interpolated. A first grid of about
    a thousand pixels is always made.
shadows: whether lights cast them.
shadow_rays: per camera ray and light, at most, and again for each roughness of the material's lobes; lights get them in
    proportion to what they add to the pixel, and one where nothing has been in the way so far; 0 ... 16384. 0: no shadows.
transparent_bounces: surfaces that let light through which a shadow ray passes, at most, 0 ... 1024; a camera ray
    passes one more.
max_bounces: surfaces that light is reflected by before the one that the camera sees, at most, as Blender's render engine
    Cycles counts them, 0 ... 1024. 0: direct light.
glossy_bounces, transmission_bounces: at most so many of these are by glossy lobes or mirrors, and so many through
    glass; None: as many. Light that bounces and that a diffuse surface reflects has a count of its own.
filter_glossy: 0 ... 100, as Cycles' Filter Glossy; 0: none. Light that diffuse surfaces reflect comes to them by glossy
    lobes that are widened, to a roughness of 0.67 by a filter of 1, by mirrors as by such lobes, and through glass that
    is as rough: what these throw on other surfaces is blurred, and without the splotches of sharp light.
clamp_indirect: 0 or more, as Cycles' Clamp Indirect; 0: none. The mean of the channels that what one path brings is cut
    to, of light that has bounced: lamps that a record's rays or the camera's meet through glass or by several mirrors,
    and surfaces that they meet after a bounce. Without it, a lamp that few rays find through glass is a bright spot.
darken_doubled: whether opaque faces that lie on others are dark, as in Cycles, where its rays meet the other: black if
    both are in one plane to the last bit, and else with dark patches. RenderReport.doubled tells their meshes in any case.
passes: names of what else is wanted of the picture, by the units and values of Blender's render engine Cycles.
    Of the ray through a pixel's middle: "depth" [m] along the view axis, 1e10 where nothing is; "position",
    "object_index", "material_index". Means over the filter: "normal", "uv", "mist", "emission", "environment",
    "diffuse_direct", "diffuse_indirect" (what has bounced before), "glossy_direct" and "glossy_indirect", which are
    divided by "diffuse_color" and "glossy_color"; "transmission_direct" and "transmission_indirect", what is seen through
    glass, divided by "transmission_color"; "denoising_normal", "denoising_albedo", "denoising_depth"; "cryptomatte_object", "cryptomatte_material", "cryptomatte_asset".
groups: also the part of the picture that the lights of each group give, "combined_NAME"; those of lights without a group
    are "combined_". They add up to the picture but for bounced light that diffuse surfaces reflect, which has no group.
aovs: also what materials have as `Shader.with_aovs`, "aov_NAME".
alpha_threshold: 0 ... 1, a surface that lets more than 1 - this through is passed over by normals, places and indices.
mist: start and depth [m] and the power of its falloff. cryptomatte_levels: 2 ... 16 identities of a pixel.
exposure: a factor on all light of the picture and its passes, not on colours; 0 or more.
threads: at most; 0: all cores. The image does not depend on it.
seed: 0 ... 2^32 - 1; another one draws other rays, so that the noise of two images is independent.
kept_light: a KeptLight, whose light the render takes as it is and adds to; None: all light is gathered anew.
progress: is called with the finished share, 0 ... 1, about every 10 ms; returning False cancels.
on_update: is called as on_update(image, report) once the image has pixels all over, after each pass, and a few times a
    second during long ones, with the picture as it stands; returning False ends the render, which returns the picture as it is. What progress and
    on_update raise ends the render and is raised here.
return_report: return (result, report), whose report the result has, too.

Returns a RenderResult, an array (height, width, 4) float32, linear, row 0 on top, RGB premultiplied; alpha is the share
of what is not empty: a surface, or an environment that the camera sees. Its .passes, .groups and .report hold the rest.
Raises ValueError naming the argument, RenderCancelled.

>>> scene = shlight.Scene()
>>> floor = scene.add_mesh([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], [[0, 1, 2], [0, 2, 3]])
>>> lamp = scene.add_sphere_light((0, 0, 1), 0.2, radiance=10)
>>> scene.set_camera(shlight.look_at((0, -3, 2), (0, 0, 0)), fov_x=0.8)
>>> result = shlight.render(scene, 32, 24, passes=["depth"])
>>> result.shape, list(result.passes)
((24, 32, 4), ['depth'])
>>> result.save("floor.png"))";

constexpr const char* kKeptLightDoc = R"(Light that bounces, kept from one render to the next.

A render of the same scene that is given it as kept_light gathers only what it lacks: where the camera moves, light that
bounces is there at once, and still surfaces stay as they were. Such a picture depends on those before it, within its
noise. What changes the scene, but for its camera, and other settings that light depends on, empty it; threads, size,
passes and the numbers of samples are none of these. A cancelled render leaves in it what it has gathered.)";

/// A report with what only Python's side knows.
struct Report {
    RenderReport core;
    double build_seconds;
    std::string dark;

    double share(std::uint64_t count) const {
        const std::uint64_t harmonics =
            std::accumulate(core.order_counts.begin(), core.order_counts.end(), std::uint64_t{0});
        const std::uint64_t all = harmonics + core.cubature_count + core.mirror_count;
        return all == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(all);
    }
    std::map<int, double> order_shares() const {
        std::map<int, double> shares;
        for (std::size_t order = 0; order < core.order_counts.size(); ++order) {
            if (core.order_counts[order] > 0) {
                shares[static_cast<int>(order)] = share(core.order_counts[order]);
            }
        }
        return shares;
    }
    double cubature_share() const { return share(core.cubature_count); }
    double mirror_share() const { return share(core.mirror_count); }
    double over_tolerance() const { return share(core.over_tolerance); }
    py::dict stage_seconds() const {
        py::dict seconds;
        for (std::size_t stage = 0; stage < kRenderStages.size(); ++stage) {
            seconds[kRenderStages[stage]] = core.stage_seconds[stage];
        }
        return seconds;
    }
    std::string repr() const {
        std::ostringstream text;
        text.precision(3);
        text << "RenderReport(passes=" << core.passes << ", noise=" << core.noise << ", hits=" << core.hits
             << ", shadow_rays=" << core.shadow_rays << ", over_tolerance=" << over_tolerance()
             << ", build_seconds=" << build_seconds << ", render_seconds=" << core.seconds;
        return text.str() + (dark.empty() ? ")" : ", dark='" + dark + "')");
    }
};

using ReportState =
    std::tuple<std::array<std::uint64_t, kMaxOrder + 1>, std::array<std::uint64_t, 7>, std::array<double, 2>,
               std::array<double, kRenderStages.size()>, double, std::string, std::vector<MeshInstance>>;

ReportState report_state(const Report& report) {
    const RenderReport& core = report.core;
    return {core.order_counts,
            {core.cubature_count, core.mirror_count, core.over_tolerance, core.hits, core.shadow_rays, core.records,
             core.passes},
            {core.noise, core.seconds},
            core.stage_seconds,
            report.build_seconds,
            report.dark,
            report.core.doubled};
}

Report report_from(const ReportState& state) {
    const auto& [order_counts, counts, floats, stage_seconds, build_seconds, dark, doubled] = state;
    const auto& [cubature, mirror, over_tolerance, hits, shadow_rays, records, passes] = counts;
    const auto& [noise, seconds] = floats;
    return {{order_counts, cubature, mirror, over_tolerance, hits, shadow_rays, records,
             static_cast<std::uint32_t>(passes), noise, seconds, 0, stage_seconds, doubled},
            build_seconds,
            dark};
}

/// RenderSettings() is direct light; a picture has more.
constexpr int kDefaultBounces = 4;

/// Sampling settings from arguments with the same names; None keeps the default.
PixelSampling sampling_from(const py::object& noise_threshold, const py::object& min_samples,
                            const py::object& max_samples, const py::object& pixel_samples,
                            const py::object& time_limit) {
    PixelSampling sampling;
    if (!pixel_samples.is_none()) {
        if (!min_samples.is_none()) {
            throw std::invalid_argument("min_samples and pixel_samples cannot be given both");
        }
        sampling = PixelSampling::refined(samples_from("pixel_samples", pixel_samples));
    }
    if (!max_samples.is_none()) {
        sampling.max_samples = samples_from("max_samples", max_samples);
        sampling.first_samples = std::min(sampling.first_samples, sampling.max_samples);
        sampling.min_samples = std::min(sampling.min_samples, sampling.max_samples);
    }
    if (!min_samples.is_none()) {
        sampling.min_samples = samples_from("min_samples", min_samples);
    }
    sampling.noise_threshold = real_from("noise_threshold", noise_threshold);
    if (!time_limit.is_none()) {
        sampling.time_limit = real_from("time_limit", time_limit);
        if (!(sampling.time_limit > 0)) {
            throw std::invalid_argument("time_limit must be positive or None");
        }
    }
    return sampling;
}

/// A PictureUpdate that calls a Python callback, or none for None; keeps a reference to the callback.
PictureUpdate update_from(const py::object& callback, int width, int height, float exposure, double build_seconds) {
    if (callback.is_none()) {
        return {};
    }
    return [=, &callback](std::span<const float> image, const RenderReport& report) {
        throw_at_end();
        const py::gil_scoped_acquire acquire;
        py::array_t<float> copy({height, width, 4}, image.data());
        expose(copy, 0, 3, exposure);
        return !is_false(callback(copy, Report{report, build_seconds, {}}));
    };
}

py::tuple render_scene(const py::object& scene_object, const py::object& width, const py::object& height,
                       const py::object& order, const py::object& tolerance, const py::object& noise_threshold,
                       const py::object& min_samples, const py::object& max_samples, const py::object& pixel_samples,
                       const py::object& time_limit, const py::object& pixel_filter, const py::object& filter_width,
                       const py::object& shadows, const py::object& shadow_rays, const py::object& transparent_bounces,
                       const py::object& max_bounces, const py::object& glossy_bounces,
                       const py::object& transmission_bounces, const py::object& filter_glossy,
                       const py::object& clamp_indirect, const py::object& darken_doubled, const py::object& passes,
                       const py::object& groups, const py::object& aovs, const py::object& alpha_threshold,
                       const py::object& mist, const py::object& cryptomatte_levels, const py::object& exposure,
                       const py::object& threads, const py::object& seed, const py::object& kept_light,
                       const py::object& progress, const py::object& on_update) {
    auto& scene = object_from<SceneObject>("scene", scene_object, "Scene");
    const int most_shadow_rays = int_from("shadow_rays", shadow_rays);
    const PassArguments pass_arguments = {passes, groups, aovs, alpha_threshold, mist, cryptomatte_levels};
    RenderSettings settings = {order_from(order),
                               real_from("tolerance", tolerance),
                               sampling_from(noise_threshold, min_samples, max_samples, pixel_samples, time_limit),
                               filter_from(pixel_filter, filter_width),
                               flag_from("shadows", shadows) ? most_shadow_rays : 0,
                               int_from("threads", threads),
                               seed_from(seed),
                               int_from("transparent_bounces", transparent_bounces),
                               int_from("max_bounces", max_bounces),
                               bounces_from("glossy_bounces", glossy_bounces),
                               bounces_from("transmission_bounces", transmission_bounces),
                               real_from("filter_glossy", filter_glossy),
                               real_from("clamp_indirect", clamp_indirect),
                               flag_from("darken_doubled", darken_doubled),
                               pass_settings_from(pass_arguments)};
    const int columns = int_from("width", width);
    const int rows = int_from("height", height);
    const auto light_factor = static_cast<float>(real_from("exposure", exposure));
    if (!(light_factor >= 0 && std::isfinite(light_factor))) {
        throw std::invalid_argument("exposure must be 0 or more, got " + std::to_string(light_factor));
    }
    check_render(settings, columns, rows);
    check_callable("on_update", on_update);
    KeptLight* kept =
        kept_light.is_none() ? nullptr : &object_from<KeptLight>("kept_light", kept_light, "KeptLight or None");
    const Progress report_progress = progress_from(progress);
    const Camera camera = camera_of(scene);
    const auto [compiled_scene, build_seconds] = compiled(scene, settings.threads, report_progress);
    add_named_passes(pass_arguments, scene, *compiled_scene, settings.passes);
    py::array_t<float> image({rows, columns, 4});
    py::array_t<float> values({rows, columns, static_cast<int>(PassLayout(settings.passes).stride())});
    const std::span<float> pixels(image.mutable_data(), static_cast<std::size_t>(image.size()));
    const RenderWatch watch = {report_progress, update_from(on_update, columns, rows, light_factor, build_seconds)};
    RenderReport report;
    {
        const GilReleased release;
        report = render(*compiled_scene, camera, columns, rows, settings, pixels, watch,
                        {values.mutable_data(), static_cast<std::size_t>(values.size())}, kept);
    }
    const py::object told = report_of(report, build_seconds, *compiled_scene, pixels);
    expose(image, 0, 3, light_factor);
    expose_light(settings.passes, values, light_factor);
    return py::make_tuple(pass_dict(settings.passes, scene, image, values), told);
}

std::string darkness(const CompiledScene& scene, std::span<const float> pixels, std::uint64_t hits) {
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (i % 4 != 3 && pixels[i] != 0) {
            return {};
        }
    }
    if (scene.lights().empty() && scene.environment().is_black()) {
        return "the scene has no light";
    }
    return hits == 0 ? std::string()
                     : "no light reaches what the camera sees; polygon lights shine to the side that sees their "
                       "vertices counter-clockwise, disk lights along half_axis_u x half_axis_v";
}

}  // namespace

py::object report_of(const RenderReport& report, double build_seconds, const CompiledScene& scene,
                     std::span<const float> pixels) {
    return py::cast(Report{report, build_seconds, darkness(scene, pixels, report.hits)});
}

void bind_render(py::module_& m) {
    py::register_exception<RenderCancelled>(m, "RenderCancelled", PyExc_RuntimeError);
    py::class_<Report> report_type(m, "RenderReport", "What a picture took.", without_constructor());
    define_pickling(report_type, &report_state, &report_from);
    report_type
        .def_property_readonly("order_shares", &Report::order_shares,
                               "Shares of what was shaded by harmonics, by their order. Once is a lobe of a camera hit "
                               "under a light that it sees.")
        .def_property_readonly("cubature_share", &Report::cubature_share, "Share of what was shaded by cubature.")
        .def_property_readonly("mirror_share", &Report::mirror_share, "Share of what mirrors showed.")
        .def_property_readonly("over_tolerance", &Report::over_tolerance,
                               "Share whose estimated error exceeds the tolerance.")
        .def_property_readonly(
            "hits", [](const Report& r) { return r.core.hits; }, "Camera rays that met a surface.")
        .def_property_readonly(
            "shadow_rays", [](const Report& r) { return r.core.shadow_rays; }, "Shadow rays traced.")
        .def_property_readonly(
            "records", [](const Report& r) { return r.core.records; },
            "Records of light that bounces that were gathered; those that a KeptLight had are none of them.")
        .def_property_readonly(
            "passes", [](const Report& r) { return r.core.passes; }, "Passes over the picture or some of its pixels.")
        .def_property_readonly(
            "noise", [](const Report& r) { return r.core.noise; },
            "Root mean square of the pixels' estimated errors, relative as noise_threshold; of a single pass 0, as in "
            "on_update until most pixels have rays that are kept.")
        .def_property_readonly(
            "seconds_left", [](const Report& r) { return r.core.seconds_left; },
            "Time that the render will probably go on; 0 when it has ended, or when nothing is known of it yet.")
        .def_readonly("build_seconds", &Report::build_seconds, "Time for building what rays are traced in; 0 if kept.")
        .def_readonly("dark", &Report::dark, "Why the picture is black, as far as light is missing; else empty.")
        .def_property_readonly(
            "doubled", [](const Report& r) { return r.core.doubled; },
            "Instances of meshes whose faces lie on others where the camera sees them, as pairs of "
            "SceneMesh.index and a number among its instances. shlight draws one of the faces as if "
            "the other were not there; renderers whose rays start on the surface in float show "
            "black or noise. Empty in on_update.")
        .def_property_readonly(
            "render_seconds", [](const Report& r) { return r.core.seconds; }, "Time for rendering.")
        .def_property_readonly(
            "stage_seconds", &Report::stage_seconds,
            "Time for each stage, summed over threads: camera rays; views, of the materials there; "
            "light, without shadows; shadows, drawing and weighing; shadow rays, tracing; pixels, adding "
            "up.")
        .def("__repr__", &Report::repr);
    py::class_<KeptLight>(m, "KeptLight", kKeptLightDoc, constructed_when_new())
        .def(py::init<>())
        .def("clear", &KeptLight::clear, "Forget all light.")
        .def_property(
            "max_bytes", &KeptLight::most_bytes,
            [](KeptLight& self, const py::object& bytes) {
                const auto most = integer_from("max_bytes", bytes, 0, std::numeric_limits<std::int64_t>::max());
                self.set_most_bytes(static_cast<std::size_t>(most));
            },
            "Memory that it may take between renders, about; what no picture has used for longest goes first.")
        .def_property_readonly("nbytes", &KeptLight::bytes, "Memory that it takes, about; 0 while a render uses it.")
        .def_property_readonly("record_count", &KeptLight::record_count,
                               "Records of light that are kept; 0 while a render uses them.")
        .def("__repr__", [](const KeptLight& self) {
            return "KeptLight(" + std::to_string(self.record_count()) + " records, " + std::to_string(self.bytes()) +
                   " bytes)";
        });
    m.def(
        "cryptomatte_hash", [](const std::string& name) { return cryptomatte_hash(name); }, "name"_a);
    m.def("render", &render_scene, kRenderDoc, "scene"_a, "width"_a, "height"_a, py::kw_only(), "order"_a = "auto",
          "tolerance"_a = kDefaultTolerance, "noise_threshold"_a = PixelSampling().noise_threshold,
          "min_samples"_a = py::none(), "max_samples"_a = py::none(), "pixel_samples"_a = py::none(),
          "time_limit"_a = py::none(), "pixel_filter"_a = "box", "filter_width"_a = PixelFilter().width,
          "shadows"_a = true, "shadow_rays"_a = RenderSettings().shadow_rays, "transparent_bounces"_a = 8,
          "max_bounces"_a = kDefaultBounces, "glossy_bounces"_a = py::none(), "transmission_bounces"_a = py::none(),
          "filter_glossy"_a = 0.0, "clamp_indirect"_a = 0.0, "darken_doubled"_a = false, "passes"_a = py::tuple(),
          "groups"_a = false, "aovs"_a = false, "alpha_threshold"_a = PassSettings().alpha_threshold,
          "mist"_a = py::make_tuple(MistRange().start, MistRange().depth, MistRange().falloff),
          "cryptomatte_levels"_a = PassSettings().cryptomatte_levels, "exposure"_a = 1.0, "threads"_a = 0, "seed"_a = 0,
          "kept_light"_a = py::none(), "progress"_a = py::none(), "on_update"_a = py::none());
}

}  // namespace shlight::python
