#include "gelenk/client/stream_statistics.h"

#include <gtest/gtest.h>

namespace gelenk::client {
namespace {

TEST(RoundTripsTest, NoneIsZero) {
  EXPECT_EQ(RoundTrips().Quantile(0.5), absl::ZeroDuration());
}

TEST(RoundTripsTest, QuantilesOfAHundred) {
  RoundTrips round_trips;
  for (int i = 100; i >= 0; --i) round_trips.Add(absl::Milliseconds(i));
  EXPECT_EQ(round_trips.Quantile(0), absl::ZeroDuration());
  EXPECT_EQ(round_trips.Quantile(0.5), absl::Milliseconds(50));
  EXPECT_EQ(round_trips.Quantile(0.99), absl::Milliseconds(99));
  EXPECT_EQ(round_trips.Quantile(1), absl::Milliseconds(100));
}

TEST(RoundTripsTest, OldestGiveWay) {
  RoundTrips round_trips(/*capacity=*/10);
  for (int i = 0; i < 25; ++i) round_trips.Add(absl::Milliseconds(i));
  EXPECT_EQ(round_trips.size(), 10);
  EXPECT_EQ(round_trips.Quantile(0), absl::Milliseconds(15));
  EXPECT_EQ(round_trips.Quantile(1), absl::Milliseconds(24));
}

}  // namespace
}  // namespace gelenk::client
