// SPDX-License-Identifier: MIT
//
// Instruction sets: SHLIGHT_KERNEL_TARGET forces one for a whole run of the tests. CMakeLists.txt runs every test of
// accuracy on each.
#include "simd/targets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace shlight {
namespace {

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

}  // namespace
}  // namespace shlight
