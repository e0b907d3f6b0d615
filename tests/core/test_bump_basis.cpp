// SPDX-License-Identifier: MIT
#include "surfaces/bump_basis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "shlight/basis.h"

namespace shlight {
namespace {

/// f·cos times the harmonics, summed up over a grid of directions of the world.
std::array<double, kRecordTerms> summed(const DiffuseShape& shape, const Vec3d& normal, const Vec3d& smooth) {
    const Vec3d x = glm::normalize(smooth - glm::dot(smooth, normal) * normal), y = glm::cross(normal, x);
    const auto in_frame = [&](const Vec3d& v) { return Vec3d(glm::dot(v, x), glm::dot(v, y), glm::dot(v, normal)); };
    constexpr int kSteps = 300;
    std::array<double, kRecordTerms> sums{};
    for (int i = 0; i < 2 * kSteps; ++i) {
        const double z = (i + 0.5) / kSteps - 1, radius = std::sqrt(1 - z * z);
        for (int j = 0; j < 2 * kSteps; ++j) {
            const double angle = (j + 0.5) * std::numbers::pi / kSteps;
            const Vec3d direction(radius * std::cos(angle), radius * std::sin(angle), z);
            if (glm::dot(direction, normal) > 0) {
                std::array<double, kRecordTerms> basis;
                sh_basis(direction, kRecordOrder, basis.data());
                const double value = shape.value(in_frame(direction), in_frame(smooth));
                for (std::size_t k = 0; k < kRecordTerms; ++k) {
                    sums[k] += value * basis[k] * std::numbers::pi / (kSteps * kSteps);
                }
            }
        }
    }
    return sums;
}

TEST(BumpBasis, IsTheProjectionOfTheLobe) {
    const Vec3d smooth = glm::normalize(Vec3d(0.3, -0.5, 0.8)),
                aside = glm::normalize(glm::cross(smooth, Vec3d(1, 2, 0)));
    for (const Diffuse kind : {Diffuse::bumped_cubic, Diffuse::bumped_ggx}) {
        for (const double lean : {0.01, 0.4, 1.1, 1.5}) {
            const Vec3d normal = std::cos(lean) * smooth + std::sin(lean) * aside;
            const auto expected = summed({kind}, normal, smooth);
            const auto found = bumped_basis(DiffuseShape{kind}, normal, smooth);
            ASSERT_TRUE(found);
            for (std::size_t k = 0; k < kRecordTerms; ++k) {
                // The table's steps of 3°, beside values up to 0.28.
                EXPECT_NEAR((*found)[k], expected[k], 1e-3) << k << " at " << lean;
            }
        }
    }
    EXPECT_FALSE(bumped_basis(LambertShape{}, smooth, smooth));
}

}  // namespace
}  // namespace shlight
