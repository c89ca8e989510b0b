// Who drives a session, who watches it, and how it ends: take-over, expiry and
// deletion under streams and viewers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "gelenk/client/session_stream.h"
#include "gelenk/client/status.h"
#include "tests/integration/service_test.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using testing::ArmSessionRequest;
using testing::AttachRequest;
using testing::Fails;
using ::testing::HasSubstr;
using testing::kPatience;
using ::testing::SizeIs;
using testing::SolveStream;
using testing::WholeFrame;
using v1::StreamEvent;

using Stub = v1::SessionService::Stub;

// Long enough for a few calls on a busy machine, short enough to wait for.
constexpr absl::Duration kShortLife = absl::Milliseconds(700);

int64_t Nanos(const google::protobuf::Timestamp& time) {
  return time.seconds() * 1000000000 + time.nanos();
}

class SessionLifeTest : public ServiceTest {
 protected:
  static void SetUpTestSuite() { StartServer({"--heartbeat", "300ms"}); }

  static absl::StatusOr<v1::Session> Get(const std::string& name) {
    v1::GetSessionRequest request;
    request.set_name(name);
    return Call(&Stub::GetSession, request);
  }
  static absl::Status Delete(const std::string& name) {
    v1::DeleteSessionRequest request;
    request.set_name(name);
    return Call(&Stub::DeleteSession, request).status();
  }
  static std::string CreateShortLived(const std::string& id = "") {
    v1::CreateSessionRequest request = ArmSessionRequest(id);
    request.mutable_session()->mutable_idle_ttl()->set_nanos(
        static_cast<int>(absl::ToInt64Nanoseconds(kShortLife)));
    return CreateSession(request);
  }

  static StreamEvent EventOf(SolveStream& stream,
                             const v1::AttachSession& attach) {
    EXPECT_TRUE(stream.Attach(attach));
    return stream.NextNews().value_or(StreamEvent());
  }

  static void ExpectEvent(const std::optional<StreamEvent>& event,
                          StreamEvent::Kind kind, absl::StatusCode code,
                          const std::string& words) {
    ASSERT_TRUE(event);
    EXPECT_EQ(event->kind(), kind) << event->DebugString();
    EXPECT_EQ(event->status().code(), static_cast<int>(code));
    EXPECT_THAT(event->status().message(), HasSubstr(words));
  }
};

// --- One driver at a time ---

TEST_F(SessionLifeTest, ADrivenSessionIsNotAttachedTwice) {
  const std::string name = CreateSession();
  const auto driver = OpenStream({AttachRequest(name)});
  const auto other = OpenStream();
  ExpectEvent(EventOf(*other, AttachRequest(name)), StreamEvent::KIND_DETACHED,
              absl::StatusCode::kFailedPrecondition, "take_over");
  ASSERT_TRUE(driver->SendFrame(WholeFrame(1)));
  EXPECT_EQ(driver->NextFrame()->status().code(), 0);
}

TEST_F(SessionLifeTest, WhoLosesASessionIsTold) {
  const std::string name = CreateSession();
  const auto loser = OpenStream({AttachRequest(name)});
  ASSERT_TRUE(loser->SendFrame(WholeFrame(3)));
  ASSERT_TRUE(loser->NextFrame());

  const auto winner = OpenStream();
  v1::AttachSession attach = AttachRequest(name);
  attach.set_take_over(true);
  const StreamEvent attached = EventOf(*winner, attach);
  EXPECT_EQ(attached.kind(), StreamEvent::KIND_ATTACHED);
  EXPECT_EQ(attached.sequence_number(), 3) << "where the session is";

  const auto event = loser->NextNews();
  ExpectEvent(event, StreamEvent::KIND_DETACHED, absl::StatusCode::kAborted,
              "taken over");
  EXPECT_EQ(event->slot(), 0);
  // Its frames go nowhere, and its stream lives.
  ASSERT_TRUE(loser->SendFrame(WholeFrame(4)));
  EXPECT_NE(loser->NextFrame()->status().code(), 0);
  ASSERT_TRUE(winner->SendFrame(WholeFrame(4)));
  EXPECT_EQ(winner->NextFrame()->status().code(), 0);
  loser->HalfClose();
  EXPECT_EQ(loser->Finish(), absl::OkStatus());
}

TEST_F(SessionLifeTest, AStreamMayTakeASessionFromItself) {
  const std::string name = CreateSession();
  const auto stream = OpenStream({AttachRequest(name)});
  v1::AttachSession again = AttachRequest(name);
  again.set_slot(1);
  ExpectEvent(EventOf(*stream, again), StreamEvent::KIND_DETACHED,
              absl::StatusCode::kFailedPrecondition, "take_over");
  again.set_take_over(true);
  ExpectEvent(EventOf(*stream, again), StreamEvent::KIND_ATTACHED,
              absl::StatusCode::kOk, "");
  const auto event = stream->NextNews();
  ExpectEvent(event, StreamEvent::KIND_DETACHED, absl::StatusCode::kAborted,
              "taken over");
  EXPECT_EQ(event->slot(), 0);
}

// The library does not fight for a session: two automatic clients would steal
// it from each other for ever.
TEST_F(SessionLifeTest, TheClientLibraryNeverTakesASessionBack) {
  CreateSession(ArmSessionRequest("stolen"));
  client::SessionSpec spec;
  spec.session.set_session_id("stolen");
  spec.frame_policy = v1::FRAME_POLICY_EVERY_FRAME;
  const auto open = [&spec] {
    return client::SessionStream::Open(
        std::make_shared<client::Connection>(server().target()), {}, {spec});
  };
  const auto loser = open();
  ASSERT_TRUE(loser.ok()) << loser.status();
  ASSERT_TRUE((*loser)->SendNext(WholeFrame(0)).ok());
  ASSERT_TRUE((*loser)->Receive(kPatience).ok());
  // Nor does it take one in the first place, unless it is told to.
  EXPECT_THAT(open().status(),
              Fails(absl::StatusCode::kFailedPrecondition, "take_over"));
  spec.take_over = true;
  const auto winner = open();
  ASSERT_TRUE(winner.ok()) << winner.status();

  EXPECT_THAT((*loser)->Receive(kPatience).status(),
              Fails(absl::StatusCode::kAborted, "taken over"));
  EXPECT_THAT((*loser)->SendNext(WholeFrame(0)).status(),
              Fails(absl::StatusCode::kAborted, "taken over"));
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE((*winner)->SendNext(WholeFrame(0)).ok());
    const auto answer = (*winner)->Receive(kPatience);
    ASSERT_TRUE(answer.ok() && answer->has_value()) << answer.status();
    ASSERT_EQ((*answer)->status().code(), 0);
  }
}

TEST_F(SessionLifeTest, SessionsOfDifferentAffinityShareNoStream) {
  v1::CreateSessionRequest request = ArmSessionRequest();
  request.mutable_session()->set_affinity_key("crew-a");
  const std::string first = CreateSession(request);
  const std::string second = CreateSession(request);
  request.mutable_session()->set_affinity_key("crew-b");
  const std::string stranger = CreateSession(request);

  const auto stream = OpenStream({AttachRequest(first), AttachRequest(second)});
  v1::AttachSession attach = AttachRequest(stranger);
  attach.set_slot(2);
  ExpectEvent(EventOf(*stream, attach), StreamEvent::KIND_DETACHED,
              absl::StatusCode::kFailedPrecondition, "crew-b");
  for (int slot : {0, 1}) {
    ASSERT_TRUE(stream->SendFrame(WholeFrame(1, slot)));
    EXPECT_EQ(stream->NextFrame()->status().code(), 0);
  }
  // The refused one is free.
  EXPECT_TRUE(OpenStream({AttachRequest(stranger)})->SendFrame(WholeFrame(1)));
}

TEST_F(SessionLifeTest, AttachOfNonsenseIsRefusedByName) {
  const auto stream = OpenStream();
  v1::AttachSession attach = AttachRequest("sessions/nobody");
  ExpectEvent(EventOf(*stream, attach), StreamEvent::KIND_DETACHED,
              absl::StatusCode::kNotFound, "sessions/nobody");
  attach.set_session("nobody");
  attach.set_slot(-2);
  const auto event = EventOf(*stream, attach);
  ExpectEvent(event, StreamEvent::KIND_DETACHED,
              absl::StatusCode::kInvalidArgument, "attach.session: ");
  ExpectEvent(event, StreamEvent::KIND_DETACHED,
              absl::StatusCode::kInvalidArgument,
              "attach.slot: want 0 or more, got -2");
  attach = AttachRequest(CreateSession());
  attach.set_report_interval(-1);
  attach.set_continuation_interval(-3);
  ExpectEvent(EventOf(*stream, attach), StreamEvent::KIND_DETACHED,
              absl::StatusCode::kInvalidArgument,
              "attach.report_interval: want 0 or more, got -1; "
              "attach.continuation_interval: want 0 or more, got -3");
}

// --- Time to live ---

TEST_F(SessionLifeTest, ReadingDoesNotKeepASessionAlive) {
  const std::string name = CreateShortLived("short-1");
  const auto first = Get(name);
  ASSERT_TRUE(first.ok()) << first.status();
  absl::StatusOr<v1::Session> session = first;
  const absl::Time deadline = absl::Now() + kPatience;
  while (session.ok() && absl::Now() < deadline) {
    EXPECT_EQ(Nanos(session->expire_time()), Nanos(first->expire_time()));
    v1::ListSessionsRequest list;
    list.set_page_size(1000);
    EXPECT_TRUE(Call(&Stub::ListSessions, list).ok());
    absl::SleepFor(absl::Milliseconds(20));
    session = Get(name);
  }
  EXPECT_THAT(session.status(), Fails(absl::StatusCode::kNotFound, name));
  EXPECT_GE(absl::ToUnixNanos(absl::Now()), Nanos(first->expire_time()));
  // The name is free.
  EXPECT_EQ(CreateSession(ArmSessionRequest("short-1")), name);
}

TEST_F(SessionLifeTest, DrivingCallsMoveTheExpireTime) {
  const std::string name = CreateSession();
  int64_t expires = Nanos(Get(name)->expire_time());
  const auto expect_later = [&](const char* call) {
    const int64_t now = Nanos(Get(name)->expire_time());
    EXPECT_GT(now, expires) << call;
    expires = now;
  };
  v1::SolveSessionRequest solve;
  solve.set_name(name);
  ASSERT_TRUE(Call(&Stub::SolveSession, solve).ok());
  expect_later("SolveSession");
  v1::UpdateSessionRequest update;
  update.mutable_session()->set_name(name);
  ASSERT_TRUE(Call(&Stub::UpdateSession, update).ok());
  expect_later("UpdateSession");
  const auto stream = OpenStream({AttachRequest(name)});
  expect_later("attach");
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(stream->SendFrame(WholeFrame(i)));
    ASSERT_TRUE(stream->NextFrame());
    expect_later("frame");
  }
}

TEST_F(SessionLifeTest, ExpiryFreesTheSlot) {
  const std::string name = CreateShortLived();
  const auto stream = OpenStream({AttachRequest(name)});
  ASSERT_TRUE(stream->SendFrame(WholeFrame(8)));
  const auto event = stream->NextNews();
  ExpectEvent(event, StreamEvent::KIND_DETACHED, absl::StatusCode::kNotFound,
              "has expired");
  EXPECT_EQ(event->slot(), 0);
  EXPECT_EQ(event->sequence_number(), 8);
  EXPECT_EQ(stream->NextFrame()->status().code(), 0);
  ASSERT_TRUE(stream->SendFrame(WholeFrame(9)));
  EXPECT_EQ(stream->NextFrame()->status().code(), 3) << "no such slot";
  ExpectEvent(EventOf(*stream, AttachRequest(name)), StreamEvent::KIND_DETACHED,
              absl::StatusCode::kNotFound, name);
  // The stream is as good as new.
  ExpectEvent(EventOf(*stream, AttachRequest(CreateSession())),
              StreamEvent::KIND_ATTACHED, absl::StatusCode::kOk, "");
}

TEST_F(SessionLifeTest, DeletionFreesTheSlotAndNoOther) {
  v1::CreateSessionRequest request = ArmSessionRequest();
  request.mutable_session()->set_affinity_key("crew");
  const std::string name = CreateSession(request);
  const auto stream =
      OpenStream({AttachRequest(name), AttachRequest(CreateSession(request))});
  ASSERT_TRUE(stream->SendFrame(WholeFrame(5)));
  ASSERT_EQ(stream->NextFrame()->status().code(), 0);
  ASSERT_EQ(Delete(name), absl::OkStatus());
  // Whether the event or a frame comes first, the frame is answered.
  ASSERT_TRUE(stream->SendFrame(WholeFrame(6)));
  const auto answer = stream->NextFrame();
  ASSERT_TRUE(answer);
  EXPECT_NE(answer->status().code(), 0);
  EXPECT_EQ(answer->sequence_number(), 6);
  const auto event = stream->NextNews();
  ExpectEvent(event, StreamEvent::KIND_DETACHED, absl::StatusCode::kNotFound,
              "was deleted");
  EXPECT_EQ(event->slot(), 0);
  EXPECT_EQ(event->sequence_number(), 5);
  ASSERT_TRUE(stream->SendFrame(WholeFrame(1, 1)));
  EXPECT_EQ(stream->NextFrame()->status().code(), 0);
}

TEST_F(SessionLifeTest, ACancelledStreamFreesItsSessions) {
  const std::string name = CreateSession();
  for (int i = 1; i <= 20; ++i) {
    const auto stream = OpenStream();
    StreamEvent event;
    // The server sees the end of the stream before when it gets to it.
    for (int attempt = 0; attempt < 1000; ++attempt) {
      event = EventOf(*stream, AttachRequest(name));
      if (event.kind() == StreamEvent::KIND_ATTACHED) break;
      absl::SleepFor(absl::Milliseconds(5));
    }
    ASSERT_EQ(event.kind(), StreamEvent::KIND_ATTACHED) << i;
    for (int j = 0; j < 5; ++j) {
      ASSERT_TRUE(stream->SendFrame(WholeFrame(10 * i + j)));
    }
    stream->Cancel();
  }
}

// --- Viewers ---

// A WatchSession, bounded in time.
class Viewer {
 public:
  Viewer(Stub& stub, const std::string& name,
         absl::Duration min_interval = absl::ZeroDuration()) {
    context_.set_deadline(std::chrono::system_clock::now() +
                          absl::ToChronoMicroseconds(kPatience));
    v1::WatchSessionRequest request;
    request.set_name(name);
    if (min_interval > absl::ZeroDuration()) {
      request.mutable_min_interval()->set_nanos(
          static_cast<int>(absl::ToInt64Nanoseconds(min_interval)));
    }
    reader_ = stub.WatchSession(&context_, request);
  }
  ~Viewer() {
    context_.TryCancel();
    static_cast<void>(Finish());
  }

  bool Read(v1::WatchSessionResponse& response) {
    return reader_->Read(&response);
  }
  absl::Status Finish() {
    v1::WatchSessionResponse rest;
    while (Read(rest)) {
    }
    if (!finished_) status_ = client::FromGrpc(reader_->Finish());
    finished_ = true;
    return status_;
  }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<v1::WatchSessionResponse>> reader_;
  absl::Status status_;
  bool finished_ = false;
};

TEST_F(SessionLifeTest, AViewerSeesThePoseAtOnce) {
  const std::string name = CreateSession();
  Viewer viewer(connection().sessions(), name);
  v1::WatchSessionResponse seen;
  ASSERT_TRUE(viewer.Read(seen));
  EXPECT_EQ(seen.pose().DebugString(), Get(name)->pose().DebugString());
  EXPECT_THAT(seen.joint_frames().world_translations(), SizeIs(9));
  EXPECT_THAT(seen.joint_frames().world_rotations(), SizeIs(12));
}

TEST_F(SessionLifeTest, AViewerGetsTheNewestAndSkipsTheRest) {
  const std::string name = CreateSession();
  const auto stream = OpenStream({AttachRequest(name)});
  Viewer viewer(connection().sessions(), name, absl::Milliseconds(50));
  constexpr int kFrames = 1000;
  std::vector<v1::PoseFrame> answers;
  std::thread driver([&] {
    for (int i = 1; i <= kFrames; ++i) {
      ASSERT_TRUE(stream->SendFrame(WholeFrame(i)));
      answers.push_back(stream->NextFrame().value());
    }
  });
  v1::WatchSessionResponse seen;
  int64_t newest = -1;
  int messages = 0;
  while (newest < kFrames) {
    ASSERT_TRUE(viewer.Read(seen));
    if (seen.has_event()) continue;
    ++messages;
    EXPECT_GE(seen.sequence_number(), newest);
    newest = seen.sequence_number();
  }
  driver.join();
  EXPECT_LT(messages, kFrames);
  EXPECT_EQ(seen.pose().DebugString(), answers.back().pose().DebugString());
}

TEST_F(SessionLifeTest, AViewerThatDoesNotReadHoldsNobodyUp) {
  const std::string name = CreateSession();
  const auto stream = OpenStream({AttachRequest(name)});
  std::vector<std::unique_ptr<Viewer>> viewers;
  for (int i = 0; i < 10; ++i) {
    viewers.push_back(std::make_unique<Viewer>(connection().sessions(), name,
                                               absl::Milliseconds(2)));
  }
  for (int i = 1; i <= 1000; ++i) {
    ASSERT_TRUE(stream->SendFrame(WholeFrame(i)));
    ASSERT_TRUE(stream->NextFrame());
  }
}

TEST_F(SessionLifeTest, AViewerHearsThatTheServerLives) {
  Viewer viewer(connection().sessions(), CreateSession());
  v1::WatchSessionResponse seen;
  ASSERT_TRUE(viewer.Read(seen));
  ASSERT_TRUE(viewer.Read(seen));
  EXPECT_EQ(seen.event().kind(), StreamEvent::KIND_HEARTBEAT);
}

TEST_F(SessionLifeTest, AViewerIsToldTheEnd) {
  const std::string name = CreateSession();
  Viewer viewer(connection().sessions(), name);
  v1::WatchSessionResponse seen;
  ASSERT_TRUE(viewer.Read(seen));
  ASSERT_EQ(Delete(name), absl::OkStatus());
  do {
    ASSERT_TRUE(viewer.Read(seen));
  } while (seen.event().kind() == StreamEvent::KIND_HEARTBEAT);
  ExpectEvent(seen.event(), StreamEvent::KIND_DETACHED,
              absl::StatusCode::kNotFound, "was deleted");
  EXPECT_THAT(viewer.Finish(),
              Fails(absl::StatusCode::kNotFound, "was deleted"));
}

TEST_F(SessionLifeTest, AViewerDoesNotKeepASessionAlive) {
  Viewer viewer(connection().sessions(), CreateShortLived());
  v1::WatchSessionResponse seen;
  do {
    ASSERT_TRUE(viewer.Read(seen));
  } while (seen.event().kind() != StreamEvent::KIND_DETACHED);
  EXPECT_THAT(viewer.Finish(),
              Fails(absl::StatusCode::kNotFound, "has expired"));
}

TEST_F(SessionLifeTest, ThereMustBeSomethingToWatch) {
  EXPECT_THAT(Viewer(connection().sessions(), "sessions/nobody").Finish(),
              Fails(absl::StatusCode::kNotFound, "sessions/nobody"));
  EXPECT_THAT(Viewer(connection().sessions(), "nobody").Finish(),
              Fails(absl::StatusCode::kInvalidArgument, "name: "));
}

}  // namespace
}  // namespace gelenk
