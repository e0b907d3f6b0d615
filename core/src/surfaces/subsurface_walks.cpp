// SPDX-License-Identifier: MIT
#include "surfaces/subsurface_walks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/shading_frame.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Steps of a walk, at most, as in Cycles.
constexpr std::uint32_t kMostSteps = 256;
/// The step from which on a medium scatters evenly to all sides, with the extinction that is as thick for diffusion.
constexpr std::uint32_t kEvenStep = 10;
/// Share of light below which a walk is not always followed.
constexpr float kSurelyWalked = 0.25F;

float largest(const Rgb& color) {
    return std::max({color.x, color.y, color.z});
}

/// Numbers in 0 … 1, both excluded, one after the other.
class Draws {
  public:
    Draws(std::uint32_t seed, std::uint32_t step) : state_(hash(seed, step)) {}
    double operator()() {
        state_ = hash(state_, 0x9E3779B9U);
        return (state_ + 0.5) * 0x1p-32;
    }

  private:
    std::uint32_t state_;
};

/// The cosine of a scattered direction by Henyey & Greenstein 1941.
double scattered_cosine(double g, double draw) {
    if (std::abs(g) < 1e-3) {
        return 1 - 2 * draw;
    }
    const double k = (1 - g * g) / (1 - g + 2 * g * draw);
    return std::clamp((1 + g * g - k * k) / (2 * g), -1.0, 1.0);
}

Vec3d scattered_way(const Vec3d& way, double g, double draw, double turn) {
    const double cosine = scattered_cosine(g, draw);
    const double sine = std::sqrt(1 - cosine * cosine);
    const double azimuth = 2 * std::numbers::pi * turn;
    const ShadingFrame frame = shading_frame(Vec3d(0), way, way);
    return frame.to_world({sine * std::cos(azimuth), sine * std::sin(azimuth), cosine});
}

/// Similarity: Wyman, Patterson & Wilson 1989.
ScatteringMedium evenly_scattering(const ScatteringMedium& medium) {
    const Rgb scattering = medium.albedo * medium.extinction * static_cast<float>(1 - medium.anisotropy);
    const Rgb extinction = (1.0F - medium.albedo) * medium.extinction + scattering;
    return {extinction, scattering / glm::max(extinction, Rgb(1e-30F)), 0};
}

/// The share of a walk's steps whose length each channel draws.
Rgb channel_shares(const SubsurfaceWalk& walk) {
    const Rgb weights = glm::abs(walk.throughput * walk.medium.albedo);
    const float sum = weights.x + weights.y + weights.z;
    return sum > 0 ? weights / sum : Rgb(0);
}

/// Draws the next step's direction and length.
void set_out(SubsurfaceWalk& walk, std::uint32_t step) {
    Draws draw(walk.seed, step);
    const glm::dvec2 place = step == 0 ? walk.first : glm::dvec2(draw(), draw());
    if (step == kEvenStep && walk.medium.anisotropy != 0) {
        walk.medium = evenly_scattering(walk.medium);
    }
    if (step > 0) {
        const double turn = draw();
        walk.ray.direction = Vec3f(scattered_way(Vec3d(walk.ray.direction), walk.medium.anisotropy, draw(), turn));
    }
    const Rgb shares = channel_shares(walk);
    const int channel = place.x < double{shares.x} ? 0 : place.x < double{shares.x + shares.y} ? 1 : 2;
    walk.ray.t_max = static_cast<float>(-std::log(place.y) / double{walk.medium.extinction[channel]});
}

/// Weighs a step by all channels that could have drawn it. Returns whether the walk goes on.
bool arrive(SubsurfaceWalk& walk, std::uint32_t step, const RayHit& hit) {
    const float length = hit.missed() ? walk.ray.t_max : hit.distance;
    const Rgb passed = glm::exp(-walk.medium.extinction * length);
    const Rgb density = hit.missed() ? walk.medium.extinction * passed : passed;
    const float mean = glm::dot(channel_shares(walk), density);
    if (!(mean > 0)) {
        return false;
    }
    walk.throughput *= (hit.missed() ? walk.medium.albedo * density : passed) / mean;
    if (!hit.missed()) {
        walk.exit = hit;
        return false;
    }
    walk.ray.origin += length * walk.ray.direction;
    const float followed = std::min(largest(walk.throughput) / kSurelyWalked, 1.0F);
    if (followed < 1) {
        if (Draws(~walk.seed, step)() >= double{followed}) {
            return false;
        }
        walk.throughput /= followed;
    }
    return true;
}

}  // namespace

void intersect_instances(const SceneRays& scene, std::span<const Ray> rays, std::span<const std::uint32_t> instances,
                         std::span<RayHit> hits) {
    scene.intersect(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        Ray rest = rays[i];
        while (!hits[i].missed() && hits[i].instance != instances[i]) {
            rest = behind(rest, hits[i]);
            scene.intersect({&rest, 1}, hits.subspan(i, 1));
        }
    }
}

void walk_below(const SceneRays& scene, std::span<SubsurfaceWalk> walks) {
    std::vector<std::uint32_t> going(walks.size());
    std::iota(going.begin(), going.end(), 0U);
    std::vector<Ray> rays;
    std::vector<std::uint32_t> instances;
    std::vector<RayHit> hits;
    for (std::uint32_t step = 0; step < kMostSteps && !going.empty(); ++step) {
        rays.clear();
        instances.clear();
        for (const std::uint32_t i : going) {
            set_out(walks[i], step);
            rays.push_back(walks[i].ray);
            instances.push_back(walks[i].instance);
        }
        hits.resize(rays.size());
        intersect_instances(scene, rays, instances, hits);
        std::size_t kept = 0;
        for (std::size_t k = 0; k < going.size(); ++k) {
            if (arrive(walks[going[k]], step, hits[k])) {
                going[kept++] = going[k];
            }
        }
        going.resize(kept);
    }
}

}  // namespace shlight
