// SPDX-License-Identifier: MIT
#include "shlight/basis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "error_record.h"
#include "quad_truth.h"
#include "random_input.h"

namespace shlight {
namespace {

using testing::ErrorRecord;
using testing::RandomInput;

template <class T>
std::vector<T> basis_in(const Vec3d& direction, int order) {
    std::vector<T> values(coefficient_count(order), std::numeric_limits<T>::quiet_NaN());
    const Vec3<T> rounded(direction);
    sh_basis<T>(std::span(&rounded, 1), order, values);
    return values;
}

/// Errors are relative to √(n/4π), the root mean square of the highest band's values.
template <class T>
void compare_with_laplace(int order, int count, double bound) {
    RandomInput random(static_cast<std::uint64_t>(order));
    ErrorRecord errors(static_cast<std::size_t>(count));
    std::vector<Vec3d> directions;
    for (int i = 0; i < count; ++i) {
        const double tilt = i % 3 == 0 ? random.log_uniform(1e-9, 1e-1) : random.uniform(0, std::numbers::pi);
        directions.push_back(Vec3d(Vec3<T>(random.log_uniform(1e-3, 1e3) * random.at_tilt(tilt))));
    }
    directions[0] = {0, 0, 1};
    directions[1] = {0, 0, -2};
    directions[2] = {-1, 0, 0};
    directions[3] = {0, -1, 0};
    testing::on_two_threads(directions.size(), [&](std::size_t i) {
        const std::vector<T> computed = basis_in<T>(directions[i], order);
        errors[i] = truth::largest_error(truth::basis(directions[i], order), order, computed.data()) /
                    std::sqrt(order / (4 * std::numbers::pi));
    });
    errors.publish("n = " + std::to_string(order) + (sizeof(T) == 8 ? ", float64" : ", float32"));
    const Vec3d& worst = directions[errors.worst()];
    EXPECT_LE(errors.largest(), bound) << "direction " << worst.x << ' ' << worst.y << ' ' << worst.z;
}

TEST(Basis, AgreesWithLaplacesIntegral) {
    compare_with_laplace<double>(8, 150, 1e-14);
    compare_with_laplace<double>(16, 100, 1e-13);
    compare_with_laplace<double>(33, 30, 1e-12);
    compare_with_laplace<double>(64, 15, 1e-12);
    compare_with_laplace<float>(8, 150, 1e-5);
    compare_with_laplace<float>(16, 100, 1e-4);
    compare_with_laplace<float>(33, 30, 5e-4);
    compare_with_laplace<float>(64, 15, 2e-3);
}

}  // namespace
}  // namespace shlight
