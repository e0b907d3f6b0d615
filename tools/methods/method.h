// SPDX-License-Identifier: MIT
//
// Methods for the same integrals that the library is compared with: the paper's method, those that the paper compares
// with, and plain numerical integration. Nothing that renders calls them.
//
// A method is one file that defines `Method name()` or `ShadingMethod name()`, and one line in registry.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>

#include "regions/spherical_polygon.h"
#include "shlight/cap.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight::methods {

/// Distribution of random directions.
enum class Sampling {
    solid_angle,  ///< uniform over the light as seen from the shading point
    area,         ///< uniform over the light's surface: a sphere's whole surface, the polygon's plane
    bsdf,         ///< as the material reflects (shading only)
    mis,          ///< solid_angle and bsdf, weighed by the balance heuristic (Veach & Guibas 1995; shading only)
};

/// Options of methods; a method ignores those that do not apply.
struct Options {
    double tolerance = 0;  ///< adaptive methods: error ÷ L_00, in shading radiance ÷ albedo; 0: what T can hold
    int order = 0;         ///< shading by harmonics: 1 … 64
    int samples = 256;     ///< random methods: directions a light (mis: half of each kind); cubature: points
    std::uint32_t seed = 0;
    Sampling sampling = Sampling::solid_angle;
};

/// A cap as given by the caller, in doubles that represent it exactly.
struct CapLight {
    enum class Kind { sphere, angle };
    Kind kind;
    Vec3d axis;   ///< of any length > 0; the centre if it is a sphere
    double size;  ///< radius of a sphere, 0 < radius ≤ |axis|; otherwise the half angle in (0, π]
};

/// A cap as unit axis and half angle, computed in double and rounded once.
template <class T>
struct CapAngles {
    Vec3<T> axis;  ///< unit
    T cos_half, sin_half;
    explicit CapAngles(const CapLight& light);
};

/// order² coefficients of unit radiance, clipped at z ≥ 0 or whole. Preconditions as in cap.h and polygon.h, which the
/// caller has checked; 1 ≤ order ≤ largest_order. May throw std::invalid_argument naming an option that does not fit.
template <class T>
using CapFunction = void (*)(const CapLight& light, int order, bool clip, const Options& options, T* coefficients);
template <class T>
using PolygonFunction = void (*)(std::span<const Vec3<T>> vertices, int order, bool clip, const Options& options,
                                 T* coefficients);

template <class T>
struct Functions {
    CapFunction<T> cap = nullptr;  ///< null: the method does not know caps
    PolygonFunction<T> polygon = nullptr;
};

/// A way to coefficients.
struct Method {
    std::string_view name;
    std::string_view source;  ///< paper and equations, for readers of charts
    int largest_order;
    bool adaptive;  ///< takes a tolerance
    bool random;    ///< takes samples, seed and sampling
    Functions<float> f32;
    Functions<double> f64;
};

template <class T>
const Functions<T>& functions_of(const Method& method) {
    if constexpr (std::is_same_v<T, float>) {
        return method.f32;
    } else {
        return method.f64;
    }
}

/// ∫ f·cos over a light of unit radiance, and the number of evaluations of f·cos (0: none, harmonics).
struct Reflected {
    double value;
    int points;
};

/// A polygon in the shading frame, and its part above the horizon.
struct SeenPolygon {
    std::span<const Vec3d> vertices;
    SphericalPolygon kept;
    explicit SeenPolygon(std::span<const Vec3d> whole) : vertices(whole), kept(whole, true) {}
};

/// One lobe at one view, for many lights.
class LobeIntegrator {
  public:
    LobeIntegrator() = default;
    LobeIntegrator(const LobeIntegrator&) = delete;
    LobeIntegrator& operator=(const LobeIntegrator&) = delete;
    virtual ~LobeIntegrator() = default;
    /// Radiance from the part above the horizon of a cap in the shading frame. seed: of the light, for random methods.
    virtual Reflected radiance(const SphericalCap& cap, std::uint32_t seed) const = 0;
    /// Many caps, with one seed each.
    virtual void radiances(std::span<const SphericalCap> caps, std::span<const std::uint32_t> seeds,
                           std::span<Reflected> results) const {
        for (std::size_t i = 0; i < caps.size(); ++i) {
            results[i] = radiance(caps[i], seeds[i]);
        }
    }
    virtual Reflected radiance(const SeenPolygon& polygon, std::uint32_t seed) const = 0;
};

/// A way from light to reflected radiance. No mirrors: precondition alpha > 0 for GGX.
struct ShadingMethod {
    std::string_view name;
    std::string_view source;
    bool harmonic;  ///< takes an order
    bool adaptive;  ///< takes a tolerance
    bool sampled;   ///< takes samples
    bool random;    ///< takes seed and sampling
    std::unique_ptr<LobeIntegrator> (*make)(const LobeShape& shape, double cos_theta_o, const Options& options);
};

/// All registered methods, in the order of charts.
std::span<const Method> all_methods();
std::span<const ShadingMethod> all_shading_methods();

/// Throws std::invalid_argument naming `method` and listing the known names.
const Method& find_method(std::string_view name);
const ShadingMethod& find_shading_method(std::string_view name);

}  // namespace shlight::methods
