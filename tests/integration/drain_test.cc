// SIGTERM, seen by everybody who talks to the server; and a second server on
// the same port.
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "tests/integration/service_test.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using grpc::health::v1::Health;
using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;
using testing::ArmSessionRequest;
using testing::AttachRequest;
using testing::Fails;
using ::testing::HasSubstr;
using testing::kPatience;
using testing::SolveStream;
using testing::WholeFrame;
using v1::StreamEvent;

using Stub = v1::SessionService::Stub;

// A server for each test, which ends by itself there.
class DrainTest : public ServiceTest {
 protected:
  static void SetUpTestSuite() {}
  static void TearDownTestSuite() {}

  ~DrainTest() override {
    if (operator_.joinable()) operator_.join();
  }

  void Serve(const std::string& drain) {
    StartServer({"--drain", drain, "--heartbeat", "300ms"});
    health_ = Health::NewStub(grpc::CreateChannel(
        server().target(), grpc::InsecureChannelCredentials()));
  }

  // Sends SIGTERM, and waits for the end elsewhere.
  void Terminate() {
    operator_ =
        std::thread([this] { exit_code_ = server().Terminate(kPatience); });
  }
  void ExpectExit() {
    operator_.join();
    EXPECT_EQ(exit_code_, 0);
  }

  static void SetDeadline(grpc::ClientContext& context) {
    context.set_deadline(std::chrono::system_clock::now() +
                         absl::ToChronoMicroseconds(kPatience));
  }

  HealthCheckResponse::ServingStatus HealthNow(const std::string& service) {
    grpc::ClientContext context;
    SetDeadline(context);
    HealthCheckRequest request;
    request.set_service(service);
    HealthCheckResponse response;
    const grpc::Status status = health_->Check(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response.status();
  }

  std::unique_ptr<Health::Stub> health_;

 private:
  std::thread operator_;
  int exit_code_ = -1;
};

const char* const kServices[] = {"", "gelenk.v1.SessionService",
                                 "gelenk.v1.KinematicsService"};

TEST_F(DrainTest, IsToldToEverybody) {
  Serve("20s");
  const std::string name = CreateSession();
  const auto stream = OpenStream({AttachRequest(name)});
  for (const char* service : kServices) {
    EXPECT_EQ(HealthNow(service), HealthCheckResponse::SERVING) << service;
  }
  grpc::ClientContext watch_context;
  SetDeadline(watch_context);
  const auto watch = health_->Watch(&watch_context, HealthCheckRequest());
  HealthCheckResponse health;
  ASSERT_TRUE(watch->Read(&health));
  EXPECT_EQ(health.status(), HealthCheckResponse::SERVING);

  Terminate();
  const auto event = stream->NextNews();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind(), StreamEvent::KIND_DRAINING);
  EXPECT_EQ(event->slot(), -1);
  EXPECT_THAT(event->status().message(), HasSubstr("going away"));

  ASSERT_TRUE(watch->Read(&health));
  EXPECT_EQ(health.status(), HealthCheckResponse::NOT_SERVING);
  for (const char* service : kServices) {
    EXPECT_EQ(HealthNow(service), HealthCheckResponse::NOT_SERVING) << service;
  }
  EXPECT_THAT(Call(&Stub::CreateSession, ArmSessionRequest()).status(),
              Fails(absl::StatusCode::kUnavailable, "going away"));
  v1::GetSessionRequest get;
  get.set_name(name);
  const auto session = Call(&Stub::GetSession, get);
  ASSERT_TRUE(session.ok()) << session.status();
  EXPECT_EQ(session->state(), v1::Session::STATE_DRAINING);

  // Streams go on as long as they need to, new ones are told at once.
  for (int i = 1; i <= 50; ++i) {
    ASSERT_TRUE(stream->SendFrame(WholeFrame(i)));
    ASSERT_EQ(stream->NextFrame()->status().code(), 0);
  }
  const auto late = OpenStream();
  EXPECT_EQ(late->NextNews()->kind(), StreamEvent::KIND_DRAINING);
  late->HalfClose();
  EXPECT_EQ(late->Finish(), absl::OkStatus());
  stream->HalfClose();
  EXPECT_EQ(stream->Finish(), absl::OkStatus());
  ExpectExit();
}

TEST_F(DrainTest, EndsWithTheLastStream) {
  Serve("200s");
  const auto stream = OpenStream({AttachRequest(CreateSession())});
  Terminate();
  EXPECT_EQ(stream->NextNews()->kind(), StreamEvent::KIND_DRAINING);
  stream->HalfClose();
  EXPECT_EQ(stream->Finish(), absl::OkStatus());
  ExpectExit();  // long before its time
}

TEST_F(DrainTest, StreamsThatStayAreClosed) {
  Serve("500ms");
  const auto stream = OpenStream({AttachRequest(CreateSession())});
  v1::WatchSessionRequest request;
  request.set_name("sessions/watched");
  CreateSession(ArmSessionRequest("watched"));
  grpc::ClientContext context;
  SetDeadline(context);
  const auto viewer = connection().sessions().WatchSession(&context, request);

  Terminate();
  EXPECT_EQ(stream->NextNews()->kind(), StreamEvent::KIND_DRAINING);
  const auto closing = stream->NextNews();
  ASSERT_TRUE(closing);
  EXPECT_EQ(closing->kind(), StreamEvent::KIND_CLOSING);
  EXPECT_EQ(closing->status().code(), 14);
  // The status is what was said inside.
  stream->HalfClose();
  EXPECT_THAT(stream->Finish(),
              Fails(absl::StatusCode::kUnavailable, "drain time"));

  bool told = false;
  v1::WatchSessionResponse seen;
  while (viewer->Read(&seen)) {
    told = told || seen.event().kind() == StreamEvent::KIND_DRAINING;
  }
  EXPECT_TRUE(told);
  EXPECT_EQ(viewer->Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
  ExpectExit();
}

TEST_F(DrainTest, StreamsThatDoNotListenAreEndedAllTheSame) {
  Serve("300ms");
  const auto deaf = OpenStream({AttachRequest(CreateSession())});
  const auto silent = OpenStream();
  Terminate();
  ExpectExit();
  EXPECT_FALSE(deaf->Finish().ok());
  EXPECT_FALSE(silent->Finish().ok());
}

TEST_F(DrainTest, WithoutStreamsIsQuick) {
  Serve("200s");
  CreateSession();
  Terminate();
  ExpectExit();
}

// --- Two servers ---

// What a server on `target` says and answers when it does not start.
std::pair<int, std::string> RunServer(const std::string& target) {
  FILE* pipe = popen(
      absl::StrCat("timeout 20 " GELENKD " --listen ", target, " 2>&1").c_str(),
      "r");
  std::string output;
  char buffer[256];
  while (std::fgets(buffer, sizeof(buffer), pipe) != nullptr) output += buffer;
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
}

TEST_F(DrainTest, ASecondServerOnThePortDoesNotStart) {
  Serve("1s");
  const std::string name = CreateSession();
  const auto [exit_code, output] = RunServer(server().target());
  EXPECT_EQ(exit_code, 1);
  EXPECT_THAT(output,
              HasSubstr(absl::StrCat("cannot start: listen: cannot bind ",
                                     server().target())));
  // The first one did not notice.
  const auto stream = OpenStream({AttachRequest(name)});
  ASSERT_TRUE(stream->SendFrame(WholeFrame(1)));
  EXPECT_EQ(stream->NextFrame()->status().code(), 0);
  stream->HalfClose();
  EXPECT_EQ(stream->Finish(), absl::OkStatus());
  Terminate();
  ExpectExit();
}

TEST_F(DrainTest, ThePortIsFreeAfterwards) {
  Serve("1s");
  const auto stream = OpenStream({AttachRequest(CreateSession())});
  Terminate();
  stream->HalfClose();
  EXPECT_EQ(stream->Finish(), absl::OkStatus());
  ExpectExit();
  ASSERT_EQ(server().Start(), absl::OkStatus());
  EXPECT_EQ(server().Terminate(kPatience), 0);
}

TEST_F(DrainTest, AddressesThatCannotBeAreNamed) {
  for (const char* target : {"127.0.0.1", "0.0.0.0:0", "256.0.0.1:50051"}) {
    const auto [exit_code, output] = RunServer(target);
    EXPECT_EQ(exit_code, 1) << target;
    EXPECT_THAT(output, HasSubstr("cannot start: listen: "));
    EXPECT_THAT(output, HasSubstr(target));
  }
}

}  // namespace
}  // namespace gelenk
