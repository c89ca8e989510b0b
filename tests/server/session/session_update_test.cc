// Changes of a session by unary calls, and its life.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/session/session.h"
#include "tests/testing/example_sessions.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ArmSession;
using ::gelenk::testing::kReach;
using ::gelenk::testing::ReachFrame;
using ::gelenk::testing::StateOf;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;

constexpr DriverId kDriver = 7;
constexpr absl::Duration kMoment = absl::Nanoseconds(1);
const absl::Time kNow = absl::FromUnixSeconds(1000);

absl::Status SetReachWeight(Session& session, double weight,
                            std::optional<int64_t> revision) {
  return session.Update(
      [weight](SessionState& state) {
        state.goals[kReach].weight = weight;
        return absl::OkStatus();
      },
      revision, kNow);
}

double ReachWeight(const Session& session) {
  return session.Snapshot().state.goals[kReach].weight;
}

TEST(SessionUpdateTest, TakesTheChange) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(SetReachWeight(*session, 3, {}).ok());
  EXPECT_EQ(ReachWeight(*session), 3);
}

TEST(SessionUpdateTest, TakesAChangeOfTheRevisionItSaw) {
  const auto session = ArmSession(kNow);
  const int64_t seen = session->Snapshot().revision;
  ASSERT_TRUE(SetReachWeight(*session, 3, seen).ok());
  const absl::Status again = SetReachWeight(*session, 4, seen);
  EXPECT_EQ(again.code(), absl::StatusCode::kAborted) << again;
  EXPECT_EQ(ReachWeight(*session), 3);
  EXPECT_TRUE(SetReachWeight(*session, 4, session->Snapshot().revision).ok());
}

TEST(SessionUpdateTest, RevisionsCountEverythingButThePose) {
  const auto session = ArmSession(kNow);
  const int64_t revision = session->Snapshot().revision;
  IkSolver solver;
  SolvedFrame solved;
  ASSERT_TRUE(session->Solve(kUnaryDriver, solver, true, solved).ok());
  EXPECT_EQ(session->Snapshot().revision, revision);
  InputFrame patch;
  patch.patch = [](absl::Span<const Goal> goals) {
    return absl::StatusOr<std::vector<Goal>>(
        std::vector<Goal>(goals.begin(), goals.end()));
  };
  ASSERT_TRUE(session->Apply(kUnaryDriver, patch, kNow).ok());
  EXPECT_GT(session->Snapshot().revision, revision);
}

TEST(SessionUpdateTest, IsRefusedWhileAStreamDrives) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(session->Claim(kDriver, false, kNow).ok());
  EXPECT_EQ(SetReachWeight(*session, 3, {}).code(),
            absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(ReachWeight(*session), 1);
}

TEST(SessionUpdateTest, IsRefusedAfterTheEnd) {
  const auto session = ArmSession(kNow);
  session->End(absl::NotFoundError("deleted"));
  EXPECT_EQ(SetReachWeight(*session, 3, {}).code(),
            absl::StatusCode::kNotFound);
}

TEST(SessionUpdateTest, ARefusedChangeChangesNothing) {
  const auto session = ArmSession(kNow);
  const std::string before = StateOf(*session);
  const absl::Status status = session->Update(
      [](SessionState& state) {
        state.goals.clear();
        return absl::InvalidArgumentError("no");
      },
      {}, kNow);
  EXPECT_EQ(status, absl::InvalidArgumentError("no"));
  EXPECT_EQ(StateOf(*session), before);
}

TEST(SessionUpdateTest, GoalsThatDoNotFitChangeNothing) {
  const auto session = ArmSession(kNow);
  const std::string before = StateOf(*session);
  EXPECT_THAT(ViolationLines(SetReachWeight(*session, -1, {})),
              ElementsAre("goals[0].weight: want a finite number >= 0, got "
                          "-1"));
  EXPECT_EQ(StateOf(*session), before);
}

TEST(SessionUpdateTest, ShowsViewersAPoseThatWasSet) {
  const auto session = ArmSession(kNow);
  uint64_t version = 0;
  Eigen::VectorXd positions;
  RigidTransform place;
  int64_t number = 0;
  session->CopyIfNewer(version, positions, place, number);
  ASSERT_TRUE(session
                  ->Update(
                      [](SessionState& state) {
                        state.positions = Eigen::Vector3d(1, 0, 0);
                        return absl::OkStatus();
                      },
                      {}, kNow)
                  .ok());
  EXPECT_TRUE(session->CopyIfNewer(version, positions, place, number));
  EXPECT_EQ(positions[0], 1);
}

// --- Expiry ---

TEST(SessionExpiryTest, DiesWhenItsTimeIsOver) {
  const auto session = ArmSession(kNow);
  const absl::Time end = kNow + absl::Minutes(10);
  EXPECT_EQ(session->Snapshot().expire_time, end);
  EXPECT_FALSE(session->IsExpired(end - kMoment));
  EXPECT_TRUE(session->IsExpired(end));
}

TEST(SessionExpiryTest, DrivingProlongsItsLife) {
  const auto session = ArmSession(kNow);
  const absl::Time later = kNow + absl::Minutes(9);
  InputFrame frame = ReachFrame(1, 0.5, 0.5);
  ASSERT_TRUE(session->Apply(kUnaryDriver, frame, later).ok());
  EXPECT_EQ(session->Snapshot().expire_time, later + absl::Minutes(10));
}

TEST(SessionExpiryTest, AFrameWithAFaultIsDrivingToo) {
  const auto session = ArmSession(kNow);
  const absl::Time later = kNow + absl::Minutes(9);
  InputFrame frame = ReachFrame(1, 0.5, 0.5);
  frame.updates[0].weight = -1;
  ASSERT_FALSE(session->Apply(kUnaryDriver, frame, later).ok());
  EXPECT_EQ(session->Snapshot().expire_time, later + absl::Minutes(10));
}

TEST(SessionExpiryTest, ClaimingAndUpdatingProlongItsLife) {
  const auto session = ArmSession(kNow);
  absl::Time later = kNow + absl::Minutes(9);
  ASSERT_TRUE(session->Claim(kDriver, false, later).ok());
  EXPECT_EQ(session->Snapshot().expire_time, later + absl::Minutes(10));
  session->Release(kDriver);
  later += absl::Minutes(9);
  ASSERT_TRUE(session
                  ->Update(
                      [](SessionState& state) {
                        state.idle_ttl = absl::Minutes(1);
                        return absl::OkStatus();
                      },
                      {}, later)
                  .ok());
  EXPECT_EQ(session->Snapshot().expire_time, later + absl::Minutes(1));
}

TEST(SessionExpiryTest, WhoIsRefusedDoesNotProlongIt) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(session->Claim(kDriver, false, kNow).ok());
  const absl::Time later = kNow + absl::Minutes(9);
  InputFrame frame = ReachFrame(1, 0.5, 0.5);
  EXPECT_FALSE(session->Apply(kUnaryDriver, frame, later).ok());
  EXPECT_FALSE(session->Claim(kDriver + 1, false, later).ok());
  EXPECT_EQ(session->Snapshot().expire_time, kNow + absl::Minutes(10));
}

TEST(SessionExpiryTest, LookingDoesNotProlongIt) {
  const auto session = ArmSession(kNow);
  uint64_t version = 9;
  Eigen::VectorXd positions;
  RigidTransform place;
  int64_t number = 0;
  session->CopyIfNewer(version, positions, place, number);
  session->Snapshot();
  EXPECT_EQ(session->Snapshot().expire_time, kNow + absl::Minutes(10));
}

}  // namespace
}  // namespace gelenk::server
