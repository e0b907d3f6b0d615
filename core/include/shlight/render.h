// SPDX-License-Identifier: MIT
//
// Pictures: direct light from area lights by Eq. 5 of Zhou & Wei 2020, times a visibility ratio from shadow rays.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "shlight/camera.h"
#include "shlight/kept_light.h"
#include "shlight/parallel.h"
#include "shlight/render_passes.h"
#include "shlight/render_report.h"
#include "shlight/scene.h"
#include "shlight/types.h"

namespace shlight {

inline constexpr int kMostPixelSamples = 1 << 20;
inline constexpr int kMostBounces = 1024;

/// Camera rays of a pixel. The first pass takes first_samples of each; the second four times as many of all pixels that
/// need them, and later ones twice as many. Those of all passes are spread evenly over the pixel's square together; a
/// first pass of one ray goes through its middle, and those of the next take its place. Where every pixel gets more
/// than that, it takes one pixel of four.
struct PixelSampling {
    int first_samples = 1;  ///< rounded up to a power of two, unless it is max_samples
    int min_samples = 4;
    int max_samples = 256;
    /// A pixel has enough rays where the estimated error of its mean, relative to √(r² + 0.01 r̄²), r the pixel's value
    /// and r̄ the picture's mean, is not above this. 0: all pixels get max_samples.
    double noise_threshold = 0.01;
    /// [s]: the render ends then, as soon as the batches of pixels at hand are done; ≤ 0: there is no limit.
    double time_limit = 0;

    /// So many rays of each pixel at once, and no others.
    static PixelSampling fixed(int samples) { return {samples, samples, samples, 0, 0}; }
    /// So many rays of each pixel at once, rounded up to a power of two, and up to 16 times as many where they are
    /// needed. One ray cannot disagree and stays one.
    static PixelSampling refined(int samples);
};

/// How the camera rays around a pixel's middle weigh in its mean: they are drawn as often as they weigh. Widths are
/// those that Blender's render engine Cycles calls so.
struct PixelFilter {
    enum class Kind : std::uint8_t {
        box,              ///< the pixel's own square, whatever the width
        gaussian,         ///< exp(-8 (v / width)²) on |v| < 1.5 width, along each axis
        blackman_harris,  ///< of 2 width in all
    };
    Kind kind = Kind::box;
    double width = 1.5;  ///< pixels

    /// Distance from the middle, in pixels, below which a share of all rays lies, along either axis.
    double place(double share) const;
};

struct RenderSettings {
    int order = 0;  ///< 1 … 64: harmonics of this order for every light; 0: the cheapest that meets the tolerance
    /// Error of the light that a point reflects to the camera ÷ that light, or ÷ a tenth of the picture's mean where
    /// that is larger. Only for order 0.
    double tolerance = kDefaultTolerance;
    PixelSampling sampling;
    PixelFilter filter;
    /// Per camera ray and light, at most, and again for each roughness of the glossy lobes; 0: no shadows.
    int shadow_rays = 16;
    int threads = 0;         ///< 0: all cores
    std::uint32_t seed = 0;  ///< another one draws other camera and shadow rays
    /// Surfaces that a shadow ray passes through as far as they are transparent, at most; a camera ray passes one more.
    int transparent_bounces = 8;
    /// Surfaces that light is reflected by before the one that the camera sees, at most, as Cycles counts them; 0:
    /// direct light.
    int max_bounces = 0;
    /// At most so many of these are by glossy lobes or mirrors, and so many through interfaces. Light that bounces and
    /// that a diffuse surface reflects has a count of its own.
    int glossy_bounces = kMostBounces;
    int transmission_bounces = kMostBounces;
    /// 0 … 100: light that diffuse surfaces reflect has come by glossy lobes and interfaces that are widened as Cycles'
    /// Filter Glossy does, and by mirrors as by such lobes; 0: as they are. See least_width_after_diffuse().
    double filter_glossy = 0;
    /// Mean of the channels that what a path brings is cut to, of light that has bounced as Cycles' Clamp Indirect
    /// counts it; 0: nothing is cut. What a diffuse surface reflects is cut as if that were 0.8 of it.
    double clamp_indirect = 0;
    /// Whether opaque faces that lie on others are dark where Cycles' rays, which begin on one of them in float, meet
    /// the other: black if rounding has both in one plane, and else with dark patches. Of meshes that camera rays
    /// through a grid of pixels find, see RenderReport::doubled.
    bool darken_doubled = false;
    PassSettings passes;
};

/// Is shown the picture as it stands, as render's image, and what it has taken so far; returns false to leave it so.
using PictureUpdate = std::function<bool(std::span<const float>, const RenderReport&)>;

/// Called from the thread that calls render, while others go on.
struct RenderWatch {
    Progress progress = {};
    /// Once the picture has pixels all over, after each pass, and a few times a second during long ones.
    PictureUpdate on_update = {};
};

/// The width α of the narrowest lobes of microfacets that rays from a diffuse surface meet, with a filter above 0.
/// Cycles takes √(1 - p/filter)/2 for a path whose least probable direction had the density p, and 0 where p is larger
/// than the filter; this is the mean of that over directions of a diffuse lobe, p = cosθ/π.
double least_width_after_diffuse(double filter_glossy);

/// Throws std::invalid_argument naming the member or argument: order outside 0 … 64, tolerance ≤ 0 or not finite,
/// first_samples, min_samples or max_samples outside 1 … 2^20 or not in this order, noise_threshold outside 0 … 1,
/// time_limit not finite, filter_width outside 0.001 … 100, shadow_rays outside 0 … 2^14, more than 2^22 of both in the
/// first pass, bounces of any kind outside 0 … 1024, filter_glossy outside 0 … 100, clamp_indirect < 0 or
/// not finite, threads < 0, width or height < 1, or more than 2^28 pixels; and as PassLayout's constructor.
void check_render(const RenderSettings& settings, int width, int height);

/// image: height × width × RGBA, row 0 on top, linear, premultiplied, the mean of all camera rays of each pixel; alpha
/// is the share of them that met a surface or, where the camera sees it, the environment, or went beside a panorama's
/// image. The picture depends on nothing but scene, camera, size and settings, as long as no time limit ends it; it
/// does not depend on the number of threads. A pixel that the time limit leaves without a ray is interpolated. passes:
/// pixels × PassLayout::stride() of settings.passes, rows as of the image; the image does not depend on them. kept:
/// light that bounces, of earlier pictures and for later ones, on which the picture then depends too, within its noise;
/// null: none is kept. Throws as check_render does, also for an image or passes of another size; RenderCancelled when
/// watch.progress returns false; what the watch's functions throw.
RenderReport render(const CompiledScene& scene, const Camera& camera, int width, int height,
                    const RenderSettings& settings, std::span<float> image, const RenderWatch& watch = {},
                    std::span<float> passes = {}, KeptLight* kept = nullptr);

}  // namespace shlight
