// SPDX-License-Identifier: MIT
#include "film/time_left.h"

#include <gtest/gtest.h>

namespace shlight {
namespace {

/// A render whose rays take a tenth of a second each, and ones before them twice as long.
TEST(TimeLeft, FollowsRaysOfTheKindThatIsLeft) {
    TimeLeft time(100, 0.5);
    EXPECT_EQ(time.at(0), 0);
    time.begin_job(1);
    time.add_rays(10);
    EXPECT_NEAR(time.at(3), 9, 1e-12);
    time.end_job(3);
    EXPECT_NEAR(time.at(3.5), 9, 1e-12);
    time.change_rays(1, 1, 4);
    EXPECT_NEAR(time.at(4), 9, 1e-12);
    time.begin_job(4);
    time.add_rays(80);
    EXPECT_NEAR(time.at(12), 1, 1e-12);
    time.set_rays_left(0);
    EXPECT_EQ(time.at(14), 0);
}

TEST(TimeLeft, IsUnknownUntilThereAreRecordsOfOneGrid) {
    TimeLeft time(0, 1);
    time.begin_records(1);
    EXPECT_EQ(time.at(2), 0);
    time.end_grid(32, 2);
    const double first = time.at(2);
    EXPECT_GT(first, 5);
    EXPECT_NEAR(time.at(2.5), first - 0.5, 1e-12);
    const double later = time.at(100);  // in a second grid that takes unexpectedly long
    EXPECT_GT(later, 5);
    time.end_grid(2, 101);
    EXPECT_EQ(time.at(101), 0);
    time.end_records();
    EXPECT_EQ(time.at(102), 0);
}

}  // namespace
}  // namespace shlight
