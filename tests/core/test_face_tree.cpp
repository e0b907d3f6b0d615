// SPDX-License-Identifier: MIT
//
// The light of an emitter's faces as a cut through their tree sums it up, and as directions to them are drawn, against
// the sum over small parts of all faces.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/perpendicular.h"
#include "emitters/face_sum.h"
#include "emitters/face_tree.h"
#include "lights/face_sampling.h"
#include "random_input.h"
#include "shlight/lobe_shape.h"
#include "solids.h"

namespace shlight {
namespace {

using testing::RandomInput;
using testing::Solid;

struct Emitter {
    Solid solid;
    std::vector<Rgb> radiance;
    bool closed;

    FaceTree faces() const { return {solid.vertices, solid.triangles, radiance, closed, false}; }
};

Emitter emitter(Solid solid, bool closed, RandomInput& random) {
    std::vector<Rgb> radiance;
    for (std::size_t i = 0; i < solid.triangles.size(); ++i) {
        radiance.emplace_back(random.uniform(0, 1), random.uniform(0, 3), random.chance(0.2) ? 2 : 0);
    }
    return {std::move(solid), std::move(radiance), closed};
}

std::vector<Emitter> emitters() {
    RandomInput random(3);
    Solid bowl = testing::icosphere(2);
    std::erase_if(bowl.triangles, [&](const Triangle& t) { return bowl.vertices[t.x].z > 0.3; });
    return {emitter(testing::torus(1, 0.3, 24, 12), true, random), emitter(testing::icosphere(3), true, random),
            emitter(bowl, false, random)};
}

struct View {
    ShadingFrame frame;
    Vec3d to_viewer;
};

/// Outside of the solids, and in the torus's hole and the bowl.
View random_view(RandomInput& random) {
    const Vec3d origin = random.chance(0.3) ? Vec3d(0.3, 0.2, 0.1) + Vec3d(0, 0, random.uniform(1, 1.5))
                                            : random.uniform(1.4, 8) * random.direction();
    const Vec3d z = glm::normalize(random.direction() - 0.5 * glm::normalize(origin));
    const Vec3d x = perpendicular(z);
    return {{origin, x, glm::cross(z, x), z}, glm::normalize(Vec3d(std::abs(random.direction().x), 0, 0.8))};
}

/// The sum over a triangle's parts at their middles, quartered until they are small.
Vec3d light_of(const std::array<Vec3d, 3>& corners, const Vec3d& radiance, bool front_only, const LobeShape& lobe,
               const View& view, int quarterings) {
    const auto& [a, b, c] = corners;
    if (quarterings > 0) {
        const Vec3d ab = 0.5 * (a + b);
        const Vec3d bc = 0.5 * (b + c);
        const Vec3d ca = 0.5 * (c + a);
        Vec3d sum(0);
        for (const std::array<Vec3d, 3>& part : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
            sum += light_of(part, radiance, front_only, lobe, view, quarterings - 1);
        }
        return sum;
    }
    const Vec3d way = (a + b + c) / 3.0 - view.frame.origin;
    const double distance = glm::length(way);
    const double facing = -0.5 * glm::dot(glm::cross(b - a, c - a), way) / distance;
    const Vec3d direction = view.frame.to_local(way / distance);
    if (direction.z <= 0 || (front_only && facing < 0)) {
        return Vec3d(0);
    }
    return lobe_value(lobe, direction, view.to_viewer) * std::abs(facing) / (distance * distance) * radiance;
}

Vec3d brute_force(const Emitter& emitter, const LobeShape& lobe, const View& view) {
    Vec3d sum(0);
    for (std::size_t i = 0; i < emitter.solid.triangles.size(); ++i) {
        const Triangle& t = emitter.solid.triangles[i];
        const std::array<Vec3d, 3> corners = {emitter.solid.vertices[t.x], emitter.solid.vertices[t.y],
                                              emitter.solid.vertices[t.z]};
        sum += light_of(corners, Vec3d(emitter.radiance[i]), emitter.closed, lobe, view, 4);
    }
    return sum;
}

/// The light of near faces by brute force.
Vec3d near_light(const std::vector<NearFace>& near, const LobeShape& lobe, const View& view) {
    const View local = {{Vec3d(0), {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, view.to_viewer};
    Vec3d sum(0);
    for (const NearFace& face : near) {
        sum += light_of(face.corners, Vec3d(face.radiance), false, lobe, local, 4);
    }
    return sum;
}

double relative_error(const Vec3d& found, const Vec3d& truth) {
    const Vec3d off = glm::abs(found - truth);
    return std::max({off.x, off.y, off.z}) / std::max({truth.x, truth.y, truth.z});
}

const std::vector<LobeShape> kLobes = {LambertShape{}, GgxShape{0.5}, GgxShape{0.15}};

TEST(FaceSum, IsTheSumOverAllFacesWithinItsTolerance) {
    RandomInput random(5);
    FaceSum sum;
    const std::vector<Emitter> all = emitters();
    for (std::size_t e = 0; e < all.size(); ++e) {
        const FaceTree faces = all[e].faces();
        for (const double tolerance : {0.03, 0.003}) {
            double squares = 0;
            int count = 0;
            for (int i = 0; i < 60; ++i) {
                const View view = random_view(random);
                const LobeShape& lobe = kLobes[static_cast<std::size_t>(i) % kLobes.size()];
                std::vector<NearFace> near;
                std::array<SummedLobe, 1> summed = {{{lobe, 1}}};
                sum.add_up(faces, view.to_viewer, view.frame, faces.viewpoint(view.frame, 0), tolerance, 0, summed,
                           near);
                const Vec3d found = summed[0].light;
                const Vec3d truth = brute_force(all[e], lobe, view);
                if (truth.y < 1e-3) {
                    EXPECT_LE(found.y, 2e-3);
                    continue;
                }
                const double error = relative_error(found + near_light(near, lobe, view), truth);
                EXPECT_LE(error, 5 * tolerance) << "emitter " << e << ", view " << i;
                squares += error * error;
                ++count;
            }
            // The errors of parts are estimates: the root of their mean square came to 1.37 tolerances in ten seeds.
            EXPECT_LE(std::sqrt(squares / count), 1.5 * tolerance) << "emitter " << e;
        }
    }
}

/// A strip along x that lies in the plane z = 0 but for its folds.
Emitter folded_strip(double height) {
    Emitter strip = {{}, {}, false};
    for (std::uint32_t i = 0; i < 9; ++i) {
        const double z = i % 2 == 0 ? height : -height;
        strip.solid.vertices.insert(strip.solid.vertices.end(), {Vec3d(i, -1, z), Vec3d(i, 1, z)});
        if (i > 0) {
            const std::uint32_t k = 2 * i;
            strip.solid.triangles.insert(strip.solid.triangles.end(), {{k - 2, k, k - 1}, {k, k + 1, k - 1}});
        }
    }
    strip.radiance.assign(strip.solid.triangles.size(), Rgb(1));
    return strip;
}

TEST(FaceSum, HasTheLightOfFoldsInWhosePlaneAHitLies) {
    const View view = {{{-3, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, {0, 0.6, 0.8}};
    FaceSum sum;
    for (const double height : {0.0, 0.01, 0.3}) {
        const Emitter strip = folded_strip(height);
        const FaceTree faces = strip.faces();
        std::vector<NearFace> near;
        std::array<SummedLobe, 1> summed = {{{LambertShape{}, 1}}};
        sum.add_up(faces, view.to_viewer, view.frame, faces.viewpoint(view.frame, 0), 1e-3, 0, summed, near);
        const Vec3d found = summed[0].light + near_light(near, LambertShape{}, view);
        const Vec3d truth = brute_force(strip, LambertShape{}, view);
        EXPECT_LE(glm::length(found - truth), 3e-3 * truth.y) << height;
    }
}

/// Directions that are drawn or met bring the same light, and agree about the density of what both find.
TEST(FaceSampler, BringsTheSumOverAllFaces) {
    RandomInput random(6);
    const std::vector<Emitter> all = emitters();
    for (std::size_t e = 0; e < all.size(); ++e) {
        const FaceTree faces = all[e].faces();
        for (int i = 0; i < 8; ++i) {
            const View view = random_view(random);
            FaceSampler sampler;
            sampler.reset(faces, view.frame, 0);
            Vec3d sum(0);
            Vec3d squares(0);
            constexpr int kSamples = 20'000;
            int agree = 0;
            int drawn = 0;
            for (int k = 0; k < kSamples; ++k) {
                const auto sample = sampler.sample({random.uniform(0, 1), random.uniform(0, 1)});
                if (!sample) {
                    continue;
                }
                const Vec3d value = lobe_value(LambertShape{}, sample->direction, view.to_viewer) / sample->density *
                                    Vec3d(sample->radiance);
                sum += value;
                squares += value * value;
                const auto same = std::ranges::any_of(sampler.meet(sample->direction), [&](const FaceSample& met) {
                    return met.hidden == sample->hidden && std::abs(met.density / sample->density - 1) < 1e-3;
                });
                ++drawn;
                agree += same ? 1 : 0;
            }
            const Vec3d truth = brute_force(all[e], LambertShape{}, view);
            const Vec3d mean = sum / double{kSamples};
            const Vec3d error = glm::sqrt(glm::max(squares / double{kSamples} - mean * mean, 0.0) / double{kSamples});
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(mean[c], truth[c], 4.5 * error[c] + 0.003 * truth.y) << "emitter " << e << ", view " << i;
            }
            // At the edges of faces rays in float may meet the next one.
            EXPECT_GE(agree, 0.98 * drawn) << "emitter " << e << ", view " << i;
        }
    }
}

Solid rough_ground(std::uint32_t width, RandomInput& random) {
    Solid ground;
    for (std::uint32_t y = 0; y <= width; ++y) {
        for (std::uint32_t x = 0; x <= width; ++x) {
            ground.vertices.emplace_back(x, y, random.uniform(0, 0.7));
        }
    }
    for (std::uint32_t y = 0; y < width; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::uint32_t a = y * (width + 1) + x;
            ground.triangles.push_back({a, a + 1, a + width + 2});
            ground.triangles.push_back({a, a + width + 2, a + width + 1});
        }
    }
    return ground;
}

/// A surface that lights itself does so by the few faces beside the hit, of thousands. If these are drawn more rarely
/// than they bring light, most pixels lack it and some are far too bright.
TEST(FaceSampler, DrawsTheFacesBesideAHitAsTheyBringLight) {
    RandomInput random(7);
    Emitter ground = {rough_ground(80, random), {}, false};
    ground.radiance.assign(ground.solid.triangles.size(), Rgb(1));
    const FaceTree faces = ground.faces();
    for (int i = 0; i < 10; ++i) {
        const auto number = static_cast<std::ptrdiff_t>(random.uniform(4000, 8000));
        const Triangle own = ground.solid.triangles[static_cast<std::size_t>(number)];
        const auto [a, b, c] =
            std::array{ground.solid.vertices[own.x], ground.solid.vertices[own.y], ground.solid.vertices[own.z]};
        const Vec3d z = glm::normalize(glm::cross(b - a, c - a));
        const Vec3d x = perpendicular(z);
        const View view = {{(a + b + c) / 3.0, x, glm::cross(z, x), z}, Vec3d(0, 0, 1)};
        FaceSampler sampler;
        sampler.reset(faces, view.frame, 1e-6);
        double sum = 0;
        double squares = 0;
        constexpr int kSamples = 4000;
        for (int k = 0; k < kSamples; ++k) {
            const auto sample = sampler.sample({random.uniform(0, 1), random.uniform(0, 1)});
            const double value =
                sample ? lobe_value(LambertShape{}, sample->direction, view.to_viewer) / sample->density : 0;
            sum += value;
            squares += value * value;
        }
        const double mean = sum / kSamples;
        const double deviation = std::sqrt(std::max(squares / kSamples - mean * mean, 0.0));
        Emitter others = ground;
        others.solid.triangles.erase(others.solid.triangles.begin() + number);
        const double truth = brute_force(others, LambertShape{}, view).x;
        EXPECT_NEAR(mean, truth, 4.5 * deviation / std::sqrt(double{kSamples}) + 0.003 * truth) << "hit " << i;
        EXPECT_LE(deviation, 3 * truth) << "hit " << i;
    }
}

bool shows_front_only(const FaceTree& faces, const Vec3d& point) {
    return faces.viewpoint({point, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 0).front_only;
}

TEST(FaceTree, ShowsItsInnerSideAlsoUnderOtherClosedSurfaces) {
    Solid both = testing::icosphere(2);
    const Solid& inner = testing::icosphere(1);
    const auto first = static_cast<std::uint32_t>(both.vertices.size());
    for (const Vec3d& vertex : inner.vertices) {
        both.vertices.push_back(0.1 * vertex);
    }
    for (const Triangle& triangle : inner.triangles) {
        both.triangles.push_back(triangle + first);
    }
    const FaceTree faces(both.vertices, both.triangles, std::vector(both.triangles.size(), Rgb(1)), true, false);
    const auto front_only = [&](const Vec3d& origin) {
        return faces.viewpoint({origin, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 0).front_only;
    };
    for (const Vec3d& within : {Vec3d(0.01, 0.02, -0.5), Vec3d(0.01, 0.02, 0.5), Vec3d(0.01, 0.02, 0)}) {
        EXPECT_FALSE(front_only(within)) << within.z;
    }
    EXPECT_TRUE(front_only({0.01, 0.02, -1.5}));
    EXPECT_TRUE(front_only({0.7, 0.7, -0.5}));
}

TEST(FaceTree, ShowsItsInnerSideWithinAClosedSurfaceUnlessThatIsDark) {
    for (const Emitter& emitter : emitters()) {
        const FaceTree faces = emitter.faces();
        EXPECT_EQ(shows_front_only(faces, {0.9, 0.02, 0.01}), false);
        EXPECT_EQ(shows_front_only(faces, {1.5, 0.02, 0.01}), emitter.closed);
        const FaceTree one_sided(emitter.solid.vertices, emitter.solid.triangles, emitter.radiance, emitter.closed,
                                 true);
        EXPECT_EQ(shows_front_only(one_sided, {0.9, 0.02, 0.01}), true);
    }
}

}  // namespace
}  // namespace shlight
