// SPDX-License-Identifier: MIT
//
// Scene.intersect and its like: points and rays in batches.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "arguments.h"
#include "chunks.h"
#include "gil.h"
#include "render_calls.h"
#include "scene_bindings.h"
#include "shlight/scene_queries.h"

using namespace pybind11::literals;

namespace shlight::python {
namespace {

constexpr const char* kIntersectDoc = R"(Find the first surface that each ray meets, opaque or not.

origins, directions: (n, 3), or (3,), which goes with all of the other; directions of any length > 0. A ray that begins
    on a surface may meet it: begin a little off it.
threads: at most; 0: all cores. The result does not depend on it.

Returns Hits, whose arrays have n rows.
Raises ValueError naming the argument and its row.)";

constexpr const char* kRadianceDoc = R"(Find what each ray sees, as a camera ray of shlight.render does.

origins, directions: (n, 3), or (3,), which goes with all of the other; directions of any length > 0. A ray that begins
    on a surface may meet it: begin a little off it. Textures are read where a ray meets them, without a footprint.
noise_threshold: a ray has been followed often enough where the estimated error of its mean, relative to
    sqrt(r^2 + 0.01 m^2), r its value and m the mean of all, is not above this; 0 ... 1, 0: all are followed max_samples
    times. What differs each time are shadow rays and the ways of light that bounces.
min_samples, max_samples: how often.
lights: False: light counts only if a surface has reflected it, not emission, lamps and the environment that the ray
    meets itself: what is left is what a surface at the ray's origin gets by one more bounce.
max_bounces: surfaces that light is reflected by before the one that the ray meets, at most; 0: direct light. It comes
    by drawn paths alone and takes many of them, where shlight.render makes records.
order, tolerance, shadows, shadow_rays, transparent_bounces, glossy_bounces, transmission_bounces, seed: see shlight.render.
threads: at most; 0: all cores. The result does not depend on it.
progress: is called with the finished share, 0 ... 1, about every 20 ms; returning False cancels.

Returns (n, 3), RGB [W m^-2 sr^-1]; 0 where a ray meets nothing and the environment is not visible. float32 if both
arrays are, otherwise float64; its precision is that of float32.
Raises ValueError naming the argument and its row, and RenderCancelled.)";

constexpr const char* kIrradianceDoc = R"(Find the light that falls on a surface at each point, with shadows.

points, normals: (n, 3), or (3,), which goes with all of the other; normals of any length > 0. Light counts from the side
    of the normal, as a diffuse surface there gets it; lights with diffuse=False do not count, the environment does.
rays: shadow rays of a point for each light, 0 ... 16384; brighter ones get up to twice as many, dim ones fewer, and a
    light one where rays from points nearby agree about it. 0: no shadows.
max_bounces: surfaces that light is reflected by before it falls on the point, at most; 0: direct light.
bounce_rays: rays of a point, 2 ... 16384, that find what surfaces reflect; glossy ones and small bright spots take many.
return_error: return (irradiance, error), error (n, 3) being the standard deviation that rays leave. That of shadow rays
    is estimated as if the edge of one shadow crossed each light, that of bounce_rays as if they were independent.
transparent_bounces, seed: see shlight.render. threads: at most; 0: all cores. The result does not depend on it.
progress: is called with the finished share, 0 ... 1, about every 20 ms; returning False cancels.

Returns (n, 3), RGB [W m^-2]; shlight.luminous makes illuminance of it. float32 if both arrays are, otherwise float64;
its precision is that of float32.
Raises ValueError naming the argument and its row, and RenderCancelled.)";

constexpr const char* kCoefficientsDoc =
    R"(Find the light that comes to each point, as coefficients.

points, normals: (n, 3), or (3,), which goes with all of the other; normals of any length > 0.
order: 1 ... 64.
tangents: (n, 3) or (3,), as of shlight.shading_frames, or None. Coefficients are in the frames that it makes of normals
    and tangents, clipped by the horizon.
shadows: False: as if nothing were in the way. Then they are exact for an environment of one radiance and for lights of
    even radiance: spheres, polygons, disks, suns, points and convex meshes. Others are summed over 4096 points of them.
rays: shadow rays of a point for each light, 0 ... 16384; 0: as shadows=False. They estimate the integral of visibility
    times each harmonic, without noise where all of them agree.
max_bounces: surfaces that light is reflected by before it comes to the point, at most; 0: the lights themselves.
bounce_rays: rays of a point, 2 ... 16384, that find what surfaces reflect.
return_error: return (coefficients, error), error (n, order^2, 3) being the standard deviation that rays leave. Shadow
    rays tell it by two halves of them, roughly for each number and rightly for the mean square of many.
transparent_bounces, seed: see shlight.render. threads: at most; 0: all cores. The result does not depend on it.
progress: is called with the finished share, 0 ... 1, about every 20 ms; returning False cancels.

Returns (n, order^2, 3), RGB; float32 if points and normals are, otherwise float64.
Raises ValueError naming the argument and its row, and RenderCancelled.)";

/// An array of vectors, of shape (n, 3) or (3,).
struct Vectors {
    Vectors(const char* argument, const py::object& value)
        : name(argument), array(array_from<double>(argument, value)), is_float(is_single(value)) {
        if (array.ndim() < 1 || array.ndim() > 2 || array.shape(array.ndim() - 1) != 3) {
            throw std::invalid_argument(std::string(name) + " must have shape (n, 3) or (3,)");
        }
    }
    bool is_one() const { return array.ndim() == 1; }
    std::size_t size() const { return static_cast<std::size_t>(array.size()) / 3; }

    const char* name;
    AnyArray<double> array;
    bool is_float;

  private:
    static bool is_single(const py::object& value) {
        if (!py::isinstance<py::array>(value)) {
            return false;
        }
        const py::dtype type = py::array(value).dtype();
        return type.kind() == 'f' && type.itemsize() == sizeof(float);  // of either byte order
    }
};

/// Two arrays of vectors whose rows belong together.
class Pairs {
  public:
    using Check = void (*)(std::span<const Vec3d>, std::span<const Vec3d>);

    /// Throws std::invalid_argument naming the argument and its row.
    Pairs(const Vectors& a, const Vectors& b, const Check& check, int threads)
        : first_(spread(a, b)), second_(spread(b, a)), is_float_(a.is_float && b.is_float) {
        if (first_.size() != second_.size()) {
            throw std::invalid_argument(std::string(b.name) + " must have as many rows as " + a.name + ", got " +
                                        std::to_string(second_.size()) + " and " + std::to_string(first_.size()));
        }
        try {
            in_chunks(size(), threads,
                      [&](std::size_t begin, std::size_t count) { check(first(begin, count), second(begin, count)); });
        } catch (const WrongRow& error) {
            const std::string text = error.what();
            const Vectors& wrong = text.rfind(a.name, 0) == 0 ? a : b;
            const std::string row = wrong.is_one() ? "" : "[" + std::to_string(error.row()) + "]";
            throw std::invalid_argument(wrong.name + row + text.substr(std::strlen(wrong.name)));
        }
    }

    std::size_t size() const { return first_.size(); }
    std::span<const Vec3d> first() const { return first_; }
    std::span<const Vec3d> second() const { return second_; }
    std::span<const Vec3d> first(std::size_t begin, std::size_t count) const { return first().subspan(begin, count); }
    std::span<const Vec3d> second(std::size_t begin, std::size_t count) const { return second().subspan(begin, count); }
    /// In the type of the vectors: float32 if both are, otherwise float64.
    py::array typed(const py::array_t<double>& values) const {
        return is_float_ ? py::array(py::array_t<float>(values)) : py::array(values);
    }

  private:
    static std::vector<Vec3d> spread(const Vectors& own, const Vectors& other) {
        const std::span<const Vec3d> all = vectors(own.name, own.array);
        return own.is_one() && !other.is_one() ? std::vector<Vec3d>(other.size(), all.front())
                                               : std::vector<Vec3d>(all.begin(), all.end());
    }

    std::vector<Vec3d> first_, second_;
    bool is_float_;
};

int threads_from(const py::object& threads) {
    return static_cast<int>(integer_from("threads", threads, 0, std::numeric_limits<int>::max()));
}

/// An array of a number, or of some, of each row.
template <class T>
class Column {
  public:
    Column(std::size_t rows, std::vector<py::ssize_t> core) : array_(shape(rows, std::move(core))) {}

    /// value: the numbers of a row.
    template <class Value>
    void set(std::size_t row, const Value& value) {
        std::memcpy(static_cast<char*>(static_cast<void*>(array_.mutable_data())) + row * sizeof(Value), &value,
                    sizeof(Value));
    }
    const py::array_t<T>& array() const { return array_; }

  private:
    static std::vector<py::ssize_t> shape(std::size_t rows, std::vector<py::ssize_t> core) {
        core.insert(core.begin(), static_cast<py::ssize_t>(rows));
        return core;
    }

    py::array_t<T> array_;
};

py::object intersect_scene(SceneObject& self, const py::object& origins, const py::object& directions,
                           const py::object& threads) {
    const int count = threads_from(threads);
    const Pairs rays({"origins", origins}, {"directions", directions}, &check_rays, count);
    const auto scene = compiled(self, count, progress_from(py::none())).first;
    const std::size_t n = rays.size();
    Column<double> distance(n, {});
    Column<double> position(n, {3});
    Column<double> normal(n, {3});
    Column<double> shading_normal(n, {3});
    Column<double> uv(n, {2});
    Column<std::int64_t> mesh(n, {});
    Column<std::int64_t> instance(n, {});
    Column<std::int64_t> triangle(n, {});
    in_chunks(n, count, [&](std::size_t first, std::size_t size) {
        std::vector<SurfaceHit> hits(size);
        intersect(*scene, rays.first(first, size), rays.second(first, size), hits);
        for (std::size_t i = 0; i < size; ++i) {
            distance.set(first + i, hits[i].distance);
            position.set(first + i, hits[i].position);
            normal.set(first + i, hits[i].normal);
            shading_normal.set(first + i, hits[i].shading_normal);
            uv.set(first + i, hits[i].uv);
            mesh.set(first + i, hits[i].mesh);
            instance.set(first + i, hits[i].instance);
            triangle.set(first + i, hits[i].triangle);
        }
    });
    return py::module_::import("shlight.queries")
        .attr("Hits")("distance"_a = rays.typed(distance.array()), "position"_a = rays.typed(position.array()),
                      "normal"_a = rays.typed(normal.array()), "shading_normal"_a = rays.typed(shading_normal.array()),
                      "uv"_a = rays.typed(uv.array()), "mesh"_a = mesh.array(), "instance"_a = instance.array(),
                      "triangle"_a = triangle.array());
}

/// Runs a query without the GIL. It is called with a Progress that asks the caller's function, and looks for Ctrl-C,
/// now and then where the thread that called is asked.
template <class Query>
void run_query(const Progress& report, const Query& query) {
    const GilReleased release;
    SignalWatch watch;
    query(Progress([&](double share) { return !watch.is_due() || report(share); }));
    if (!report(1)) {
        throw RenderCancelled();
    }
}

std::span<Vec3d> vectors_of(py::array_t<double>& array) {
    return {reinterpret_cast<Vec3d*>(array.mutable_data()), static_cast<std::size_t>(array.size()) / 3};
}

py::array radiance_of_rays(SceneObject& self, const py::object& origins, const py::object& directions,
                           const py::object& order, const py::object& tolerance, const py::object& noise_threshold,
                           const py::object& min_samples, const py::object& max_samples, const py::object& lights,
                           const py::object& shadows, const py::object& shadow_rays,
                           const py::object& transparent_bounces, const py::object& max_bounces,
                           const py::object& glossy_bounces, const py::object& transmission_bounces,
                           const py::object& threads, const py::object& seed, const py::object& progress) {
    RenderSettings settings;
    settings.order = order_from(order);
    settings.tolerance = real_from("tolerance", tolerance);
    settings.sampling.noise_threshold = real_from("noise_threshold", noise_threshold);
    settings.sampling.min_samples = samples_from("min_samples", min_samples);
    settings.sampling.max_samples = samples_from("max_samples", max_samples);
    settings.shadow_rays = flag_from("shadows", shadows) ? int_from("shadow_rays", shadow_rays) : 0;
    settings.transparent_bounces = int_from("transparent_bounces", transparent_bounces);
    settings.max_bounces = int_from("max_bounces", max_bounces);
    settings.glossy_bounces = bounces_from("glossy_bounces", glossy_bounces);
    settings.transmission_bounces = bounces_from("transmission_bounces", transmission_bounces);
    settings.threads = threads_from(threads);
    settings.seed = seed_from(seed);
    check_render(settings, 1, 1);
    const bool sees_lights = flag_from("lights", lights);
    const Progress report = progress_from(progress);
    const Pairs rays({"origins", origins}, {"directions", directions}, &check_rays, settings.threads);
    const auto scene = compiled(self, settings.threads, report).first;
    py::array_t<double> result({static_cast<py::ssize_t>(rays.size()), py::ssize_t{3}});
    const std::span<Vec3d> seen = vectors_of(result);
    run_query(report, [&](const Progress& watched) {
        radiance(*scene, rays.first(), rays.second(), settings, sees_lights, seen, watched);
    });
    return rays.typed(result);
}

PointSettings point_settings(const py::object& shadows, const py::object& rays, const py::object& max_bounces,
                             const py::object& bounce_rays, const py::object& transparent_bounces,
                             const py::object& threads, const py::object& seed) {
    const int most = int_from("rays", rays);
    const PointSettings settings = {flag_from("shadows", shadows) ? most : 0,
                                    int_from("transparent_bounces", transparent_bounces),
                                    int_from("max_bounces", max_bounces),
                                    int_from("bounce_rays", bounce_rays),
                                    threads_from(threads),
                                    seed_from(seed)};
    check_settings(settings);
    return settings;
}

/// A query returns this: its result, or that and its error.
py::object with_error_of(const Pairs& pairs, const py::array_t<double>& result, const py::array_t<double>& error,
                         bool with_error) {
    return with_error ? py::object(py::make_tuple(pairs.typed(result), pairs.typed(error)))
                      : py::object(pairs.typed(result));
}

py::object irradiance_at(SceneObject& self, const py::object& points, const py::object& normals, const py::object& rays,
                         const py::object& max_bounces, const py::object& bounce_rays, const py::object& return_error,
                         const py::object& transparent_bounces, const py::object& threads, const py::object& seed,
                         const py::object& progress) {
    const PointSettings settings =
        point_settings(py::bool_(true), rays, max_bounces, bounce_rays, transparent_bounces, threads, seed);
    const bool with_error = flag_from("return_error", return_error);
    const Progress report = progress_from(progress);
    const Pairs pairs({"points", points}, {"normals", normals}, &check_points, settings.threads);
    const auto scene = compiled(self, settings.threads, report).first;
    const auto rows = static_cast<py::ssize_t>(pairs.size());
    py::array_t<double> result({rows, py::ssize_t{3}});
    py::array_t<double> error({with_error ? rows : 0, py::ssize_t{3}});
    const std::span<Vec3d> all = vectors_of(result);
    const std::span<Vec3d> errors = vectors_of(error);
    run_query(report, [&](const Progress& watched) {
        irradiance(*scene, pairs.first(), pairs.second(), settings, all, errors, watched);
    });
    return with_error_of(pairs, result, error, with_error);
}

/// The frames that shlight.shading_frames makes.
std::vector<glm::dmat3> frames_from(const py::object& normals, const py::object& tangents, std::size_t count) {
    const py::object made = py::module_::import("shlight.queries").attr("shading_frames")(normals, tangents);
    const AnyArray<double> array(made);
    const auto given = static_cast<std::size_t>(array.size()) / 9;
    if (array.ndim() > 3 || (given != count && array.ndim() == 3)) {
        throw std::invalid_argument("tangents must have as many rows as points, or shape (3,)");
    }
    std::vector<glm::dmat3> frames(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double* rows = array.data() + 9 * (array.ndim() == 3 ? i : 0);
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) {
                frames[i][column][row] = rows[3 * row + column];
            }
        }
    }
    return frames;
}

py::object light_coefficients_at(SceneObject& self, const py::object& points, const py::object& normals,
                                 const py::object& order, const py::object& tangents, const py::object& shadows,
                                 const py::object& rays, const py::object& max_bounces, const py::object& bounce_rays,
                                 const py::object& return_error, const py::object& transparent_bounces,
                                 const py::object& threads, const py::object& seed, const py::object& progress) {
    const int n = static_cast<int>(integer_from("order", order, 1, kMaxOrder));
    const PointSettings settings =
        point_settings(shadows, rays, max_bounces, bounce_rays, transparent_bounces, threads, seed);
    const bool with_error = flag_from("return_error", return_error);
    const Progress report = progress_from(progress);
    const Pairs pairs({"points", points}, {"normals", normals}, &check_points, settings.threads);
    const std::vector<glm::dmat3> frames = frames_from(normals, tangents, pairs.size());
    const auto scene = compiled(self, settings.threads, report).first;
    const auto rows = static_cast<py::ssize_t>(pairs.size());
    py::array_t<double> result({rows, py::ssize_t{coefficient_count(n)}, py::ssize_t{3}});
    py::array_t<double> error({with_error ? rows : 0, py::ssize_t{coefficient_count(n)}, py::ssize_t{3}});
    const std::span<double> all(result.mutable_data(), static_cast<std::size_t>(result.size()));
    const std::span<double> errors(error.mutable_data(), static_cast<std::size_t>(error.size()));
    run_query(report, [&](const Progress& watched) {
        light_coefficients(*scene, pairs.first(), frames, n, settings, all, errors, watched);
    });
    return with_error_of(pairs, result, error, with_error);
}

}  // namespace

void bind_queries(py::class_<SceneObject>& scene) {
    scene.def("intersect", &intersect_scene, kIntersectDoc, "origins"_a, "directions"_a, py::kw_only(),
              "threads"_a = 0);
    scene.def("radiance", &radiance_of_rays, kRadianceDoc, "origins"_a, "directions"_a, py::kw_only(),
              "order"_a = "auto", "tolerance"_a = kDefaultTolerance,
              "noise_threshold"_a = PixelSampling().noise_threshold, "min_samples"_a = 1,
              "max_samples"_a = PixelSampling().max_samples, "lights"_a = true, "shadows"_a = true,
              "shadow_rays"_a = RenderSettings().shadow_rays, "transparent_bounces"_a = 8, "max_bounces"_a = 0,
              "glossy_bounces"_a = py::none(), "transmission_bounces"_a = py::none(), "threads"_a = 0, "seed"_a = 0,
              "progress"_a = py::none());
    scene.def("irradiance", &irradiance_at, kIrradianceDoc, "points"_a, "normals"_a, py::kw_only(),
              "rays"_a = PointSettings().rays, "max_bounces"_a = 0, "bounce_rays"_a = PointSettings().bounce_rays,
              "return_error"_a = false, "transparent_bounces"_a = 8, "threads"_a = 0, "seed"_a = 0,
              "progress"_a = py::none());
    scene.def("light_coefficients", &light_coefficients_at, kCoefficientsDoc, "points"_a, "normals"_a, "order"_a,
              py::kw_only(), "tangents"_a = py::none(), "shadows"_a = true, "rays"_a = PointSettings().rays,
              "max_bounces"_a = 0, "bounce_rays"_a = PointSettings().bounce_rays, "return_error"_a = false,
              "transparent_bounces"_a = 8, "threads"_a = 0, "seed"_a = 0, "progress"_a = py::none());
}

}  // namespace shlight::python
