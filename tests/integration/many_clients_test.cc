// Many at a time: streams on several connections, and sessions that idle, with
// the memory that they take.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/skeleton.h"
#include "tests/integration/service_test.h"
#include "tests/testing/example_bodies.h"
#include "tests/testing/sanitizer.h"

namespace gelenk {
namespace {

using testing::ArmSessionRequest;
using testing::AttachRequest;
using testing::kPatience;
using testing::kSanitized;
using testing::SolveStream;
using testing::WholeFrame;

using Stub = v1::SessionService::Stub;
using Positions = std::vector<double>;

Positions PositionsOf(const v1::PoseFrame& frame) {
  return {frame.pose().positions().begin(), frame.pose().positions().end()};
}

// Calls `work` with 0 .. count - 1, on several threads.
void InParallel(int count, const std::function<void(int)>& work) {
  constexpr int kThreads = 4;
  std::atomic<int> next{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&] {
      for (int j = next++; j < count; j = next++) work(j);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

// --- Streams ---

class ManyStreamsTest : public ServiceTest {};

TEST_F(ManyStreamsTest, AreAnsweredInOrderAndAsIfTheyWereAlone) {
  constexpr int kConnections = 10;
  constexpr int kStreamsEach = 20;
  constexpr int kFrames = 60;
  std::vector<Positions> alone;
  const auto reference = OpenStream({AttachRequest(CreateSession())});
  for (int i = 1; i <= kFrames; ++i) {
    ASSERT_TRUE(reference->SendFrame(WholeFrame(i)));
    alone.push_back(PositionsOf(reference->NextFrame().value()));
  }

  std::atomic<int> answered{0};
  std::vector<std::thread> clients;
  for (int c = 0; c < kConnections; ++c) {
    clients.emplace_back([&] {
      client::Connection connection(server().target());
      std::vector<std::unique_ptr<SolveStream>> streams;
      for (int s = 0; s < kStreamsEach; ++s) {
        streams.push_back(std::make_unique<SolveStream>(connection.sessions()));
        ASSERT_TRUE(streams[s]->Attach(AttachRequest(CreateSession())));
      }
      for (int i = 1; i <= kFrames; ++i) {
        for (const auto& stream : streams) {
          ASSERT_TRUE(stream->SendFrame(WholeFrame(i)));
        }
        for (const auto& stream : streams) {
          const auto answer = stream->NextFrame();
          ASSERT_TRUE(answer);
          ASSERT_EQ(answer->sequence_number(), i);
          ASSERT_EQ(answer->status().code(), 0) << answer->status().message();
          ASSERT_EQ(PositionsOf(*answer), alone[i - 1]);
          ++answered;
        }
      }
      for (const auto& stream : streams) {
        stream->HalfClose();
        EXPECT_EQ(stream->Finish(), absl::OkStatus());
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(answered, kConnections * kStreamsEach * kFrames);
}

class FewStreamsTest : public ServiceTest {
 protected:
  static void SetUpTestSuite() { StartServer({"--max-streams", "3"}); }
};

TEST_F(FewStreamsTest, MoreThanTheLimitAreRefusedUntilOneLeaves) {
  std::vector<std::unique_ptr<SolveStream>> streams;
  for (int i = 0; i < 3; ++i) {
    streams.push_back(OpenStream({AttachRequest(CreateSession())}));
  }
  const auto refused = OpenStream();
  const absl::Status status = refused->Finish();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  streams[1]->HalfClose();
  ASSERT_EQ(streams[1]->Finish(), absl::OkStatus());
  EXPECT_TRUE(
      OpenStream({AttachRequest(CreateSession())})->SendFrame(WholeFrame(1)));
}

// --- Sessions ---

class IdleSessionsTest : public ServiceTest {
 protected:
  static void SetUpTestSuite() {
    StartServer({});
    v1::CreateSkeletonRequest request;
    request.set_skeleton_id("person");
    convert::ToProto(*testing::PersonWithFingers(), request.mutable_skeleton());
    ASSERT_TRUE(
        Call(&v1::KinematicsService::Stub::CreateSkeleton, request).ok());
  }

  // 64 joints, six pose goals.
  static v1::CreateSessionRequest PersonRequest(int number) {
    v1::CreateSessionRequest request;
    request.set_session_id(absl::StrCat("person-", number));
    v1::Session* session = request.mutable_session();
    session->set_skeleton("skeletons/person");
    for (const char* effector : {"left_palm", "right_palm", "left_sole",
                                 "right_sole", "crown", "chest"}) {
      v1::Goal* goal = session->add_goals();
      goal->set_goal_id(effector);
      goal->mutable_pose()->set_end_effector_id(effector);
    }
    return request;
  }

  static void Create(int first, int count) {
    InParallel(count, [first](int i) {
      ASSERT_TRUE(Call(&Stub::CreateSession, PersonRequest(first + i)).ok());
    });
  }
  static void Solve(int first, int count) {
    InParallel(count, [first](int i) {
      v1::SolveSessionRequest request;
      request.set_name(absl::StrCat("sessions/person-", first + i));
      ASSERT_TRUE(Call(&Stub::SolveSession, request).ok());
    });
  }
  static void Delete(int first, int count) {
    InParallel(count, [first](int i) {
      v1::DeleteSessionRequest request;
      request.set_name(absl::StrCat("sessions/person-", first + i));
      ASSERT_TRUE(Call(&Stub::DeleteSession, request).ok());
    });
  }
};

TEST_F(IdleSessionsTest, TakeWhatIsPromised) {
  constexpr int kSessions = 1000;
  // Promised of a session beyond what sessions share.
  constexpr int64_t kPromisedBytes = 16 * 1024;
  // Of the process: what the allocator rounds up, whole pages.
  constexpr int64_t kSlackBytes = 1 << 20;
  // What the server takes once: arenas, connections, threads' stacks.
  constexpr int kFirst = 200;
  Create(0, kFirst);
  Solve(0, 20);
  const int64_t before = server().resident_bytes();
  Create(kFirst, kSessions);
  Solve(kFirst, 20);
  const int64_t grown = server().resident_bytes() - before;
  std::cout << grown / kSessions << " bytes a session\n";
  if (!kSanitized) {
    EXPECT_LE(grown, kSessions * kPromisedBytes + kSlackBytes);
  }
  Delete(0, kFirst + kSessions);
}

TEST_F(IdleSessionsTest, ThatAreDeletedGiveTheirMemoryBack) {
  constexpr int kSessions = 10000;
  // Fragments that the second round cannot use.
  constexpr double kMostGrowth = 1.05;
  int64_t after_round[2] = {};
  for (int64_t& bytes : after_round) {
    Create(0, kSessions);
    bytes = server().resident_bytes();
    std::cout << (bytes >> 10) << " KiB with " << kSessions << " sessions\n";
    Delete(0, kSessions);
  }
  if (!kSanitized) {
    EXPECT_LE(after_round[1], kMostGrowth * after_round[0]);
  }
}

}  // namespace
}  // namespace gelenk
