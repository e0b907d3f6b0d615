// SPDX-License-Identifier: MIT
//
// Directions from a hit to a light, distributed over the part of the light above the horizon.
//
// Samplers map a point of the unit square to a direction and a weight: the mean of weight · g(direction) over evenly
// spread points is the integral of g over the solid angle of the light above the horizon. They also intersect the light
// with a ray in a given direction.
#pragma once

#include <optional>

#include <glm/vec2.hpp>

#include "lights/cap_sampling.h"
#include "lights/ellipse_sampling.h"
#include "lights/local_light.h"
#include "lights/mesh_sampling.h"
#include "lights/polygon_sampling.h"
#include "math/light_sample.h"
#include "shlight/types.h"

namespace shlight {

/// The sampler of any light with extent. Precondition: LocalLight::look() returned true.
class LightSampler {
    enum class Kind { cap, ellipse, polygon, mesh };

    /// ask(sampler) for the sampler in use.
    template <class Ask>
    auto with(const Ask& ask) const {
        switch (kind_) {
            case Kind::cap:
                return ask(*cap_);
            case Kind::ellipse:
                return ask(*ellipse_);
            case Kind::mesh:
                return ask(mesh_);
            case Kind::polygon:
                break;
        }
        return ask(polygon_);
    }

  public:
    void reset(const LocalLight& seen);
    /// reset() for the same light from a nearby hit; a mesh may keep the contour found for the previous hit.
    void move(const LocalLight& seen);
    LightSample sample(const glm::dvec2& point) const {
        return with([&](const auto& sampler) { return sampler.sample(point); });
    }
    /// See PolygonSampler::patch_count(); not for a mesh.
    std::size_t patch_count() const {
        return kind_ == Kind::polygon ? polygon_.patch_count() : kind_ == Kind::ellipse ? EllipseSampler::kPatches : 1;
    }
    LightSample sample_patch(std::size_t patch, const glm::dvec2& point) const {
        return kind_ == Kind::polygon   ? polygon_.sample_patch(patch, point)
               : kind_ == Kind::ellipse ? ellipse_->sample_patch(patch, point)
                                        : sample(point);
    }
    double solid_angle() const {
        return with([](const auto& sampler) { return sampler.solid_angle(); });
    }
    std::optional<double> meets(const Vec3d& direction) const {
        return with([&](const auto& sampler) { return sampler.meets(direction); });
    }

  private:
    Kind kind_ = Kind::polygon;
    std::optional<CapSampler> cap_;
    std::optional<EllipseSampler> ellipse_;
    PolygonSampler polygon_;
    MeshSampler mesh_;
};

}  // namespace shlight
