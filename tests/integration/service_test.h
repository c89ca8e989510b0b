// A real gelenkd with one skeleton in it, and a connection to it.
#ifndef GELENK_TESTS_INTEGRATION_SERVICE_TEST_H_
#define GELENK_TESTS_INTEGRATION_SERVICE_TEST_H_

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gelenk/client/connection.h"
#include "tests/testing/example_requests.h"
#include "tests/testing/server_process.h"
#include "tests/testing/solve_stream.h"

namespace gelenk {

// One server for all tests of a suite: they make sessions of their own. Suites
// that want flags say so in a SetUpTestSuite of their own.
class ServiceTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { StartServer({}); }
  // Drains the server. A sanitizer in it that found something turns its exit
  // code into another one.
  static void TearDownTestSuite() { StopServer(); }

  static void StartServer(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--log-level", "error"});
    server_ = std::make_unique<testing::ServerProcess>(GELENKD, arguments);
    ASSERT_EQ(server_->Start(), absl::OkStatus());
    connection_ = std::make_unique<client::Connection>(server_->target());
    ASSERT_EQ(Call(&v1::KinematicsService::Stub::CreateSkeleton,
                   testing::ArmSkeletonRequest())
                  .status(),
              absl::OkStatus());
  }

  static void StopServer() {
    connection_.reset();
    EXPECT_EQ(server_->Terminate(testing::kPatience), 0);
    server_.reset();
  }

  static testing::ServerProcess& server() { return *server_; }
  static client::Connection& connection() { return *connection_; }

  template <class Stub, class Request, class Response>
  static absl::StatusOr<Response> Call(
      grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                   Response*),
      const Request& request) {
    client::CallOptions options;
    options.timeout = testing::kPatience;
    return connection_->Call(method, request, options);
  }

  // The name of a fresh session on the arm.
  static std::string CreateSession(
      const v1::CreateSessionRequest& request = testing::ArmSessionRequest()) {
    const auto session =
        Call(&v1::SessionService::Stub::CreateSession, request);
    EXPECT_EQ(session.status(), absl::OkStatus());
    return session.ok() ? session->name() : "";
  }

  static std::unique_ptr<testing::SolveStream> OpenStream() {
    return std::make_unique<testing::SolveStream>(connection_->sessions());
  }

  // A stream with sessions attached to its slots 0, 1, ..; their events are
  // read.
  static std::unique_ptr<testing::SolveStream> OpenStream(
      const std::vector<v1::AttachSession>& attach) {
    std::unique_ptr<testing::SolveStream> stream = OpenStream();
    v1::StreamingSolveRequest request;
    *request.mutable_attach() = {attach.begin(), attach.end()};
    for (int slot = 0; slot < request.attach_size(); ++slot) {
      request.mutable_attach(slot)->set_slot(slot);
    }
    EXPECT_TRUE(stream->Send(request));
    for (int slot = 0; slot < request.attach_size(); ++slot) {
      const auto event = stream->NextNews();
      EXPECT_TRUE(event && event->kind() == v1::StreamEvent::KIND_ATTACHED)
          << (event ? event->DebugString() : "no event");
    }
    return stream;
  }

 private:
  inline static std::unique_ptr<testing::ServerProcess> server_;
  inline static std::unique_ptr<client::Connection> connection_;
};

}  // namespace gelenk

#endif  // GELENK_TESTS_INTEGRATION_SERVICE_TEST_H_
