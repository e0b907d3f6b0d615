// SPDX-License-Identifier: MIT
//
// What the camera rays of a batch meet: surfaces, one behind the other as long as they let light through, and at last
// the background. Shader programs run here, over all surfaces of a material at once.
//
// Paths go on from surfaces, as many times as PathSettings allows: from a mirror into its direction, and from a glossy
// lobe into a drawn one. What they meet is shaded like what the camera sees, with the share of its light that the path
// brings to the camera in the weights of its lobes. Light that bounces and that a diffuse lobe reflects comes from
// records near it (surfaces/light_records.h), or by a path where there are none.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "lobes/material_lobes.h"
#include "lobes/refraction.h"
#include "shlight/scene.h"
#include "shlight/types.h"
#include "surfaces/doubled_faces.h"
#include "surfaces/lamp_drawer.h"
#include "surfaces/placed_meshes.h"
#include "surfaces/stored_light.h"
#include "surfaces/subsurface_walks.h"
#include "surfaces/visible_lamps.h"
#include "tracing/hits.h"

namespace shlight {

/// A camera ray of a picture, or another that paths begin with.
struct CameraRay {
    Ray ray;
    std::uint32_t sample;  ///< its number within its pixel
    std::uint32_t seed;    ///< of the directions that are drawn on its path
};

/// The origin of a ray.
enum class RaySource : std::uint8_t {
    camera,
    held_out,  ///< the camera's ends at a holdout and goes on where that is transparent
    mirror,    ///< no other light of a mirror is counted: its ray sees lamps, the background, and surfaces shine
    scattered  ///< by a lobe whose direct light counts apart: its ray sees what reflects light
};

struct PathSettings {
    /// Surfaces that a ray passes through, as Cycles counts them: a camera ray passes through one more, and of the next
    /// one it sees the emission alone.
    std::uint32_t transparent_bounces;
    /// Surfaces between the light and the one whose light reaches the camera; 0: direct light.
    std::uint32_t max_bounces;
    std::uint32_t glossy_bounces, transmission_bounces;  ///< of these, at most
    const StoredLight* stored = nullptr;                 ///< outlives this; null: none
    bool scatters = true;                                ///< false: paths end at lobes whose direct light counts apart
    double filter_glossy = 0;                            ///< see RenderSettings
    double least_width = 0;    ///< of lobes of microfacets that vary and that are met by a filtered path
    float clamp_indirect = 0;  ///< see RenderSettings
    /// A flag for each placement: its faces are dark where they lie on others. Outlives this; null: none are.
    const std::vector<bool>* doubled = nullptr;

    /// The share that is left of light that has bounced.
    float kept(const Rgb& light) const {
        const float mean = (std::abs(light.x) + std::abs(light.y) + std::abs(light.z)) / 3;
        return clamp_indirect > 0 && mean > clamp_indirect ? clamp_indirect / mean : 1.0F;
    }
};

/// Camera rays beside another, as far away as its share of the pixel is wide. Those of other rays are not read.
struct NeighbourRays {
    Ray right, below;
    double width, spread;  ///< a pixel's width [m] where the ray begins, and what it grows by along the ray [1]
};

/// Light of a camera ray that is met along its path: emission of surfaces, lamps, and the background, also in mirrors.
struct RayLight {
    Rgb radiance{0};
    Rgb drawn{0};       ///< the part that has come by directions that were drawn
    float opacity = 1;  ///< the part that does not stay empty
};

/// A lobe as a camera ray meets it.
struct SurfaceLobe {
    LobeShape shape;
    Vec3d normal;                  ///< unit, on the side from which it takes light
    Rgb weight;                    ///< colour, as of a surface that nothing stands before
    bool several_bounces = false;  ///< see ShadedLobe
    bool translucent = false;      ///< see ShadedLobe
    Vec3d leans_from{0};           ///< of a bump, the smooth normal; 0: the lobe is none of a bump
    Vec3d smooth{0};               ///< the same of any lobe, where it is not the point's

    Vec3d viewers_normal() const { return translucent ? -normal : normal; }
    bool is_bumped() const { return leans_from != Vec3d(0); }
    /// The point as the side has it from which it takes light.
    SurfacePoint lit_side(const SurfacePoint& point) const { return translucent ? point.turned() : point; }
};

/// Keeps its memory from batch to batch; one per thread.
class CameraSurfaces {
  public:
    /// transparent_bounces: as Cycles counts them, a camera ray passes through one surface more, and of the next one
    /// it sees the emission alone.
    CameraSurfaces(const CompiledScene& scene, std::span<const MaterialLobes> materials, const PathSettings& settings)
        : scene_(&scene), materials_(materials), settings_(settings), has_bodies_(has_absorbing(scene.materials())) {}

    void follow(const PathSettings& settings) { settings_ = settings; }
    const PathSettings& settings() const { return settings_; }
    /// rays: those of a pixel, rays_per_pixel, follow each other. neighbours: of each ray, or none if no program takes
    /// differences. light: one for each ray. Clears the hits first.
    void trace(std::span<const CameraRay> rays, std::span<const NeighbourRays> neighbours, std::size_t rays_per_pixel,
               Hits& hits, std::vector<RayLight>& light);
    /// The same for rays that surfaces scatter. light: of each ray what has bounced once, twice … max_bounces times.
    /// Each of these has parts of its own, by the same numbers.
    void trace_scattered(std::span<const CameraRay> rays, std::span<const NeighbourRays> neighbours,
                         std::size_t rays_per_group, Hits& hits, std::vector<RayLight>& light);

    /// The path of a camera ray from its beginning, a surface that reflects, or one that lets light through, to the
    /// next surface.
    struct Segment {
        std::size_t ray;
        RaySource source;
        std::uint32_t bounces;  ///< surfaces that have reflected the path
        std::uint32_t depth;    ///< surfaces that it has passed through since
        PathKind kind;
        Rgb throughput;                      ///< share of its light that reaches the camera
        Ray whole;                           ///< from where the camera ray, or the reflecting surface's, begins
        std::uint32_t seen_by = kCameraRay;  ///< the kinds of its rays
        std::uint32_t glossy = 0, transmissions = 0;  ///< of the bounces
        bool is_drawn = false;                        ///< by a lobe, or one before, from which directions are drawn
        bool is_broad = false;                        ///< its end need not be seen sharply
        bool diffused = false;                        ///< by a surface before
        bool filtered = false;                        ///< it has come by an improbable way, see filter_glossy
        std::optional<std::uint32_t> exit_lobe{};     ///< it ends where light enters a body for this lobe
        std::optional<std::uint32_t> light_set{};     ///< of the surface that has reflected it; see MeshUse
        /// [1/m] of the bodies that it runs in, as far as they are known, and of those behind its end.
        Rgb absorption{0}, absorption_beyond{0};
        double travelled = 0;                                      ///< from the camera to where `whole` begins [m]
        double density = std::numeric_limits<double>::infinity();  ///< see drawn_part(); infinite: no lamp is drawn
        float chance = 1;  ///< with which Cycles' path goes through the interfaces, and is not reflected

        bool sees_lights() const { return source != RaySource::scattered && source != RaySource::held_out; }
        /// The path on from its end. by: what sends it there; through: to the other side.
        Segment next(RaySource origin, PathKind by, bool through, const Rgb& share, const Ray& way) const {
            return {ray,
                    origin,
                    bounces + 1,
                    0,
                    kind_after(by),
                    share,
                    way,
                    through                   ? kTransmissionRay
                    : by == PathKind::diffuse ? kDiffuseRay
                                              : kGlossyRay,
                    glossy + (by == PathKind::glossy ? 1 : 0),
                    transmissions + (through ? 1 : 0),
                    is_drawn,
                    false,
                    diffused || by == PathKind::diffuse,
                    filtered,
                    {},
                    {},
                    through ? absorption_beyond : absorption};
        }
        Segment from(const Material& material) const {
            Segment own = *this;
            own.light_set = material.light_set;
            return own;
        }
        Segment drawn(bool rough, bool broad, bool improbable = false) const {
            Segment own = *this;
            own.is_drawn = is_drawn || rough;
            own.is_broad = broad;
            own.filtered = filtered || improbable;
            return own;
        }
        PathKind kind_after(PathKind by) const { return bounces > 0 ? kind : by; }
        /// Bounces of light that is emitted where it ends.
        std::uint32_t emitted_bounces() const { return bounces - (source == RaySource::mirror ? 1 : 0); }
        /// The kind of light that it meets. camera: of what the camera itself sees.
        LightKind met(LightKind camera) const {
            return bounces == 0 ? camera : bounces == 1 ? direct_kind(kind) : indirect_kind(kind);
        }
    };
    /// The surface at the end of a segment.
    struct Surface : Segment {
        RayHit hit;
        SurfacePoint point;
        Vec3d towards_viewer;
        double distance;      ///< from the origin of the whole ray
        Cover cover;          ///< by a face that lies on it and stops light that it reflects
        std::size_t results;  ///< of its program: where the first is
        std::size_t stride;   ///< and from result to result

        /// Distance from where the whole ray begins, at its t_min.
        double ray_length() const { return distance - whole.t_min; }
        Segment next(RaySource origin, PathKind by, bool through, const Rgb& share, const Ray& way) const {
            Segment on = Segment::next(origin, by, through, share, way);
            on.travelled = travelled + distance;
            on.chance = chance;
            return on;
        }
    };

    // Results of the last call:
    /// Numbers of camera rays that met a surface, and of paths into mirrors.
    std::uint64_t hit_count() const { return hit_count_; }
    std::uint64_t mirror_count() const { return mirror_count_; }
    /// All surfaces; those that one camera ray has met itself are ordered by distance.
    std::span<const Surface> surfaces() const { return surfaces_; }
    /// Segment::is_drawn and Segment::chance of each hit.
    std::span<const std::pair<bool, float>> hit_paths() const { return hit_paths_; }
    void find_lobes(const Surface& surface, std::vector<SurfaceLobe>& lobes) const;
    /// The share of light that the viewer gets of what is behind interfaces, by Fresnel's law at their smooth surface.
    Rgb refracted(const Surface& surface) const;
    /// The share of light that goes on straight through, not negative.
    Rgb transparency(const Surface& surface) const;
    /// A result of its program.
    float result(const Surface& surface, std::uint32_t number) const {
        return results_[surface.results + number * surface.stride];
    }

  private:
    /// Destination of the light of a call's rays.
    struct Sink {
        std::vector<RayLight>& light;  // of each ray: at all, or by the number of bounces
        LightGroupBuffer& apart;
        std::size_t rays_per_pixel;
        std::uint32_t first_bounces;  // light that has bounced so often is a ray's first; 0: it is not told apart
        std::uint32_t counts;         // numbers of bounces that are told apart

        std::size_t number(const Segment& segment, std::uint32_t bounces) const {
            return segment.ray * counts + (first_bounces > 0 ? bounces - first_bounces : 0);
        }
        std::size_t in_apart(const Segment& segment, std::uint32_t bounces) const {
            return first_bounces > 0 ? number(segment, bounces) : segment.ray / rays_per_pixel;
        }
        void add(const Segment& segment, std::uint32_t bounces, const Rgb& radiance) const {
            RayLight& own = light[number(segment, bounces)];
            own.radiance += radiance;
            own.drawn += segment.is_drawn ? radiance : Rgb(0);
        }
    };
    /// One of the paths that share what a lobe reflects.
    struct Division {
        std::uint32_t paths, path;
        bool is_broad;
    };
    void trace(const Segment& beginning, std::span<const NeighbourRays> neighbours, const Sink& sink, Hits& hits);
    void start(const Segment& segment, const Ray& part);
    /// Dims a path by what bodies absorb on its last part, of this length.
    void absorb(Surface& end, double length) const;
    /// Whether some material absorbs light inside a body.
    static bool has_absorbing(std::span<const Material> materials);
    /// Absorption where a ray begins.
    Rgb absorption_at(const Ray& ray) const;
    void meet(const Sink& sink);
    void leave_scene(const Segment& segment, const Sink& sink);
    /// A part of the picture stays empty.
    static void leave_empty(const Segment& segment, const Rgb& part, const Sink& sink) {
        sink.light[segment.ray].opacity -= (part.x + part.y + part.z) / 3;
    }
    void add_lamps(LampViewer viewer, const Segment& segment, const Ray& part, const std::optional<double>& surface,
                   const Sink& sink);
    /// Light that a segment meets. kind: see Segment::met. whole: before it is clamped.
    void add_light(const Segment& segment, LightKind kind, std::uint32_t group, const Rgb& whole,
                   const Sink& sink) const;
    /// The share that is left of light that is emitted where a segment ends. A path of Cycles goes one way at an
    /// interface.
    float kept(const Segment& segment, const Rgb& radiance) const {
        return segment.emitted_bounces() > 0 ? settings_.kept(radiance / segment.chance) : 1.0F;
    }
    Cover cover(const RayHit& hit, const SurfacePoint& point, const Vec3d& towards_viewer);
    /// Paths from a covered surface, which the face above sends back to either side.
    void leave_gap(std::size_t number, const Sink& sink);
    void run_programs(std::span<const NeighbourRays> neighbours, std::size_t first);
    void run_program(std::span<const NeighbourRays> neighbours, std::span<const std::uint32_t> surfaces);
    PlacesBeside places_beside(const SurfacePlace& place, const Surface& surface, const NeighbourRays& neighbours,
                               double slope_width) const;
    void add_emission(const Surface& surface, const Sink& sink);
    void pass_on(std::size_t first, const Sink& sink);
    bool is_shaded(const Segment& segment) const {
        return segment.source != RaySource::held_out && segment.bounces <= settings_.max_bounces &&
               segment.glossy <= settings_.glossy_bounces && segment.transmissions <= settings_.transmission_bounces &&
               segment.depth <= settings_.transparent_bounces;
    }
    bool reflects(const Surface& surface) const { return is_shaded(surface) && surface.cover == Cover::none; }
    /// A ray through a body, of which all hits are places near a surface.
    struct SubsurfaceProbe {
        std::size_t surface;
        std::uint32_t lobe;
        std::size_t axis;
        std::array<Vec3d, 3> axes;
        Ray ray;
        Rgb inverse, throughput;
        double radius;  ///< from the axis through the surface
    };
    /// Begins walks below surfaces, first … last - 1, that light comes out of.
    void enter_bodies(std::size_t first, std::size_t last);
    void enter_body(std::size_t number, std::uint32_t lobe);
    /// The direction below a surface, in the frame of a lobe.
    Vec3d way_below(const Surface& surface, const ShadedSubsurface& own, const ShadingFrame& frame,
                    glm::dvec2 point) const;
    /// Looks for places near a surface where light enters. inverse: see ShadedSubsurface.
    void probe_body(std::size_t number, std::uint32_t lobe, const Rgb& inverse, const Rgb& throughput,
                    glm::dvec2 point);
    /// Adds the surfaces that walks and probes end at.
    void leave_bodies();
    void leave_probe(const SubsurfaceProbe& probe, const RayHit& hit);
    /// way: of the path, out of the body.
    void leave_body(std::size_t number, std::uint32_t lobe, const RayHit& hit, const Vec3d& way, const Rgb& throughput);
    /// Takes what enters below a surface out of lobes_, of which the places where it does have hits of their own.
    void drop_entered(const Surface& surface);
    /// The lobes by which light comes out of a body that has entered it by the surface's exit_lobe.
    void find_exit_lobes(const Surface& surface, const SurfaceShader& shader, std::vector<SurfaceLobe>& lobes) const;
    /// The paths that go on from a surface by its lobes.
    void reflect(const Surface& surface, const Sink& sink);
    void reflect_mirror(const Surface& surface, const SurfaceLobe& lobe, const Sink& sink);
    /// The share of scattered paths that go on from a surface, which is less than 1 once those of a ray have met many.
    float share_in_crowd(const Surface& surface) const;
    /// Whether a path that it lets pass is one of them.
    bool passes_crowd(const Surface& surface) const;
    /// Paths by the lobe with this number, and those of the same distribution.
    void scatter(const Surface& surface, std::size_t first);
    void scatter(const Surface& surface, std::size_t first, std::uint32_t seed, const Division& division);
    /// Adds the light of the cell that a segment ends in. Returns false where it is unknown.
    bool add_cell(const Surface& end, const Sink& sink);
    /// Adds light (StoredLight) the first of which has bounced so often. kind: of the path that it comes by.
    void add_stored(const Segment& segment, std::uint32_t bounces, PathKind kind, const Rgb& weight,
                    std::span<const Rgb> light, const Sink& sink) const;
    /// Adds what a diffuse lobe reflects of light that has bounced. Returns false where no records are near.
    bool add_recorded(const Surface& surface, const SurfaceLobe& lobe, const Sink& sink);
    /// The view of a lobe; a bump's is the smooth normal. A translucent lobe has none, and looks the same from
    /// everywhere.
    static const Vec3d& view_of(const Surface& surface, const SurfaceLobe& lobe) {
        return lobe.translucent ? lobe.normal : lobe.is_bumped() ? lobe.leans_from : surface.towards_viewer;
    }
    ShadingFrame frame_of(const Surface& surface, const SurfaceLobe& lobe) const;
    /// A shape as it lies on the surface, see PlacedMeshes::azimuth().
    LobeShape laid_out(const Surface& surface, const LobeShape& shape) const;
    /// point: of own.lit_side().
    Terminator terminator(const Surface& surface, const SurfaceLobe& own, const SurfacePoint& point) const;
    /// SurfaceLobe::leans_from of a bump. own: its normal.
    Vec3d leaning(const Surface& surface, const ShadedLobe& lobe, const Vec3d& own) const;
    /// The shape of a shader's lobe whose width varies. normal: of the lobe.
    LobeShape varied(const Surface& surface, const ShadedLobe& lobe, const Vec3d& normal) const;
    void add_hits(const Sink& sink, Hits& hits);
    void add_hit(const Surface& surface, const Sink& sink, Hits& hits);
    /// A path through an interface, or inside back from it.
    void refract(const Surface& surface, const ShadedRefraction& refraction, std::uint32_t number, const Sink& sink);
    double ior(const Surface& surface, const ShadedRefraction& refraction) const;
    void refract(const Surface& surface, const ShadedRefraction& refraction, std::uint32_t seed,
                 const Division& division, const Sink& sink);
    /// An interface, as one path meets it.
    struct Interface {
        RoughInterface shape;
        ShadingFrame frame;
        Vec3d view;  ///< in the frame

        bool is_rough() const;
    };
    /// Adds the light of lamps through a rough interface by directions to them; see drawn_part().
    /// path: to the side of `frame`, of which the lamps are.
    void add_drawn_lamps(const Surface& surface, const Interface& interface, const ShadingFrame& frame,
                         const Segment& path, std::uint32_t seed, std::uint32_t number, const Sink& sink);
    /// The number of lamps of which add_drawn_lamps() draws one; 1: it draws a direction to each.
    double number_of_draws() const;
    Division division(const Surface& surface, double share, double width) const;
    /// Unit. result: see ShadedLobe::normal.
    Vec3d normal(const Surface& surface, const std::optional<std::uint32_t>& result) const;
    Vec3d vector(const Surface& surface, std::uint32_t result) const;
    /// A colour in which components that are not finite are 0.
    Rgb color(const Surface& surface, std::uint32_t result) const;
    float width(const Surface& surface, std::uint32_t result) const;

    const CompiledScene* scene_;
    std::span<const MaterialLobes> materials_;
    PathSettings settings_;
    bool has_bodies_;                  // that absorb light
    std::span<const CameraRay> rays_;  // of the last call
    std::uint64_t hit_count_ = 0, mirror_count_ = 0;
    std::vector<Segment> segments_;
    std::vector<Ray> parts_;     // of each segment's ray, what is left
    std::vector<Rgb> by_group_;  // of lamps along a ray
    std::vector<SurfaceLobe> lobes_;
    std::vector<RayHit> met_, near_;
    std::vector<Surface> surfaces_;
    std::vector<SubsurfaceWalk> walks_;
    std::vector<SubsurfaceProbe> probes_;
    std::vector<std::uint32_t> order_, material_of_, met_by_ray_;
    std::vector<ShadedPlace> places_;
    std::vector<PlacesBeside> beside_;
    std::vector<float> results_;
    ShaderProgram::Registers registers_;
    std::vector<std::pair<bool, float>> hit_paths_;
    std::vector<std::uint8_t> taken_;  // by lobe: whether a hit or a path has it
    std::vector<Rgb> weights_;
    std::vector<LobeForm> forms_;
    std::vector<Rgb> recorded_;  // see StoredLight
    LampDrawer drawer_;
};

}  // namespace shlight
