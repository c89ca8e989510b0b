#include "server/session/fill_schedule.h"

#include <gtest/gtest.h>

namespace gelenk::server {
namespace {

constexpr absl::Duration kInterval = absl::Milliseconds(20);
// Above what stands still within an interval.
constexpr double kMoves = 2 * FillSchedule::kStillSpeed * 0.02;
const absl::Time kNow = absl::FromUnixSeconds(1000);

TEST(FillScheduleTest, OfNoIntervalIsNever) {
  FillSchedule schedule(absl::ZeroDuration());
  EXPECT_FALSE(schedule.is_on());
  schedule.Begin(kNow);
  schedule.PutOff(kNow);
  EXPECT_EQ(schedule.next(), std::nullopt);
}

TEST(FillScheduleTest, GoesByTheNewestFrame) {
  FillSchedule schedule(kInterval);
  EXPECT_TRUE(schedule.is_on());
  EXPECT_EQ(schedule.next(), std::nullopt) << "no frame yet";
  schedule.Begin(kNow);
  EXPECT_EQ(schedule.next(), kNow + kInterval);
  schedule.Begin(kNow + absl::Milliseconds(15));
  EXPECT_EQ(schedule.next(), kNow + absl::Milliseconds(35));
}

TEST(FillScheduleTest, WhatStandsStillIsAskedForOnce) {
  FillSchedule schedule(kInterval);
  schedule.Begin(kNow);
  schedule.Note(kNow + kInterval, true, 0);
  EXPECT_EQ(schedule.next(), std::nullopt);
}

TEST(FillScheduleTest, WhatHasNotSettledIsAskedForAgain) {
  FillSchedule schedule(kInterval);
  schedule.Begin(kNow);
  absl::Time now = kNow;
  // As long as it takes, also where nothing happens to move.
  for (int i = 0; i < 1000; ++i) {
    now += kInterval;
    schedule.Note(now, false, 0);
    ASSERT_EQ(schedule.next(), now + kInterval);
  }
  schedule.Note(now + kInterval, true, 0);
  EXPECT_EQ(schedule.next(), std::nullopt);
}

TEST(FillScheduleTest, WhatFollowsASettledSourceGetsSomeTime) {
  FillSchedule schedule(kInterval);
  schedule.Begin(kNow);
  schedule.Note(kNow, false, 1);
  absl::Time now = kNow;
  int count = 0;
  while (schedule.next()) {
    ASSERT_LT(++count, 1000);
    now = *schedule.next();
    schedule.Note(now, true, kMoves);
  }
  EXPECT_EQ(now, kNow + FillSchedule::kSettling);
}

TEST(FillScheduleTest, LateFramesPutOffOnlyWhatIsToCome) {
  FillSchedule schedule(kInterval);
  schedule.Begin(kNow);
  schedule.PutOff(kNow + absl::Milliseconds(10));
  EXPECT_EQ(schedule.next(), kNow + absl::Milliseconds(30));
  schedule.Stop();
  schedule.PutOff(kNow + absl::Milliseconds(40));
  EXPECT_EQ(schedule.next(), std::nullopt);
}

}  // namespace
}  // namespace gelenk::server
