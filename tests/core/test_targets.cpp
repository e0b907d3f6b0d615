// SPDX-License-Identifier: MIT
//
// Instruction sets: each gives the same numbers within rounding, and SHLIGHT_KERNEL_TARGET forces one for a whole run
// of the tests. CMakeLists.txt runs every test of accuracy on each.
#include "simd/targets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "error_message.h"
#include "error_record.h"
#include "random_input.h"
#include "random_polygon.h"
#include "shlight/basis.h"
#include "shlight/cap.h"
#include "shlight/light_shading.h"
#include "shlight/polygon.h"

namespace shlight {
namespace {

using testing::ErrorRecord;
using testing::RandomInput;

constexpr double kHalfPi = std::numbers::pi / 2;
constexpr std::array kOrders = {1, 2, 3, 5, 8, 16};

/// Forces what SHLIGHT_KERNEL_TARGET names before the first test; skips all tests where the machine lacks it, or where
/// it is what they run on without that.
class TargetOfEnvironment : public ::testing::Environment {
  public:
    void SetUp() override {
        const char* wanted = std::getenv("SHLIGHT_KERNEL_TARGET");
        const std::vector<std::string> targets = kernel_targets();
        if (wanted != nullptr && std::find(targets.begin(), targets.end(), wanted) == targets.end()) {
            GTEST_SKIP() << "[  SKIPPED ] this machine has no " << wanted;
        }
        if (wanted != nullptr && targets.front() == wanted) {
            GTEST_SKIP() << "[  SKIPPED ] without SHLIGHT_KERNEL_TARGET all tests run on " << wanted;
        }
        choose_kernel_target();
    }
};

const auto* const kEnvironment = ::testing::AddGlobalTestEnvironment(new TargetOfEnvironment);

TEST(Targets, AccuracyIsTestedOnAllOfThisMachine) {
    std::istringstream listed(SHLIGHT_TESTED_TARGETS);
    const std::vector<std::string> tested{std::istream_iterator<std::string>(listed), {}};
    const std::vector<std::string> targets = kernel_targets();
    for (std::size_t i = 1; i < targets.size(); ++i) {  // the best one is what all tests run on
        EXPECT_NE(std::find(tested.begin(), tested.end(), targets[i]), tested.end()) << targets[i];
    }
}

TEST(Targets, AForcedOneIsInUse) {
    const std::string before = kernel_target();
    for (const std::string& target : kernel_targets()) {
        const ForcedKernelTarget forced(target);
        EXPECT_EQ(kernel_target(), target);
    }
    EXPECT_EQ(kernel_target(), before);
}

TEST(Targets, AnUnknownOneIsNamed) {
    const std::string message = testing::error_message([] { force_kernel_target("MMX"); });
    EXPECT_EQ(message.find("target: this build has " + kernel_targets().front()), 0U) << message;
    EXPECT_NE(message.find(", not MMX"), std::string::npos) << message;
}

template <class T>
constexpr double kBound = std::is_same_v<T, float> ? 1e-5 : 1e-12;

template <class T>
const char* name_of() {
    return std::is_same_v<T, float> ? "float" : "double";
}

/// What compute() gives on each target against what the best one gives: `width` numbers for each of scales.size()
/// lights, relative to the light's scale.
template <class T>
void expect_agreement(const std::string& name, std::size_t width, const std::vector<double>& scales,
                      const std::function<void(std::span<T>)>& compute) {
    const std::vector<std::string> targets = kernel_targets();
    std::vector<T> best(width * scales.size());
    for (const std::string& target : targets) {
        const ForcedKernelTarget forced(target);
        std::vector<T> values(best.size(), std::numeric_limits<T>::quiet_NaN());
        compute(values);
        // Compilers have been seen to leave the registers that long double shares with MMX instructions unusable.
        const volatile long double one = 1;
        EXPECT_EQ(one + one, 2) << target;
        if (target == targets.front()) {
            best = values;
        }
        ErrorRecord errors(scales.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double error = std::abs(static_cast<double>(values[i]) - static_cast<double>(best[i]));
            errors[i / width] = std::max(errors[i / width], std::isnan(error) ? 1e300 : error / scales[i / width]);
        }
        errors.publish(name + "_" + name_of<T>() + "_" + target);
        EXPECT_LE(errors.largest(), kBound<T>) << "light " << errors.worst();
    }
}

template <class T>
class TargetsAgree : public ::testing::Test {};
using Types = ::testing::Types<float, double>;
TYPED_TEST_SUITE(TargetsAgree, Types);

TYPED_TEST(TargetsAgree, OnTheBasis) {
    using T = TypeParam;
    RandomInput random(1);
    std::vector<Vec3<T>> directions;
    for (int i = 0; i < 2000; ++i) {
        const Vec3d d = i % 5 == 0 ? random.at_tilt(random.log_uniform(1e-6, 0.1)) : random.direction();
        directions.emplace_back(random.log_uniform(1e-3, 1e3) * d);
    }
    for (const int order : kOrders) {
        const auto width = static_cast<std::size_t>(coefficient_count(order));
        // The largest of a basis function is that of the zonal one at its pole, and grows as √n.
        const std::vector<double> scales(directions.size(), std::sqrt(order));
        expect_agreement<T>("basis_" + std::to_string(order), width, scales,
                            [&](std::span<T> out) { sh_basis<T>(directions, order, out); });
    }
}

/// Spheres of all sizes and sorts, mixed so that neighbouring lanes differ.
template <class T>
struct Spheres {
    std::vector<Vec3<T>> centers;
    std::vector<T> radii;

    explicit Spheres(std::size_t count) {
        RandomInput random(2);
        for (std::size_t i = 0; i < count; ++i) {
            const double half = random.log_uniform(1e-3, 1.5);
            const int kind = random.integer(0, 5);
            double tilt = kHalfPi + half * random.uniform(-0.8, 0.8);
            if (kind == 3) {
                tilt = random.uniform(0, kHalfPi - half);
            } else if (kind == 4) {
                tilt = random.log_uniform(1e-6, 1e-2);
            } else if (kind == 5) {
                tilt = random.uniform(0, std::numbers::pi);
            }
            const double distance = random.log_uniform(0.1, 10);
            centers.emplace_back(distance * random.at_tilt(tilt));
            radii.push_back(static_cast<T>(distance * std::sin(half)));
        }
    }
};

/// L_00 of each light: what is kept of it, or, of a sliver of less than a tenth, a tenth of the whole.
template <class T>
std::vector<double> scales_of(const std::vector<T>& kept, const std::vector<T>& whole) {
    std::vector<double> scales;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        scales.push_back(std::max(static_cast<double>(kept[i]), 0.1 * static_cast<double>(whole[i])));
    }
    return scales;
}

TYPED_TEST(TargetsAgree, OnSpheres) {
    using T = TypeParam;
    const Spheres<T> lights(3000);
    std::vector<T> kept(lights.radii.size());
    std::vector<T> whole(lights.radii.size());
    sphere_coefficients<T>(lights.centers, lights.radii, 1, true, kept);
    sphere_coefficients<T>(lights.centers, lights.radii, 1, false, whole);
    const std::vector<double> kept_scales = scales_of(kept, whole);
    const std::vector<double> whole_scales(whole.begin(), whole.end());
    for (const int order : kOrders) {
        const auto width = static_cast<std::size_t>(coefficient_count(order));
        for (const bool clip : {true, false}) {
            const std::vector<double>& scales = clip ? kept_scales : whole_scales;
            expect_agreement<T>(
                (clip ? "spheres_" : "whole_spheres_") + std::to_string(order), width, scales,
                [&](std::span<T> out) { sphere_coefficients<T>(lights.centers, lights.radii, order, clip, out); });
        }
    }
}

TYPED_TEST(TargetsAgree, OnPolygons) {
    using T = TypeParam;
    constexpr int kCorners = 4;
    RandomInput random(3);
    std::vector<Vec3<T>> vertices;
    constexpr std::size_t kCount = 1500;
    for (std::size_t i = 0; i < kCount; ++i) {
        for (const Vec3d& v : testing::facing(random, kCorners, 0.6, random.log_uniform(0.01, 1))) {
            vertices.emplace_back(v);
        }
    }
    std::vector<T> kept(kCount);
    std::vector<T> whole(kCount);
    polygon_coefficients<T>(vertices, kCorners, 1, true, kept);
    polygon_coefficients<T>(vertices, kCorners, 1, false, whole);
    const std::vector<double> scales = scales_of(kept, whole);
    for (const int order : kOrders) {
        const auto width = static_cast<std::size_t>(coefficient_count(order));
        expect_agreement<T>("polygons_" + std::to_string(order), width, scales,
                            [&](std::span<T> out) { polygon_coefficients<T>(vertices, kCorners, order, true, out); });
    }
}

std::vector<Bsdf> materials() {
    std::vector<Bsdf> all = {Bsdf::lambert(Rgb(1))};
    for (const float roughness : {0.1F, 0.3F, 0.7F}) {
        all.push_back(Bsdf::ggx(roughness, Rgb(1)));
    }
    return all;
}

/// Radiance relative to the albedo, which is nearly 1, of a material at views that differ from light to light.
void expect_equal_radiance(
    const std::string& name, std::size_t count,
    const std::function<void(const Bsdf&, std::span<const double>, int, std::span<Rgb>)>& shade) {
    RandomInput random(4);
    std::vector<double> views;
    for (std::size_t i = 0; i < count; ++i) {
        views.push_back(i % 7 == 0 ? 0.6 : random.uniform(0.05, 1));
    }
    int material = 0;
    for (const Bsdf& bsdf : materials()) {
        ++material;
        for (const int order : {2, 8, 16}) {
            expect_agreement<float>(name + "_" + std::to_string(material) + "_" + std::to_string(order), 1,
                                    std::vector<double>(count, 1.0), [&](std::span<float> out) {
                                        std::vector<Rgb> radiance(count);
                                        shade(bsdf, views, order, radiance);
                                        std::transform(radiance.begin(), radiance.end(), out.begin(),
                                                       [](const Rgb& r) { return r.x; });
                                    });
        }
    }
}

TEST(TargetsAgreeOnLight, OfSpheres) {
    const Spheres<double> lights(1000);
    expect_equal_radiance("lit_by_spheres", lights.radii.size(),
                          [&](const Bsdf& bsdf, std::span<const double> views, int order, std::span<Rgb> radiance) {
                              shade_spheres(lights.centers, lights.radii, bsdf, views, {order, 1e-3}, radiance);
                          });
}

TEST(TargetsAgreeOnLight, OfSpheresAsTheyCome) {
    const Spheres<float> lights(1000);
    expect_equal_radiance("lit_by_float_spheres", lights.radii.size(),
                          [&](const Bsdf& bsdf, std::span<const double> views, int order, std::span<Rgb> radiance) {
                              LightShader(bsdf, {order, 1e-3})
                                  .spheres(std::span<const Vec3<float>>(lights.centers),
                                           std::span<const float>(lights.radii), views, radiance);
                          });
}

TEST(TargetsAgreeOnLight, OfPolygons) {
    RandomInput random(5);
    constexpr std::size_t kCount = 500;
    std::vector<Vec3d> vertices;
    for (std::size_t i = 0; i < kCount; ++i) {
        for (const Vec3d& v : testing::facing(random, 4, 0.6, random.log_uniform(0.01, 1))) {
            vertices.push_back(v);
        }
    }
    expect_equal_radiance("lit_by_polygons", kCount,
                          [&](const Bsdf& bsdf, std::span<const double> views, int order, std::span<Rgb> radiance) {
                              shade_polygons(vertices, 4, bsdf, views, {order, 1e-3}, radiance);
                          });
}

}  // namespace
}  // namespace shlight
