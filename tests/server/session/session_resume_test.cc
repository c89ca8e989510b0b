// Going on where a driver last saw its session.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/session/session.h"
#include "tests/testing/example_sessions.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ArmGoals;
using ::gelenk::testing::ArmSession;
using ::gelenk::testing::kAim;
using ::gelenk::testing::ReachFrame;
using ::gelenk::testing::StateOf;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;

constexpr DriverId kDriver = 7;
const absl::Time kNow = absl::FromUnixSeconds(1000);

std::shared_ptr<Session> DrivenSession() {
  auto session = ArmSession(kNow);
  EXPECT_TRUE(session->Claim(kDriver, false, kNow).ok());
  return session;
}

Eigen::VectorXd SolveFrame(Session& session, InputFrame frame) {
  IkSolver solver;
  SolvedFrame solved;
  EXPECT_TRUE(session.Apply(kDriver, frame, kNow).ok());
  EXPECT_TRUE(session.Solve(kDriver, solver, false, solved).ok());
  return solved.positions;
}

TEST(SessionResumeTest, TakesPoseAndSequenceNumber) {
  const auto session = DrivenSession();
  const Eigen::VectorXd positions = Eigen::Vector3d(0.3, 0.2, 0.1);
  ASSERT_TRUE(session->Resume(kDriver, {positions, 41, nullptr, nullptr}).ok());
  Eigen::VectorXd now;
  session->CopyPositions(now);
  EXPECT_EQ(now, positions);
  EXPECT_EQ(session->sequence_number(), 41);
  InputFrame old = ReachFrame(41, 0.5, 0.5);
  EXPECT_THAT(ViolationLines(session->Apply(kDriver, old, kNow)),
              ElementsAre("sequence_number: want more than 41, got 41"));
  InputFrame next = ReachFrame(42, 0.5, 0.5);
  EXPECT_TRUE(session->Apply(kDriver, next, kNow).ok());
}

TEST(SessionResumeTest, MayGoBackToAnEarlierFrame) {
  const auto session = DrivenSession();
  InputFrame frame = ReachFrame(100, 0.5, 0.5);
  ASSERT_TRUE(session->Apply(kDriver, frame, kNow).ok());
  const Eigen::VectorXd positions = Eigen::Vector3d(0.3, 0.2, 0.1);
  ASSERT_TRUE(session->Resume(kDriver, {positions, 90, nullptr, nullptr}).ok());
  EXPECT_EQ(session->sequence_number(), 90);
}

TEST(SessionResumeTest, EndsAColdStart) {
  SessionState cold;
  cold.positions = Eigen::Vector3d::Zero();
  const auto session = ArmSession(kNow, ArmGoals(), cold);
  ASSERT_TRUE(session->Claim(kDriver, false, kNow).ok());
  ASSERT_TRUE(session->IsHeavy());
  ASSERT_TRUE(
      session->Resume(kDriver, {cold.positions, 1, nullptr, nullptr}).ok());
  EXPECT_FALSE(session->IsHeavy());
}

TEST(SessionResumeTest, GoesOnBitByBit) {
  const auto first = DrivenSession();
  const auto frame_at = [](int i) {
    InputFrame frame = ReachFrame(i, 1.1 - 0.04 * i, 0.03 * i);
    if (i == 3) frame.updates.push_back({kAim, {}, 0.02});
    if (i == 5) {
      frame.world_from_skeleton =
          RigidTransform{Eigen::Quaterniond::Identity(), {0.05, 0, 0}};
    }
    return frame;
  };
  Eigen::VectorXd positions;
  for (int i = 1; i <= 10; ++i) positions = SolveFrame(*first, frame_at(i));

  const SessionState known = first->Snapshot().state;
  const auto second = DrivenSession();
  ASSERT_TRUE(second
                  ->Resume(kDriver, {positions, 10, &known.goals,
                                     &known.world_from_skeleton})
                  .ok());
  for (int i = 11; i <= 20; ++i) {
    ASSERT_EQ(SolveFrame(*first, frame_at(i)), SolveFrame(*second, frame_at(i)))
        << "frame " << i;
  }
}

TEST(SessionResumeTest, RefusesBadGoalsAndChangesNothing) {
  const auto session = DrivenSession();
  const std::string before = StateOf(*session);
  std::vector<Goal> goals = ArmGoals();
  goals[1].weight = -1;
  const Eigen::VectorXd positions = Eigen::Vector3d(0.3, 0.2, 0.1);
  EXPECT_THAT(
      ViolationLines(session->Resume(kDriver, {positions, 9, &goals, nullptr})),
      ElementsAre("goals[1].weight: want a finite number >= 0, got -1"));
  EXPECT_EQ(StateOf(*session), before);
}

TEST(SessionResumeTest, RefusesABadPlaceAndChangesNothing) {
  const auto session = DrivenSession();
  const std::string before = StateOf(*session);
  const std::vector<Goal> goals = ArmGoals();
  const RigidTransform place{Eigen::Quaterniond(0, 0, 0, 0), {0, 0, 0}};
  const Eigen::VectorXd positions = Eigen::Vector3d(0.3, 0.2, 0.1);
  EXPECT_THAT(
      ViolationLines(session->Resume(kDriver, {positions, 9, &goals, &place})),
      ElementsAre("world_from_skeleton.rotation: want a unit quaternion, got "
                  "(0, 0, 0, 0)"));
  EXPECT_EQ(StateOf(*session), before);
}

}  // namespace
}  // namespace gelenk::server
