// SPDX-License-Identifier: MIT
//
// The references themselves: two resolutions and two unrelated methods must agree far below what the tests ask of the
// library.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "quad_ellipse.h"
#include "quad_truth.h"
#include "random_input.h"

namespace shlight {
namespace {

using testing::RandomInput;
using truth::CapInput;
using truth::Coefficients;
using truth::EllipseInput;

/// The larger of two errors, NaN counting as larger.
double worst(double a, double b) {
    return b <= a ? a : b;
}

/// Largest difference ÷ L_00 of the first.
double difference(const Coefficients& a, const Coefficients& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.high.size(); ++i) {
        largest = worst(largest, std::abs((a.high[i] - b.high[i]) + (a.low[i] - b.low[i])));
    }
    return largest / a.high[0];
}

CapInput random_clipped_cap(RandomInput& random) {
    const double half = random.log_uniform(1e-6, 1.56);
    const double tilt = std::numbers::pi / 2 + half * random.uniform(-1, 0.999);
    return {random.at_tilt(tilt), CapInput::Kind::angle, half};
}

std::vector<Vec3d> random_polygon(RandomInput& random, double size) {
    const Vec3d center = random.direction();
    const Vec3d u = size * glm::normalize(glm::cross(center, random.direction()));
    const Vec3d v = size * glm::normalize(glm::cross(random.direction(), u));
    const int count = random.integer(3, 6);
    std::vector<Vec3d> vertices;
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * (i + random.uniform(0, 0.8)) / count;
        vertices.push_back(center + random.uniform(0.3, 1) * (std::cos(angle) * u + std::sin(angle) * v));
    }
    return vertices;
}

/// Checks that more nodes do not change reference(input, order, clip, extra_nodes), for some inputs at each order.
template <class Draw, class Reference>
void expect_convergence(int inputs, std::uint64_t seed, const Draw& draw, const Reference& reference) {
    RandomInput random(seed);
    double largest = 0;
    for (const int order : {1, 8, 16, 33, 64}) {
        for (int i = 0; i < std::max(1, inputs / order); ++i) {
            const auto input = draw(random);
            for (const bool clip : {true, false}) {
                const Coefficients usual = reference(input, order, clip, 0);
                if (usual.high[0] > 0) {
                    largest = worst(largest, difference(usual, reference(input, order, clip, 8)));
                }
            }
        }
    }
    EXPECT_LE(largest, 1e-20);
}

TEST(Reference, CapsHaveConverged) {
    expect_convergence(100, 1, random_clipped_cap, [](const CapInput& input, int order, bool clip, int extra_nodes) {
        return truth::cap(input, order, clip, extra_nodes);
    });
}

/// Circles at random against horizons at random: they cross, are nested, apart, or cover the sphere; and ones that z =
/// 0 cuts.
TEST(Reference, CapsAgreeWithQuadratureOverColatitude) {
    RandomInput random(5);
    double methods = 0;
    double resolutions = 0;
    for (int i = 0; i < 20; ++i) {
        const double horizon = std::numbers::pi * random.uniform(0.001, 0.999);
        const CapInput input{random.direction(), CapInput::Kind::angle, random.uniform(0.01, 3.13)};
        const auto above = [&](int extra_nodes) {
            return truth::cap_above(input, std::cos(horizon), std::sin(horizon), 12, extra_nodes);
        };
        const Coefficients reference = above(0);
        if (reference.high[0] > 0) {
            resolutions = worst(resolutions, difference(reference, above(8)));
            methods = worst(methods, difference(reference, truth::cap_above_by_slices(input, std::cos(horizon),
                                                                                      std::sin(horizon), 12)));
        }
        const CapInput clipped = random_clipped_cap(random);
        methods = worst(methods, difference(truth::cap(clipped, 12, true), truth::cap_by_slices(clipped, 12, true)));
    }
    EXPECT_LE(resolutions, 1e-20);
    EXPECT_LE(methods, 1e-20);
}

TEST(Reference, BoostedCapsHaveConverged) {
    RandomInput random(6);
    double largest = 0;
    for (int i = 0; i < 40; ++i) {
        const CapInput input = random_clipped_cap(random);
        const double tilt = random.uniform(-1.5, 1.5);
        const double narrowness = i == 0 ? 1 : random.log_uniform(1e-3, 1);
        const Coefficients reference = truth::boosted_cap(input, {tilt, narrowness}, 12);
        largest = worst(largest, difference(reference, truth::boosted_cap(input, {tilt, narrowness}, 12, 8)));
        if (i == 0) {
            largest = worst(largest, difference(reference, truth::cap(input, 12, true)));
        }
    }
    EXPECT_LE(largest, 1e-16);  // a boost leaves areas down to 1e-17, and they are differences of larger ones
}

TEST(Reference, PolygonsHaveConverged) {
    expect_convergence(
        80, 3, [](RandomInput& random) { return random_polygon(random, random.log_uniform(1e-6, 100)); },
        [](const std::vector<Vec3d>& vertices, int order, bool clip, int extra_nodes) {
            return truth::polygon(vertices, order, clip, extra_nodes);
        });
}

TEST(Reference, PolygonsAgreeWithProductCubature) {
    RandomInput random(4);
    double largest = 0;
    for (int i = 0; i < 6; ++i) {
        const std::vector<Vec3d> vertices = random_polygon(random, random.log_uniform(1e-4, 0.3));
        for (const bool clip : {true, false}) {
            const Coefficients reference = truth::polygon(vertices, 10, clip);
            if (reference.high[0] > 0) {
                largest = worst(largest, difference(reference, truth::polygon_by_cubature(vertices, 10, clip, 36)));
            }
        }
    }
    EXPECT_LE(largest, 1e-17);
}

TEST(Reference, EllipsesHaveConverged) {
    const auto draw = [](RandomInput& random) {
        const double size = random.log_uniform(0.1, 10);
        return EllipseInput{random.direction(), size * random.direction(), size * random.direction()};
    };
    expect_convergence(20, 9, draw, [](const EllipseInput& input, int order, bool clip, int extra_nodes) {
        return truth::ellipse(input, order, clip, extra_nodes);
    });
}

TEST(Reference, FacingDisksAgreeWithCaps) {
    RandomInput random(10);
    double largest = 0;
    for (int i = 0; i < 20; ++i) {
        // At right angles as doubles have them: along an axis.
        const double size = random.log_uniform(1e-3, 10);
        const Vec3d center(0, 1, 0);
        const bool clip = i % 2 == 0;
        const Coefficients cap = truth::cap({center, CapInput::Kind::facing_disk, size}, 12, clip);
        largest = worst(largest, difference(cap, truth::ellipse({center, {size, 0, 0}, {0, 0, size}}, 12, clip)));
    }
    EXPECT_LE(largest, 1e-25);
}

}  // namespace
}  // namespace shlight
