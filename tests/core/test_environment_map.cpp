// SPDX-License-Identifier: MIT
//
// Light from all around as a picture has it: its harmonics, their turns, lobes clamped at the horizon, directions drawn
// from it, and what surfaces reflect of it.
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "environment/environment_map.h"
#include "environment/map_lookup.h"
#include "lobes/lobe_moments.h"
#include "lobes/sh_projection.h"
#include "lobes/turned_lobes.h"
#include "math/band_rotation.h"
#include "render_scenes.h"
#include "shlight/basis.h"
#include "shlight/environment.h"

namespace shlight::testing {
namespace {

constexpr double kPi = std::numbers::pi;

glm::dmat3 rotation_about(const Vec3d& axis, double angle) {
    const Vec3d a = glm::normalize(axis);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const glm::dmat3 cross(0, a.z, -a.y, -a.z, 0, a.x, a.y, -a.x, 0);
    return c * glm::dmat3(1) + (1 - c) * glm::outerProduct(a, a) + s * cross;
}

LatLong random_picture(int width, int height, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, 2);
    LatLong picture{{}, width, height};
    for (int i = 0; i < width * height; ++i) {
        picture.pixels.emplace_back(uniform(random), uniform(random), uniform(random));
    }
    return picture;
}

/// ∫ g dω over the sphere by the midpoint rule in latitude and longitude.
double sphere_integral(int steps, const std::function<double(const Vec3d&)>& g) {
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double z = 1 - 2 * (i + 0.5) / steps;
        for (int j = 0; j < 2 * steps; ++j) {
            const double azimuth = kPi * (j + 0.5) / steps;
            sum += g({std::sqrt(1 - z * z) * std::cos(azimuth), std::sqrt(1 - z * z) * std::sin(azimuth), z});
        }
    }
    return sum * 2 * kPi / steps / steps;
}

std::vector<double> basis_at(const Vec3d& direction, int order) {
    std::vector<double> basis(static_cast<std::size_t>(order * order));
    sh_basis(direction, order, basis.data());
    return basis;
}

// --- pictures

// --- harmonics

TEST(EnvironmentMap, CoefficientsAreIntegralsOfTheBilinearPicture) {
    constexpr int kOrder = 8;
    constexpr int kSteps = 400;
    for (const auto& [width, height] : {std::pair{7, 3}, {8, 4}, {1, 2}, {3, 1}, {40, 20}}) {
        const LatLong picture = random_picture(width, height, 5);
        std::vector<double> expected(kOrder * kOrder);
        sphere_integral(kSteps, [&](const Vec3d& direction) {
            const double radiance = radiance_from(picture, direction).y;
            const auto basis = basis_at(direction, kOrder);
            for (std::size_t k = 0; k < expected.size(); ++k) {
                expected[k] += basis[k] * radiance * 2 * kPi / kSteps / kSteps;
            }
            return 0.0;
        });
        const RadianceCoefficients coefficients = radiance_coefficients(picture, BrightTexels(picture));
        for (std::size_t k = 0; k < expected.size(); ++k) {
            EXPECT_NEAR(coefficients.channels[1][k], expected[k], 1e-3) << width << " × " << height << ", " << k;
        }
    }
}

// --- turns

/// Light of the harmonics at a direction shows what a lobe sends there.
TEST(TurnedLobes, ReflectAsFunctionsMoveWithTheirArgument) {
    std::mt19937 random(9);
    std::normal_distribution<float> normal;
    std::vector<glm::dmat3> rotations = {glm::dmat3(1),
                                         rotation_about({1, 2, 3}, 1.1),
                                         rotation_about({-2, 1, 0.3}, 2.9),
                                         rotation_about({0, 0, 1}, 0.7),
                                         rotation_about({1, 1, 0}, kPi),
                                         rotation_about({1, 0, 0}, 1e-7),
                                         rotation_about({0, 1, 0}, kPi - 1e-7)};
    while (rotations.size() < 2 * kTurnedLanes) {
        rotations.push_back(rotation_about({normal(random), normal(random), normal(random)}, 3 * normal(random)));
    }
    for (const int order : {1, 2, 7, 40, 64}) {
        std::vector<TurnedLobe> lobes;
        for (const glm::dmat3& rotation : rotations) {
            TurnedLobe& lobe = lobes.emplace_back(TurnedLobe{{}, BandRotation(rotation)});
            lobe.sine = lobes.size() % 3 == 0 ? 1.0F : 0.0F;
            std::generate_n(lobe.terms.begin(), cosine_count(order), [&] { return normal(random) / 64; });
            for (int l = 0; lobe.sine == 1 && l < order; ++l) {
                lobe.terms[static_cast<std::size_t>(cosine_index(l, 0))] = 0;
            }
        }
        for (int i = 0; i < 20; ++i) {
            std::array<Vec3d, 3> directions;
            ColorHarmonics light;
            for (std::size_t c = 0; c < 3; ++c) {
                directions[c] = glm::normalize(Vec3d(normal(random), normal(random), normal(random)));
                const auto basis = basis_at(directions[c], order);
                light[c].assign(basis.begin(), basis.end());
            }
            std::vector<Rgb> reflected(lobes.size());
            reflect_turned(lobes, order, light, reflected);
            for (std::size_t k = 0; k < lobes.size(); ++k) {
                for (int c = 0; c < 3; ++c) {
                    const auto basis = basis_at(glm::transpose(rotations[k]) * directions[c], order);
                    double expected = 0;
                    for (int l = 0; l < order; ++l) {
                        for (int m = 0; m <= l; ++m) {
                            const int degree = lobes[k].sine == 1 ? -m : m;
                            expected += lobes[k].terms[cosine_index(l, m)] * basis[coefficient_index(l, degree)];
                        }
                    }
                    EXPECT_NEAR(reflected[k][c], expected, 2e-4) << order << ' ' << k;
                }
            }
        }
    }
}

// --- lobes

TEST(ShProjection, IsTheLobesMoments) {
    for (const LobeShape& shape : {LobeShape(LambertShape{}), LobeShape(GgxShape{0.25}), LobeShape(GgxShape{0.02})}) {
        const auto lobe = sh_projection(shape);
        for (const double tilt : {0.1234, 0.9, 1.4}) {
            const LobeMoments expected = lobe_moments(shape, tilt);
            std::vector<float> terms(2080);
            lobe->coefficients(static_cast<float>(std::cos(tilt)), 0, false, 64, terms.data());
            for (std::size_t i = 0; i < terms.size(); ++i) {
                ASSERT_NEAR(terms[i], expected.moments[i], 1e-4 * std::max(1.0, std::sqrt(expected.norm_squared)))
                    << tilt << ", " << i;
            }
        }
        const LobeMoments head_on = lobe_moments(shape, 0);
        double all = lobe->tail(0);
        for (int l = 0; l < 64; ++l) {
            all += lobe->powers(0)[l];
        }
        EXPECT_NEAR(all / head_on.norm_squared, 1, 1e-5);
    }
}

// --- directions

TEST(RadianceSampler, DrawsAsItsDensitySays) {
    LatLong picture = random_picture(12, 6, 8);
    picture.pixels[30] = Rgb(100);
    const RadianceSampler sampler(picture);
    EXPECT_NEAR(sphere_integral(600, [&](const Vec3d& d) { return sampler.density(d); }), 1, 1e-3);
    const auto g = [](const Vec3d& d) { return std::exp(d.x + 0.5 * d.y * d.z); };
    constexpr int kSteps = 400;
    double sum = 0;
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const Vec3d d = sampler.sample({(i % kSteps + 0.5) / kSteps, (i / kSteps + 0.5) / kSteps});
        EXPECT_NEAR(glm::length(d), 1, 1e-12);
        sum += g(d) / sampler.density(d) / kSteps / kSteps;
    }
    EXPECT_NEAR(sum, sphere_integral(400, g), 0.05);
}

TEST(MapLookup, IsThePicturesRadianceAndItsSamplersDensity) {
    std::mt19937 random(12);
    std::normal_distribution<double> normal;
    for (const auto& [width, height] : {std::pair(48, 24), {1, 3}, {2, 1}}) {
        LatLong source = random_picture(width, height, 5);
        source.pixels[1] = Rgb(2000, 900, 400);
        const EnvironmentMap map(std::make_shared<const LatLong>(source));
        LatLong below = source;
        std::ranges::transform(source.pixels, below.pixels.begin(),
                               [&](const Rgb& texel) { return map.bright.below(texel); });
        constexpr std::size_t kCount = 5 * kLookupLanes;
        std::array<std::vector<float>, 10> v;
        v.fill(std::vector<float>(kCount));
        std::vector<Vec3d> directions(kCount);
        for (std::size_t i = 0; i < kCount; ++i) {
            directions[i] = glm::normalize(Vec3d(normal(random), normal(random), normal(random)));
            for (int axis = 0; axis < 3; ++axis) {
                v[static_cast<std::size_t>(axis)][i] = static_cast<float>(directions[i][axis]);
            }
        }
        look_up(map, {v[0].data(), v[1].data(), v[2].data()}, kCount - 3,
                {{v[3].data(), v[4].data(), v[5].data()}, {v[6].data(), v[7].data(), v[8].data()}, v[9].data()});
        for (std::size_t i = 0; i + 3 < kCount; ++i) {
            const Rgb smooth = radiance_from(below, directions[i]);
            const Rgb whole = radiance_from(source, directions[i]);
            for (std::size_t c = 0; c < 3; ++c) {
                const auto channel = static_cast<int>(c);
                EXPECT_NEAR(v[3 + c][i], smooth[channel], 2e-5 * (whole[channel] + 20)) << width << " " << i;
                EXPECT_NEAR(v[3 + c][i] + v[6 + c][i], whole[channel], 2e-5 * (whole[channel] + 20))
                    << width << " " << i;
            }
            const double density = map.sampler.density(directions[i]);
            EXPECT_NEAR(v[9][i], density, 1e-4 * density) << width << " " << i;
        }
    }
}

TEST(MapLookup, BlurredOverNothingItIsThePicture) {
    LatLong source = random_picture(48, 24, 5);
    source.pixels[300] = Rgb(2000, 900, 400);
    const EnvironmentMap map(std::make_shared<const LatLong>(source));
    LatLong below = source;
    std::ranges::transform(source.pixels, below.pixels.begin(),
                           [&](const Rgb& texel) { return map.bright.below(texel); });
    std::mt19937 random(13);
    std::normal_distribution<double> normal;
    const std::vector<float> none(kLookupLanes, 1e-12F);
    for (int round = 0; round < 50; ++round) {
        std::array<std::vector<float>, 6> v;
        v.fill(std::vector<float>(kLookupLanes));
        // All within some texels of the bright one.
        const Vec3d middle = round % 2 == 0 ? direction_of({12.5, 6.5}, 48, 24) : Vec3d(0);
        std::vector<Vec3d> directions(kLookupLanes);
        for (std::size_t i = 0; i < kLookupLanes; ++i) {
            directions[i] = glm::normalize(middle + 0.1 * Vec3d(normal(random), normal(random), normal(random)));
            for (int axis = 0; axis < 3; ++axis) {
                v[static_cast<std::size_t>(axis)][i] = static_cast<float>(directions[i][axis]);
            }
        }
        for (const bool with_spots : {true, false}) {
            // A place in float errs by some roundings of the width, times the largest step between two texels.
            const double tolerance = 48 * 0x1p-22 * (with_spots ? 2000.0 : map.bright.limit);
            look_up_blurred(map, with_spots, {v[0].data(), v[1].data(), v[2].data()}, none.data(), kLookupLanes,
                            {v[3].data(), v[4].data(), v[5].data()});
            for (std::size_t i = 0; i < kLookupLanes; ++i) {
                const Rgb expected = radiance_from(with_spots ? source : below, directions[i]);
                for (std::size_t c = 0; c < 3; ++c) {
                    EXPECT_NEAR(v[3 + c][i], expected[static_cast<int>(c)], tolerance) << with_spots;
                }
            }
        }
    }
}

// --- reflection

/// Rendered and true radiance, by quadrature, of a floor at the origin with normal (0.48, 0.6, 0.64) at one view.
class Floor {
  public:
    explicit Floor(double cos_theta_o) : normal_(0.48, 0.6, 0.64), x_(glm::normalize(glm::cross(normal_, {0, 0, 1}))) {
        y_ = glm::cross(normal_, x_);
        view_ = std::sqrt(1 - cos_theta_o * cos_theta_o) * x_ + cos_theta_o * normal_;
    }

    Rgb rendered(const LatLong& picture, const Bsdf& bsdf) const {
        Scene scene;
        Mesh mesh = floor_mesh(1, 0, bsdf);
        mesh.transforms = {frame_matrix(x_, y_, normal_, {0, 0, 0})};
        scene.add_mesh(mesh);
        scene.set_environment(Environment(picture));
        return render_image(scene, {look_at(5.0 * view_, {0, 0, 0}), 1e-4}, 1, 1, analytic_settings()).color(0, 0);
    }
    double expected(const LatLong& picture, const Bsdf& bsdf) const {
        const glm::dmat3 frame(x_, y_, normal_);
        return sphere_integral(250, [&](const Vec3d& direction) {
            return direction.z > 0
                       ? double{bsdf.evaluate(direction, view_ * frame).x *
                                radiance_from(picture, glm::transpose(picture.to_world) * frame * direction).x}
                       : 0.0;
        });
    }

    /// The same, of a part of a picture between these texels.
    double expected(const LatLong& picture, const Bsdf& bsdf, const glm::dvec2& first, const glm::dvec2& last) const {
        constexpr int kSteps = 64;
        const glm::dmat3 frame(x_, y_, normal_);
        const glm::dvec2 step = (last - first) / double{kSteps};
        double sum = 0;
        for (int i = 0; i < kSteps * kSteps; ++i) {
            const glm::dvec2 texel = first + (glm::dvec2(i % kSteps, i / kSteps) + 0.5) * step;  // NOLINT
            const Vec3d direction = direction_of(texel, picture.width, picture.height);
            const Vec3d local = direction * frame;
            const double sine = std::hypot(direction.x, direction.y);
            sum += local.z > 0
                       ? sine * double{bsdf.evaluate(local, view_ * frame).x * radiance_from(picture, direction).x}
                       : 0.0;
        }
        return sum * step.x * step.y * 2 * kPi / picture.width * kPi / picture.height;
    }
    Vec3d mirrored() const { return 2 * glm::dot(view_, normal_) * normal_ - view_; }

  private:
    Vec3d normal_, x_, y_, view_;
};

TEST(EnvironmentMap, SurfacesReflectTheirIntegral) {
    LatLong picture = random_picture(32, 16, 4);
    picture.pixels[170] = Rgb(60);                            // some of it a spot
    picture.to_world = rotation_about({0.5, 0.5, 0.7}, 2.2);  // leaves the spot above the floor
    for (const double cosine : {0.95, 0.5, 0.2}) {
        const Floor floor(cosine);
        const double matte = floor.expected(picture, Bsdf::lambert(Rgb(0.7F)));
        EXPECT_NEAR(floor.rendered(picture, Bsdf::lambert(Rgb(0.7F))).x / matte, 1, 2e-3) << cosine;
        // Texels of 11 degrees at random: hardly anything of them is left in 256 directions for narrow lobes.
        for (const auto& [roughness, tolerance] : {std::pair{0.7F, 5e-3}, {0.5F, 2e-2}, {0.25F, 6e-2}}) {
            const Bsdf bsdf = Bsdf::ggx(roughness, Rgb(0.3F), 1.5F);
            const double expected = floor.expected(picture, bsdf);
            const double ratio = floor.rendered(picture, bsdf).x / expected;
            EXPECT_NEAR(ratio, 1, tolerance) << cosine << " " << roughness;
        }
    }
}

/// The picture changes by half its mean from texel to texel, and hardly within the lobe.
TEST(EnvironmentMap, ANarrowLobeShowsThePicture) {
    const LatLong picture = random_picture(128, 64, 4);
    for (const double cosine : {0.95, 0.7, 0.5, 0.2}) {
        const Floor floor(cosine);
        const double seen = radiance_from(picture, floor.mirrored()).x;
        EXPECT_NEAR(floor.rendered(picture, Bsdf::ggx(0.003F, Rgb(1))).x / seen, 1, 1e-4) << cosine;
    }
}

/// One direction is too few for a lobe that is about as wide as a texel, and directions of the lobe miss the sun.
TEST(EnvironmentMap, ASunOfOneTexelHasItsExtent) {
    const int width = 256;
    const int height = 128;
    const Floor floor(0.8);
    const glm::dvec2 peak = glm::floor(texel_of(floor.mirrored(), width, height));
    for (const float roughness : {0.3F, 0.1F, 0.03F}) {
        for (const int off : {0, 3}) {
            const Bsdf bsdf = Bsdf::ggx(roughness, Rgb(0.5F));
            LatLong picture{std::vector<Rgb>(std::size_t{width} * height), width, height};
            const glm::dvec2 sun = peak + glm::dvec2(off, 0);
            picture.pixels[static_cast<std::size_t>(sun.y * width + sun.x)] = Rgb(1000);
            const double expected = floor.expected(picture, bsdf, sun - 0.5, sun + 1.5);
            EXPECT_NEAR(floor.rendered(picture, bsdf).x / expected, 1, 0.03) << roughness << " " << off;
        }
    }
}

TEST(EnvironmentMap, AMirrorShowsThePicture) {
    LatLong picture = random_picture(32, 16, 4);
    picture.to_world = rotation_about({1, -2, 0.5}, 2.2);
    const Image image = [&] {
        Scene scene;
        scene.add_mesh(floor_mesh(1, 0, Bsdf::ggx(0, Rgb(1))));
        scene.set_environment(Environment(picture));
        return render_image(scene, {look_at({1, 2, 3}, {0, 0, 0}), 1e-5}, 1, 1, {});
    }();
    const Vec3d reflected = glm::normalize(Vec3d(-1, -2, 3));
    EXPECT_NEAR(image.red(0, 0), Environment(picture).radiance(reflected).x, 1e-4);
}

/// A wall hides a bright window of the picture from a glossy ball. Few rays of a hit find the window, but what the
/// others lack of it is not seen.
TEST(EnvironmentMap, FewRaysLetNothingThroughAWall) {
    const auto mean_of = [](float window, int shadow_rays) {
        LatLong picture;
        picture.width = 64;
        picture.height = 32;
        picture.pixels.assign(64 * 32, Rgb(0.1F));
        for (const std::size_t row : {12, 13, 14, 15, 16, 17}) {
            std::fill_n(picture.pixels.begin() + static_cast<std::ptrdiff_t>(row * 64 + 13), 6, Rgb(window));
        }
        Scene scene;
        Mesh ball = sphere_mesh({0, 0, 0}, 1, 48, true);
        ball.bsdfs = {Bsdf::ggx(0.5F, Rgb(0.9F))};
        Mesh wall = floor_mesh(4);
        wall.transforms = {frame_matrix({1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {0, 1.2, 0})};
        scene.add_mesh(ball);
        scene.add_mesh(wall);
        scene.set_environment(Environment(picture));
        RenderSettings settings;
        settings.shadow_rays = shadow_rays;
        settings.sampling = PixelSampling::fixed(16);
        const Image image = render_image(scene, {look_at({-8, 0.2, 0.5}, {-1, 0.4, 0}), 0.12}, 12, 12, settings);
        double sum = 0;
        for (int pixel = 0; pixel < 144; ++pixel) {
            sum += image.red(pixel % 12, pixel / 12) / 144.0;
        }
        return sum;
    };
    const double without = mean_of(0.1F, 256);
    EXPECT_NEAR(mean_of(20, 256) / without, 1, 5e-3);
    EXPECT_NEAR(mean_of(20, 2) / without, 1, 5e-2);
}

}  // namespace
}  // namespace shlight::testing
