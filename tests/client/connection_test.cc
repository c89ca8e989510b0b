#include "gelenk/client/connection.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/testing/fake_session_server.h"

namespace gelenk::client {
namespace {

using testing::FakeSessionServer;

v1::GetSessionRequest NobodysSession() {
  v1::GetSessionRequest request;
  request.set_name("sessions/nobody");
  return request;
}

TEST(ConnectionTest, CallsBothServices) {
  FakeSessionServer server;
  Connection connection(server.target());
  EXPECT_TRUE(connection.WaitForReady(absl::Seconds(5)).ok());
  v1::CreateSkeletonRequest request;
  request.set_skeleton_id("arm");
  const auto skeleton =
      connection.Call(&v1::KinematicsService::Stub::CreateSkeleton, request);
  ASSERT_TRUE(skeleton.ok()) << skeleton.status();
  EXPECT_EQ(skeleton->name(), "skeletons/arm");
  EXPECT_TRUE(absl::IsNotFound(
      connection.Call(&v1::SessionService::Stub::GetSession, NobodysSession())
          .status()));
}

TEST(ConnectionTest, NoServerIsUnavailable) {
  FakeSessionServer server;
  server.Stop();
  Connection connection(server.target());
  EXPECT_TRUE(absl::IsUnavailable(
      connection.Call(&v1::SessionService::Stub::GetSession, NobodysSession())
          .status()));
  EXPECT_TRUE(absl::IsDeadlineExceeded(
      connection.WaitForReady(absl::Milliseconds(50))));
  server.Start();
  EXPECT_TRUE(connection.WaitForReady(absl::Seconds(10)).ok());
}

TEST(ConnectionTest, CancelledCallsEndAtOnce) {
  FakeSessionServer server;
  Connection connection(server.target());
  Cancellation cancellation;
  cancellation.Cancel();
  CallOptions options;
  options.cancellation = &cancellation;
  EXPECT_TRUE(absl::IsCancelled(connection
                                    .Call(&v1::SessionService::Stub::GetSession,
                                          NobodysSession(), options)
                                    .status()));
}

TEST(ConnectionTest, DeadlineAndAffinityReachTheContext) {
  Connection connection("127.0.0.1:1");
  grpc::ClientContext context;
  CallOptions options;
  options.timeout = absl::Seconds(3);
  connection.Prepare(options, context);
  const auto left = context.deadline() - std::chrono::system_clock::now();
  EXPECT_LE(left, std::chrono::seconds(3));
  EXPECT_GT(left, std::chrono::seconds(2));
}

}  // namespace
}  // namespace gelenk::client
