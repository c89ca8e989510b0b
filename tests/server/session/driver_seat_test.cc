#include "server/session/driver_seat.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "tests/testing/status_matchers.h"

namespace gelenk::server {
namespace {

using ::testing::HasSubstr;

constexpr char kName[] = "sessions/a";

TEST(DriverSeatTest, SecondStreamHasToTakeOver) {
  DriverSeat seat;
  ASSERT_TRUE(seat.Claim(1, false, kName).ok());
  const absl::Status refused = seat.Claim(2, false, kName);
  EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(refused.message()), HasSubstr(kName));
  EXPECT_TRUE(seat.Check(1, kName).ok());

  ASSERT_TRUE(seat.Claim(2, true, kName).ok());
  EXPECT_EQ(seat.Check(1, kName).code(), absl::StatusCode::kAborted);
  EXPECT_TRUE(seat.Check(2, kName).ok());
}

TEST(DriverSeatTest, UnaryCallsDriveOnlyAFreeSeat) {
  DriverSeat seat;
  EXPECT_TRUE(seat.Check(kUnaryDriver, kName).ok());
  ASSERT_TRUE(seat.Claim(7, false, kName).ok());
  EXPECT_EQ(seat.Check(kUnaryDriver, kName).code(),
            absl::StatusCode::kFailedPrecondition);
  // Whoever has lost the seat does not free it for others.
  seat.Release(6);
  EXPECT_FALSE(seat.Check(kUnaryDriver, kName).ok());
  seat.Release(7);
  EXPECT_TRUE(seat.Check(kUnaryDriver, kName).ok());
}

TEST(DriverSeatTest, NumbersRise) {
  DriverSeat seat;
  EXPECT_TRUE(seat.TakeNumber(std::nullopt).ok());
  EXPECT_EQ(seat.sequence_number(), 0);
  EXPECT_TRUE(seat.TakeNumber(5).ok());
  const absl::Status old = seat.TakeNumber(5);
  EXPECT_EQ(old.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(seat.sequence_number(), 5);
  seat.SetNumber(2);
  EXPECT_TRUE(seat.TakeNumber(3).ok());
}

TEST(DriverSeatTest, FirstReasonToEndCounts) {
  DriverSeat seat;
  ASSERT_TRUE(seat.Claim(1, false, kName).ok());
  seat.End(absl::NotFoundError("expired"));
  seat.End(absl::UnavailableError("later"));
  EXPECT_EQ(seat.Check(1, kName), absl::NotFoundError("expired"));
  EXPECT_EQ(seat.Check(kUnaryDriver, kName), absl::NotFoundError("expired"));
  EXPECT_EQ(seat.Claim(2, true, kName), absl::NotFoundError("expired"));
}

}  // namespace
}  // namespace gelenk::server
