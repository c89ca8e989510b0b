#include "gelenk/client/status.h"

#include <gtest/gtest.h>

namespace gelenk::client {
namespace {

TEST(StatusTest, KeepsCodeAndMessage) {
  EXPECT_EQ(FromGrpc(grpc::Status::OK), absl::OkStatus());
  EXPECT_EQ(FromGrpc({grpc::StatusCode::NOT_FOUND, "sessions/a"}),
            absl::NotFoundError("sessions/a"));
  v1::FrameStatus status;
  EXPECT_EQ(FromProto(status), absl::OkStatus());
  status.set_code(10);
  status.set_message("taken over");
  EXPECT_EQ(FromProto(status), absl::AbortedError("taken over"));
}

TEST(StatusTest, CodeBeyondTheCanonicalOnesIsUnknown) {
  v1::FrameStatus status;
  for (int code : {-1, 17, 1000}) {
    status.set_code(code);
    EXPECT_EQ(FromProto(status).code(), absl::StatusCode::kUnknown) << code;
  }
}

// As seen with a server killed behind nothing, nginx and haproxy.
TEST(StatusTest, WhatALossLooksLike) {
  EXPECT_TRUE(IsTransportLoss(absl::UnavailableError("Socket closed")));
  EXPECT_TRUE(IsTransportLoss(absl::CancelledError("")));
  EXPECT_TRUE(IsTransportLoss(
      absl::InternalError("Received RST_STREAM with error code 2")));
  EXPECT_TRUE(IsTransportLoss(absl::InternalError("Connection reset by peer")));
  EXPECT_TRUE(IsTransportLoss(absl::UnknownError("Stream removed")));
}

TEST(StatusTest, WhatIsNoLoss) {
  EXPECT_FALSE(IsTransportLoss(absl::OkStatus()));
  EXPECT_FALSE(IsTransportLoss(absl::InternalError("division by zero")));
  EXPECT_FALSE(IsTransportLoss(absl::UnknownError("")));
  EXPECT_FALSE(IsTransportLoss(absl::ResourceExhaustedError("sessions")));
  EXPECT_FALSE(IsTransportLoss(absl::UnauthenticatedError("no key")));
  EXPECT_FALSE(IsTransportLoss(absl::AbortedError("taken over")));
}

}  // namespace
}  // namespace gelenk::client
