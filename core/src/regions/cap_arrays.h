// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "shlight/cap.h"
#include "shlight/types.h"

namespace shlight {

/// Circles in the shading frame, before any boost: SphericalCap's members, an array for each.
struct CapArrays {
    const double *x, *y, *z;
    const double *cosine, *sine;
    /// sin²σ - L_z², positive where the circle crosses the plane z = 0. Rules that add up points do without.
    const double* crossing_squared = nullptr;
};

/// Spheres in the shading frame, of which the kernels that read them find the circles.
struct SphereArrays {
    const Vec3<float>* centers;
    const float* radii;
};

/// Circles as the kernels read them. Keeps its memory.
class CapBatch {
  public:
    /// The caps that the batch holds are lost.
    void resize(std::size_t count) {
        stride_ = (count + kStep - 1) / kStep * kStep;
        members_.resize(kMembers * stride_);
    }
    void set(std::size_t i, const SphericalCap& circle) {
        const Vec3d& axis = circle.axis;
        // The smaller pair is taken: near hemispheres may be seen straight above or below.
        const double crossing = circle.sine < std::abs(circle.cosine)
                                    ? (circle.sine - axis.z) * (circle.sine + axis.z)
                                    : axis.x * axis.x + axis.y * axis.y - circle.cosine * circle.cosine;
        const std::array<double, kMembers> values = {axis.x, axis.y, axis.z, circle.cosine, circle.sine, crossing};
        for (std::size_t k = 0; k < kMembers; ++k) {
            members_[k * stride_ + i] = values[k];
        }
    }
    /// cap_of_sphere of each; precondition 0 < radius ≤ |center|, all finite.
    void set_spheres(std::span<const Vec3<float>> centers, const float* radii);
    void set_spheres(std::span<const Vec3<double>> centers, const double* radii);

    CapArrays arrays() const {
        const auto at = [this](std::size_t k) { return members_.data() + k * stride_; };
        return {at(0), at(1), at(2), at(3), at(4), at(5)};
    }

  private:
    static constexpr std::size_t kMembers = 6;
    static constexpr std::size_t kStep = 8;  // no vector has more doubles

    std::vector<double> members_;
    std::size_t stride_ = 0;
};

/// The number of spheres, from the first on, that check_sphere accepts beyond doubt.
std::size_t sound_spheres(const Vec3<float>* centers, const float* radii, std::size_t count);
std::size_t sound_spheres(const Vec3<double>* centers, const double* radii, std::size_t count);

}  // namespace shlight
