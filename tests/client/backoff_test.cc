#include "gelenk/client/backoff.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace gelenk::client {
namespace {

std::vector<absl::Duration> Waits(Backoff& backoff, int count) {
  std::vector<absl::Duration> waits;
  for (int i = 0; i < count; ++i) waits.push_back(backoff.Next());
  return waits;
}

TEST(BackoffTest, FirstWaitIsShort) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    Backoff backoff(BackoffOptions(), seed);
    const absl::Duration wait = backoff.Next();
    EXPECT_GE(wait, absl::Milliseconds(20));
    EXPECT_LE(wait, absl::Milliseconds(50));
  }
}

TEST(BackoffTest, EachWaitStaysBelowItsDoublingCeiling) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    Backoff backoff(BackoffOptions(), seed);
    absl::Duration ceiling = absl::Milliseconds(50);
    for (int i = 0; i < 20; ++i) {
      const absl::Duration wait = backoff.Next();
      EXPECT_GE(wait, absl::Milliseconds(20));
      EXPECT_LE(wait, std::min(ceiling, absl::Seconds(2)));
      ceiling *= 2;
    }
  }
}

TEST(BackoffTest, LateWaitsFillTheirRange) {
  Backoff backoff(BackoffOptions(), 7);
  Waits(backoff, 10);
  const std::vector<absl::Duration> waits = Waits(backoff, 200);
  EXPECT_LT(*std::min_element(waits.begin(), waits.end()),
            absl::Milliseconds(200));
  EXPECT_GT(*std::max_element(waits.begin(), waits.end()),
            absl::Milliseconds(1800));
}

TEST(BackoffTest, ResetStartsOver) {
  Backoff backoff(BackoffOptions(), 7);
  Waits(backoff, 10);
  backoff.Reset();
  EXPECT_LE(backoff.Next(), absl::Milliseconds(50));
}

TEST(BackoffTest, SeedDecides) {
  Backoff one(BackoffOptions(), 7);
  Backoff same(BackoffOptions(), 7);
  Backoff other(BackoffOptions(), 8);
  const std::vector<absl::Duration> waits = Waits(one, 5);
  EXPECT_EQ(waits, Waits(same, 5));
  EXPECT_NE(waits, Waits(other, 5));
}

TEST(BackoffTest, CeilingBelowTheFloorIsTheWait) {
  BackoffOptions options;
  options.max_ceiling = absl::Milliseconds(3);
  EXPECT_EQ(Backoff(options, 1).Next(), absl::Milliseconds(3));
}

}  // namespace
}  // namespace gelenk::client
