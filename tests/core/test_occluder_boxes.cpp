// SPDX-License-Identifier: MIT
//
// What boxes about surfaces prove to be free is free for Embree's rays too, and is found to be where a plane shows it.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lights/light_bounds.h"
#include "random_input.h"
#include "render_scenes.h"
#include "tracing/occluder_boxes.h"

namespace shlight {
namespace {

using namespace testing;

class OccluderBoxesTest : public ::testing::Test {
  protected:
    Vec3d vector(double most) {
        return {random_.uniform(-most, most), random_.uniform(-most, most), random_.uniform(-most, most)};
    }

    /// Patches of small triangles, some of them placed by transforms that shear.
    void add_surfaces() {
        for (std::uint32_t number = 0; number < 6; ++number) {
            std::vector<Vec3f> vertices;
            std::vector<Triangle> triangles;
            const Vec3d middle = vector(3);
            for (std::uint32_t i = 0; i < 40; ++i) {
                vertices.emplace_back(middle + vector(0.5));
                if (i >= 2) {
                    triangles.emplace_back(i - 2, i - 1, i);
                }
            }
            const Vec3d x = Vec3d(1, 0, 0) + vector(0.5);
            const glm::dmat4 to_world =
                number % 2 == 0 ? glm::dmat4(1) : frame_matrix(x, {0.2, 1, 0}, {0, -0.3, 0.7}, vector(1));
            instances_.push_back({std::make_shared<const TriangleTree>(vertices, triangles), to_world});
            for (const OccluderCluster& cluster : occluder_clusters(vertices, triangles)) {
                clusters_.push_back(placed_cluster(cluster, to_world));
            }
        }
    }

    RandomInput random_{7};
    std::vector<TracedInstance> instances_;
    std::vector<OccluderCluster> clusters_;
};

struct Opaque : SurfaceTransparency {
    void find(std::span<const Ray> /*rays*/, std::span<const RayHit> /*hits*/, std::uint32_t /*depth*/,
              std::span<Rgb> /*passed*/) const override {}
};

TEST_F(OccluderBoxesTest, NoRayMeetsAnythingWhereNothingMayBlock) {
    constexpr int kShafts = 10000;
    add_surfaces();
    const Opaque opaque;
    const SceneRays rays(instances_, {}, clusters_, opaque);
    int free = 0;
    for (int i = 0; i < kShafts; ++i) {
        const Vec3d corner = vector(5);
        const Vec3d end = vector(5);
        const Vec3d u = vector(0.2);
        const Vec3d v = glm::cross(u, vector(1));
        const bool is_sun = i % 4 == 0;
        const double angle = random_.uniform(0.01, 0.3);
        const Light light = is_sun ? make_sun_light(end, angle, Rgb(1), false)
                                   : Light(make_polygon_light({end, end + u, end + u + v, end + v}, Rgb(1), true));
        std::vector<Vec3f> points;
        for (int point = 0; point < 100; ++point) {
            points.emplace_back(corner + vector(0.05));
        }
        if (rays.boxes().may_block(points, *bounds_of(light))) {
            continue;
        }
        ++free;
        std::vector<Ray> asked;
        for (const Vec3f& point : points) {
            const Vec3d to_sun = -glm::normalize(end) + 0.7 * angle / 2 * glm::normalize(vector(1));
            const Vec3d to_lamp = end + random_.uniform(0, 1) * u + random_.uniform(0, 1) * v - Vec3d(point);
            asked.push_back({point, 0, Vec3f(is_sun ? to_sun : to_lamp), is_sun ? INFINITY : 1.0F});
        }
        std::vector<Rgb> visible(asked.size());
        rays.visibility(asked, 8, visible);
        for (const Rgb& share : visible) {
            ASSERT_EQ(share, Rgb(1)) << "shaft " << i;
        }
    }
    EXPECT_GE(free, kShafts / 10);
    EXPECT_LE(free, kShafts - kShafts / 10);
}

TEST_F(OccluderBoxesTest, AFloorHidesNothingFromItselfHoweverItLies) {
    for (int i = 0; i < 20; ++i) {
        const Vec3d normal = glm::normalize(vector(1));
        const Vec3d u = glm::normalize(glm::cross(normal, vector(1)));
        const Vec3d v = glm::cross(normal, u);
        const Vec3d middle = vector(10);
        Scene scene;
        Mesh floor;
        floor.vertices = {Vec3f(middle - u - v), Vec3f(middle + u - v), Vec3f(middle + u + v), Vec3f(middle - u + v)};
        floor.triangles = {{0, 1, 2}, {0, 2, 3}};
        floor.bsdfs = {Bsdf::lambert(Rgb(0.5F))};
        scene.add_mesh(floor);
        scene.add_sphere_light(middle + 2.0 * normal + u, 0.3, Rgb(1));
        const Camera camera(look_at(middle + 3.0 * normal, middle), 0.4);
        const Image image = render_image(scene, camera, 16, 16, RenderSettings());
        EXPECT_EQ(image.report.shadow_rays, 0U) << "floor " << i;
        EXPECT_GT(image.color(8, 8).x, 0);
    }
}

}  // namespace
}  // namespace shlight
