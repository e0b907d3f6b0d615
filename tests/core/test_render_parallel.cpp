// SPDX-License-Identifier: MIT
//
// The same bits however the work is spread; progress, cancellation and exceptions.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "emitters/emitter_levels.h"
#include "emitters/face_tree.h"
#include "environment/environment_map.h"
#include "render_scenes.h"
#include "shlight/parallel.h"
#include "shlight/ray_tracer.h"

namespace shlight {
namespace {

using namespace testing;

Scene busy_scene() {
    Scene scene;
    scene.add_mesh(floor_mesh(4, 0, Bsdf::layer(Bsdf::ggx(0.7F, Rgb(0.04F)), Bsdf::lambert(Rgb(0.5F)))));
    Mesh ball = sphere_mesh({0, 0, 0.5}, 0.5, 12, true);
    ball.bsdfs = {Bsdf::ggx(0.3F, Rgb(0.9F)) + Bsdf::lambert(Rgb(0.1F))};
    scene.add_mesh(ball);
    scene.add_sphere_light({1, -1, 2}, 0.5, Rgb(3));
    scene.add_polygon_light({{-1, -1, 2}, {-1, 0, 2}, {0, 0, 2}, {0, -1, 2}}, Rgb(3));
    return scene;
}

RenderSettings settings_for(int threads) {
    RenderSettings settings;
    settings.sampling = PixelSampling::refined(4);
    settings.threads = threads;
    return settings;
}

TEST(RenderParallel, TilesDoNotChangeABit) {
    // The left quarter alone is cut into other tiles than as part of the whole. Powers of two keep the rays the same, a
    // given order keeps the mean of a picture from counting, and a fixed number of rays the neighbours outside.
    RenderSettings settings = settings_for(0);
    settings.order = 8;
    settings.sampling = PixelSampling::fixed(16);
    const Scene scene = busy_scene();
    const glm::dmat4 above = frame_matrix({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 10});
    const Image whole =
        render_image(scene, Camera(above, Window{-1, 1, -1, 1}, Projection::orthographic), 64, 64, settings);
    const Image part =
        render_image(scene, Camera(above, Window{-1, -0.75, -1, 1}, Projection::orthographic), 8, 64, settings);
    for (int row = 0; row < 64; ++row) {
        for (int column = 0; column < 8; ++column) {
            EXPECT_EQ(part.color(column, row), whole.color(column, row));
        }
    }
}

TEST(RenderParallel, NoMoreThreadsThanAskedFor) {
    std::atomic<int> running = 0;
    std::atomic<int> most = 0;
    parallel_for(50, 1, [&](std::size_t) {
        most = std::max<int>(most, ++running);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        --running;
    });
    EXPECT_EQ(most, 1);
    EXPECT_THROW(parallel_for(1, -1, [](std::size_t) {}), std::invalid_argument);
}

TEST(RenderParallel, CallersAtOnceAndCallsInCalls) {
    std::vector<std::atomic<int>> runs(4000);
    const auto outer = [&](std::size_t caller) {
        parallel_for(10, 0, [&](std::size_t i) {
            for (const int threads : {0, 2}) {
                const std::size_t first = 1000 * caller + 100 * i + (threads == 0 ? 0 : 50);
                parallel_for(50, threads, [&](std::size_t k) { ++runs[first + k]; });
            }
        });
    };
    std::vector<std::thread> callers;
    for (std::size_t caller = 0; caller < 4; ++caller) {
        callers.emplace_back([&, caller] { outer(caller); });
    }
    for (std::thread& caller : callers) {
        caller.join();
    }
    EXPECT_TRUE(std::all_of(runs.begin(), runs.end(), [](const auto& count) { return count == 1; }));
}

TEST(RenderParallel, TheCallerLooksWhileWorkGoesOn) {
    const auto caller = std::this_thread::get_id();
    std::atomic<int> looks = 0;
    const auto look = [&] {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        ++looks;
        return true;
    };
    const auto work = [&](const Watch& watch) {
        EXPECT_NE(std::this_thread::get_id(), caller);
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        const int before = looks;
        EXPECT_GE(before, 3);
        watch.look();
        EXPECT_EQ(looks.load(), before + 1);  // at once, and the work has waited for it
    };
    run_watched(0, work, look);
    run_watched(0, [&](const Watch& watch) { EXPECT_TRUE(!watch.stopped && !watch.look); }, {});
}

TEST(RenderParallel, WatchedWorkIsToldToEnd) {
    const auto endless = [](const Watch& watch) {
        while (true) {
            end_if(watch.stopped);
            std::this_thread::yield();
        }
    };
    EXPECT_THROW(run_watched(0, endless, [] { return false; }), RenderCancelled);
    const auto asks = [](const Watch& watch) {
        while (true) {
            watch.look();
            end_if(watch.stopped);
        }
    };
    const auto throws = []() -> bool { throw std::out_of_range("from look"); };
    EXPECT_THROW(run_watched(0, asks, throws), std::out_of_range);
    const auto fails = [](const Watch&) { throw std::length_error("from work"); };
    EXPECT_THROW(run_watched(0, fails, [] { return true; }), std::length_error);
}

TEST(RenderParallel, BuildingTheTracerCanBeStopped) {
    std::vector<Vec3f> vertices;
    std::vector<Triangle> triangles;
    for (std::uint32_t i = 0; i < 100000; ++i) {
        const auto x = static_cast<float>(i % 317);
        const auto y = static_cast<float>(i / 317);
        vertices.insert(vertices.end(), {{x, y, 0}, {x + 1, y, 0}, {x, y + 1, 0}});
        triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    std::atomic<int> asked = 0;
    const SurfaceTree whole(vertices, triangles, {}, [&] { return ++asked < 0; });
    EXPECT_GT(asked, 2);  // not only before the build
    asked = 0;
    EXPECT_THROW(SurfaceTree(vertices, triangles, {}, [&] { return ++asked > 1; }), RenderCancelled);
}

TEST(RenderParallel, BuildingEmittersAndEnvironmentsCanBeStopped) {
    std::vector<Vec3d> vertices;
    std::vector<Triangle> triangles;
    std::vector<Rgb> radiance;
    for (std::uint32_t i = 0; i < 20000; ++i) {
        const auto x = static_cast<double>(i % 100);
        const auto y = static_cast<double>(i / 100);
        vertices.insert(vertices.end(), {{x, y, 0}, {x + 1, y, 0}, {x, y + 1, 0}});
        triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
        radiance.emplace_back(static_cast<float>(i % 7));
    }
    const auto picture = std::make_shared<LatLong>(LatLong{{}, 64, 32});
    for (int i = 0; i < 64 * 32; ++i) {
        picture->pixels.emplace_back(static_cast<float>(i % 11));
    }
    const std::vector<std::function<void(const Stopped&)>> builds = {
        [&](const Stopped& stopped) { make_emitter_levels(vertices, triangles, 64, stopped); },
        [&](const Stopped& stopped) { FaceTree(vertices, triangles, radiance, false, false, stopped); },
        [&](const Stopped& stopped) { EnvironmentMap(picture, stopped); }};
    for (const auto& build : builds) {
        std::atomic<int> asked = 0;
        build([&] { return ++asked < 0; });
        EXPECT_GE(asked, 4);
        for (const int most : {0, asked / 2}) {
            asked = 0;
            EXPECT_THROW(build([&] { return ++asked > most; }), RenderCancelled);
        }
    }
}

TEST(RenderParallel, ExceptionsReachTheCaller) {
    try {
        parallel_for(100, 0, [](std::size_t i) {
            if (i == 50) throw std::out_of_range("from the body");
        });
        FAIL() << "nothing was thrown";
    } catch (const std::out_of_range& error) {
        EXPECT_EQ(std::string(error.what()), "from the body");
    }
    std::atomic<int> runs = 0;
    parallel_for(100, 0, [&](std::size_t) { ++runs; });
    EXPECT_EQ(runs, 100) << "after an exception";
}

}  // namespace
}  // namespace shlight
