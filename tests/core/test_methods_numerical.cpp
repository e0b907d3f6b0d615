// SPDX-License-Identifier: MIT
//
// The numerical methods: cubature against the 113-bit reference and against brute force, random directions against
// their densities, and Monte Carlo against both within its own standard error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "adaptive_cubature.h"
#include "batch.h"
#include "error_message.h"
#include "error_record.h"
#include "kept_region.h"
#include "light_cubature.h"
#include "lobe_truth.h"
#include "method.h"
#include "quad_truth.h"
#include "quadrature.h"
#include "random_directions.h"
#include "random_input.h"
#include "random_numbers.h"
#include "random_polygon.h"

namespace shlight {
namespace {

using methods::AdaptiveCubature;
using methods::ConeSampler;
using methods::DiskSampler;
using methods::find_method;
using methods::find_shading_method;
using methods::KeptRegion;
using methods::Options;
using methods::Patch;
using methods::RandomDirection;
using methods::RandomNumbers;
using methods::ReflectionSampler;
using methods::Sampling;
using methods::SphereSurfaceSampler;
using methods::TriangleSampler;
using testing::all_tests;
using testing::error_message;
using testing::ErrorRecord;
using testing::on_two_threads;
using testing::RandomInput;
using testing::Vertices;
using testing::view_direction;
using Kind = truth::CapInput::Kind;

constexpr double kPi = std::numbers::pi;

Circle circle(const Vec3d& axis, double half_angle) {
    return {glm::normalize(axis), std::cos(half_angle), std::sin(half_angle)};
}

// --- coefficients ---------------------------------------------------------------------------------------------------

template <class T>
std::vector<T> of_sphere(const char* method, const Vec3d& center, double radius, int order, bool clip,
                         const Options& options = {}, std::size_t number = 0) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const Vec3<T> c(center);
    const auto r = static_cast<T>(radius);
    methods::sphere_coefficients<T>(find_method(method), std::span(&c, 1), std::span(&r, 1), order, clip, options,
                                    number, result);
    return result;
}

template <class T>
std::vector<T> of_cap(const char* method, const Vec3d& axis, double half_angle, int order, bool clip,
                      const Options& options = {}, std::size_t number = 0) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const Vec3<T> a(axis);
    const auto h = static_cast<T>(half_angle);
    methods::cap_coefficients<T>(find_method(method), std::span(&a, 1), std::span(&h, 1), order, clip, options, number,
                                 result);
    return result;
}

template <class T>
std::vector<T> of_polygon(const char* method, const Vertices& vertices, int order, bool clip,
                          const Options& options = {}, std::size_t number = 0) {
    std::vector<T> result(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const std::vector<Vec3<T>> v(vertices.begin(), vertices.end());
    methods::polygon_coefficients<T>(find_method(method), v, static_cast<int>(v.size()), order, clip, options, number,
                                     result);
    return result;
}

template <class T>
double relative_error(const truth::Coefficients& reference, int order, const std::vector<T>& computed) {
    const double largest = truth::largest_error(reference, order, computed.data());
    return largest == 0 ? 0 : largest / reference.high[0];
}

/// What a type can hold of sums of basis values. The preparation in double of a light loses digits to a gap of 1e-7
/// between rim and horizon.
template <class T>
constexpr double kHeld = std::is_same_v<T, float> ? 1e-5 : 1e-12;
constexpr double kHeldNearTangency = 1e-8;

/// An input that a method sees in T, as the reference has to see it.
template <class T, class Value>
Value rounded(const Value& value) {
    if constexpr (std::is_same_v<T, float>) {
        return testing::as_float(value);
    } else {
        return value;
    }
}
template <class T>
const char* const kTypeName = std::is_same_v<T, float> ? "float" : "double";

struct SphereKind {
    const char* name;
    Vec3d (*axis)(RandomInput&, double half_angle);
    double smallest, largest;  // half angle
};

Vec3d anywhere(RandomInput& random, double) {
    return random.direction();
}
Vec3d across_horizon(RandomInput& random, double half_angle) {
    return random.at_tilt(kPi / 2 + random.uniform(-0.95, 0.95) * std::min(half_angle, kPi - half_angle));
}
Vec3d near_tangency(RandomInput& random, double half_angle) {
    const double side = random.chance(0.5) ? 1 : -1;
    return random.at_tilt(kPi / 2 + side * half_angle * (1 - random.log_uniform(1e-7, 1e-2)));
}
Vec3d axis_near_horizon(RandomInput& random, double) {
    return random.at_tilt(kPi / 2 + random.uniform(-1, 1) * random.log_uniform(1e-9, 1e-2));
}

template <class T>
void check_caps(const SphereKind& kind) {
    constexpr std::size_t kCount = 16;
    ErrorRecord record(kCount);
    on_two_threads(kCount, [&](std::size_t i) {
        RandomInput random(i);
        const int order = i % 4 == 0 ? 16 : random.integer(1, 9);
        const auto half = rounded<T>(random.log_uniform(kind.smallest, kind.largest));
        const Vec3d axis = rounded<T>(kind.axis(random, half));
        const bool clip = i % 3 != 0;
        record[i] = relative_error(truth::cap({axis, Kind::angle, half}, order, clip), order,
                                   of_cap<T>("quadrature", axis, half, order, clip));
    });
    record.publish(std::string(kind.name) + " " + kTypeName<T>);
    EXPECT_LE(record.largest(), std::max(kHeld<T>, kind.axis == &near_tangency ? kHeldNearTangency : 0.0))
        << kind.name << " " << record.worst();
}

TEST(NumericalMethods, QuadratureOfCapsMatchesReference) {
    for (const SphereKind& kind : {SphereKind{"anywhere", &anywhere, 0.05, 1.5},
                                   {"across the horizon", &across_horizon, 0.05, 1.5},
                                   {"near tangency", &near_tangency, 0.05, 1.4},
                                   {"axis near the horizon", &axis_near_horizon, 0.05, 1.5},
                                   {"small", &across_horizon, 1e-5, 0.05},
                                   {"beyond a hemisphere", &anywhere, 1.6, 3.1}}) {
        check_caps<float>(kind);
        check_caps<double>(kind);
    }
}

TEST(NumericalMethods, QuadratureOfSpheresInContactMatchesReference) {
    for (const double gap : {0.0, 1e-9, 1e-3}) {
        const Vec3d center(0.36, 0.48, 0.8);  // of length 1
        const truth::Coefficients reference = truth::cap({center, Kind::sphere, 1 - gap}, 8, true);
        EXPECT_LE(relative_error(reference, 8, of_sphere<double>("quadrature", center, 1 - gap, 8, true)), 1e-12);
    }
    const std::vector<double> all = of_cap<double>("quadrature", {0, 0, 1}, kPi, 8, false);
    EXPECT_NEAR(all[0], 4 * kPi * 0.5 * std::numbers::inv_sqrtpi, 1e-13);
    EXPECT_LE(std::abs(*std::max_element(all.begin() + 1, all.end())), 1e-13);
}

struct PolygonKind {
    const char* name;
    Vertices (*make)(RandomInput&);
};

template <class T>
void check_polygons(const PolygonKind& kind) {
    constexpr std::size_t kCount = 12;
    ErrorRecord record(kCount);
    on_two_threads(kCount, [&](std::size_t i) {
        RandomInput random(i);
        const int order = i % 4 == 0 ? 16 : random.integer(1, 9);
        Vertices vertices = kind.make(random);
        for (Vec3d& v : vertices) {
            v = rounded<T>(v);
        }
        const bool clip = i % 3 != 0;
        record[i] = relative_error(truth::polygon(vertices, order, clip), order,
                                   of_polygon<T>("quadrature", vertices, order, clip));
    });
    record.publish(std::string(kind.name) + " polygons " + kTypeName<T>);
    EXPECT_LE(record.largest(), kHeld<T>) << kind.name << " " << record.worst();
}

TEST(NumericalMethods, QuadratureOfPolygonsMatchesReference) {
    for (const PolygonKind& kind : {PolygonKind{"plain", &testing::plain},
                                    {"concave", &testing::concave},
                                    {"small", &testing::small},
                                    {"large", &testing::large},
                                    {"near contact", &testing::near_contact},
                                    {"on the horizon", &testing::on_horizon}}) {
        check_polygons<float>(kind);
        check_polygons<double>(kind);
    }
}

TEST(NumericalMethods, QuadratureKeepsItsTolerance) {
    for (const double tolerance : {1e-2, 1e-4, 1e-8}) {
        ErrorRecord record(40);
        for (std::size_t i = 0; i < 40; ++i) {
            RandomInput random(i);
            const int order = random.integer(2, 12);
            const double half = random.uniform(0.05, 1.4);
            const Vec3d axis = across_horizon(random, half);
            const Vertices vertices = testing::plain(random);
            const bool polygon = i % 2 == 1;
            record[i] = relative_error(
                polygon ? truth::polygon(vertices, order, true) : truth::cap({axis, Kind::angle, half}, order, true),
                order,
                polygon ? of_polygon<double>("quadrature", vertices, order, true, {.tolerance = tolerance})
                        : of_cap<double>("quadrature", axis, half, order, true, {.tolerance = tolerance}));
        }
        record.publish("tolerance " + std::to_string(tolerance));
        EXPECT_LE(record.largest(), tolerance);
    }
}

struct CountingOne {
    void operator()(const Vec3d& /*direction*/, double* value) const { *value = 1; }
};

double area(std::span<const Patch> patches) {
    const CountingOne one;
    double sum = 0;
    AdaptiveCubature<double, CountingOne>(one, 1, {1e-12, 1e-15, 8, 20, 1U << 20}).add(patches, &sum);
    return sum;
}

TEST(NumericalMethods, PatchesCoverARegionFromAnyHub) {
    RandomInput random(5);
    for (int i = 0; i < 40; ++i) {
        const double half = random.uniform(0.1, 1.5);
        const Circle cap = circle(across_horizon(random, half), half);
        const KeptRegion kept = KeptRegion::of_cap(cap, true);
        const double whole = 2 * kPi * (1 - cap.cosine);
        const Circle mirrored = {Vec3d(cap.axis.x, cap.axis.y, -cap.axis.z), cap.cosine, cap.sine};
        EXPECT_NEAR(area(kept.patches()) + area(KeptRegion::of_cap(mirrored, true).patches()), whole, 1e-11);
        const Vec3d hub = random.at_tilt(random.uniform(0, 1.5));
        EXPECT_NEAR(area(kept.patches_about(hub, random.log_uniform(1, 30))), area(kept.patches()), 1e-9) << i;

        const SphericalPolygon<double> polygon(testing::plain(random), true);
        if (!polygon.empty()) {
            const KeptRegion seen = KeptRegion::of_polygon(polygon);
            EXPECT_NEAR(area(seen.patches()), polygon.solid_angle(), 1e-11);
            EXPECT_NEAR(area(seen.patches_about(hub, random.log_uniform(1, 30))), polygon.solid_angle(), 1e-9) << i;
        }
    }
}

/// Narrow, off the middle, and not smooth.
struct Spike {
    Vec3d peak;
    mutable std::size_t calls = 0;
    void operator()(const Vec3d& direction, double* value) const {
        ++calls;
        *value = 1 / (0.01 + glm::length(direction - peak));
    }
};

TEST(NumericalMethods, HarderToleranceTakesMoreWorkAndNoMoreThanAllowed) {
    const KeptRegion region = KeptRegion::of_cap(circle({0.2, 0.1, 0.3}, 0.8), true);
    const Spike spike{glm::normalize(Vec3d(0.3, 0.1, 0.5))};
    const auto sum = [&](double tolerance, std::size_t work) {
        AdaptiveCubature<double, Spike> cubature(spike, 1, {tolerance, 0, 6, 20, work});
        double value = 0;
        cubature.add(region.patches(), &value);
        EXPECT_EQ(cubature.points(), spike.calls);
        spike.calls = 0;
        return std::pair(value, cubature.points());
    };
    constexpr std::size_t kMuch = std::size_t{1} << 24;
    const auto [best, most] = sum(1e-9, kMuch);
    const auto [fair, some] = sum(1e-5, kMuch);
    const auto [rough, few] = sum(1e-2, kMuch);
    EXPECT_LE(std::abs(fair - best), 1e-5);
    EXPECT_LE(std::abs(rough - best), 1e-2);
    EXPECT_LT(some, most);
    EXPECT_LT(few, some);
    // Once the work is done, each piece that was begun gets its two smallest rules.
    const auto [stopped, allowed] = sum(0, 20000);
    EXPECT_LE(allowed, 60000U);
    EXPECT_LE(std::abs(stopped - best), 0.1);
}

// --- random numbers and directions ----------------------------------------------------------------------------------

TEST(NumericalMethods, RandomNumbersAreUniformAndIndependent) {
    constexpr int kCount = 200000;
    const double bound = 5 / std::sqrt(static_cast<double>(kCount));
    for (const std::uint32_t seed : {0U, 1U, 0xFFFFFFFFU}) {
        RandomNumbers random(seed);
        RandomNumbers neighbour(seed + 1);
        double before = random.next() - 0.5;
        double mean = 0;
        double square = 0;
        double serial = 0;
        double cross = 0;
        for (int i = 0; i < kCount; ++i) {
            const double x = random.next() - 0.5;
            mean += x / kCount;
            square += 12 * x * x / kCount;
            serial += 12 * x * before / kCount;
            cross += 12 * x * (neighbour.next() - 0.5) / kCount;
            before = x;
            ASSERT_TRUE(x > -0.5 && x < 0.5);
        }
        EXPECT_LE(std::abs(mean) * std::sqrt(12.0), bound) << seed;
        EXPECT_LE(std::abs(square - 1), 0.9 * bound) << seed;
        EXPECT_LE(std::abs(serial), bound) << seed;
        EXPECT_LE(std::abs(cross), bound) << seed;
    }
}

/// The mean of values, and its distance from a truth in standard errors.
class Mean {
  public:
    void add(double value) {
        ++count_;
        const double step = value - mean_;
        mean_ += step / count_;
        squares_ += step * (value - mean_);
    }
    double mean() const { return mean_; }
    double error() const { return std::sqrt(squares_ / (count_ * (count_ - 1.0))); }
    /// Of a truth that is itself known to `slack`.
    double deviation(double truth, double slack = 1e-12) const {
        return std::max(0.0, std::abs(mean_ - truth) - slack) / std::max(error(), 1e-300);
    }

  private:
    int count_ = 0;
    double mean_ = 0, squares_ = 0;
};

constexpr double kFewSigma = 5;

/// ∫ g over the light = the mean of g / density.
template <class Sampler>
void check_sampler(const Sampler& sampler, const std::string& name, double solid_angle, const Vec3d& first_moment) {
    RandomNumbers random(9);
    Mean area_mean;
    std::array<Mean, 3> moment;
    for (int i = 0; i < 40000; ++i) {
        const RandomDirection at = sampler.sample(random.point());
        ASSERT_LE(std::abs(glm::length(at.direction) - 1), 1e-9) << name;
        ASSERT_GE(at.density, 0) << name;
        const double weight = at.density > 0 ? 1 / at.density : 0;
        area_mean.add(weight);
        for (int k = 0; k < 3; ++k) {
            moment[static_cast<std::size_t>(k)].add(weight * at.direction[k]);
        }
    }
    EXPECT_LE(area_mean.deviation(solid_angle, 1e-9 * solid_angle), kFewSigma) << name;
    for (int k = 0; k < 3; ++k) {
        EXPECT_LE(moment[static_cast<std::size_t>(k)].deviation(first_moment[k], 1e-9 * solid_angle), kFewSigma)
            << name << " " << k;
    }
}

/// density() of what was drawn is the density with which it was drawn, and nothing else has one. nothing_in_vain: all
/// that is drawn counts.
template <class Sampler, class Inside>
void check_density(const Sampler& sampler, const std::string& name, double solid_angle, const Inside& inside,
                   bool nothing_in_vain = true) {
    RandomNumbers random(10);
    for (int i = 0; i < 500; ++i) {
        const RandomDirection at = sampler.sample(random.point());
        const double density = sampler.density(at.direction);
        EXPECT_LE(std::abs(density - at.density), 1e-6 * at.density) << name;
    }
    RandomInput input(11);
    Mean share;
    int differ = 0;
    for (int i = 0; i < 40000; ++i) {
        const Vec3d direction = input.direction();
        const double density = sampler.density(direction);
        differ += (density > 0) == inside(direction) ? 0 : 1;
        share.add(4 * kPi * density);
    }
    EXPECT_EQ(differ, 0) << name;
    if (solid_angle > 0.01 && nothing_in_vain) {
        EXPECT_LE(share.deviation(1), kFewSigma) << name;
    }
}

TEST(NumericalMethods, ConesSpheresAndDisksAreSampledAsTheySay) {
    RandomInput random(6);
    for (const double half : {1e-6, 0.1, 0.9, 1.5, 2.0, 3.1, kPi}) {
        const Circle cap = circle(random.direction(), half);
        const double solid_angle = 4 * kPi * std::pow(std::sin(half / 2), 2);
        const Vec3d moment = kPi * std::pow(std::sin(half), 2) * cap.axis;
        const std::string name = "half angle " + std::to_string(half);
        check_sampler(ConeSampler(cap), "cone, " + name, solid_angle, moment);
        check_density(ConeSampler(cap), "cone, " + name, solid_angle, [&](const Vec3d& d) {
            return std::atan2(glm::length(glm::cross(d, cap.axis)), glm::dot(d, cap.axis)) <= half;
        });
        if (half < 1.2) {  // beyond, next to nothing of a sphere's surface is seen, and of a disk, much is far away
            check_sampler(SphereSurfaceSampler(cap), "sphere, " + name, solid_angle, moment);
            check_sampler(DiskSampler(cap), "disk, " + name, solid_angle, moment);
        }
    }
}

/// ∫ ω dω over a polygon (Lambert 1760).
Vec3d first_moment(const SphericalPolygon<double>& polygon) {
    Vec3d sum(0);
    for (std::size_t i = 0; i < polygon.directions().size(); ++i) {
        const Vec3d& cross = polygon.edge_cross(i);
        const double sine = glm::length(cross);
        const double cosine =
            glm::dot(polygon.directions()[i], polygon.directions()[(i + 1) % polygon.directions().size()]);
        sum += sine > 0 ? cross * (std::atan2(sine, cosine) / (2 * sine)) : Vec3d(0);
    }
    return sum;
}

/// Whether a ray meets the polygon, by crossings in its plane.
bool meets(const Vertices& vertices, const Vec3d& direction) {
    const Vec3d origin = vertices[0];
    Vec3d normal(0);
    for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
        normal += glm::cross(vertices[i] - origin, vertices[i + 1] - origin);
    }
    const double distance = glm::dot(normal, origin) / glm::dot(normal, direction);
    if (!(distance > 0)) {
        return false;
    }
    const Vec3d x = glm::normalize(glm::cross(normal, Vec3d(0.3, 0.5, 0.8)));
    const Vec3d y = glm::cross(glm::normalize(normal), x);
    const Vec3d p = distance * direction;
    bool inside = false;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3d a = vertices[i] - p;
        const Vec3d b = vertices[(i + 1) % vertices.size()] - p;
        const double ay = glm::dot(a, y);
        const double by = glm::dot(b, y);
        if ((ay > 0) != (by > 0)) {
            const double t = ay / (ay - by);
            inside = inside != (glm::dot(a + t * (b - a), x) > 0);
        }
    }
    return inside;
}

TEST(NumericalMethods, PolygonsAreSampledAsTheySay) {
    using Uniform = TriangleSampler::Uniform;
    for (const PolygonKind& kind : {PolygonKind{"plain", &testing::plain},
                                    {"concave", &testing::concave},
                                    {"small", &testing::small},
                                    {"tiny", &testing::tiny},
                                    {"large", &testing::large}}) {
        for (std::uint64_t i = 0; i < 4; ++i) {
            RandomInput random(i);
            const Vertices vertices = kind.make(random);
            const SphericalPolygon<double> seen(vertices, false);
            const std::string name = std::string(kind.name) + " " + std::to_string(i);
            const auto inside = [&](const Vec3d& direction) { return meets(vertices, direction); };
            const TriangleSampler by_angle(Uniform::in_solid_angle, seen.directions());
            check_sampler(by_angle, name, seen.solid_angle(), first_moment(seen));
            check_density(by_angle, name, seen.solid_angle(), inside, kind.make != &testing::concave);
            if (kind.make != &testing::large) {  // whose far parts leave too few points near by
                const TriangleSampler by_area(Uniform::in_area, vertices);
                check_sampler(by_area, name + " by area", seen.solid_angle(), first_moment(seen));
            }
            if (kind.make == &testing::plain) {
                check_density(TriangleSampler(Uniform::in_area, vertices), name, 0, inside);
            }
        }
    }
}

TEST(NumericalMethods, ReflectionsAreSampledAsTheySay) {
    for (const LobeShape& shape : {LobeShape(LambertShape{}), LobeShape(GgxShape{0.04}), LobeShape(GgxShape{0.6})}) {
        for (const double cosine : {0.1, 0.7, 1.0}) {
            const Vec3d view = view_direction(cosine);
            const ReflectionSampler sampler(shape, view);
            RandomNumbers random(12);
            Mean by_lobe;
            for (int i = 0; i < 100000; ++i) {
                const Vec3d direction = sampler.sample(random.point());
                const double density = sampler.density(direction);
                EXPECT_EQ(density > 0, direction.z > 0);
                by_lobe.add(density > 0 ? lobe_value(shape, direction, view) / density : 0);
            }
            const auto truth = find_shading_method("quadrature").make(shape, cosine, {});
            EXPECT_LE(by_lobe.deviation(truth->radiance(circle({0, 0, 1}, kPi / 2), 0).value, 1e-9), kFewSigma);
        }
    }
}

// --- Monte Carlo coefficients ---------------------------------------------------------------------------------------

using Coefficients = std::function<std::vector<double>(const Options&, std::size_t number)>;

/// Means over many lights of a batch, which differ in their random numbers.
void check_unbiased(const truth::Coefficients& reference, const Coefficients& compute, Options options,
                    const std::string& name) {
    std::vector<Mean> means(reference.high.size());
    options.samples = 64;
    options.seed = 3;
    for (std::size_t number = 0; number < 400; ++number) {
        const std::vector<double> c = compute(options, number);
        for (std::size_t k = 0; k < means.size(); ++k) {
            means[k].add(c[k]);
        }
    }
    for (std::size_t k = 0; k < means.size(); ++k) {
        EXPECT_LE(means[k].deviation(reference.high[k], 1e-9 * reference.high[0]), kFewSigma) << name << " " << k;
        EXPECT_LE(means[k].error(), 0.2 * reference.high[0]) << name << " " << k;
    }
}

TEST(NumericalMethods, MonteCarloCoefficientsAreUnbiased) {
    const Vec3d axis(0.5, -0.3, 0.2);
    const double half = 0.7;
    const double radius = std::sin(half) * glm::length(axis);
    const Vertices quad = {{-0.2, 0.5, -0.3}, {0.9, 0.5, -0.2}, {0.9, 0.6, 0.9}, {-0.2, 0.6, 0.8}};
    const Vertices concave = {{-0.5, 0.5, 1}, {0, 0.1, 1}, {0.5, 0.5, 1}, {0, -0.5, 1}};
    for (const bool clip : {true, false}) {
        for (const Sampling sampling : {Sampling::solid_angle, Sampling::area}) {
            const Options options = {.sampling = sampling};
            const std::string name = (clip ? "clipped " : "whole ") + std::to_string(static_cast<int>(sampling));
            check_unbiased(
                truth::cap({axis, Kind::angle, half}, 4, clip),
                [&](const Options& o, std::size_t i) {
                    return of_cap<double>("monte_carlo", axis, half, 4, clip, o, i);
                },
                options, "cap " + name);
            check_unbiased(
                truth::cap({axis, Kind::sphere, radius}, 4, clip),
                [&](const Options& o, std::size_t i) {
                    return of_sphere<double>("monte_carlo", axis, radius, 4, clip, o, i);
                },
                options, "sphere " + name);
            for (const Vertices& vertices : {quad, concave}) {
                check_unbiased(
                    truth::polygon(vertices, 4, clip),
                    [&](const Options& o, std::size_t i) {
                        return of_polygon<double>("monte_carlo", vertices, 4, clip, o, i);
                    },
                    options, "polygon " + name);
            }
        }
        check_unbiased(
            truth::cap({axis, Kind::angle, 2.5}, 4, clip),
            [&](const Options& o, std::size_t i) { return of_cap<double>("monte_carlo", axis, 2.5, 4, clip, o, i); },
            {}, "beyond a hemisphere");
    }
}

TEST(NumericalMethods, SeedAndNumberPickTheRandomNumbers) {
    const Vec3d axis(0.5, -0.3, 0.6);
    const auto compute = [&](std::uint32_t seed, std::size_t number) {
        return of_cap<float>("monte_carlo", axis, 0.4, 3, true, {.samples = 8, .seed = seed}, number);
    };
    EXPECT_EQ(compute(1, 0), compute(1, 0));
    EXPECT_NE(compute(1, 0), compute(2, 0));
    EXPECT_NE(compute(1, 0), compute(1, 1));
}

TEST(NumericalMethods, OptionsThatDoNotFitAreNamed) {
    const Vec3d axis(0, 0, 1);
    const auto starts = [](const std::string& text, const std::string& with) { return text.rfind(with, 0) == 0; };
    for (const Sampling sampling : {Sampling::bsdf, Sampling::mis}) {
        EXPECT_TRUE(
            starts(error_message([&] { of_cap<float>("monte_carlo", axis, 0.4, 3, true, {.sampling = sampling}); }),
                   "sampling"));
    }
    EXPECT_TRUE(
        starts(error_message([&] { of_cap<float>("monte_carlo", axis, 1.6, 3, true, {.sampling = Sampling::area}); }),
               "half_angles"));
    EXPECT_TRUE(
        starts(error_message([&] { of_cap<float>("monte_carlo", axis, 0.4, 3, true, {.samples = 0}); }), "samples"));
}

// --- shading --------------------------------------------------------------------------------------------------------

struct Glossy {
    GgxShape shape;
    double cosine;
};

Glossy random_glossy(RandomInput& random) {
    const double roughness = random.uniform(0.05, 1);
    const Fresnel fresnel = random.chance(0.5)   ? Fresnel::one
                            : random.chance(0.5) ? Fresnel::schlick
                                                 : Fresnel::dielectric;
    return {{roughness * roughness, fresnel}, random.uniform(0.1, 1)};
}

Vec3d lit_axis(RandomInput& random, const Glossy& lobe, double half_angle) {
    const Vec3d view = view_direction(lobe.cosine);
    const Vec3d mirror(-view.x, 0, view.z);
    return glm::normalize(mirror + (half_angle + 2 * lobe.shape.alpha) * random.uniform(0, 1) * random.direction());
}

double albedo(const Glossy& lobe) {
    return testing::lobe_over_cap(lobe.shape, lobe.cosine, {0, 0, 1}, kPi / 2);
}

TEST(NumericalMethods, ShadingQuadratureOfCapsMatchesBruteForce) {
    const std::size_t count = all_tests() ? 400 : 60;
    ErrorRecord record(count);
    ErrorRecord grazing(count);  // where brute force itself knows no more than this
    on_two_threads(count, [&](std::size_t i) {
        RandomInput random(i);
        Glossy lobe = random_glossy(random);
        const double half = random.log_uniform(0.01, 1.5);
        const bool cut = i % 3 == 0;
        // Rings about the axis have no care for narrow lobes; those about the lobe none for the horizon.
        lobe.shape.alpha = std::max(lobe.shape.alpha, cut ? 0.1 : 0.0);
        const Vec3d axis = cut ? across_horizon(random, half) : lit_axis(random, lobe, half);
        if (!cut && axis.z < std::sin(half)) {
            return;
        }
        const Vec3d view = view_direction(lobe.cosine);
        const auto value = [&](const Vec3d& direction) { return lobe_value(lobe.shape, direction, view); };
        const double truth = cut ? testing::integral(testing::clipped_cap_samples(axis, half, 200), value)
                                 : testing::lobe_over_cap(lobe.shape, lobe.cosine, axis, half, 48);
        const auto method = find_shading_method("quadrature").make(lobe.shape, lobe.cosine, {});
        (lobe.cosine < 0.2 ? grazing : record)[i] =
            std::abs(method->radiance(circle(axis, half), 0).value - truth) / albedo(lobe);
    });
    record.publish("shading quadrature of caps");
    EXPECT_LE(record.largest(), 1e-8) << record.worst();
    EXPECT_LE(grazing.largest(), 1e-6) << grazing.worst();
}

TEST(NumericalMethods, ShadingQuadratureOfPolygonsMatchesBruteForce) {
    constexpr std::size_t kCount = 16;
    ErrorRecord record(kCount);
    on_two_threads(kCount, [&](std::size_t i) {
        RandomInput random(i);
        Glossy lobe = random_glossy(random);
        lobe.shape.alpha = std::max(lobe.shape.alpha, 0.05);
        const Vertices vertices = testing::plain(random);
        const auto method = find_shading_method("quadrature").make(lobe.shape, lobe.cosine, {});
        const double truth = testing::PolygonTruth(lobe.shape, lobe.cosine).integral(vertices);
        record[i] = std::abs(method->radiance(SphericalPolygon<double>(vertices, true), 0).value - truth);
    });
    record.publish("shading quadrature of polygons");
    EXPECT_LE(record.largest(), 1e-8) << record.worst();
}

TEST(NumericalMethods, ShadingQuadratureKnowsClosedForms) {
    const auto lambert = find_shading_method("quadrature").make(LambertShape{}, 0.4, {});
    for (const double half : {1e-4, 0.3, 1.2}) {
        const Vec3d axis(std::sin(0.3), 0, std::cos(0.3));
        const double expected = std::pow(std::sin(half), 2) * axis.z;  // where nothing is below the horizon
        EXPECT_NEAR(lambert->radiance(circle(axis, half), 0).value, expected, 1e-12 * expected) << half;
    }
    const auto hidden = lambert->radiance(circle({0, 0, -1}, 0.5), 0);
    EXPECT_EQ(hidden.value, 0);
}

TEST(NumericalMethods, ShadingMonteCarloIsUnbiased) {
    const Vertices quad = {{-0.9, 0.5, -0.3}, {0.2, 0.5, -0.2}, {0.2, 0.6, 0.9}, {-0.9, 0.6, 0.8}};
    const Vertices concave = {{-0.9, 0.5, 1}, {-0.4, 0.1, 1}, {0.1, 0.5, 1}, {-0.4, -0.5, 1}};
    for (const LobeShape& shape : {LobeShape(LambertShape{}), LobeShape(GgxShape{0.5}), LobeShape(GgxShape{0.09})}) {
        for (const Sampling sampling : {Sampling::solid_angle, Sampling::area, Sampling::bsdf, Sampling::mis}) {
            const auto method =
                find_shading_method("monte_carlo").make(shape, 0.6, {.samples = 65, .sampling = sampling});
            const auto truth = find_shading_method("quadrature").make(shape, 0.6, {});
            const auto check = [&](const std::string& name, double expected, const auto& draw) {
                Mean mean;
                for (std::uint32_t seed = 0; seed < 2000; ++seed) {
                    const methods::Reflected r = draw(seed);
                    EXPECT_EQ(r.points, 65);
                    mean.add(r.value);
                }
                EXPECT_LE(mean.deviation(expected, 1e-9), kFewSigma)
                    << name << " " << shape.index() << " " << static_cast<int>(sampling);
                EXPECT_GT(expected, 1e-4);
            };
            for (const Circle& cap : {circle({-0.8, 0.1, 0.6}, 0.5), circle({-0.8, 0.1, 0.1}, 0.7)}) {
                check("cap", truth->radiance(cap, 0).value, [&](auto seed) { return method->radiance(cap, seed); });
            }
            for (const Vertices& vertices : {quad, concave}) {
                const SphericalPolygon<double> seen(vertices, true);
                check("polygon", truth->radiance(seen, 0).value,
                      [&](auto seed) { return method->radiance_of_plane(seen, vertices, seed); });
            }
        }
    }
}

/// Standard error of one light, relative to its value.
double noise(const LobeShape& shape, double half_angle, Sampling sampling) {
    const auto method = find_shading_method("monte_carlo").make(shape, 0.6, {.samples = 64, .sampling = sampling});
    Mean mean;
    for (std::uint32_t seed = 0; seed < 500; ++seed) {
        mean.add(method->radiance(circle({-0.8, 0, 0.6}, half_angle), seed).value);
    }
    return mean.error() / mean.mean();
}

TEST(NumericalMethods, BothKindsOfSamplesTogetherAreGoodWhereEitherIs) {
    // A narrow lobe under a wide light is for the lobe's directions, a wide lobe under a small light for the light's.
    EXPECT_LE(10 * noise(GgxShape{0.01}, 0.7, Sampling::mis), noise(GgxShape{0.01}, 0.7, Sampling::solid_angle));
    EXPECT_LE(3 * noise(GgxShape{0.8}, 0.03, Sampling::mis), noise(GgxShape{0.8}, 0.03, Sampling::bsdf));
}

TEST(NumericalMethods, CubatureConvergesAndTakesNoMorePointsThanAllowed) {
    RandomInput random(21);
    for (int i = 0; i < 60; ++i) {
        const double roughness = random.uniform(0.5, 1);
        const LobeShape shape = i % 5 == 0 ? LobeShape(LambertShape{}) : LobeShape(GgxShape{roughness * roughness});
        const double cosine = random.uniform(0.4, 1);
        const double half = random.uniform(0.05, 0.5);
        const Circle cap = circle(across_horizon(random, half), half);
        const Circle above = circle({random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 1}, half);
        const SphericalPolygon<double> polygon(testing::facing(random, 4, 0.6, half), true);
        const auto truth = find_shading_method("quadrature").make(shape, cosine, {});
        for (const int points : {1, 3, 4, 7, 24, 40, 128, 600}) {
            const auto method = find_shading_method("cubature").make(shape, cosine, {.samples = points});
            const double largest = points >= 600 ? 2e-6 : points >= 128 ? 5e-4 : points >= 24 ? 5e-3 : 0.1;
            const auto check = [&](const char* name, const auto& region) {
                const methods::Reflected r = method->radiance(region, 0);
                EXPECT_LE(r.points, points) << name;
                EXPECT_GE(r.points, points == 1 ? 1 : points / 4) << name;
                EXPECT_LE(std::abs(r.value - truth->radiance(region, 0).value), largest) << name << " " << points;
            };
            check("cap above", above);
            check("cap cut", cap);
            if (!polygon.empty()) {
                check("polygon", polygon);
            }
        }
    }
}

TEST(NumericalMethods, CubatureOfFewPointsIsTheLibrarysOwn) {
    const GgxShape shape{0.3};
    const Circle cap = circle({-0.5, 0.2, 0.8}, 0.2);
    int rule = 0;
    for (const int points : {1, 4, 7, 24}) {
        const auto method = find_shading_method("cubature").make(shape, 0.7, {.samples = points});
        const CubatureSum expected = cap_cubature(shape, view_direction(0.7), cap, ++rule);
        EXPECT_EQ(method->radiance(cap, 0).value, expected.value);
        EXPECT_EQ(method->radiance(cap, 0).points, points);
    }
}

}  // namespace
}  // namespace shlight
