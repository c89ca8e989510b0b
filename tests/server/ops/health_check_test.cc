#include "server/ops/health_check.h"

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "server/server.h"

namespace gelenk::server {
namespace {

namespace health = grpc::health::v1;
using ::testing::HasSubstr;

// Never waited for in full where a server answers.
constexpr absl::Duration kPatience = absl::Seconds(20);

TEST(LocalTargetTest, IsLoopbackForAServerThatListensEverywhere) {
  EXPECT_EQ(LocalTarget("0.0.0.0:50051"), "127.0.0.1:50051");
  EXPECT_EQ(LocalTarget("[::]:50051"), "[::1]:50051");
}

TEST(LocalTargetTest, IsTheAddressOfAnyOther) {
  for (const char* listen : {"127.0.0.1:50051", "localhost:1", "[::1]:1",
                             "10.0.0.0:50051", "unix:/run/gelenk", "gelenk"}) {
    EXPECT_EQ(LocalTarget(listen), listen);
  }
}

// A gRPC server on a free port, with one service or none.
class OneService {
 public:
  explicit OneService(grpc::Service* service) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(),
                             &port_);
    if (service != nullptr) builder.RegisterService(service);
    server_ = builder.BuildAndStart();
  }
  ~OneService() { server_->Shutdown(); }

  std::string target() const { return absl::StrCat("127.0.0.1:", port_); }

 private:
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

// Answers for the whole server with what it is told.
class FakeHealth final : public health::Health::Service {
 public:
  explicit FakeHealth(health::HealthCheckResponse::ServingStatus says)
      : says_(says) {}

  grpc::Status Check(grpc::ServerContext*,
                     const health::HealthCheckRequest* request,
                     health::HealthCheckResponse* response) override {
    if (!request->service().empty()) return grpc::Status::CANCELLED;
    response->set_status(says_);
    return grpc::Status::OK;
  }

 private:
  const health::HealthCheckResponse::ServingStatus says_;
};

// Says nothing until the caller has left.
class MuteHealth final : public health::Health::Service {
 public:
  grpc::Status Check(grpc::ServerContext* context,
                     const health::HealthCheckRequest*,
                     health::HealthCheckResponse*) override {
    while (!context->IsCancelled()) absl::SleepFor(absl::Milliseconds(1));
    return grpc::Status::CANCELLED;
  }
};

ServerOptions OnAFreePort() {
  ServerOptions options;
  options.listen = "127.0.0.1:0";
  return options;
}

TEST(CheckHealthTest, AServerIsHealthyUntilItEnds) {
  auto server = Server::Start(OnAFreePort());
  ASSERT_TRUE(server.ok()) << server.status();
  const std::string target = (*server)->address();
  EXPECT_EQ(CheckHealth(target, kPatience), absl::OkStatus());
  server->reset();
  EXPECT_EQ(CheckHealth(target, kPatience).code(),
            absl::StatusCode::kUnavailable);
}

TEST(CheckHealthTest, AServerThatDoesNotServeIsNot) {
  FakeHealth not_serving(health::HealthCheckResponse::NOT_SERVING);
  const OneService server(&not_serving);
  const absl::Status status = CheckHealth(server.target(), kPatience);
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(status.message()), HasSubstr("NOT_SERVING"));
}

TEST(CheckHealthTest, ServersWithoutHealthAnswerSo) {
  const OneService server(nullptr);
  EXPECT_EQ(CheckHealth(server.target(), kPatience).code(),
            absl::StatusCode::kUnimplemented);
}

TEST(CheckHealthTest, GivesUpOnAServerThatSaysNothing) {
  MuteHealth mute;
  const OneService server(&mute);
  EXPECT_EQ(CheckHealth(server.target(), absl::Milliseconds(100)).code(),
            absl::StatusCode::kDeadlineExceeded);
}

TEST(CheckHealthTest, TheEnvironmentsProxyIsNotAsked) {
  FakeHealth serving(health::HealthCheckResponse::SERVING);
  const OneService server(&serving);
  unsetenv("no_proxy");
  // Port 1: nobody listens.
  setenv("http_proxy", "http://127.0.0.1:1", /*overwrite=*/1);
  EXPECT_EQ(CheckHealth(server.target(), kPatience), absl::OkStatus());
  unsetenv("http_proxy");
}

}  // namespace
}  // namespace gelenk::server
