#include "convert/duration.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace gelenk::convert {
namespace {

TEST(ConvertDurationTest, ComesRound) {
  for (absl::Duration duration :
       {absl::ZeroDuration(), absl::Nanoseconds(1), absl::Milliseconds(16),
        absl::Hours(24), absl::Seconds(1) - absl::Nanoseconds(1),
        -absl::Milliseconds(1500)}) {
    google::protobuf::Duration proto;
    ToProto(duration, &proto);
    EXPECT_EQ(FromProto(proto), duration);
    EXPECT_GE(static_cast<int64_t>(proto.seconds()) * proto.nanos(), 0)
        << "of one sign, as the message wants it";
  }
}

TEST(ConvertDurationTest, OutOfRangeSaturates) {
  google::protobuf::Duration proto;
  proto.set_seconds(std::numeric_limits<int64_t>::max());
  proto.set_nanos(std::numeric_limits<int32_t>::max());
  EXPECT_EQ(FromProto(proto), absl::InfiniteDuration());
}

}  // namespace
}  // namespace gelenk::convert
